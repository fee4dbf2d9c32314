//! Soundness of the findings by value: no guard that never holds did, no unreachable mode was active, no proven
//! invariant was violated. The programs are the examples, and examples with modified numbers.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::support::{Disk, files, sized};
use hypedc::analysis::{InvariantVerdict, configuration_space, invariants};
use hypedc::compile::{Compilation, LevelFile, check_with, compile};
use hypedc::diagnostic::{Code, Diagnostic, render};
use hypedc::ir::{
    EntityId, Expr, ExprId, Function, Origin, Program, SlotId, Subject, VarId, WorldId, arithmetic, call, compare,
};
use hypedc::sim::{Input, PlayerInput, Simulator};
use hypedc::source::{Files, ReadError};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Random steps of each world.
const STEPS: usize = 3_000;

/// A program with one file changed.
struct Changed<'a>(&'a Path, &'a str);

impl Files for Changed<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        if path == self.0 { Ok(self.1.to_string()) } else { Disk.read(path) }
    }

    fn identity(&self, path: &Path) -> PathBuf {
        Disk.identity(path)
    }
}

/// An instance in a state, read without the simulator's own reader; inputs and other instances are not known.
struct Instance<'a> {
    sim: &'a Simulator,
    state: &'a [u8],
    slot: SlotId,
}

impl Instance<'_> {
    fn number(&self, id: ExprId) -> Option<f64> {
        let (world, program) = (self.sim.world(), self.sim.program());
        let layout = &world.layout.slots[self.slot];
        Some(match program.exprs[id] {
            Expr::Number(n) => n,
            Expr::Frames(n) => n * world.step.seconds(),
            Expr::Param(Subject::Me, p) if world.slots[self.slot].origin == Origin::Named => {
                world.slots[self.slot].params[p]
            }
            Expr::Var(Subject::Me, var, degree) => layout.var(self.state, var, degree),
            Expr::Discrete(Subject::Me, d) => f64::from(layout.discrete(self.state, d)),
            Expr::Timer(timer) => world.step.times(layout.timer(self.state, timer)),
            Expr::Negate(a) => -self.number(a)?,
            Expr::Arithmetic(op, a, b) => arithmetic(op, self.number(a)?, self.number(b)?),
            Expr::Call(Function::If, [c, a, b]) => self.number(if self.truth(c)? { a } else { b })?,
            Expr::Call(f, [a, b, c]) => call(f, [self.number(a)?, self.number(b)?, self.number(c)?]),
            _ => return self.truth(id).map(f64::from),
        })
    }

    fn truth(&self, id: ExprId) -> Option<bool> {
        let layout = &self.sim.world().layout.slots[self.slot];
        match self.sim.program().exprs[id] {
            Expr::Bool(b) => Some(b),
            Expr::Compare(op, a, b) => Some(compare(op, self.number(a)?, self.number(b)?)),
            Expr::Not(a) => self.truth(a).map(|b| !b),
            Expr::And(a, b) => match (self.truth(a), self.truth(b)) {
                (Some(false), _) | (_, Some(false)) => Some(false),
                (Some(true), Some(true)) => Some(true),
                _ => None,
            },
            Expr::Or(a, b) => match (self.truth(a), self.truth(b)) {
                (Some(true), _) | (_, Some(true)) => Some(true),
                (Some(false), Some(false)) => Some(false),
                _ => None,
            },
            Expr::InMode(Subject::Me, mode) => {
                let entity = &self.sim.program().entities[self.sim.world().slots[self.slot].entity];
                let leaf = layout.leaf(self.state, entity.modes[mode].group);
                Some(entity.is_active_in(mode, leaf))
            }
            Expr::Touching(Subject::Me, touch) => Some(layout.touch(self.state, touch)),
            Expr::Discrete(Subject::Me, d) => Some(layout.discrete(self.state, d) != 0),
            Expr::Number(_) | Expr::Var(Subject::Me, ..) | Expr::Timer(_) | Expr::Arithmetic(..) => {
                Some(self.number(id)? != 0.0)
            }
            _ => None,
        }
    }
}

/// A predicate and its subpredicates.
fn parts(program: &Program, id: ExprId) -> Vec<ExprId> {
    let mut out = vec![id];
    match program.exprs[id] {
        Expr::Not(a) => out.extend(parts(program, a)),
        Expr::And(a, b) | Expr::Or(a, b) => out.extend([a, b].into_iter().flat_map(|x| parts(program, x))),
        _ => {}
    }
    out
}

