//! Soft locks: in finite puzzles the numbers of states are those of a brute force that is written from the simulator
//! alone; in platform worlds with planted pits the pits are found, and nothing that a search can leave.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::HashMap;
use std::sync::Arc;

use crate::support::{Disk, compile_text, files, program};
use hypedc::analysis::configuration_space;
use hypedc::compile::compile;
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::stuck::{
    Candidate, CandidateAnswer, CandidateLimits, ExactAnswer, Gap, StateCounts, Unknown, find_candidates, find_stuck,
};
use hypedc::reach::{Limits, Problem, Settings, Verdict, reach};
use hypedc::sim::{Input, PlayerInput, Script, Simulator, State};
use hypedc::watch::Unwatched;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const GOAL: GoalId = GoalId(0);
const WAYS: usize = 1000;

fn limits(nodes: u64) -> Limits {
    Limits { nodes, ..Limits::default() }
}

fn exact(program: &Arc<Program>) -> Result<ExactAnswer, Gap> {
    let sim = Simulator::new(program, WorldId(0));
    find_stuck(&Problem::new(&sim, GOAL), &limits(400_000), WAYS, &Unwatched).unwrap()
}

// Brute force.

/// What a state leads to: other states, whether it is a goal, whether the run can end.
struct Explored {
    next: Vec<Vec<usize>>,
    is_goal: Vec<bool>,
    can_end: Vec<bool>,
    /// Whether no player is left.
    is_gone: Vec<bool>,
    states: Vec<State>,
}

/// All inputs of the only player of the tests' entities: two axes at -1, 0 and 1, and the first button.
fn all_inputs(buttons: u64) -> Vec<Input> {
    let mut inputs = Vec::new();
    for horizontal in [-1.0, 0.0, 1.0] {
        for vertical in [-1.0, 0.0, 1.0] {
            for buttons in 0..=buttons {
                let mut player = PlayerInput { buttons, ..PlayerInput::default() };
                (player.axes[0], player.axes[1]) = (horizontal, vertical);
                inputs.push(Input::of_players(vec![player]));
            }
        }
    }
    inputs
}

fn explored(sim: &Simulator, inputs: &[Input]) -> Explored {
    let mut scratch = sim.scratch();
    let first = sim.initial(&mut scratch).unwrap();
    let is_over = |state: &State| sim.violated(state).unwrap().is_some() || sim.left_bounds(state).is_some();
    assert!(!is_over(&first));
    let mut numbers = HashMap::from([(first.clone(), 0)]);
    let player = sim.world().players.iter().next().unwrap().slot;
    let mut all = Explored {
        next: Vec::new(),
        is_goal: Vec::new(),
        can_end: Vec::new(),
        is_gone: Vec::new(),
        states: vec![first],
    };
    let mut at = 0;
    while at < all.states.len() {
        let is_goal = sim.goal(&all.states[at], GOAL).unwrap();
        let (mut next, mut can_end) = (Vec::new(), false);
        for input in inputs.iter().filter(|_| !is_goal) {
            let mut state = all.states[at].clone();
            sim.step(&mut state, input, &mut scratch).unwrap();
            if is_over(&state) {
                can_end = true;
                continue;
            }
            let number = *numbers.entry(state.clone()).or_insert_with(|| {
                all.states.push(state);
                all.states.len() - 1
            });
            next.push(number);
        }
        all.next.push(next);
        all.is_goal.push(is_goal);
        all.can_end.push(can_end);
        all.is_gone.push(!sim.instance(&all.states[at], player).is_alive());
        at += 1;
    }
    all
}

/// The states that lead to one of some: by repeated passes over all states.
fn leading_to(all: &Explored, mut leads: Vec<bool>) -> Vec<bool> {
    loop {
        let mut has_changed = false;
        for at in (0..leads.len()).rev().chain(0..leads.len()) {
            if !leads[at] && all.next[at].iter().any(|to| leads[*to]) {
                (leads[at], has_changed) = (true, true);
            }
        }
        if !has_changed {
            return leads;
        }
    }
}

