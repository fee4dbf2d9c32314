//! Converts `file:` URIs to paths and back. URIs of other schemes are used as paths unchanged.

use std::path::{Path, PathBuf};

use gen_lsp_types::Uri;
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, percent_decode_str, utf8_percent_encode};

use crate::source::normalize;

/// The characters that are percent-encoded in paths (RFC 3986, section 3.3).
const OUTSIDE_OF_PATHS: &AsciiSet = &NON_ALPHANUMERIC
    .remove(b'-')
    .remove(b'.')
    .remove(b'_')
    .remove(b'~')
    .remove(b'/')
    .remove(b':')
    .remove(b'@')
    .remove(b'!')
    .remove(b'$')
    .remove(b'&')
    .remove(b'(')
    .remove(b')')
    .remove(b'*')
    .remove(b'+')
    .remove(b',')
    .remove(b';')
    .remove(b'=')
    .remove(b'\'');

/// The path of a document, without `.` and `..`.
pub(super) fn path_of(uri: &Uri) -> PathBuf {
    let Some(rest) = uri.0.strip_prefix("file://") else { return PathBuf::from(&uri.0) };
    // Drop the host, which precedes the first slash.
    let path = rest.find('/').map_or("", |at| &rest[at..]);
    let decoded = percent_decode_str(path).decode_utf8_lossy();
    let bytes = decoded.as_bytes();
    let has_drive = matches!(bytes, [b'/', drive, b':', ..] if drive.is_ascii_alphabetic());
    normalize(Path::new(if has_drive { &decoded[1..] } else { &decoded }))
}

/// The URI of a path.
pub(super) fn uri_of(path: &Path) -> Uri {
    let text = path.to_string_lossy().replace('\\', "/");
    if !text.starts_with('/') && text.get(1..2).is_none_or(|colon| colon != ":") {
        return Uri(text);
    }
    let root = if text.starts_with('/') { "file://" } else { "file:///" };
    Uri(format!("{root}{}", utf8_percent_encode(&text, OUTSIDE_OF_PATHS)))
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