/// Runs a world at random; `visit` receives every state, and returns whether to continue from it.
fn run(program: &Arc<Program>, id: WorldId, seed: u64, mut visit: impl FnMut(&Simulator, &[u8]) -> bool) {
    let sim = Simulator::new(program, id);
    let mut scratch = sim.scratch();
    let Ok(start) = sim.initial(&mut scratch) else { return };
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut state = start.clone();
    let mut input = Input::nothing(sim.world().players.len());
    let mut left = 0;
    for _ in 0..STEPS {
        let goes_on = visit(&sim, &state);
        if left == 0 {
            left = rng.random_range(1..40);
            for player in &mut input.0 {
                let mut axis = || f64::from(rng.random_range(-1..=1));
                let axes = [axis(), axis(), axis(), axis()];
                *player = PlayerInput { buttons: rng.random(), axes };
            }
        }
        left -= 1;
        if !goes_on || sim.step(&mut state, &input, &mut scratch).is_err() || rng.random_range(0..1_000) == 0 {
            state.copy_from_slice(&start);
        }
    }
}

/// Whether no player is below or beside its space.
fn is_inside(sim: &Simulator, state: &[u8]) -> bool {
    sim.world().players.iter().all(|p| {
        let layout = &sim.world().layout.slots[p.slot];
        let bounds = sim.world().spaces[layout.space(state)].bounds;
        let (x, y) = (layout.var(state, VarId(0), 0), layout.var(state, VarId(1), 0));
        !layout.alive(state) || bounds.is_none_or(|b| (b.left..=b.right).contains(&x) && y >= b.bottom)
    })
}

#[test]
fn guards_turn_out_as_they_can() {
    let mut found = Vec::new();
    let mut asked = 0;
    for path in files("examples", "hyped").into_iter().chain(files("tests/conformance", "hyped")) {
        let program = compile(&path, &Disk).program.unwrap();
        for id in program.worlds.ids() {
            let space = configuration_space(&program, id);
            run(&program, id, 3, |sim, state| {
                if !is_inside(sim, state) {
                    return false;
                }
                for (slot, s) in sim.world().slots.pairs() {
                    let (layout, entity) = (&sim.world().layout.slots[slot], &program.entities[s.entity]);
                    if space.slots[slot].is_given_up || !layout.alive(state) {
                        continue;
                    }
                    let leaves: Vec<_> = entity.groups.ids().map(|g| layout.leaf(state, g)).collect();
                    let Some(at) = space.slots[slot].configurations.iter().find(|c| *c.leaves == *leaves) else {
                        found.push(format!("{}: {leaves:?} of {}", path.display(), s.name));
                        return false;
                    };
                    let me = Instance { sim, state, slot };
                    let edges = leaves.iter().flat_map(|l| &entity.leaves[*l].edges);
                    for part in edges.flat_map(|e| parts(&program, entity.edges[*e].guard)) {
                        let Some(holds) = me.truth(part) else { continue };
                        asked += 1;
                        let (can_hold, can_fail) = space.turns_out(&program, id, (slot, at), part);
                        if !(if holds { can_hold } else { can_fail }) {
                            found.push(format!("{}: {} of {} is {holds}", path.display(), part, s.name));
                        }
                    }
                }
                true
            });
        }
    }
    assert!(asked > 100_000, "only {asked} were asked");
    assert!(found.is_empty(), "{}", found.join("\n"));
}

/// A number of a guard, an update, a bound or a parameter becomes another one.
fn renumbered(text: &str, rng: &mut Pcg64) -> Option<String> {
    let mut places = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let is_code = ["when ", ":=", "clamp ", "param ", "invariant "].iter().any(|w| line.contains(w));
        let bytes = line.as_bytes();
        let mut i = 0;
        while i < bytes.len() && is_code {
            let word = i > 0 && (bytes[i - 1].is_ascii_alphanumeric() || bytes[i - 1] == b'_' || bytes[i - 1] == b'.');
            let length = bytes[i..].iter().take_while(|b| b.is_ascii_digit()).count();
            if length > 0 && !word {
                places.push((at + i, length));
            }
            i += length.max(1);
        }
        at += line.len();
    }
    if places.is_empty() {
        return None;
    }
    let (from, length) = places[rng.random_range(0..places.len())];
    let old: u64 = text[from..from + length].parse().ok()?;
    let new = [0, old / 10, old * 10, old + 1, 999, 5][rng.random_range(0..6)];
    Some(format!("{}{new}{}", &text[..from], &text[from + length..]))
}