/// Which states arrive, and which of the others go on for ever with a player.
fn passes(all: &Explored) -> (Vec<bool>, Vec<bool>) {
    let arrives = leading_to(all, all.is_goal.clone());
    let has_players = leading_to(all, all.is_gone.iter().map(|gone| !gone).collect());
    let mut stays: Vec<bool> = (0..arrives.len()).map(|at| !arrives[at] && has_players[at]).collect();
    loop {
        let ends = |at: &usize| stays[*at] && !all.next[*at].iter().any(|to| stays[*to]);
        let ends: Vec<usize> = (0..stays.len()).filter(ends).collect();
        if ends.is_empty() {
            return (arrives, stays);
        }
        ends.into_iter().for_each(|at| stays[at] = false);
    }
}

fn counted(all: &Explored, arrives: &[bool], stays: &[bool]) -> StateCounts {
    let count = |is: &dyn Fn(usize) -> bool| (0..arrives.len()).filter(|at| is(*at)).count() as u64;
    StateCounts {
        all: arrives.len() as u64,
        goals: count(&|at| all.is_goal[at]),
        arriving: count(&|at| arrives[at]),
        stuck: count(&|at| stays[at]),
        dead_ends: count(&|at| stays[at] && !all.can_end[at] && all.next[at].iter().all(|to| *to == at)),
        doomed: count(&|at| !arrives[at] && !stays[at]),
    }
}

/// Compares a world with brute force, its ways in included; returns the counts.
fn check(name: &str, text: &str, buttons: u64) -> StateCounts {
    let program = program(compile_text(text));
    let sim = Simulator::new(&program, WorldId(0));
    let all = explored(&sim, &all_inputs(buttons));
    let (arrives, stays) = passes(&all);
    let expected = counted(&all, &arrives, &stays);
    let answer = exact(&program).unwrap_or_else(|gap| panic!("{name}: {gap:?}"));
    assert_eq!(answer.counts, expected, "{name}");
    assert_eq!(answer.starts_well, arrives[0], "{name}");
    assert!(answer.ways.first().is_none_or(|way| way.is_apart), "{name}");
    // There is a way in exactly if something is stuck and the start is not.
    assert_eq!(!answer.ways.is_empty(), arrives[0] && expected.stuck > 0, "{name}");
    assert_eq!(answer.places, answer.ways.len().min(WAYS), "{name}");
    let number = |state: &State| all.states.iter().position(|known| known == state).unwrap();
    let mut last = (false, 0);
    for way in &answer.ways {
        let end = way.script.len();
        let before = number(&after(&sim, &way.script.first(end - 1)));
        assert!(arrives[before], "{name}: {}", way.place);
        let at = number(&after(&sim, &way.script));
        assert!(stays[at], "{name}: {}", way.place);
        assert!((!way.is_apart, end) >= last, "{name}: of each kind, the shortest come first");
        assert!(1 <= way.behind && way.behind <= expected.stuck + expected.doomed, "{name}");
        last = (!way.is_apart, end);
    }
    expected
}

fn after(sim: &Simulator, script: &Script) -> State {
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    for input in script.inputs() {
        sim.step(&mut state, input, &mut scratch).unwrap();
    }
    state
}

// Puzzles.

/// The entities of the example, with one room.
fn sokoban(room: &[&str]) -> String {
    let example = std::fs::read_to_string("examples/sokoban.hyped").unwrap();
    let entities = &example[..example.find("world First").unwrap()];
    format!(
        "{entities}
world Room {{
    step 1/60
    tiles room 16 x 16 {{
        '.': empty
        '#': wall, solid
        'o': spot
        '@': spawn Player as player
        '$': spawn Crate
    }}
    space main {{
        map room \"
            {}
        \"
    }}
    player 1: player
    goal solved: all Crate in home
}}
",
        room.join("\n            ")
    )
}

