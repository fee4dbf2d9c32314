//! `hypedc reach --shard` and `hypedc merge`: the parts of a run together are the whole, whatever their number and
//! costs; shards that are killed go on; files that do not belong together are refused.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::Value;

use crate::corpus::{LEVELS, TestFolder, untimed};

/// Two goals of four levels: one of them has no way.
const OF: &str = "--map levels --nodes 2000";

/// The exit code of `hypedc merge`, what it printed, and its errors.
fn merged(place: &TestFolder, arguments: &str) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hypedc"));
    command.arg("merge").args(arguments.split_whitespace()).current_dir(&place.0);
    let output = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

/// The names of the files of shards.
fn names(count: usize) -> String {
    (1..=count).map(|index| format!("rows.{index}.jsonl ")).collect()
}

/// Runs all shards; returns the verdict of the command for each.
fn run_all(place: &TestFolder, count: usize, more: &str) -> Vec<i32> {
    let of = |index: usize| format!("{OF} --shard {index}/{count} --results rows.{index}.jsonl {more}");
    (1..=count).map(|index| place.answer(&of(index)).0).collect()
}

fn is_row(line: &Value) -> bool {
    line.get("row").is_some()
}

#[test]
fn the_shards_together_are_the_whole_run() {
    let place = TestFolder::new("shards");
    place.answer(&format!("{OF} --results whole.jsonl"));
    let whole = place.rows("whole.jsonl");
    assert_eq!(whole.len(), 8);
    // Costs of other levels, and such that one question takes longer than all others.
    let text = place.read("whole.jsonl");
    place.write("foreign.jsonl", &text.replace("levels/", "elsewhere/"));
    let costly: String = text
        .lines()
        .enumerate()
        .map(|(at, line)| {
            let mut row: Value = serde_json::from_str(line).unwrap();
            row["timing"]["seconds"] = if at == 5 { 1000.0 } else { at as f64 }.into();
            // The version is what a line begins with.
            let line = row.to_string();
            format!("{{\"row\":4,{}\n", line.trim_start_matches('{').replace(",\"row\":4", ""))
        })
        .collect();
    place.write("costly.jsonl", &costly);
    for (count, costs) in
        [(1, ""), (2, ""), (3, ""), (5, ""), (8, ""), (3, "whole"), (8, "whole"), (2, "foreign"), (3, "costly")]
    {
        (1..=8).for_each(|index| drop(std::fs::remove_file(place.0.join(format!("rows.{index}.jsonl")))));
        let option = if costs.is_empty() { String::new() } else { format!("--costs {costs}.jsonl") };
        assert_eq!(run_all(&place, count, &option).len(), count);
        let what = format!("{count} shards, costs {costs:?}");
        let _ = std::fs::remove_file(place.0.join("all.jsonl"));
        let (code, shown, error) = merged(&place, &format!("{}-o all.jsonl", names(count)));
        assert_eq!((code, error.as_str()), (0, ""), "{what}: {shown}");
        let plural = if count == 1 { "" } else { "s" };
        let summary =
            format!("all.jsonl of {count} shard{plural}: 8 questions about 4 levels: 7 reached, 1 not found\n");
        assert_eq!(shown, summary, "{what}");
        assert_eq!(place.rows("all.jsonl"), whole, "{what}");
        let sizes: Vec<usize> =
            (1..=count).map(|index| place.read(&format!("rows.{index}.jsonl")).lines().count() - 1).collect();
        assert!(sizes.iter().all(|size| *size > 0), "{what}: {sizes:?}");
        if costs == "costly" {
            assert_eq!(sizes.iter().min(), Some(&1), "the one that takes long is alone: {sizes:?}");
        } else if costs != "whole" {
            assert!(sizes.iter().max().unwrap() - sizes.iter().min().unwrap() <= 1, "{what}: {sizes:?}");
        }
    }
    // The joined file is that of the whole run: nothing is asked again.
    let (_, shown, _) = place.answer(&format!("{OF} --results all.jsonl --baseline whole.jsonl"));
    assert!(shown.contains("8 of them kept from `all.jsonl`") && shown.contains("8 as before"), "{shown}");
}

