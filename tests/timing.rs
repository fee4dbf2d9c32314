//! Timing errors: how probable success is, by closed form and by other code with other random numbers; windows, by
//! replaying every error.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::support::{compile_text, program, script};
use hypedc::ask::search_svg;
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::json::{self, Layout};
use hypedc::reach::query::{Answer, Query, Session, TimingErrors};
use hypedc::reach::robust::{Jitter, MAX_WINDOW, Robustness, SLACK, Side, measure_robustness};
use hypedc::reach::{Limits, Plan, Problem, Target};
use hypedc::sim::{Input, Script, Simulator};
use hypedc::source::SourceMap;
use hypedc::view::Images;
use hypedc::watch::Unwatched;

const WORLD: WorldId = WorldId(0);
const GOAL: GoalId = GoalId(0);

/// Runs a pixel a step of 1/64 s and stops where `go` is pressed: the press has a window, the release has none.
fn stopper(low: u32, high: u32) -> String {
    format!(
        "entity Runner {{
    button go
    collider body: rect(0, 0, 8, 8)
    initial mode running {{
        x' = 64
        when pressed(go) -> stopped
    }}
    mode stopped {{ x' = 0 }}
}}
world Track {{
    step 1/64
    space main {{ place hero: Runner at (0, 0) }}
    player 1: hero
    goal there: hero in stopped and hero.x >= {low} and hero.x <= {high}
}}
"
    )
}

/// Runs and jumps over two pits, stops at a wall, and presses a switch behind the second.
const PITS: &str = r#"entity Hero {
    axis horizontal
    button jump, act
    param speed = 96
    collider body: rect(0, 0, 12, 15)
    y'' = -512
    discrete is_done: bool = false
    envelope x' by horizontal { sustain speed }
    initial mode air {
        when y' <= 0 and touching(body, rock, below) -> ground
    }
    mode ground {
        when not touching(body, rock, below) -> air
        when pressed(jump) -> air { y' := 192 }
        when pressed(act) and touching(body, flag) { is_done := true }
    }
}
world Pits {
    step 1/64
    collide body with rock: block
    collide body with flag: sense
    tiles own 16 x 16 {
        '.': empty
        '#': rock
        'F': flag
        'P': spawn Hero as hero
    }
    space main {
        map own "
            .............#
            P..........F.#
            ####..##..####
        "
    }
    player 1: hero
    goal open: hero.is_done
    never fell: hero.y < -8
}
"#;

/// Two buttons at the same time open it; at other times they slam it shut.
const LOCK: &str = "entity Lock {
    button left, right
    discrete count: int 0..3 = 0
    initial mode closed {
        when held(left) and held(right) -> turning
        when count >= 3 -> jammed
        when pressed(left) { count := min(count + 1, 3) }
    }
    mode turning {
        when timer < 6frames and not held(left) -> jammed
        when timer < 6frames and not held(right) -> closed
        when timer >= 12frames -> jammed
        when not held(left) and not held(right) -> open
    }
    mode open {}
    mode jammed {}
}
world Door {
    step 1/60
    space main { place lock: Lock at (0, 0) }
    player 1: lock
    goal opened: lock in open
    never broken: lock in jammed
}
";

/// What is measured of some inputs of a program.
fn measured(program: &Arc<Program>, inputs: &str, sigma: f64, trials: u64, threads: usize) -> Robustness {
    let sim = Simulator::new(program, WORLD);
    let problem = Problem::new(&sim, GOAL);
    let plan = plan(program, inputs);
    measure_robustness(&problem, &plan, &Jitter::new(sigma), (1, trials, threads), &Unwatched).unwrap()
}

/// The inputs up to the goal.
fn plan(program: &Arc<Program>, inputs: &str) -> Plan {
    let whole = script(program, inputs);
    let steps = reached(program, &whole.inputs().cloned().collect::<Vec<_>>(), 0).expect("a way to the goal");
    Plan { script: whole.first(steps), steps, after: 0, is_shortest: false }
}