/// A finding that a run refutes.
fn contradicted(compilation: &Compilation, program: &Program, d: &Diagnostic, sim: &Simulator, state: &[u8]) -> bool {
    let Some(at) = d.primary.as_ref().map(|l| l.span) else { return false };
    let trace = |span| compilation.sources.trace(span).0;
    sim.world().slots.pairs().any(|(slot, s)| {
        let (layout, entity) = (&sim.world().layout.slots[slot], &program.entities[s.entity]);
        if !layout.alive(state) {
            return false;
        }
        let mut leaves = entity.groups.ids().map(|g| layout.leaf(state, g));
        match d.code {
            Code::ModeByValue => {
                let modes = &program.spans.entities[s.entity].modes;
                leaves.any(|l| entity.leaves[l].path.iter().any(|m| trace(modes[*m]) == at))
            }
            Code::GuardByValue => {
                let never = d.message.ends_with("never holds");
                assert!(never || d.message.ends_with("always holds"), "{}", d.message);
                let me = Instance { sim, state, slot };
                let edges = leaves.flat_map(|l| entity.leaves[l].edges.iter().chain(&entity.leaves[l].internal));
                let guards = edges.flat_map(|e| parts(program, entity.edges[*e].guard));
                guards.filter(|g| trace(program.spans.exprs[*g]) == at).any(|g| me.truth(g) == Some(never))
            }
            _ => false,
        }
    })
}

/// Runs all worlds of a program; returns its findings, and those that the runs refute.
fn tried(path: &Path, text: &str) -> (Vec<Code>, Vec<String>) {
    let compilation = check_with(path, LevelFile::default(), &Changed(path, text));
    let Some(program) = &compilation.program else { return Default::default() };
    let said: Vec<&Diagnostic> = compilation.diagnostics.iter().collect();
    let mut wrong = Vec::new();
    for id in program.worlds.ids().filter(|w| program.worlds[*w].open.is_none()) {
        let mut is_first = true;
        run(program, id, 5, |sim, state| {
            for d in &said {
                if contradicted(&compilation, program, d, sim, state) {
                    wrong.push(format!("{}: {}\n{text}", path.display(), d.message));
                    return false;
                }
            }
            if std::mem::take(&mut is_first) && said.iter().any(|d| d.code == Code::BrokenAtStart) {
                let broken = program.worlds.ids().any(|w| {
                    let sim = Simulator::new(program, w);
                    let start = sim.initial(&mut sim.scratch()).unwrap();
                    sim.broken_invariant(&start).unwrap().is_some()
                });
                assert!(broken, "{}: nothing is broken at the start\n{text}", path.display());
            }
            true
        });
        let space = configuration_space(program, id);
        let verdicts = invariants(program, id, &space);
        let proven = |entity: EntityId, index: usize| {
            verdicts.iter().any(|(e, i, v)| (*e, *i) == (entity, index) && *v == InvariantVerdict::Proven)
        };
        run(program, id, 6, |sim, state| {
            if !is_inside(sim, state) {
                return false;
            }
            if let Ok(Some((slot, index))) = sim.broken_invariant(state)
                && proven(sim.world().slots[slot].entity, index)
            {
                wrong.push(format!("{}: invariant {index} broke\n{text}", path.display()));
                return false;
            }
            true
        });
    }
    (said.iter().map(|d| d.code).collect(), wrong)
}

