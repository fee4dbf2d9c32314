//! The code of the Zed extension: the command line of the language server.

use zed_extension_api::{self as zed, Command, LanguageServerId, Result, Worktree};

struct Hyped;

impl zed::Extension for Hyped {
    fn new() -> Self {
        Hyped
    }

    fn language_server_command(&mut self, _: &LanguageServerId, worktree: &Worktree) -> Result<Command> {
        let command = worktree.which("hypedc").ok_or("`hypedc` is not on the PATH: `cargo install --path .` installs it")?;
        Ok(Command { command, args: vec!["lsp".into()], env: worktree.shell_env() })
    }
}

zed::register_extension!(Hyped);