/// The step at which the goal holds, if no `never` does before: inputs as they are, then the last one for some steps.
fn reached(program: &Arc<Program>, inputs: &[Input], slack: u64) -> Option<u64> {
    let sim = Simulator::new(program, WORLD);
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    let mut step = 0;
    let held = inputs.last().cloned().unwrap_or_default();
    loop {
        if sim.violated(&state).unwrap().is_some() || sim.left_bounds(&state).is_some() {
            return None;
        }
        if sim.goal(&state, GOAL).unwrap() {
            return Some(step);
        }
        if step >= inputs.len() as u64 + slack {
            return None;
        }
        sim.step(&mut state, inputs.get(step as usize).unwrap_or(&held), &mut scratch).unwrap();
        step += 1;
    }
}

/// A change of a button (by number) or of an axis (64 and its number), at a step.
type Change = (u32, u64, f64);

/// The changes of a plan of one player, by step, axes first.
fn changes(script: &Script) -> Vec<Change> {
    let mut all = Vec::new();
    let (mut buttons, mut axes) = (0_u64, [0.0; 2]);
    for (input, step) in script.inputs().zip(0..) {
        let now = input.0[0];
        for ((control, last), value) in (64..).zip(&mut axes).zip(now.axes) {
            if value != *last {
                all.push((control, step, value));
                *last = value;
            }
        }
        for button in 0..64 {
            let is_down = now.buttons >> button & 1;
            if buttons >> button & 1 != is_down {
                all.push((button, step, is_down as f64));
            }
        }
        buttons = now.buttons;
    }
    all
}

/// Whether a plan still succeeds if each change has an error; the second value is when each happens.
fn succeeds(program: &Arc<Program>, plan: &Plan, changes: &[Change], errors: &[i64]) -> (bool, Vec<u64>) {
    let mut last: BTreeMap<u32, i64> = BTreeMap::new();
    let mut times = Vec::new();
    for ((control, step, _), error) in changes.iter().zip(errors) {
        let earliest = last.get(control).map_or(0, |time| time + 1);
        let time = (*step as i64 + error).max(earliest);
        last.insert(*control, time);
        times.push(time as u64);
    }
    let (mut buttons, mut axes) = (0_u64, [0.0; 2]);
    let end = plan.steps.max(times.iter().max().map_or(0, |time| time + 1));
    let inputs: Vec<Input> = (0..end)
        .map(|step| {
            for ((control, _, value), _) in changes.iter().zip(&times).filter(|(_, time)| **time == step) {
                match control {
                    64.. => axes[*control as usize - 64] = *value,
                    _ if *value == 0.0 => buttons &= !(1 << control),
                    _ => buttons |= 1 << control,
                }
            }
            let mut input = Input::nothing(1);
            input.0[0].buttons = buttons;
            input.0[0].axes[..2].copy_from_slice(&axes);
            input
        })
        .collect();
    let slack = (SLACK / Simulator::new(program, WORLD).world().step.seconds()).ceil() as u64;
    let until = plan.steps + slack;
    (reached(program, &inputs, until.saturating_sub(end)).is_some_and(|step| step <= until), times)
}

/// The integral of the normal distribution from 0 to `x`, by Simpson's rule.
fn normal(x: f64) -> f64 {
    let n = 2000;
    let h = x / f64::from(n);
    let density = |t: f64| (-t * t / 2.0).exp() / (2.0 * std::f64::consts::PI).sqrt();
    let weight = |i: i32| if i == 0 || i == n { 1.0 } else { f64::from(2 + 2 * (i % 2)) };
    (0..=n).map(|i| weight(i) * density(h * f64::from(i))).sum::<f64>() * h / 3.0
}

/// The probability of a rounded error from `-early` to `late`.
fn between(early: f64, late: f64, sigma: f64) -> f64 {
    normal((late + 0.5) / sigma) + normal((early + 0.5) / sigma)
}

/// Random numbers by another generator: xorshift64*, and the polar method of Marsaglia.
struct Other(u64);

impl Other {
    fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        ((self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 + 0.5) / 2.0_f64.powi(53)
    }

    fn normal(&mut self) -> f64 {
        loop {
            let (x, y) = (2.0 * self.unit() - 1.0, 2.0 * self.unit() - 1.0);
            let square = x * x + y * y;
            if square > 0.0 && square < 1.0 {
                return x * (-2.0 * square.ln() / square).sqrt();
            }
        }
    }
}