#[test]
fn what_is_proven_is_so_in_runs() {
    let mut all = Vec::new();
    let mut wrong = Vec::new();
    for path in files("examples", "hyped") {
        // Large worlds are too slow for this number of rounds.
        let large = ["mario.hyped", "boss.hyped", "lode_runner.hyped", "metroidvania.hyped"];
        if large[..sized(4, 3)].iter().any(|name| path.ends_with(name)) && !path.starts_with("examples/paper") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        // A new example leaves the changes of the others as they are.
        let name = path.file_name().unwrap().as_encoded_bytes();
        let seed = name.iter().fold(11_u64, |seed, byte| seed.wrapping_mul(31).wrapping_add((*byte).into()));
        let mut rng = Pcg64::seed_from_u64(seed);
        // So many modified versions of an example.
        for _ in 0..sized(4, 18) {
            let Some(changed) = renumbered(&text, &mut rng) else { continue };
            let (codes, found) = tried(&path, &changed);
            all.extend(codes);
            wrong.extend(found);
        }
    }
    for path in files("tests/ui", "hyped") {
        if path.file_name().unwrap().to_str().unwrap().starts_with("values_") {
            let text = std::fs::read_to_string(&path).unwrap();
            let (codes, found) = tried(&path, &text);
            all.extend(codes);
            wrong.extend(found);
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let count = |code: Code| all.iter().filter(|c| **c == code).count();
    for (code, least) in
        [(Code::GuardByValue, sized(4, 15)), (Code::ModeByValue, sized(2, 5)), (Code::UnprovenInvariant, 1)]
    {
        assert!(count(code) >= least, "{code} was found {} times", count(code));
    }
}

/// A ball with a distance per step and an initial distance from a wall of 16 px; whether it passes through the wall,
/// and whether that is predicted.
fn shot(text: &str) -> (bool, bool) {
    let path = Path::new("shot.hyped");
    let compilation = check_with(path, LevelFile::default(), &Changed(path, text));
    let program = compilation.program.as_ref().unwrap();
    let sim = Simulator::new(program, WorldId(0));
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    for _ in 0..50 {
        sim.step(&mut state, &Input::nothing(0), &mut scratch).unwrap();
    }
    let (x, y) = sim.position(&state, SlotId(0));
    (x > 216.0 || y < -24.0, compilation.diagnostics.iter().any(|d| d.code == Code::Tunnels))
}

#[test]
fn what_is_too_fast_for_a_wall_passes_it_and_nothing_else_does() {
    // 16 px of wall and 8 px of ball.
    let across = |far: f64, gap: f64| {
        format!(
            "entity Ball {{\n param speed = {}\n collider ball: rect(0, 0, 8, 8)\n x' = speed\n}}\n\
             world W {{\n step 1/50\n collide ball with wall: block\n space main {{\n \
             rect wall (200, -80, 16, 200)\n place ball: Ball at ({}, 16)\n }}\n}}\n",
            far * 50.0,
            192.0 - gap,
        )
    };
    // Tiles of 8 px: of two, one above the other, the lower one does not help. Once more from above alone.
    let down = |far: f64, gap: f64, how: &str| {
        let rows = if how == "block" { "    ....\n    ####\n    ####\n" } else { "    ....\n    ####\n    ....\n" };
        format!(
            "entity Ball {{\n param speed = {}\n collider ball: circle(4, 4, 4)\n y' = -speed\n}}\n\
             world W {{\n step 1/50\n collide ball with wall: {how}\n tiles t 8 x 8 {{\n '.': empty\n '#': wall\n }}\n \
             space main {{\n map t \"\n{rows}\"\n place ball: Ball at (12, {})\n }}\n}}\n",
            far * 50.0,
            16.0 + gap,
        )
    };
    let gaps = || (0..48).map(|i| f64::from(i) / 2.0);
    for (far, passes) in [(20.0, false), (23.9, false), (24.1, true), (30.0, true)] {
        let runs: Vec<(bool, bool)> = gaps().map(|gap| shot(&across(far, gap))).collect();
        assert_eq!(runs.iter().any(|(passed, _)| *passed), passes, "{far} px across");
        assert!(runs.iter().all(|(_, foreseen)| *foreseen == passes), "{far} px across");
    }
    for (far, passes) in [(12.0, false), (15.9, false), (16.1, true), (20.0, true)] {
        for how in ["block", "block from above"] {
            let runs: Vec<(bool, bool)> = gaps().map(|gap| shot(&down(far, gap, how))).collect();
            assert_eq!(runs.iter().any(|(passed, _)| *passed), passes, "{far} px down, {how}");
            assert!(runs.iter().all(|(_, foreseen)| *foreseen == passes), "{far} px down, {how}");
        }
    }
}

/// The codes that are found in a program of some files, the first being the one that is checked.
fn codes(files: &[(&str, &str)]) -> Vec<&'static str> {
    struct Given<'a>(&'a [(&'a str, &'a str)]);
    impl Files for Given<'_> {
        fn read(&self, path: &Path) -> Result<String, ReadError> {
            let found = self.0.iter().find(|(name, _)| path == Path::new(name));
            found.map(|(_, text)| (*text).to_string()).ok_or(ReadError::Unreadable("there is none".to_string()))
        }
        fn identity(&self, path: &Path) -> PathBuf {
            path.to_path_buf()
        }
    }
    let compilation = check_with(Path::new(files[0].0), LevelFile::default(), &Given(files));
    compilation.diagnostics.iter().map(|d| d.code.text()).collect()
}

