//! `hypedc play --export`: the page, the engine as WebAssembly and the files of a program in one HTML file, which plays
//! without a network and without `hypedc`.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;

use crate::compile::{Compilation, LevelFile, compile_with};
use crate::source::{Files, ReadError};

use super::super::Exit;
use super::super::args::PlayArgs;
use super::super::disk::Disk;
use super::super::pictures::image;
use super::super::report::{plain_error, show};

/// The engine, packed by gzip.
#[cfg(feature = "web-engine")]
const ENGINE: Option<&[u8]> = Some(include_bytes!("../../../bindings/web/dist/hypedc.wasm.gz"));
#[cfg(not(feature = "web-engine"))]
const ENGINE: Option<&[u8]> = None;

/// How a file begins that gzip has packed.
const GZIP: [u8; 2] = [0x1f, 0x8b];
/// How a module of WebAssembly begins.
const MODULE: [u8; 4] = *b"\0asm";

/// The page may load nothing, from nowhere; WebAssembly is compiled from what it carries.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline' 'wasm-unsafe-eval'; style-src 'unsafe-inline'; \
    img-src data: blob:; worker-src blob:; base-uri 'none'; form-action 'none'";

/// The files of a program, as `studio/src/worker/project.ts` has them.
#[derive(Debug, Serialize)]
struct Project {
    files: BTreeMap<String, String>,
    /// The pictures that the program names, as addresses that hold the whole files.
    pictures: BTreeMap<String, String>,
    root: String,
    map: Option<String>,
    legend: Option<String>,
    tile: Option<(f64, f64)>,
}

/// Writes the page of a program to a file.
pub(super) fn run(args: &PlayArgs, target: &Path) -> io::Result<Exit> {
    let engine = match engine(args.engine.as_deref()) {
        Ok(engine) => engine,
        Err(why) => {
            plain_error(&why)?;
            return Ok(Exit::Refused);
        }
    };
    let level = args.level.file();
    let recorder = Recorder::default();
    let Compilation { sources, program, diagnostics } = compile_with(&args.file, level, &recorder);
    let Some(program) = program else {
        show(&sources, &diagnostics)?;
        return Ok(Exit::No);
    };
    if program.worlds.is_empty() {
        plain_error(&format!("`{}` has no world to play", args.file.display()))?;
        return Ok(Exit::Refused);
    }
    let mut project = project(&args.file, level, recorder.texts.into_inner())?;
    for name in program.looks.pictures() {
        match image(name, &args.file) {
            Ok((_, address)) => drop(project.pictures.insert(name.to_string(), address)),
            Err(why) => {
                plain_error(&why)?;
                return Ok(Exit::Refused);
            }
        }
    }
    // A level is played without the pictures of its editor, too.
    let tiles = program.looks.tile_pictures().into_iter();
    project.pictures.extend(tiles.filter_map(|name| Some((name.to_string(), image(name, &args.file).ok()?.1))));
    let json = serde_json::to_string(&project).map_err(io::Error::other)?;
    let page = page(super::PAGE, &json, &engine).ok_or_else(|| io::Error::other("the page has no head"))?;
    if let Err(error) = fs::write(target, &page) {
        plain_error(&format!("cannot write `{}`: {error}", target.display()))?;
        return Ok(Exit::Refused);
    }
    writeln!(
        io::stdout(),
        "{}: {} kB, {} files",
        target.display(),
        page.len().div_ceil(1000),
        project.files.len() + project.pictures.len()
    )?;
    Ok(Exit::Yes)
}

/// The engine, packed: of this binary, or of a file.
///
/// # Errors
/// Why there is none.
fn engine(file: Option<&Path>) -> Result<Vec<u8>, String> {
    let Some(file) = file else {
        return ENGINE.map(<[u8]>::to_vec).ok_or_else(|| {
            "this hypedc was built without the engine for browsers: build one with `bindings/web/build` in hypedc's \
             repository, and give it with `--engine bindings/web/dist/hypedc.wasm.gz`"
                .to_string()
        });
    };
    let bytes = fs::read(file).map_err(|error| format!("cannot read `{}`: {error}", file.display()))?;
    if bytes.starts_with(&GZIP) {
        return Ok(bytes);
    }
    if !bytes.starts_with(&MODULE) {
        return Err(format!("`{}` is no module of WebAssembly", file.display()));
    }
    let mut packer = GzEncoder::new(Vec::new(), Compression::best());
    packer.write_all(&bytes).and_then(|()| packer.finish()).map_err(|error| error.to_string())
}