#[test]
fn one_press_succeeds_as_often_as_its_window_says() {
    let program = program(compile_text(&stopper(57, 66)));
    for (press, early, late) in [(60, 3, 6), (57, 0, 9), (66, 9, 0)] {
        for sigma in [0.4, 1.0, 2.5, 6.0] {
            let found = measured(&program, &format!("-*{press} go*2"), sigma, 40_000, 2);
            let expected = between(f64::from(early), f64::from(late), sigma);
            let [low, high] = found.success.interval();
            let wide = 1.3 * (high - low);
            assert!(
                low - wide < expected && expected < high + wide,
                "{press}, {sigma}: {expected}, not {low} to {high}"
            );
            let window = &found.windows[0];
            assert_eq!((window.early, window.late), (Side::Steps(early), Side::Steps(late)), "{press}");
            assert!((window.alone - expected).abs() < 1e-5, "{press}, {sigma}: {expected}, not {}", window.alone);
            assert_eq!(found.hardest(), Some(window));
        }
    }
}

/// The worlds with ways through them.
const WAYS: [(&str, &str); 4] = [
    (PITS, "right*30 right+jump*3 right*47 right+jump*12 right*30 -*15 act*3"),
    (
        PITS,
        "right*28 right+jump*10 right*40 right+jump*10 right*36 right+act*1 right*1 right+act*1 right*1 right+act*2",
    ),
    (LOCK, "left*3 left+right*9 -*3"),
    (LOCK, "-*4 left*1 -*5 right*2 left+right*8 -*2"),
];

#[test]
fn windows_are_what_replays_say() {
    for (text, inputs) in WAYS {
        let program = program(compile_text(text));
        let (plan, sigma) = (plan(&program, inputs), 1.5);
        let (found, changes) = (measured(&program, inputs, sigma, 64, 1), changes(&plan.script));
        assert_eq!(found.windows.len(), changes.len(), "{inputs}");
        for (index, window) in found.windows.iter().enumerate() {
            assert_eq!(window.change.step, changes[index].1);
            let one = |error: i64| {
                let mut errors = vec![0; changes.len()];
                errors[index] = error;
                succeeds(&program, &plan, &changes, &errors)
            };
            for (side, sign) in [(window.early, -1), (window.late, 1)] {
                let most = i64::from(MAX_WINDOW);
                let fine = (1..=most).take_while(|steps| one(sign * steps).0).count() as u32;
                // Whether a larger error is the same play.
                let is_last = |steps: i64| one(sign * (steps + 1)).1 == one(sign * steps).1;
                match side {
                    Side::Steps(steps) => assert_eq!(steps, fine, "{inputs}, change {index}, {sign}"),
                    Side::AtLeast(_) => assert_eq!(fine, MAX_WINDOW, "{inputs}, change {index}, {sign}"),
                    Side::Any => assert!(fine == MAX_WINDOW && (0..most).any(is_last), "{inputs}, change {index}"),
                }
            }
            let weigh = |error: i64| if one(error).0 { between(-error as f64, error as f64, sigma) } else { 0.0 };
            let alone: f64 = (-12..=12).map(weigh).sum();
            assert!((window.alone - alone).abs() < 1e-5, "{inputs}, change {index}: {alone}, not {}", window.alone);
        }
    }
}

#[test]
fn success_is_what_other_code_with_other_numbers_finds() {
    const RUNS: u32 = 100_000;
    for ((text, inputs), sigma) in [(WAYS[0], 2.0), (WAYS[2], 1.0), (WAYS[3], 1.5)] {
        let program = program(compile_text(text));
        let plan = plan(&program, inputs);
        let changes = changes(&plan.script);
        let mut random = Other(0x9e37_79b9_7f4a_7c15);
        // A play is determined by when the changes happen: each play once.
        let mut known: BTreeMap<Vec<i64>, bool> = BTreeMap::new();
        let wins = (0..RUNS).filter(|_| {
            let errors: Vec<i64> = changes.iter().map(|_| (sigma * random.normal()).round() as i64).collect();
            *known.entry(errors).or_insert_with_key(|errors| succeeds(&program, &plan, &changes, errors).0)
        });
        let (n, share) = (f64::from(RUNS), wins.count() as f64 / f64::from(RUNS));
        let found = measured(&program, inputs, sigma, 100_000, 2).success;
        let gap = (found.probability() - share).abs();
        assert!((0.02..0.98).contains(&share), "{inputs}: {share} tells nothing");
        assert!(gap < 3.5 * (2.0 * share * (1.0 - share) / n).sqrt(), "{inputs}: {}, not {share}", found.probability());
    }
}