/// A walker on a grid that falls where there is no floor and climbs one cell. `p` shuts all `g` for good, `k` is a key
/// that opens one of two doors `d` and `e`, `x` ends the run.
fn grid(room: &[&str]) -> String {
    format!(
        "entity Walker {{
    discrete shut: bool = false
    discrete key: int 0..2 = 0
    discrete opened: int 0..2 = 0
    axis horizontal, vertical
    collider body: rect(0, 0, 16, 16)
    condition right_free = not touching(body at (16, 0), wall) and not (shut and touching(body at (16, 0), gate))
        and not (touching(body at (16, 0), one) and opened != 1 and key != 1)
        and not (touching(body at (16, 0), two) and opened != 2 and key != 1)
    condition left_free = not touching(body at (-16, 0), wall) and not (shut and touching(body at (-16, 0), gate))
        and not (touching(body at (-16, 0), one) and opened != 1 and key != 1)
        and not (touching(body at (-16, 0), two) and opened != 2 and key != 1)
    condition falls = not touching(body at (0, -16), wall)
    condition can_climb = not touching(body at (0, 16), wall)
    mode living {{
        when touching(body at (0, 0), home) -> home
        when touching(body at (0, 0), spikes) -> dead
        when touching(body at (0, 0), pit) {{ destroy self }}
        when touching(body at (0, 0), plate) and not shut {{ shut := true }}
        when touching(body at (0, 0), keys) and key == 0 {{ key := 1 }}
        when touching(body at (0, 0), one) and key == 1 {{ key := 2; opened := 1 }}
        when touching(body at (0, 0), two) and key == 1 {{ key := 2; opened := 2 }}
        when falls {{ y += -16 }}
        when horizontal > 0 and right_free {{ x += 16 }}
        when horizontal < 0 and left_free {{ x += -16 }}
        when horizontal > 0 and can_climb and not touching(body at (16, 16), wall) {{ x += 16; y += 16 }}
        when horizontal < 0 and can_climb and not touching(body at (-16, 16), wall) {{ x += -16; y += 16 }}
    }}
    mode home {{ }}
    mode dead {{ }}
}}
world Room {{
    step 1/60
    tiles room 16 x 16 {{
        '.': empty
        '#': wall
        'G': home
        'p': plate
        'v': pit
        'g': gate
        'k': keys
        'd': one
        'e': two
        'x': spikes
        '@': spawn Walker as hero
    }}
    space main {{
        map room \"
            {}
        \"
    }}
    player 1: hero
    goal home: hero in home
    never dead: hero in dead
}}
",
        room.join("\n            ")
    )
}

/// A walker seen from above, on floor and on bridges that break behind it; `>` is floor that cannot be left to the left, `k` a
/// key without which `d` cannot be entered.
fn bridges(room: &[&str]) -> String {
    let mut edges = String::new();
    for (input, (x, y)) in [
        ("horizontal > 0 and vertical == 0", (16, 0)),
        ("horizontal < 0 and vertical == 0 and not touching(body at (0, 0), oneway)", (-16, 0)),
        ("vertical > 0 and horizontal == 0", (0, 16)),
        ("vertical < 0 and horizontal == 0", (0, -16)),
    ] {
        let there = format!("body at ({x}, {y})");
        let goes = format!(
            "{input} and (touching({there}, floor) or touching({there}, bridge)) and (has_key or not touching({there}, door))"
        );
        edges += &format!("        when {goes} and touching(body at (0, 0), bridge) as b {{ destroy b }}\n");
        edges += &format!("        when {goes} {{ x += {x}; y += {y} }}\n");
    }
    format!(
        "entity Walker {{
    discrete has_key: bool = false
    axis horizontal, vertical
    collider body: rect(0, 0, 16, 16)
    mode walking {{
        when touching(body at (0, 0), home) -> home
        when touching(body at (0, 0), key) {{ has_key := true }}
{edges}    }}
    mode home {{ }}
}}
world Bridges {{
    step 1/60
    tiles room 16 x 16 {{
        '.': empty
        'F': floor
        'G': floor, home
        '>': floor, oneway
        'k': floor, key
        'd': floor, door
        'b': bridge breakable
    }}
    space main {{
        map room \"
            {}
        \"
        place hero: Walker at (0, 0)
    }}
    player 1: hero
    goal home: hero in home
}}
",
        room.join("\n            ")
    )
}

