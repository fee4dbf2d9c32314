//! `hypedc explain`: explains a code, with a wrong and a right example.

use std::io::{self, IsTerminal, Write};

use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::page::Page;
use crate::diagnostic::{Code, render, similar};
use crate::source::SourceMap;

use super::Exit;
use super::args::ExplainArgs;
use super::report::{colored, show_fact};

pub(super) fn run(args: &ExplainArgs) -> io::Result<Exit> {
    let mut out = io::stdout().lock();
    if args.codes.is_empty() {
        for code in Code::ALL {
            writeln!(out, "{code}  {}", code.title())?;
        }
        return Ok(Exit::Yes);
    }
    let color = colored(io::stdout().is_terminal());
    let mut answer = Exit::Yes;
    let mut shown = 0;
    for text in &args.codes {
        let Some(code) = Code::from_text(text) else {
            let near = similar(text, Code::ALL.iter().map(|code| code.text()));
            let help = near.is_none().then(|| "`hypedc explain` lists all codes".to_string());
            show_fact(&SourceMap::new(), NoQuestion { why: format!("no code `{text}`"), near, help })?;
            answer = Exit::Refused;
            continue;
        };
        if shown > 0 {
            writeln!(out)?;
        }
        write!(out, "{}", render::page(&Page::of(code), color))?;
        shown += 1;
    }
    Ok(answer)
}
