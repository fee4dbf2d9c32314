//! The project that `new` creates, and the help texts of the command line.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::PathBuf;
use std::process::{Command, Output};

fn hypedc(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_hypedc")).args(arguments).output().unwrap()
}

/// A path that does not exist.
fn nothing(name: &str) -> PathBuf {
    let path = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&path);
    path
}

#[test]
fn a_new_project_checks_plays_and_is_solved() {
    let folder = nothing("new").join("in").join("tide pool");
    let output = hypedc(&["new", folder.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let made = String::from_utf8(output.stdout).unwrap();
    assert!(made.lines().count() == 3 && made.lines().all(|path| PathBuf::from(path).exists()), "{made}");
    let at = |file: &str| folder.join(file).display().to_string();
    assert!(std::fs::read_to_string(at("README.md")).unwrap().starts_with("# tide pool\n"));
    let (game, inputs) = (at("game.hyped"), at("play.inputs"));
    let check = hypedc(&["check", "--deny", "warnings", &game]);
    assert_eq!((check.status.code(), check.stdout.len()), (Some(0), 0));
    let sim = hypedc(&["sim", &game, "--inputs-file", &inputs]);
    let told = String::from_utf8(sim.stdout).unwrap();
    assert!(sim.status.code() == Some(0) && told.contains("goal flag: reached"), "{told}");
    for seed in ["1", "2", "3"] {
        assert_eq!(hypedc(&["reach", &game, "--seed", seed]).status.code(), Some(0), "seed {seed}");
    }
    assert_eq!(hypedc(&["graph", &game]).status.code(), Some(0));
}

#[test]
fn what_is_there_already_is_left() {
    let folder = nothing("new_taken");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join("game.hyped"), "mine\n").unwrap();
    for path in [folder.clone(), folder.join("game.hyped")] {
        let output = hypedc(&["new", path.to_str().unwrap()]);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0));
        assert!(String::from_utf8_lossy(&output.stderr).contains("exists already"));
    }
    assert_eq!(std::fs::read_to_string(folder.join("game.hyped")).unwrap(), "mine\n");
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 1);
    assert_eq!(hypedc(&["new", ".."]).status.code(), Some(2));
}

#[test]
fn shells_and_the_manual_know_every_command() {
    let text = |arguments: &[&str]| {
        let output = hypedc(arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    let help = text(&["--help"]);
    let listed = help.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let commands: Vec<&str> =
        listed.filter_map(|line| line.split_whitespace().next()).filter(|c| *c != "help").collect();
    assert!(commands.len() >= 8 && commands.contains(&"graph"), "{help}");
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let script = text(&["completions", shell]);
        assert!(commands.iter().all(|command| script.contains(*command)), "{shell}");
    }
    let page = text(&["man"]);
    for command in commands {
        assert!(page.contains(&format!("hypedc\\-{command}")), "{command}");
        assert!(text(&["man", command]).starts_with(".ie"), "{command}");
    }
    assert_eq!(hypedc(&["man", "cheek"]).status.code(), Some(2));
    assert_eq!(hypedc(&["completions", "abacus"]).status.code(), Some(2));
}
