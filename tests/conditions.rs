//! Named conditions: a program with names is the program with the expressions written out; uses have limits; names that
//! look alike keep their meanings.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::fmt::Write as _;

use crate::support::{compile_text, program, sized};
use hypedc::diagnostic::{Code, render};
use hypedc::ir;

/// The compiled program as text; no finding is expected.
fn compiled(text: &str) -> String {
    let compilation = compile_text(text);
    let found = render::short(&compilation.sources, compilation.diagnostics.iter());
    assert!(found.is_empty(), "{found}\n{text}");
    ir::text(&program(compilation))
}

/// The codes of all findings, and what is shown of them.
fn findings(text: &str) -> (Vec<Code>, String) {
    let compilation = compile_text(text);
    let shown = render::short(&compilation.sources, compilation.diagnostics.iter());
    (compilation.diagnostics.iter().map(|d| d.code).collect(), shown)
}

/// The lines with conditions are left out, and their names written out: `NAME => EXPRESSION`.
fn written_out(text: &str, names: &[(&str, &str)]) -> String {
    let lines = text.lines().filter(|line| !line.trim_start().starts_with("condition "));
    let mut out = String::new();
    for line in lines {
        let mut line = line.to_string();
        for (name, expression) in names {
            line = line.replace(&format!("{name}!"), &format!("({expression})"));
        }
        out.push_str(&line);
        out.push('\n');
    }
    out
}

/// A `!` after a name marks a use. Tags and names are used in the same order in both programs.
const EVERYWHERE: &str = "
behavior Blinks(t) {
    group blink {
        mode on {
            condition over = timer >= t
            when over! -> off
        }
        mode off { when timer >= t -> on }
    }
}
entity Slime {
    discrete hp: int 0..3 = 3
    collider slime: rect(0, 0, 8, 8)
    invariant hp >= 0
}
entity Hero {
    condition leaps = low! and pressed(jump)
    param speed = 60
    param strong = 1
    param slows = -400
    discrete awake: bool = true
    button jump
    axis way
    ref prey: Slime
    condition low = y < 40 and not asleep!
    condition asleep = not awake
    condition gone = lost(prey)
    condition weak = prey.hp < 2
    condition mighty = strong > 0.5
    condition finds = prey is Slime and near!
    condition near = abs(prey.x - x) < 20
    collider body: rect(0, 0, 16, 16) when low!
    invariant low! or awake
    use Blinks(t = 0.5s)
    group legs {
        mode ground {
            condition late = timer > 1s
            envelope x' by way {
                attack accel 400
                sustain speed
                release hold
                while low!
            }
            when leaps! or touching(body, wall) and late! -> air { awake := asleep!; y' := if(low!, 100px, 50px) / 1s }
            else { y' := 3 * speed }
            follow links when low!
            mode inner {
                when not late! -> hunt
                when late! and finds! -> ground
            }
        }
        mode air { y'' = slows; when low! -> ground }
        mode hunt {
            when gone! -> ground
            when weak! -> ground
            initial when mighty! mode first { when timer > 3s -> second }
            mode second { }
        }
    }
}
world Room {
    step 1/60
    collide body, slime with wall: block
    condition up = hero.y > 100 and not there!
    condition there = near(hero, slime, 30) or hero touching wall
    goal high: up! and hero in air
    never both: there! and up!
    player 1: hero
    limit Slime 4
    space main {
        place hero: Hero at (0, 32) { prey = slime }
        place slime: Slime at (60, 16)
        rect wall (0, 0, 200, 16)
        link rect(0, 0, 4, 4) -> main at rect(8, 10, 4, 4) when up!
    }
}
";

const MEANINGS: &[(&str, &str)] = &[
    ("over", "timer >= t"),
    ("leaps", "low! and pressed(jump)"),
    ("up", "hero.y > 100 and not there!"),
    ("there", "near(hero, slime, 30) or hero touching wall"),
    ("finds", "prey is Slime and near!"),
    ("near", "abs(prey.x - x) < 20"),
    ("low", "y < 40 and not asleep!"),
    ("asleep", "not awake"),
    ("gone", "lost(prey)"),
    ("weak", "prey.hp < 2"),
    ("mighty", "strong > 0.5"),
    // The timer is that of the mode with the condition, also where a mode inside uses it.
    ("late", "timer(ground) > 1s"),
];

#[test]
fn a_program_with_names_is_the_program_without() {
    // A pixel is written where the dimension cannot be inferred.
    let text = EVERYWHERE.replace("if(low!, 100px, 50px) / 1s", "if(low!, 3 * speed, 2 * speed)");
    let text = text.replace("else { y' := 3 * speed }", "else { y' := 1 * speed }");
    // Of a mode that hunts, only those with a prey are entered.
    let text = text.replace("when not late! -> hunt", "when not late! and prey is Slime -> hunt");
    let text = text.replace("-> air { awake", "-> air { prey := none; awake");
    let named = compiled(&text.replace('!', ""));
    let written = compiled(&written_out(&text, MEANINGS).replace('!', ""));
    let differences: Vec<_> = named.lines().zip(written.lines()).filter(|(a, b)| a != b).collect();
    assert!(differences.is_empty(), "{differences:#?}");
    assert_eq!(named, written);
    assert!(written.len() > 2_000, "{written}");
}

#[test]
fn the_word_is_a_name_elsewhere() {
    let text = "entity A {
        continuous condition: 1 = 0
        discrete done: bool = false
        condition' = 2 * condition / 1s
        clamp condition <= 3
        condition far = condition > 2
        mode m {
            condition' := condition / 1s
            condition warm = condition > 1
            when far and warm and not done { condition := 0; done := true }
        }
    }
    world W { space s { place condition: A at (0, 0) } condition near = condition.condition > 3; goal g: near }";
    let (codes, shown) = findings(text);
    assert!(codes.is_empty(), "{shown}");
}

