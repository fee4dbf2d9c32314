//! `hypedc completions` and `hypedc man`: generated shell completions and manual pages.

use std::io::{self, Write};

use clap::CommandFactory;
use clap_mangen::Man;

use super::Exit;
use super::args::{Arguments, CompletionsArgs, ManArgs};
use super::report::plain_error;

pub(super) fn completions(args: &CompletionsArgs) -> io::Result<Exit> {
    let mut text = Vec::new();
    clap_complete::generate(args.shell, &mut Arguments::command(), "hypedc", &mut text);
    io::stdout().write_all(&text)?;
    Ok(Exit::Yes)
}

pub(super) fn man(args: &ManArgs) -> io::Result<Exit> {
    let mut command = Arguments::command();
    command.build();
    let page = match &args.command {
        None => command,
        Some(name) => match command.find_subcommand(name) {
            Some(found) => found.clone(),
            None => {
                plain_error(&format!("no command `{name}`"))?;
                return Ok(Exit::Refused);
            }
        },
    };
    let mut text = Vec::new();
    Man::new(page).source(concat!("hypedc ", env!("CARGO_PKG_VERSION"))).render(&mut text)?;
    io::stdout().write_all(&text)?;
    Ok(Exit::Yes)
}
