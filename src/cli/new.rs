//! `hypedc new`: creates a folder with a small project. Existing files are never touched.

use std::fs;
use std::io::{self, Write};
use std::path::Path;

use super::Exit;
use super::args::NewArgs;
use super::report::plain_error;

/// The files of a project. `{{name}}` is replaced by its name.
const FILES: [(&str, &str); 3] = [
    ("game.hyped", include_str!("template/game.hyped")),
    ("play.inputs", include_str!("template/play.inputs")),
    ("README.md", include_str!("template/README.md")),
];

pub(super) fn run(args: &NewArgs) -> io::Result<Exit> {
    let folder = args.name.as_path();
    let Some(name) = folder.file_name() else {
        plain_error(&format!("`{}` is not a valid folder name", folder.display()))?;
        return Ok(Exit::Refused);
    };
    if let Err(error) = make(folder, &name.to_string_lossy()) {
        let why = match error.kind() {
            io::ErrorKind::AlreadyExists => "it exists already and is unchanged".to_string(),
            _ => error.to_string(),
        };
        plain_error(&format!("cannot make `{}`: {why}", folder.display()))?;
        return Ok(Exit::Refused);
    }
    let mut out = io::stdout().lock();
    for (file, _) in FILES {
        writeln!(out, "{}", folder.join(file).display())?;
    }
    writeln!(io::stderr(), "made `{}`; next: hypedc reach {}", folder.display(), folder.join("game.hyped").display())?;
    Ok(Exit::Yes)
}

fn make(folder: &Path, name: &str) -> io::Result<()> {
    if let Some(parent) = folder.parent() {
        fs::create_dir_all(parent)?;
    }
    // Fails if the name exists, so all files written into it are new.
    fs::create_dir(folder)?;
    for (file, text) in FILES {
        fs::write(folder.join(file), text.replace("{{name}}", name))?;
    }
    Ok(())
}
