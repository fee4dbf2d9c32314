//! `hypedc play --export`, and reports as pages: the page, the engine as WebAssembly and the files of a program in one
//! HTML file, which plays without a network and without `hypedc`.

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
use crate::diagnostic::Diagnostics;
use crate::source::{Files, ReadError, SourceMap};

use super::super::Exit;
use super::super::args::PlayArgs;
use super::super::args::output::{is_standard, write};
use super::super::disk::Disk;
use super::super::pictures::image;
use super::super::reach::counted;
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
#[derive(Debug, Clone, Serialize)]
struct Project {
    files: BTreeMap<String, String>,
    /// The pictures that the program names, as addresses that hold the whole files.
    pictures: BTreeMap<String, String>,
    root: String,
    map: Option<String>,
    legend: Option<String>,
    tile: Option<(f64, f64)>,
    /// The world that is shown first.
    #[serde(skip_serializing_if = "Option::is_none")]
    world: Option<String>,
}

/// What a page carries.
pub(in crate::cli) struct Carried {
    project: Project,
    engine: Vec<u8>,
}

/// Why there is no page.
pub(in crate::cli) enum NoPage {
    Plain(String),
    /// The program has errors.
    Findings(SourceMap, Diagnostics),
    Io(io::Error),
}

impl NoPage {
    /// Shows it on standard error.
    pub fn show(self) -> io::Result<Exit> {
        match self {
            NoPage::Plain(why) => {
                plain_error(&why)?;
                Ok(Exit::Refused)
            }
            NoPage::Findings(sources, found) => {
                show(&sources, &found)?;
                Ok(Exit::No)
            }
            NoPage::Io(error) => Err(error),
        }
    }
}

impl Carried {
    /// Reads the files of a program and the engine: of this binary, or of a file.
    pub fn read(file: &Path, level: LevelFile<'_>, engine_file: Option<&Path>) -> Result<Carried, NoPage> {
        let engine = engine(engine_file).map_err(NoPage::Plain)?;
        let recorder = Recorder::default();
        let Compilation { sources, program, diagnostics, .. } = compile_with(file, level, &recorder);
        let Some(program) = program else { return Err(NoPage::Findings(sources, diagnostics)) };
        if program.worlds.is_empty() {
            return Err(NoPage::Plain(format!("`{}` has no world to play", file.display())));
        }
        let mut project = project(file, level, recorder.texts.into_inner()).map_err(NoPage::Io)?;
        for name in program.looks.pictures() {
            let (_, address) = image(name, file).map_err(NoPage::Plain)?;
            project.pictures.insert(name.to_string(), address);
        }
        // A level is played without the pictures of its editor, too.
        let tiles = program.looks.tile_pictures().into_iter();
        project.pictures.extend(tiles.filter_map(|name| Some((name.to_string(), image(name, file).ok()?.1))));
        Ok(Carried { project, engine })
    }

    /// The page, with a report of answers if there is one.
    fn page(&self, world: Option<&str>, report: Option<&str>) -> io::Result<String> {
        let project = Project { world: world.map(str::to_string), ..self.project.clone() };
        let json = serde_json::to_string(&project).map_err(io::Error::other)?;
        page(super::PAGE, (&json, report), &self.engine).ok_or_else(|| io::Error::other("the page has no head"))
    }

    /// Writes the page of a world with a report.
    ///
    /// # Errors
    /// Why it cannot be written.
    pub fn save(&self, target: &Path, world: Option<&str>, report: &impl Serialize) -> Result<(), String> {
        let json = serde_json::to_string(report).map_err(io::Error::other);
        let page = json.and_then(|json| self.page(world, Some(&json)));
        let written = page.and_then(|page| fs::write(target, page));
        written.map_err(|error| format!("cannot write `{}`: {error}", target.display()))
    }
}

/// Writes the page of a program to a file.
pub(super) fn run(args: &PlayArgs, target: &Path) -> io::Result<Exit> {
    let carried = match Carried::read(&args.file, args.level.file(), args.engine.as_deref()) {
        Ok(carried) => carried,
        Err(why) => return why.show(),
    };
    let page = carried.page(None, None)?;
    if let Err(error) = write(target, page.as_bytes()) {
        plain_error(&format!("cannot write `{}`: {error}", target.display()))?;
        return Ok(Exit::Refused);
    }
    if is_standard(target) {
        return Ok(Exit::Yes);
    }
    let files = counted((carried.project.files.len() + carried.project.pictures.len()) as u64, "file");
    writeln!(io::stdout(), "{}: {} kB, {files}", target.display(), page.len().div_ceil(1000))?;
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

    fn bad_picture(&self, path: &Path) -> Option<String> {
        Disk.bad_picture(path)
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
        world: None,
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
fn page(page: &str, (project, report): (&str, Option<&str>), engine: &[u8]) -> Option<String> {
    const HEAD: &str = "<head>";
    let at = page.find(HEAD)? + HEAD.len();
    let engine = STANDARD.encode(engine);
    let data = |id: &str, json: &str| {
        // A `<` in a string could end the script.
        let json = json.replace('<', "\\u003c");
        format!("<script type=\"application/json\" id=\"{id}\">{json}</script>\n")
    };
    Some(format!(
        "{}\n<meta http-equiv=\"Content-Security-Policy\" content=\"{POLICY}\">\n{}{}\
         <script type=\"text/plain\" id=\"engine\">{engine}</script>{}",
        &page[..at],
        data("project", project),
        report.map_or(String::new(), |report| data("report", report)),
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
        let carried = ("{\"a\":\"</script>\"}", Some("{\"b\":1}"));
        let page = page("<html><head><title></title></head></html>", carried, &[1, 2, 3]).unwrap();
        assert!(page.contains("id=\"report\">{\"b\":1}</script>"), "{page}");
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