/// A small room with walls and as many crates as spots, all at random.
fn random_room(seed: u64) -> Vec<String> {
    let mut rng = Pcg64::seed_from_u64(seed);
    let (columns, rows) = (rng.random_range(4..=5usize), 4usize);
    let mut cells: Vec<Vec<char>> = vec![vec!['.'; columns]; rows];
    for thing in ['@', '$', 'o', '#'] {
        loop {
            let (column, row) = (rng.random_range(0..columns), rng.random_range(0..rows));
            // A crate at a wall is stuck too often.
            let is_inside = (1..columns - 1).contains(&column) && (1..rows - 1).contains(&row);
            if cells[row][column] == '.' && (thing != '$' || is_inside) {
                cells[row][column] = thing;
                break;
            }
        }
    }
    let border = "#".repeat(columns + 2);
    let inside = cells.into_iter().map(|row| format!("#{}#", row.into_iter().collect::<String>()));
    std::iter::once(border.clone()).chain(inside).chain([border]).collect()
}

#[test]
fn puzzles_are_as_brute_force_says() {
    let boxes = ["#####", "#@..#", "#.$.#", "#..o#", "#####"];
    let counts = check("corner", &sokoban(&boxes), 0);
    assert!(counts.stuck > 0 && counts.arriving > counts.goals && counts.goals > 0, "{counts:?}");
    let (mut stuck, mut arriving) = (0, 0);
    for seed in 1..=5 {
        let room = random_room(seed);
        let room: Vec<&str> = room.iter().map(String::as_str).collect();
        let counts = check(&format!("room {seed}: {room:?}"), &sokoban(&room), 0);
        stuck += u64::from(counts.stuck > 0);
        arriving += u64::from(counts.arriving > 0);
    }
    assert!(stuck >= 3 && arriving >= 2, "{stuck}, {arriving}");
}

#[test]
fn grids_are_as_brute_force_says() {
    let drop =
        ["###########", "#....@....#", "#.#######.#", "#.#######.#", "#.#######.#", "#G#######.#", "###########"];
    let counts = check("drop", &grid(&drop), 0);
    // Nothing can be done at the bottom, and falling is no choice either.
    assert!(counts.stuck >= 3 && counts.dead_ends == 1 && counts.doomed == 0, "{counts:?}");
    let spikes = ["###########", "#....@....#", "#.#######.#", "#.#######.#", "#G#######x#", "###########"];
    let counts = check("spikes", &grid(&spikes), 0);
    // In the shaft nothing can be done any more.
    assert!(counts.stuck == 0 && counts.doomed == 2, "{counts:?}");
    let pit = ["##########", "#v...@.G.#", "##########"];
    let counts = check("pit", &grid(&pit), 0);
    // Who is gone is not stuck.
    assert!(counts.stuck == 0 && counts.doomed >= 1, "{counts:?}");
    let plate = ["############", "#G.g.@..p..#", "############"];
    let counts = check("plate", &grid(&plate), 0);
    assert!(counts.stuck > 5 && counts.dead_ends == 0, "{counts:?}");
    let doors = ["#############", "#G.d.@.k.e..#", "#############"];
    let counts = check("doors", &grid(&doors), 0);
    assert!(counts.stuck > 5, "{counts:?}");
    // What is in the hole climbs out of it on the left, where it is one cell deep.
    let ledge = ["##########", "#@......G#", "##.#######", "##########"];
    let counts = check("hole", &grid(&ledge), 0);
    assert!(counts.stuck == 0 && counts.arriving == counts.all, "{counts:?}");
    let never = ["#######", "#@..#G#", "#######"];
    let counts = check("walled", &grid(&never), 0);
    assert!(counts.arriving == 0 && counts.stuck == counts.all && counts.goals == 0, "{counts:?}");
}

