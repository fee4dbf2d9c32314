//! Names of documents: `file:` URIs to paths and back. A document of another scheme is called by its URI.

use std::path::{Component, Path, PathBuf};

use gen_lsp_types::Uri;

/// The path of a document, without `.` and `..`.
pub(in crate::lsp) fn path_of(uri: &Uri) -> PathBuf {
    let Some(rest) = uri.0.strip_prefix("file://") else { return PathBuf::from(&uri.0) };
    // What stands before the first slash is a host; ours has no name.
    let path = rest.find('/').map_or("", |at| &rest[at..]);
    let decoded = decoded(path);
    let bytes = decoded.as_bytes();
    let has_drive = matches!(bytes, [b'/', drive, b':', ..] if drive.is_ascii_alphabetic());
    clean(Path::new(if has_drive { &decoded[1..] } else { &decoded }))
}

/// The URI of a path.
pub(in crate::lsp) fn uri_of(path: &Path) -> Uri {
    let text = path.to_string_lossy().replace('\\', "/");
    if !text.starts_with('/') && text.get(1..2).is_none_or(|colon| colon != ":") {
        return Uri(text);
    }
    let mut uri = String::from(if text.starts_with('/') { "file://" } else { "file:///" });
    for byte in text.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/:@!$&'()*+,;=".contains(&byte) {
            uri.push(char::from(byte));
        } else {
            uri.push_str(&format!("%{byte:02X}"));
        }
    }
    Uri(uri)
}

/// A path without `.` and `..`, whatever the disk says of links.
pub(in crate::lsp) fn clean(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if matches!(out.components().next_back(), Some(Component::Normal(_))) => {
                out.pop();
            }
            other => out.push(other),
        }
    }
    out
}

fn decoded(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        let code = after.get(..2).filter(|_| byte == b'%').and_then(|two| std::str::from_utf8(two).ok());
        match code.and_then(|two| u8::from_str_radix(two, 16).ok()) {
            Some(code) => {
                bytes.push(code);
                rest = after.get(2..).unwrap_or_default();
            }
            None => {
                bytes.push(byte);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_and_uris_name_the_same() {
        for (uri, path) in [
            ("file:///a/b%20c/%C3%A9.hyped", "/a/b c/é.hyped"),
            ("file:///a/x/../b.hyped", "/a/b.hyped"),
            ("file:///c:/games/a.hyped", "c:/games/a.hyped"),
            ("file:///c%3A/games/a.hyped", "c:/games/a.hyped"),
            ("untitled:Untitled-1", "untitled:Untitled-1"),
            ("file:///100%", "/100%"),
        ] {
            assert_eq!(path_of(&Uri(uri.into())), Path::new(path));
        }
        assert_eq!(uri_of(Path::new("/a/b c/é.hyped")).0, "file:///a/b%20c/%C3%A9.hyped");
        assert_eq!(uri_of(Path::new("c:/games/a.hyped")).0, "file:///c:/games/a.hyped");
    }
}