#[test]
fn a_name_means_what_it_means_where_the_condition_is_declared() {
    let with = |guard: &str| {
        format!(
            "entity Coin {{ collider coin: rect(0, 0, 8, 8) }}
            entity A {{
                ref it: Coin
                collider body: rect(0, 0, 8, 8)
                condition right = not (it is none) and it.x > 3
                mode m {{ when touching(coin) as it and {guard} {{ destroy it }} }}
            }}
            world W {{ step 1/60; collide body with coin: sense; space s {{ place a: A at (0, 0) }} limit Coin 2 }}"
        )
    };
    let text = ir::text(&program(compile_text(&with("right"))));
    let other = ir::text(&program(compile_text(&with("not (it is none) and it.x > 3"))));
    assert_ne!(text, other, "the reference, not what is touched");
}

/// Each condition stands for two of the one before.
fn doubling(count: usize, is_backwards: bool) -> String {
    let mut lines = vec!["condition c0 = y > 3".to_string()];
    lines.extend((1..count).map(|i| format!("condition c{i} = c{} or c{}", i - 1, i - 1)));
    if is_backwards {
        lines.reverse();
    }
    format!("entity A {{\n{}\nmode m {{ when c{} {{ y := 0 }} }}\n}}\n", lines.join("\n"), count - 1)
}

#[test]
fn conditions_that_double_end_at_a_limit() {
    for is_backwards in [false, true] {
        let (codes, shown) = findings(&doubling(8, is_backwards));
        assert!(!codes.iter().any(|c| c.text().starts_with('E')), "{shown}");
        let (codes, shown) = findings(&doubling(60, is_backwards));
        let of_limits = [Code::ExpressionTooLong, Code::TooLarge];
        assert!(!codes.is_empty() && codes.iter().all(|code| of_limits.contains(code)), "{shown}");
    }
}

#[test]
fn long_chains_of_conditions_end_at_a_limit() {
    let length = sized(1_500, 3_000);
    for is_backwards in [false, true] {
        for (start, end) in [("", ""), ("not ", ""), (&*"(".repeat(60), &*")".repeat(60))] {
            let mut lines = vec!["condition c0 = y > 3".to_string()];
            lines.extend((1..length).map(|i| format!("condition c{i} = {start}c{}{end}", i - 1)));
            if is_backwards {
                lines.reverse();
            }
            let text =
                format!("entity A {{\n{}\nmode m {{ when c{} {{ y := 0 }} }}\n}}\n", lines.join("\n"), length - 1);
            let (codes, shown) = findings(&text);
            assert!(!codes.is_empty() && codes.iter().all(|code| *code == Code::TooLarge), "{start}: {shown}");
        }
    }
    // A circle of the same length.
    let lines: Vec<String> = (0..length).map(|i| format!("condition c{i} = c{}", (i + 1) % length)).collect();
    let (codes, _) = findings(&format!("entity A {{\n{}\n}}\n", lines.join("\n")));
    assert!(!codes.is_empty() && codes.iter().all(|code| *code == Code::TooLarge));
}

#[test]
fn what_all_uses_stand_for_is_limited() {
    let mut text = String::from("entity A {\nparam a = 1\n");
    let long = vec!["a > 0"; 80].join(" or ");
    writeln!(text, "condition long = {long}").unwrap();
    text.push_str("discrete yes: bool = false\nmode m {\n");
    (0..600).for_each(|_| text.push_str("when long { yes := long }\n"));
    text.push_str("}\n}\n");
    let (codes, shown) = findings(&text);
    assert_eq!(codes, [Code::TooLarge], "{}", &shown[..shown.len().min(2_000)]);
}

#[test]
fn the_deepest_expressions_compile() {
    let sum = |of: &str, count: usize| vec![of; count].join(" + ");
    let text = format!(
        "const deep = {}\nentity A {{\ncondition low = y / 1px < deep + {}\nmode m {{ when {} {{ y := 0 }} }}\n}}\n",
        sum("1", 200),
        sum("1", 50),
        vec!["(pressed(b) and low)"; 100].join(" or "),
    );
    let text = text.replace("y / 1px", "y / size").replace("mode m", "param size: px = 1; button b; mode m");
    let (codes, shown) = findings(&text);
    assert!(!codes.iter().any(|c| c.text().starts_with('E')), "{shown}");
}