#[test]
fn bridges_that_break_are_as_brute_force_says() {
    // Whoever goes up to the key first comes back over the second bridge; over the first, the way home is broken.
    let key = ["kbF..", "b.bdG", "FbF.."];
    let counts = check("key", &bridges(&key), 0);
    assert!(counts.stuck > 0 && counts.arriving > 0, "{counts:?}");
    let side = ["..F..", "..b..", "FbFbG"];
    let counts = check("side", &bridges(&side), 0);
    assert!(counts.stuck > 0 && counts.arriving > 0, "{counts:?}");
    let ledge = ["FFFFG", "F....", "F>FFF"];
    let counts = check("one way", &bridges(&ledge), 0);
    assert!(counts.stuck >= 3 && counts.arriving > 0, "{counts:?}");
    // Rooms at random, most of which can be spoilt.
    let (mut stuck, mut arriving) = (0, 0);
    for seed in 1..=12 {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut cells: Vec<Vec<char>> = (0..4)
            .map(|_| (0..5).map(|_| ['F', 'b', 'b', 'F', '>', '.', 'k', 'd'][rng.random_range(0..8)]).collect())
            .collect();
        (cells[3][0], cells[rng.random_range(0..3)][4]) = ('F', 'G');
        let room: Vec<String> = cells.into_iter().map(|row| row.into_iter().collect()).collect();
        let room: Vec<&str> = room.iter().map(String::as_str).collect();
        let counts = check(&format!("bridges {seed}: {room:?}"), &bridges(&room), 0);
        stuck += u64::from(counts.stuck > 0 && counts.arriving > 0);
        arriving += u64::from(counts.arriving > 0);
    }
    assert!(stuck >= 2 && arriving >= 3, "{stuck}, {arriving}");
    let apart = ["FbF.G", "b.b..", "FbF.."];
    let counts = check("apart", &bridges(&apart), 0);
    assert!(counts.arriving == 0 && counts.stuck == counts.all, "{counts:?}");
}

#[test]
fn nothing_is_claimed_where_states_are_left_out() {
    let program = program(compile_text(&sokoban(&["#####", "#@..#", "#.$.#", "#..o#", "#####"])));
    let sim = Simulator::new(&program, WorldId(0));
    let problem = Problem::new(&sim, GOAL);
    let all = exact(&program).unwrap().counts.all;
    let within = |nodes| find_stuck(&problem, &limits(nodes), WAYS, &Unwatched).unwrap();
    assert_eq!(within(all - 1), Err(Gap::Nodes));
    assert!(within(all).is_ok());
    let memory = Limits { memory: 1000, ..Limits::default() };
    assert_eq!(find_stuck(&problem, &memory, WAYS, &Unwatched).unwrap(), Err(Gap::Memory));
}

// Platform worlds.

/// A runner that jumps 62 px high, with some geometry and a goal.
fn platforms(things: &str, goal: &str) -> Arc<Program> {
    let runner = std::fs::read_to_string("tests/verdicts/parts/runner.hyped").unwrap();
    program(compile_text(&format!(
        "{runner}
world W {{
    step 1/64
    collide body with floor: block
    space main {{
        bounds rect(0, 0, 480, 320)
        rect floor (0, 0, 8, 320)
        rect floor (472, 0, 8, 320)
        place hero: Runner at (40, 160)
        {things}
    }}
    player 1: hero
    goal out: {goal}
}}
"
    )))
}

fn candidates(program: &Arc<Program>, nodes: u64, seed: u64) -> Result<CandidateAnswer, Unknown> {
    let sim = Simulator::new(program, WorldId(0));
    let space = configuration_space(program, WorldId(0));
    let limits = CandidateLimits { limits: limits(nodes), seed };
    find_candidates(&Problem::new(&sim, GOAL), &space, &limits, &Unwatched).unwrap()
}

/// Where the hero is at the end of the way into each candidate. No search from there arrives.
fn places(program: &Arc<Program>, answer: &CandidateAnswer) -> Vec<(f64, f64)> {
    let sim = Simulator::new(program, WorldId(0));
    let space = configuration_space(program, WorldId(0));
    let hero = program.worlds[WorldId(0)].slots.find(|slot| slot.name == "hero").unwrap();
    let place = |candidate: &Candidate| {
        let problem = Problem::new(&sim, GOAL).after(candidate.script.clone()).unwrap();
        let settings = Settings { seed: 77, ..Settings::default() };
        let outcome = reach(&problem, &space, &settings, &limits(30_000), &Unwatched).unwrap();
        assert!(!matches!(outcome.verdict, Verdict::Reached(_)), "{candidate:?}");
        sim.position(&after(&sim, &candidate.script), hero)
    };
    answer.candidates.iter().map(place).collect()
}