#[test]
fn a_shard_that_is_killed_goes_on() {
    let place = TestFolder::new("shard-killed");
    for index in 0..8 {
        place.write(&format!("levels/slow{index}.txt"), LEVELS[2].1);
    }
    let of = "--map levels --goal out --nodes 4000";
    assert_eq!(place.answer(&format!("{of} --results whole.jsonl")).0, 1);
    let shard = |index| format!("{of} --shard {index}/2 --results rows.{index}.jsonl");
    place.answer(&shard(1));
    let lines = || std::fs::read(place.0.join("rows.2.jsonl")).map_or(0, |t| t.iter().filter(|b| **b == b'\n').count());
    for rows in [0, 1, 2, 4] {
        let mut child = place.command(&shard(2)).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        // The header is a line, too.
        while lines() < rows + 1 && child.try_wait().unwrap().is_none() {
            std::thread::sleep(Duration::from_millis(1));
        }
        let _ = child.kill();
        child.wait().unwrap();
    }
    let (code, shown, _) = merged(&place, "rows.1.jsonl rows.2.jsonl -o all.jsonl");
    let before = place.read("rows.2.jsonl");
    assert!(code == 0 || shown.contains("shard 2/2, `rows.2.jsonl`:"), "{shown}");
    assert_eq!(place.answer(&shard(2)).0, 1);
    let now = place.read("rows.2.jsonl");
    for line in before.split_inclusive('\n').filter(|line| line.ends_with('\n')) {
        assert!(now.contains(line), "done again: {line}");
    }
    assert_eq!(merged(&place, "rows.1.jsonl rows.2.jsonl -o all.jsonl").0, 0);
    assert_eq!(place.rows("all.jsonl"), place.rows("whole.jsonl"));
}

/// A scheduler sees that a shard was stopped: an answer of no has another exit code.
#[cfg(unix)]
#[test]
fn a_shard_that_is_stopped_is_not_done() {
    let place = TestFolder::new("shard-stopped");
    let of = "--map levels --goal out --nodes 1000000000 --planner coverage --shard 1/2 --results rows.jsonl";
    let child = place.command(of).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    // `c`, the second level of the shard, never ends.
    let lines = || std::fs::read(place.0.join("rows.jsonl")).map_or(0, |t| t.iter().filter(|b| **b == b'\n').count());
    while lines() < 2 {
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("stopped when 1 of 2 were done; they are in `rows.jsonl`"), "{error}");
}

#[test]
fn a_file_that_was_cut_anywhere_is_mended() {
    let place = TestFolder::new("shard-cut");
    place.answer(&format!("{OF} --results whole.jsonl"));
    run_all(&place, 2, "");
    let text = place.read("rows.2.jsonl");
    let lines = untimed_shard(&text);
    let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at).collect();
    for end in [0, 1, 9, 10, 200, ends[0], ends[0] + 1, ends[0] + 2, ends[1] - 1, ends[1], ends[1] + 300, ends[3] + 8] {
        place.write("rows.2.jsonl", &text[..end]);
        let (code, shown, error) = merged(&place, &format!("{}-o all.jsonl", names(2)));
        assert_eq!((code, error.as_str()), (1, ""), "cut at {end}: {shown}");
        let kept = ends.iter().skip(1).filter(|at| end >= **at).count();
        assert!(shown.contains(&format!("{} of 8 questions ", 4 - kept)), "cut at {end}: {shown}");
        let is_known = end >= ends[0];
        assert_eq!(shown.contains("shard 2/2, `rows.2.jsonl`"), is_known, "cut at {end}: {shown}");
        assert_eq!(shown.contains("shard 2/2: no file of it is given, 4 questions"), !is_known, "{shown}");
        place.answer(&format!("{OF} --shard 2/2 --results rows.2.jsonl"));
        assert_eq!(untimed_shard(&place.read("rows.2.jsonl")), lines, "cut at {end}");
        assert_eq!(merged(&place, &format!("{}-o all.jsonl", names(2))).0, 0, "cut at {end}");
        assert_eq!(place.rows("all.jsonl"), place.rows("whole.jsonl"), "cut at {end}");
    }
}

/// The header of a shard's file, and its rows without what depends on the machine.
fn untimed_shard(text: &str) -> (String, Vec<Value>) {
    let (header, rows) = text.split_once('\n').unwrap();
    assert!(!is_row(&serde_json::from_str(header).unwrap()), "{header}");
    (header.to_string(), untimed(rows))
}