/// A counter that stays at `most`, and its readers.
const COUNTER: &str = "entity Counter {
    param most = 3
    param last = 0
    discrete count: int 0..9 = 0
    mode counting {
        when count < most and count < 9 { count := count + 1 }
        when GUARD -> done
    }
    mode done { when timer > 1s + last -> counting }
}
";

fn counter(guard: &str, worlds: &str) -> Vec<&'static str> {
    let text = format!("{}{worlds}", COUNTER.replace("GUARD", guard));
    codes(&[("counter.hyped", &text)])
}

#[test]
fn a_guard_is_told_of_only_where_all_instances_agree() {
    let one = "world A { space main { place a: Counter at (0, 0) } }";
    let more = "world B { space main { place b: Counter at (0, 0) { most = 8 } } }";
    let both = "world C { space main { place a: Counter at (0, 0)\n place b: Counter at (0, 0) { most = 8 } } }";
    let open = "world D { tiles t 8 x 8 { '.': empty }\n space main { map level t\n place a: Counter at (0, 0) } }";
    // Its target is unreachable: that is reported once.
    assert_eq!(counter("count > 5", one), ["W0702"]);
    assert_eq!(counter("count > 5", &format!("{one}\n{more}")), [""; 0]);
    assert_eq!(counter("count > 5", both), [""; 0]);
    assert_eq!(counter("count > 8", both), ["W0702"]);
    assert_eq!(counter("count > 5", &format!("{one}\n{open}")), [""; 0]);
    assert_eq!(counter("count > 5", ""), [""; 0], "no instance at all");
    assert_eq!(counter("count > 5 or timer > 5s", one), [""; 0]);
    assert_eq!(counter("count <= 3 and timer >= 0s", one), ["W0701"], "it always holds");
}

#[test]
fn what_the_level_or_a_parameter_decides_is_not_told_of() {
    let place = |given: &str| format!("world A {{ space main {{ place a: Counter at (0, 0) {given} }} }}");
    let with = |guard: &str, given: &str| counter(guard, &place(given));
    assert_eq!(with("last > 0", ""), [""; 0], "a parameter alone");
    assert_eq!(with("last > 0 and timer > 1s", ""), [""; 0]);
    assert_eq!(with("timer > last - 1", ""), [""; 0], "a parameter that makes it always hold");
    assert_eq!(with("count > most", ""), ["W0702"], "the default");
    assert_eq!(with("count > most", "{ most = 4 }"), [""; 0], "what this instance was given");
    assert_eq!(with("x > 100", ""), [""; 0], "where it stands");
    let touching = "entity Slime {
            collider slime: rect(0, 0, 8, 8)
            mode idle { when touching(spring) -> flying }
            mode flying { when timer > 1s -> idle }
        }
        entity Spring { collider spring: rect(0, 0, 8, 8) }
        world W {
            collide slime with spring: sense
            space main { place slime: Slime at (0, 0) }
        }";
    assert_eq!(codes(&[("a.hyped", touching)]), [""; 0], "there is no spring in this level");
}