/// The floor at a height of 160 px, with gaps `(from, to, bottom)`.
fn floor(gaps: &[(i32, i32, i32)]) -> String {
    let (mut out, mut left) = (String::new(), 8);
    for (from, to, bottom) in gaps {
        out.push_str(&format!("rect floor ({left}, 0, {}, 160)\n", from - left));
        out.push_str(&format!("rect floor ({from}, 0, {}, {bottom})\n", to - from));
        left = *to;
    }
    out + &format!("rect floor ({left}, 0, {}, 160)\n", 472 - left)
}

const NODES: u64 = 30_000;

#[test]
fn the_same_seed_gives_the_same_candidates() {
    let deep = platforms(&floor(&[(160, 220, 64)]), "hero.x > 400");
    let found = candidates(&deep, NODES, 1).unwrap();
    assert_eq!(candidates(&deep, NODES, 1).unwrap(), found);
}

/// The pits of a world in `tests/stuck`, from the lines at its beginning: from where to where the hero can be, at which
/// height.
fn pits(text: &str) -> Vec<(f64, f64, f64)> {
    let lines = text.lines().map_while(|line| line.strip_prefix("// pit "));
    let pit = |line: &str| {
        let (place, _) = line.split_once(": ")?;
        let (range, height) = place.split_once(" at ")?;
        let (from, to) = range.split_once("..")?;
        Some((from.parse().ok()?, to.parse().ok()?, height.parse().ok()?))
    };
    lines.map(|line| pit(line).unwrap_or_else(|| panic!("{line}"))).collect()
}

#[test]
fn all_pits_that_are_planted_are_found() {
    let paths = files("tests/stuck", "hyped");
    assert!(paths.len() >= 5);
    for path in paths {
        let planted = pits(&std::fs::read_to_string(&path).unwrap());
        let world = program(compile(&path, &Disk));
        // Where all states can be visited, the first ways lead into one pit each.
        let answer = exact(&world).unwrap();
        let apart = answer.ways.iter().take_while(|way| way.is_apart).count();
        assert_eq!(apart, planted.len(), "{}: {:?}", path.display(), &answer.ways[..apart]);
        let found = candidates(&world, NODES, 1).unwrap();
        let at = places(&world, &found);
        let is_in = |(x, y): &(f64, f64), (from, to, height): &(f64, f64, f64)| from <= x && x <= to && y == height;
        for pit in &planted {
            assert!(at.iter().any(|place| is_in(place, pit)), "{}: {pit:?} is not among {at:?}", path.display());
        }
        if path.ends_with("trap.hyped") {
            let changes = &found.candidates[0].changes;
            assert!(changes.iter().any(|change| change.contains("trap")), "{found:?}");
        }
        for place in &at {
            assert!(planted.iter().any(|pit| is_in(place, pit)), "{}: {place:?} is no pit", path.display());
        }
    }
}

#[test]
fn a_pit_with_a_ledge_is_fine() {
    let things = floor(&[(160, 260, 64)]) + "rect floor (220, 64, 40, 48)\n";
    let program = platforms(&things, "hero.x > 400");
    let found = candidates(&program, NODES, 1).unwrap();
    assert_eq!(places(&program, &found), [], "{found:?}");
    assert!(found.rest_places > 10, "{found:?}");
}

#[test]
fn nothing_is_said_where_players_never_rest_or_nothing_arrives() {
    let flappy = program(compile("examples/flappy.hyped".as_ref(), &Disk));
    assert_eq!(candidates(&flappy, 20_000, 1), Err(Unknown::NoRest));
    let walled = platforms(&floor(&[(160, 200, 160)]), "hero.y > 300");
    assert!(matches!(candidates(&walled, 2_000, 1), Err(Unknown::NotFound | Unknown::Unreachable)));
}

#[test]
fn a_limit_of_time_is_what_is_named_when_it_is_over() {
    // Over before anything is begun: a machine can be as fast as it likes.
    let command = ["stuck", "examples/flappy.hyped", "--seconds", "0"];
    let output = std::process::Command::new(env!("CARGO_BIN_EXE_hypedc")).args(command).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains("goal out: nothing can be said (not proven)"), "{text}");
    assert_eq!(text.matches("`--seconds 0` allows no more").count(), 2, "{text}");
}