/// Reads from the disk, and keeps what was read.
#[derive(Default)]
struct Recorder {
    texts: RefCell<BTreeMap<PathBuf, String>>,
}

impl Files for Recorder {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        let text = Disk.read(path)?;
        self.texts.borrow_mut().insert(path.to_path_buf(), text.clone());
        Ok(text)
    }

    fn identity(&self, path: &Path) -> PathBuf {
        Disk.identity(path)
    }
}

/// The files by names that say nothing about the machine: relative to the folder of the program.
fn project(root: &Path, level: LevelFile<'_>, texts: BTreeMap<PathBuf, String>) -> io::Result<Project> {
    let folder = normal(&std::path::absolute(root)?);
    let folder = folder.parent().unwrap_or(Path::new("/")).to_path_buf();
    let name = |path: &Path| -> io::Result<String> {
        let path = normal(&std::path::absolute(path)?);
        Ok(relative(&folder, &path).iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/"))
    };
    let files = texts.into_iter().map(|(path, text)| Ok((name(&path)?, text)));
    Ok(Project {
        files: files.collect::<io::Result<_>>()?,
        pictures: BTreeMap::new(),
        root: name(root)?,
        map: level.map.map(name).transpose()?,
        legend: level.legend.map(name).transpose()?,
        tile: level.tile,
    })
}

/// A path without `.` and `..`.
fn normal(path: &Path) -> PathBuf {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                out.pop();
            }
            other => out.push(other),
        }
    }
    out
}

/// A path as it is named from a folder.
fn relative(folder: &Path, path: &Path) -> PathBuf {
    let shared = folder.components().zip(path.components()).take_while(|(a, b)| a == b).count();
    let up = folder.components().skip(shared).map(|_| Component::ParentDir);
    up.chain(path.components().skip(shared)).collect()
}

/// The page with what it carries, before its script.
fn page(page: &str, project: &str, engine: &[u8]) -> Option<String> {
    const HEAD: &str = "<head>";
    let at = page.find(HEAD)? + HEAD.len();
    // A `<` in a string could end the script.
    let project = project.replace('<', "\\u003c");
    let engine = STANDARD.encode(engine);
    Some(format!(
        "{}\n<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n\
         <script type=\"application/json\" id=\"project\">{project}</script>\n\
         <script type=\"text/plain\" id=\"engine\">{engine}</script>{}",
        &page[..at],
        &page[at..]
    ))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    #[test]
    fn files_are_named_from_the_folder_of_the_program() {
        let named = |path: &str| relative(Path::new("/home/me/games"), Path::new(path)).display().to_string();
        assert_eq!(named("/home/me/games/a.hyped"), "a.hyped");
        assert_eq!(named("/home/me/games/levels/1.txt"), "levels/1.txt");
        assert_eq!(named("/home/me/shared/b.hyped"), "../shared/b.hyped");
        assert_eq!(normal(Path::new("/home/./me/games/../x")), Path::new("/home/me/x"));
    }

    #[test]
    fn what_a_page_carries_does_not_end_its_script() {
        let page = page("<html><head><title></title></head></html>", "{\"a\":\"</script>\"}", &[1, 2, 3]).unwrap();
        assert!(page.contains("{\"a\":\"\\u003c/script>\"}</script>"), "{page}");
        assert!(page.contains(">AQID</script><title>"), "{page}");
    }

    #[test]
    fn only_modules_are_engines() {
        let path = std::env::temp_dir().join(format!("hypedc_engine_{}", std::process::id()));
        fs::write(&path, b"not a module").unwrap();
        assert!(engine(Some(&path)).is_err());
        fs::write(&path, b"\0asm1234").unwrap();
        assert!(engine(Some(&path)).unwrap().starts_with(&GZIP));
        fs::remove_file(&path).unwrap();
        assert!(engine(Some(&path)).is_err());
    }
}