#[test]
fn a_shard_goes_on_with_other_levels() {
    let place = TestFolder::new("shard-levels");
    run_all(&place, 2, "");
    place.write("levels/e.txt", LEVELS[0].1);
    let second = format!("{OF} --shard 2/2 --results rows.2.jsonl");
    assert!(place.answer(&second).1.contains("kept from `rows.2.jsonl`"));
    // The other one still has the older plan.
    let (code, _, error) = merged(&place, "rows.1.jsonl rows.2.jsonl -o all.jsonl");
    assert!(code == 2 && error.contains("it has 10 questions in all, not 8"), "{error}");
    let headers = |name: &str| place.read(name).lines().filter(|l| l.starts_with("{\"shard\":")).count();
    assert_eq!(headers("rows.2.jsonl"), 1);
    place.answer(&format!("{OF} --shard 1/2 --results rows.1.jsonl"));
    assert_eq!(merged(&place, "rows.1.jsonl rows.2.jsonl -o all.jsonl").0, 0);
    place.answer(&format!("{OF} --results whole.jsonl"));
    assert_eq!(place.rows("all.jsonl"), place.rows("whole.jsonl"));
    // Another program, and other settings.
    let game = place.read("game.hyped");
    place.write("game.hyped", &game.replace("320", "330"));
    place.answer(&second);
    let (code, _, error) = merged(&place, "rows.1.jsonl rows.2.jsonl -o all.jsonl");
    assert!(code == 2 && error.contains("`game.hyped` was another program"), "{error}");
    place.write("game.hyped", &game);
    place.answer(&format!("{second} --seed 3"));
    let (code, _, error) = merged(&place, "rows.1.jsonl rows.2.jsonl -o all.jsonl");
    assert!(code == 2 && error.contains("`seed` is 1 in `rows.1.jsonl` and 3 in `rows.2.jsonl`"), "{error}");
}

#[test]
fn mistakes_are_told_with_a_way_out() {
    let place = TestFolder::new("shard-mistakes");
    let of = "--map levels --goal up";
    place.answer(&format!("{of} --results whole.jsonl"));
    place.answer(&format!("{of} --shard 1/2 --results rows.1.jsonl"));
    place.answer(&format!("{of} --shard 2/2 --results rows.2.jsonl"));
    place.answer("--map levels/a.txt --goal up --seed 7 --results seven.jsonl");
    place.write("longer.jsonl", &place.read("whole.jsonl").replacen("\"nodes\":", "\"nodes\":9", 1));
    let mut out = String::new();
    let mut told = |command: &str, (code, shown, error): (i32, String, String)| {
        // How to get help is not about the mistake.
        let error = error.split("\n\nFor more information").next().unwrap_or_default().trim_end();
        out.push_str(&format!("$ hypedc {command}\n{shown}{error}\nexit code {code}\n\n"));
    };
    for arguments in [
        "--shard 0/2 --results new.jsonl",
        "--shard 3/2 --results new.jsonl",
        "--shard 1/5 --results new.jsonl",
        "--shard half --results new.jsonl",
        "--shard 1/2",
        "--shard 1/2 --results rows.2.jsonl",
        "--shard 1/2 --results whole.jsonl",
        "--results rows.1.jsonl",
        "--shard 1/2 --results new.jsonl --costs game.hyped",
        "--shard 1/2 --results new.jsonl --costs none.jsonl",
        "--shard 1/2 --results new.jsonl --baseline whole.jsonl",
    ] {
        told(&format!("reach game.hyped … {arguments}"), place.answer(&format!("{of} {arguments}")));
    }
    for arguments in [
        "rows.1.jsonl -o all.jsonl",
        "rows.1.jsonl rows.2.jsonl -o rows.2.jsonl",
        "rows.1.jsonl whole.jsonl -o all.jsonl",
        "rows.1.jsonl none.jsonl -o all.jsonl",
        "rows.1.jsonl game.hyped -o all.jsonl",
        "rows.1.jsonl levels -o all.jsonl",
        "rows.1.jsonl rows.2.jsonl -o game.hyped",
        "rows.1.jsonl rows.2.jsonl -o no/folder/all.jsonl",
        "rows.1.jsonl rows.2.jsonl -o -",
        "whole.jsonl seven.jsonl -o all.jsonl",
        "whole.jsonl longer.jsonl -o all.jsonl",
    ] {
        told(&format!("merge {arguments}"), merged(&place, arguments));
    }
    assert!(!place.0.join("new.jsonl").exists() && place.read("game.hyped").contains("entity Walker"));
    insta::assert_snapshot!(out);
}