#[test]
fn bounds_at_which_a_search_stops_prove_nothing() {
    let text = |bounds: &str| {
        format!(
            "entity Hero {{
                button jump
                y'' = -400
                invariant y > -100
                mode falling {{
                    when pressed(jump) {{ y' := 0 }}
                    when y' < -300 -> dead
                }}
                mode dead {{ y' = 0 }}
            }}
            world W {{
                space main {{ {bounds} place hero: Hero at (8, 32) }}
                player 1: hero
            }}"
        )
    };
    for bounds in ["", "bounds rect(0, 0, 320, 240)\n"] {
        assert_eq!(codes(&[("a.hyped", &text(bounds))]), ["W0703"]);
    }
}

#[test]
fn what_another_file_says_is_its_own_affair() {
    let counter = COUNTER.replace("GUARD", "count > 5");
    let world = "world A { space main { place a: Counter at (0, 0) } }";
    let own = format!("{counter}{world}");
    assert_eq!(codes(&[("own.hyped", &own)]), ["W0702"]);
    let main = format!("import \"counter.hyped\"\n{world}");
    assert_eq!(codes(&[("main.hyped", &main), ("counter.hyped", &counter)]), [""; 0]);
}

#[test]
fn a_behavior_is_told_of_where_all_its_uses_agree() {
    let text = |two: &str| {
        format!(
            "behavior Sink {{
                mode sinking {{ when y' < -300 -> fast\n when timer > 9s -> fast }}
                mode fast {{ when timer > 1s -> sinking }}
            }}
            entity Stone {{ y'' = -400\n clamp y' in -200..200\n use Sink }}
            entity Anvil {{ y'' = -400\n clamp y' in -{two}..200\n use Sink }}
            world W {{ space main {{ place stone: Stone at (0, 0)\n place anvil: Anvil at (0, 0) }} }}"
        )
    };
    assert_eq!(codes(&[("a.hyped", &text("400"))]), [""; 0]);
    assert_eq!(codes(&[("a.hyped", &text("250"))]), ["W0701", "W0701"]);
}

#[test]
fn a_whole_number_below_a_fraction_is_not_lost() {
    let text = "entity Counter {
    discrete n: int 0..9 = 0
    mode counting {
        when n < 2.5 { n := n + 1 }
        when n > 2.5 -> done
    }
    mode done { when timer > 1s -> counting { n := 0 } }
}
world A { space main { place a: Counter at (0, 0) } }";
    assert_eq!(codes(&[("counter.hyped", text)]), [""; 0]);
}

/// The findings of `check` about a text, as people see them.
fn checked(text: &str) -> String {
    let compiled = check_with(Path::new("test.hyped"), LevelFile::default(), &crate::support::Text(text));
    render::human(&compiled.sources, compiled.diagnostics.iter(), false)
}

/// An entity with so many groups that its combinations of modes are not distinguished.
fn tangled(inside: &str) -> String {
    let groups: String = (1..12)
        .map(|i| {
            format!(
                "group g{i} {{ mode a {{ when timer >= {i}frames -> b }} mode b {{ when timer >= {}frames -> a }} }}\n",
                i + 1
            )
        })
        .collect();
    format!("entity Hero {{ {inside}\nx' = 60\n{groups} }}")
}

#[test]
fn an_invariant_of_which_nothing_is_known_is_not_proven() {
    let world = "world W { space main { place hero: Hero at (0, 0) } }";
    let found = checked(&format!("{} {world}", tangled("invariant x <= 5")));
    assert!(found.contains("W0703") && found.contains("1024 combinations of modes"), "{found}");
    // A violation in the initial state is reported even if the analysis gives up.
    let found = checked(&format!("{} {world}", tangled("invariant x > 5")));
    assert!(found.contains("E0701"), "{found}");
    let plain = "entity Hero { collider body: rect(0, 0, 16, 16); invariant x <= 40; x' = 60 }";
    let open = "world W { tiles t 16 x 16 { '.': empty }; space main { map level t; place hero: Hero at (32, 0) } }";
    let found = checked(&format!("{plain} {open}"));
    assert!(found.contains("W0703") && found.contains("the map of `W` is not given"), "{found}");
    let found = checked(&format!("{plain} {}", open.replace("(32, 0)", "(64, 0)")));
    assert!(found.contains("E0701"), "{found}");
    let found = checked(plain);
    assert!(found.contains("W0703") && found.contains("no world has a `Hero`"), "{found}");
    // One world is proven; the other one is not analysed.
    let still = "entity Hero { invariant x <= 40 }";
    let found = checked(&format!("{still} {world} {}", open.replace("world W", "world V")));
    assert!(found.contains("W0703"), "{found}");
    assert_eq!(checked(&format!("{still} {world}")), "", "silence means proven");
}

#[test]
fn what_an_entity_that_is_given_up_spawns_can_be_anything() {
    let spawner = tangled("button go").replace(
        "mode a { when timer >= 1frames -> b }",
        "mode a { when timer >= 1frames -> b { spawn Shot(size = 4) } }",
    );
    assert!(spawner.contains("spawn"));
    let text = format!(
        "{spawner} entity Shot {{ param size = 8; invariant size > 5; x' = 1 }}
         world W {{ limit Shot 2; space main {{ place hero: Hero at (0, 0) }} }}"
    );
    let found = checked(&text);
    assert!(found.contains("W0703"), "{found}");
}