/// The answer to the first goal of a program, with a search for a way that withstands timing errors.
fn robust_answer(text: &str, sigma: f64, threads: usize) -> (Answer, String) {
    let program = program(compile_text(text));
    let mut query = Query::new(vec![Target::Goal(GOAL)]);
    query.errors = Some(TimingErrors::new(sigma, 2_000));
    query.limits = Limits { nodes: 4_000, ..query.limits };
    query.settings.threads = threads;
    let session = Session::new(&program, WORLD, query, &Unwatched);
    let mut found = session.find(Target::Goal(GOAL), &Unwatched).unwrap();
    let answer = session.answer(&mut found, &SourceMap::new());
    let text = json::text(&answer, Layout::Compact).unwrap();
    (answer, text)
}

#[test]
fn the_answer_is_the_same_on_any_number_of_threads() {
    for text in [PITS, LOCK] {
        assert_eq!(robust_answer(text, 1.0, 1).1, robust_answer(text, 1.0, 2).1);
        let program = program(compile_text(text));
        let inputs = WAYS.iter().find(|(world, _)| *world == text).unwrap().1;
        assert_eq!(measured(&program, inputs, 1.0, 1_000, 1), measured(&program, inputs, 1.0, 1_000, 2));
    }
}

#[test]
fn what_is_found_is_at_least_as_good_and_leads_there() {
    for (text, sigma) in [(PITS.to_string(), 2.0), (LOCK.to_string(), 1.0), (stopper(100, 120), 4.0)] {
        let (answer, _) = robust_answer(&text, sigma, 2);
        let program = program(compile_text(&text));
        let inputs = answer.inputs.unwrap();
        // It is a way to the goal, and what is said about it is said about these inputs.
        assert_eq!(plan(&program, &inputs).steps, answer.steps.unwrap());
        let robust = answer.robust.unwrap();
        let own = measured(&program, &inputs, sigma, 2_000, 1).success;
        assert_eq!((robust.success.trials, robust.success.successes), (own.trials, own.successes));
        let first = robust.first.map_or(0.0, |first| first.success.success_95[0]);
        assert!(robust.success.success_95[1] >= first, "{sigma}: {first} before");
        assert!(robust.success.success > 0.5, "{sigma}: {}", robust.success.success);
    }
}

/// The picture has a ring for each change that needs timing, and one for each kind of ring in its legend.
#[test]
fn a_picture_shows_what_needs_timing() {
    let program = program(compile_text(PITS));
    let mut query = Query::new(vec![Target::Goal(GOAL)]);
    query.errors = Some(TimingErrors::new(1.0, 500));
    query.limits = Limits { nodes: 2_000, ..query.limits };
    let session = Session::new(&program, WORLD, query, &Unwatched);
    let mut found = session.find(Target::Goal(GOAL), &Unwatched).unwrap();
    let mut answer = session.answer(&mut found, &SourceMap::new());
    let svg = search_svg(&session, &found, &answer, &Images::default(), &Unwatched);
    let robust = answer.robust.take().unwrap();
    let timed = robust.changes.iter().filter(|change| change.needs_timing()).count();
    assert!(timed > 1 && robust.hardest.is_some(), "{robust:?}");
    assert_eq!(svg.matches("<circle class=\"moment").count(), timed + 2);
    assert_eq!(svg.matches("<circle class=\"moment hardest").count(), 2);
    let hardest = &robust.changes[robust.hardest.unwrap()];
    assert!(svg.contains(&format!("{}: {}", hardest.what, hardest.window())), "{svg}");
    // Without the question there are none.
    assert!(!search_svg(&session, &found, &answer, &Images::default(), &Unwatched).contains("moment"));
}
