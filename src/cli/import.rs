//! `hypedc import`: converts descriptions of other systems to `.hyped` text. The text goes to standard output or into
//! files of a folder, findings go to standard error.

use std::fs::{self, File};
use std::io::{self, IsTerminal, Write};
use std::path::{Path, PathBuf};

use crate::diagnostic::Diagnostics;
use crate::diagnostic::catalogue::file::Unreadable;
use crate::diagnostic::render::{self, Found};
use crate::import::{Import, xml, zelda};
use crate::source::{FileId, Files, SourceMap};

use super::Exit;
use super::args::output::is_standard;
use super::args::{FindingFormat, ImportCommand, ImportInto};
use super::disk::{Disk, replace};
use super::report::{colored, plain_error};

pub(super) fn run(command: &ImportCommand) -> io::Result<Exit> {
    match command {
        ImportCommand::Xml(args) => {
            let mut beside = xml::Entities::default();
            import(&args.files, &args.into, |_, file, text, is_beside| {
                if !is_beside {
                    // Each file becomes a separate program, without other entities.
                    beside = xml::Entities::default();
                }
                xml::import(file, text, &mut beside)
            })
        }
        ImportCommand::ZeldaDungeon(args) => import(&args.files, &args.into, |path, file, text, _| {
            zelda::import(file, text, &world_name(path), &args.entities)
        }),
    }
}

/// An imported file with its findings.
struct Imported<'a> {
    path: &'a Path,
    sources: SourceMap,
    diagnostics: Diagnostics,
}

/// Imports files, each with `read`, which is told whether the text follows those before it in one output.
fn import(
    files: &[PathBuf],
    into: &ImportInto,
    mut read: impl FnMut(&Path, FileId, &str, bool) -> Import,
) -> io::Result<Exit> {
    let folder = into.output.as_deref().filter(|path| !is_standard(path));
    let mut answer = Exit::Yes;
    let mut texts: Vec<String> = Vec::new();
    let mut imported: Vec<Imported<'_>> = Vec::new();
    for path in files {
        let mut sources = SourceMap::new();
        let Import { text, diagnostics } = match Disk.read(path) {
            Ok(text) => {
                let file = sources.add(path, text);
                read(path, file, sources.file(file).text(), folder.is_none())
            }
            Err(error) => {
                answer = Exit::Refused;
                let mut diagnostics = Diagnostics::new();
                diagnostics.report(Unreadable { path: path.clone(), import: None, error });
                Import { text: None, diagnostics }
            }
        };
        if diagnostics.has_errors() {
            answer = answer.max(Exit::No);
        }
        if let Some((text, folder)) = text.as_ref().zip(folder) {
            let target = folder.join(program_name(path));
            if let Err(why) = write(folder, &target, text, into.force) {
                plain_error(&format!("cannot write `{}`: {why}", target.display()))?;
                answer = Exit::Refused;
            }
        } else {
            texts.extend(text);
        }
        imported.push(Imported { path, sources, diagnostics });
    }
    write!(io::stdout(), "{}", texts.join("\n"))?;
    show(into.format, &imported)?;
    Ok(answer)
}

/// The name of the program for a file: `mario.hyped` for `mario.char.xml`.
fn program_name(path: &Path) -> PathBuf {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let stem = Path::new(&name).file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    PathBuf::from(format!("{}.hyped", stem.strip_suffix(".char").unwrap_or(&stem)))
}

/// The name of the world for a file: `Tloz1_1` for `tloz1_1.txt`.
fn world_name(path: &Path) -> String {
    let stem = path.file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let word: String = stem.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    match word.chars().next() {
        Some(first) if first.is_ascii_alphabetic() => format!("{}{}", first.to_ascii_uppercase(), &word[1..]),
        _ => format!("Dungeon{word}"),
    }
}

/// Writes a file into a folder, creating the folder if needed.
fn write(folder: &Path, target: &Path, text: &str, force: bool) -> Result<(), String> {
    fs::create_dir_all(folder).map_err(|e| e.to_string())?;
    if force && target.exists() {
        return replace(target, text);
    }
    let mut file = File::options().write(true).create_new(true).open(target).map_err(|e| match e.kind() {
        io::ErrorKind::AlreadyExists => "it is there already; `--force` replaces it".to_string(),
        _ => e.to_string(),
    })?;
    file.write_all(text.as_bytes()).map_err(|e| e.to_string())
}

fn show(format: FindingFormat, imported: &[Imported<'_>]) -> io::Result<()> {
    let color = colored(io::stderr().is_terminal());
    let run: Vec<Found<'_>> =
        imported.iter().map(|Imported { path, sources, diagnostics }| Found { path, sources, diagnostics }).collect();
    let each = |shown: &dyn Fn(&Imported<'_>) -> String| imported.iter().map(shown).collect::<String>();
    let text = match format {
        FindingFormat::Human => each(&|d| render::human(&d.sources, d.diagnostics.iter(), color)),
        FindingFormat::Short => each(&|d| render::short(&d.sources, d.diagnostics.iter())),
        FindingFormat::Json => render::json(&run)?,
        FindingFormat::Sarif => render::sarif(&run, &std::env::current_dir()?)?,
    };
    write!(io::stderr(), "{text}")
}
