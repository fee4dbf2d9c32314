//! `hypedc explain`: explains a code, with a wrong and a right example, or a word of the language.

use std::io::{self, IsTerminal, Write};

use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::page::Page;
use crate::diagnostic::{Code, render, similar, words};
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
        let page = match Code::from_text(text) {
            Some(code) => Some(render::page(&Page::of(code), color)),
            None => words::explained(text).map(|word| render::word(&word, color)),
        };
        let Some(page) = page else {
            show_fact(&SourceMap::new(), unknown(text))?;
            answer = Exit::Refused;
            continue;
        };
        if shown > 0 {
            writeln!(out)?;
        }
        write!(out, "{page}")?;
        shown += 1;
    }
    Ok(answer)
}

/// What is neither a code nor a word, with the nearest one.
fn unknown(text: &str) -> NoQuestion {
    let is_code = text.get(1..).is_some_and(|rest| rest.len() > 1 && rest.bytes().all(|b| b.is_ascii_digit()));
    let near = similar(text, Code::ALL.iter().map(|code| code.text()).chain(words::all()));
    let what = if is_code { "no code" } else { "no code and no word of the language is" };
    let help = near.is_none().then(|| "`hypedc explain` lists all codes".to_string());
    NoQuestion { why: format!("{what} `{text}`"), near, help }
}
