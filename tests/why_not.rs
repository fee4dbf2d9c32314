//! Why a goal was not reached: the nearest state is as near as can be worked out, its inputs lead there, and the simulator
//! agrees with what is said to be missing.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::support::{Disk, Text, files, is_long, program, script_of, sized};
use hypedc::compile::{Asked, Changes, Compilation, ExtraQuestion, LevelFile, compile, compile_changed, compile_with};
use hypedc::ir::{Program, WorldId};
use hypedc::reach::query::{Answer, Query, Session};
use hypedc::reach::why_not::{Barrier, PartState, Point, WhyNot};
use hypedc::reach::{Limits, Planner, Settings, Target};
use hypedc::sim::Simulator;
use hypedc::source::SourceMap;
use hypedc::watch::Unwatched;

const WORLD: WorldId = WorldId(0);

/// Runs a pixel a step of 1/64 s, jumps 62 px high and is back at its height after 63 steps, when it is 63 px further. All
/// numbers are exact.
const RUNNER: &str = "
entity Runner {
    param speed = 64
    param jump_speed = 256
    param gravity = -512
    axis horizontal
    button jump
    collider body, player: rect(0, 0, 16, 16)
    envelope x' by horizontal { sustain speed }
    mode ground {
        y' = 0
        when not touching(body, floor, below) -> air
        when pressed(jump) -> air { y' := jump_speed }
    }
    initial mode air {
        y'' = gravity
        when touching(body, floor, below) and y' <= 0 -> ground
    }
}
";

/// Walks a pixel a step in four or eight directions; takes keys, and opens doors with them.
const WALKER: &str = "
entity Walker {
    param speed = 64
    discrete keys: int 0..9 = 0
    discrete mood: {calm, cross} = calm
    axis horizontal, vertical
    collider body, player: rect(0, 0, 12, 12)
    mode walking {
        envelope x' by horizontal { sustain speed }
        envelope y' by vertical { sustain speed }
        follow links
        when touching(body, key) { keys := min(keys + 1, 9) }
    }
}
entity Key {
    collider key: rect(0, 0, 8, 8)
    mode lying { when touching(key, player) { destroy self } }
}
entity Door {
    kinematic collider door, wall: rect(0, 0, 8, 60) when in locked
    mode locked { when touching(door, player) as hero and hero is Walker and hero.keys > 0 -> open }
    mode open { }
}
";

/// A room in which a wall of 8 px at x = 80 keeps a walker from what is right of it: it gets to x = 68.
const WALLED: &str = "
    collide body with wall: block
    collide player, body with key: sense
    collide player, body with door: sense
    collide body with flag: sense
    space main {
        bounds rect(0, 0, 160, 60)
        rect wall (0, 0, 160, 8)
        rect wall (0, 52, 160, 8)
        rect wall (0, 0, 8, 60)
        rect wall (152, 0, 8, 60)
        place door: Door at (80, 0)
        rect flag (120, 8, 8, 44)
        place hero: Walker at (20, 20)
        place key: Key at (100, 20)
        place near_key: Key at (40, 20)
    }
    player 1: hero
";

/// Ground of 32 px with a ledge that is 2 px too high.
const LEDGE: &str = "
    collide body with floor: block
    space main {
        bounds rect(0, 0, 200, 200)
        rect floor (0, 0, 200, 32)
        rect floor (100, 0, 100, 96)
        place hero: Runner at (30, 32)
    }
    player 1: hero
";

/// Two grounds with a gap of 78 px, which is a pixel too wide.
const GAP: &str = "
    collide body with floor: block
    space main {
        bounds rect(0, 0, 300, 200)
        rect floor (0, 0, 100, 32)
        rect floor (178, 0, 122, 32)
        place hero: Runner at (9, 32)
    }
    player 1: hero
";

/// Three rooms; the link of the first one asks for more keys than there are.
const ROOMS: &str = "
    collide body with wall: block
    collide player, body with key: sense
    collide player, body with door: sense
    collide body with flag: sense
    tiles t 16 x 16 { '.': empty; '#': wall }
    space hall {
        map t \"
            #######
            #.....#
            #.....#
            #######
        \"
        place hero: Walker at (20, 20)
        place key: Key at (40, 20)
        place door: Door at (300, 0)
        link rect(80, 16, 16, 32) -> cellar at rect(16, 16, 16, 32) when hero.keys > 2
    }
    space cellar {
        map t \"
            #######
            #.....#
            #.....#
            #######
        \"
        link rect(80, 16, 16, 32) -> attic at rect(16, 16, 16, 32)
    }
    space attic {
        map t \"
            #######
            #.....#
            #.....#
            #######
        \"
        rect flag (40, 20, 8, 8)
    }
    player 1: hero
";

fn world(entity: &str, body: &str, goal: &str) -> String {
    format!("{entity}world W {{\n    step 1/64\n{body}    goal asked: {goal}\n}}\n")
}

/// Asks for the first goal, with the analysis and the default planner.
fn ask(text: &str, planner: Planner, nodes: u64, change: impl Fn(&mut Query)) -> (Arc<Program>, Answer) {
    let compiled = compile(Path::new("test.hyped"), &Text(text));
    let sources = compiled.sources.clone();
    let program = program(compiled);
    let answer = answer(&program, &sources, Target::Goal(hypedc::ir::GoalId(0)), planner, nodes, change);
    (program, answer)
}

fn answer(
    program: &Arc<Program>,
    sources: &SourceMap,
    target: Target,
    planner: Planner,
    nodes: u64,
    change: impl Fn(&mut Query),
) -> Answer {
    let mut query = Query::new(vec![target]);
    query.settings = Settings { planner, explains: true, ..Settings::default() };
    query.limits = Limits { nodes, ..Limits::default() };
    change(&mut query);
    let session = Session::new(program, WORLD, query, &Unwatched);
    let mut found = session.find(target, &Unwatched).unwrap();
    session.answer(&mut found, sources)
}

fn why(answer: &Answer) -> &WhyNot {
    answer.why_not.as_ref().unwrap_or_else(|| panic!("{:?}", answer.verdict))
}

/// A world with a goal, and the parts of the nearest state that are missing: what of it is said, with its unit.
struct Known {
    entity: &'static str,
    body: &'static str,
    goal: &'static str,
    /// Missing parts with their distances and units.
    missing: &'static [(&'static str, f64, &'static str)],
}

const fn known(
    entity: &'static str,
    body: &'static str,
    goal: &'static str,
    missing: &'static [(&'static str, f64, &'static str)],
) -> Known {
    Known { entity, body, goal, missing }
}

/// The distances that can be worked out.
const KNOWN: [Known; 20] = [
    // A jump rises by the sum of 4 - k/8 for k from 1 to 32: 62 px, from 32 to 94.
    known(RUNNER, LEDGE, "hero.y > 130", &[("hero.y > 130", 36.0, "px")]),
    known(RUNNER, LEDGE, "130 < hero.y", &[("130 < hero.y", 36.0, "px")]),
    // Before the ledge at x = 84, at the top of a jump.
    known(RUNNER, LEDGE, "hero.x > 110 and hero.y >= 96", &[("hero.x > 110", 26.0, "px"), ("hero.y >= 96", 2.0, "px")]),
    known(RUNNER, LEDGE, "hero.x > 110", &[("hero.x > 110", 26.0, "px")]),
    // 16 px of the body are before the ledge at 100.
    known(RUNNER, LEDGE, "near(hero, (120, 32), 8)", &[("near(hero, (120, 32), 8)", 28.0, "px")]),
    // 64 px/s are all there is.
    known(RUNNER, LEDGE, "hero.x' > 74", &[("hero.x' > 74", 10.0, "px/s")]),
    // The fastest rise is that of the first step of a jump, less 8 px/s of gravity.
    known(RUNNER, LEDGE, "hero.y' >= 300", &[("hero.y' >= 300", 52.0, "px/s")]),
    // Steps are 1 px long and begin at 30.
    known(RUNNER, LEDGE, "hero.x == 40.5", &[("hero.x == 40.5", 0.5, "px")]),
    // From x = 99, the last place on the ground, to the far edge: there the body is against it.
    known(RUNNER, GAP, "hero.x > 190 and hero.y >= 32", &[("hero.x > 190", 28.0, "px")]),
    known(RUNNER, GAP, "hero.x > 170", &[("hero.x > 170", 8.0, "px")]),
    // A key that is behind the door for which it is the second one.
    known(WALKER, WALLED, "hero.keys > 2", &[("hero.keys > 2", 1.0, "")]),
    known(WALKER, WALLED, "hero.keys >= 5", &[("hero.keys >= 5", 3.0, "")]),
    known(WALKER, WALLED, "hero.x < 5", &[("hero.x < 5", 3.0, "px")]),
    known(WALKER, WALLED, "hero.x > 170 or hero.y > 50", &[("hero.x > 170 or hero.y > 50", 10.0, "px")]),
    known(WALKER, WALLED, "count(Key) > 2", &[("count(Key) > 2", 1.0, "")]),
    known(WALKER, WALLED, "distance(hero, (76, 20)) > 200", &[("distance(hero, (76, 20)) > 200", 129.1, "px")]),
    known(WALKER, WALLED, "not near(hero, (74, 26), 400)", &[("not near(hero, (74, 26), 400)", 331.0, "px")]),
    known(WALKER, ROOMS, "inside(hero, attic)", &[("inside(hero, attic)", 2.0, "rooms")]),
    known(WALKER, ROOMS, "inside(hero, cellar) and hero.keys > 0", &[("inside(hero, cellar)", 1.0, "rooms")]),
    known(WALKER, ROOMS, "hero.keys >= 2", &[("hero.keys >= 2", 1.0, "")]),
];

#[test]
fn the_nearest_state_is_as_near_as_can_be_worked_out() {
    let mut wrong = String::new();
    for Known { entity, body, goal, missing } in &KNOWN {
        let (program, answer) = ask(&world(entity, body, goal), Planner::Auto, 10_000, |_| {});
        let why = why(&answer);
        let nearest = why.nearest.as_ref().unwrap();
        let found: Vec<&PartState> = nearest.parts.iter().filter(|part| !part.holds).collect();
        let agrees = found.len() == missing.len()
            && found.iter().zip(*missing).all(|(part, (text, distance, unit))| {
                let apart = (part.distance.unwrap_or(f64::NAN) - distance).abs();
                part.text == *text && part.unit == *unit && apart <= 1.0
            });
        if !agrees {
            wrong += &format!("{goal}: {:?}, {} nodes: {found:?}\n", answer.verdict, why.nodes);
        }
        replays(&program, &nearest.at);
        why.parts.iter().filter_map(|part| part.at.as_ref()).for_each(|at| replays(&program, at));
    }
    assert!(wrong.is_empty(), "{wrong}");
}

/// The inputs lead to the place after the number of steps.
fn replays(program: &Arc<Program>, at: &Point) {
    let sim = Simulator::new(program, WORLD);
    let script = script_of(program, WORLD, &at.inputs);
    assert_eq!(script.len(), at.step);
    let (mut scratch, player) = (sim.scratch(), sim.world().players.iter().next().unwrap().slot);
    let mut state = sim.initial(&mut scratch).unwrap();
    for input in script.inputs() {
        sim.step(&mut state, input, &mut scratch).unwrap();
    }
    assert_eq!(sim.position(&state, player), (at.x, at.y), "{}", at.inputs);
    assert_eq!(Some(&sim.world().spaces[sim.space(&state, player)].name), at.space.as_ref());
}

/// A step too few: with a time limit, it is the last state that is nearest.
#[test]
fn a_step_too_late_is_a_pixel_too_far() {
    let text = world(WALKER, WALLED, "hero.x >= 60");
    let (_, answer) = ask(&text, Planner::Auto, 3_000, |query| query.within = Some(39));
    let nearest = why(&answer).nearest.as_ref().unwrap();
    assert_eq!((nearest.at.step, nearest.at.x), (39, 59.0));
    assert_eq!(nearest.parts[0].words, "misses by 1 px");
    let (_, answer) = ask(&text, Planner::Auto, 3_000, |query| query.within = Some(40));
    assert_eq!(answer.steps, Some(40));
    assert_eq!(answer.why_not, None);
}

/// What has no distance is said in words.
#[test]
fn modes_and_values_are_told_in_words() {
    let words = |entity, body, goal| {
        let (_, answer) = ask(&world(entity, body, goal), Planner::Auto, 2_000, |_| {});
        why(&answer).nearest.as_ref().unwrap().parts.iter().map(PartState::phrase).collect::<Vec<_>>().join("; ")
    };
    assert_eq!(words(WALKER, ROOMS, "door in open"), "`door in open` is in `locked`");
    assert_eq!(words(WALKER, ROOMS, "hero.mood == cross"), "`hero.mood == cross` is `calm`");
    assert_eq!(
        words(WALKER, ROOMS, "hero touching flag"),
        "`hero touching flag` misses by 2 rooms: `hero` is in `hall`"
    );
    assert_eq!(
        words(WALKER, ROOMS, "all Key in lying and any Door in open"),
        "`all Key in lying` holds; `any Door in open` is in `locked`"
    );
    assert_eq!(words(RUNNER, LEDGE, "hero.y > 94"), "`hero.y > 94` is at the limit and has to be beyond it");
}

/// Of what edges count, the edge that counts is told, and the nearest state is the one that is nearest to taking it.
#[test]
fn what_edges_count_is_told_with_the_edge() {
    let collector = RUNNER.replace(
        "    mode ground {",
        "    discrete gems: int 0..9 = 0
    always { when touching(body, gem) and gems < 9 { gems += 1 } }
    always { when gems > 5 { gems -= 1 } }
    mode ground {",
    );
    let body = LEDGE.replace("    collide", "    collide body with gem: sense\n    collide").replace(
        "        place hero",
        "        rect gem (60, 120, 8, 8)
        place hero",
    );
    let text = world(&collector, &body, "hero.gems > 2");
    let edge = 1 + text.lines().position(|line| line.contains("gems += 1")).unwrap();
    let (program, answer) = ask(&text, Planner::Auto, 3_000, |_| {});
    let nearest = why(&answer).nearest.as_ref().unwrap();
    // At the top of a jump the body ends at 94 + 16.
    let missing =
        format!("`hero.gems > 2` misses by 3 (edge at test.hyped:{edge}: `touching(body, gem)` misses by 10 px)");
    assert_eq!(nearest.parts[0].phrase(), missing);
    assert_eq!((nearest.parts[0].distance, nearest.at.y), (Some(3.0), 94.0));
    replays(&program, &nearest.at);
}

/// An instance that blocks the player in the nearest state is named, with what its edges lack.
#[test]
fn an_instance_in_the_way_is_named() {
    let locked = WALLED.replace("        place near_key: Key at (40, 20)\n", "");
    let (_, answer) = ask(&world(WALKER, &locked, "hero.x > 100"), Planner::Auto, 3_000, |_| {});
    let why = why(&answer);
    let way = why.way.as_ref().unwrap();
    assert_eq!(way.barrier, Barrier::Instance);
    assert_eq!(way.words, "in the nearest state `door` is right of the player and blocks it, in `locked`");
    let open = why.modes.iter().find(|mode| mode.instance == "door" && mode.mode == "open").unwrap();
    assert!(open.is_asked && open.missing.iter().any(|part| part.contains("hero.keys > 0")), "{open:?}");
    // What is in another direction is not in the way.
    let (_, answer) = ask(&world(WALKER, &locked, "hero.x < 5"), Planner::Auto, 3_000, |_| {});
    assert_ne!(self::why(&answer).way.as_ref().map(|way| way.barrier), Some(Barrier::Instance));
}

/// Each part also tells how near it came by itself.
#[test]
fn each_part_came_nearest_by_itself() {
    let (_, answer) = ask(&world(RUNNER, LEDGE, "hero.x < 20 and hero.x > 110"), Planner::Auto, 5_000, |_| {});
    let why = why(&answer);
    let [low, high] = &*why.parts else { panic!("{:?}", why.parts) };
    assert!(low.part.holds, "{low:?}");
    assert_eq!(high.part.distance, Some(26.0), "{high:?}");
}

/// Where the way ends, according to the map.
#[test]
fn the_way_ends_where_the_map_says_so() {
    let level = |rows: &[&str], within: Option<u32>| {
        let rows = rows.join("\n            ");
        let body = format!(
            "    collide body with floor: block
    tiles t 16 x 16 {{ '.': empty; '#': floor }}
    space main {{
        bounds rect(0, 0, 640, 400)
        map t \"
            {rows}
        \"
        place hero: Runner at (16, 16)
    }}
    player 1: hero
"
        );
        let (_, answer) = ask(&world(RUNNER, &body, "hero.x > 288 and hero.y >= 16"), Planner::Auto, 6_000, |query| {
            query.within = within
        });
        why(&answer).way.clone().unwrap()
    };
    let ground = "####################";
    let air = "....................";
    let wall = "..........##........";
    let way = level(&[air, wall, wall, wall, wall, wall, ground], None);
    assert_eq!((way.barrier, way.column, way.tiles), (Barrier::Wall, Some(10), Some(5.0)), "{way:?}");
    let way = level(&[wall, wall, wall, wall, wall, wall, ground], None);
    assert!(way.words.contains("up to the top of the map"), "{way:?}");
    let way = level(&[air, air, air, air, air, air, "#####.......########"], None);
    assert_eq!((way.barrier, way.column, way.tiles), (Barrier::Gap, Some(5), Some(7.0)), "{way:?}");
    let way = level(&[air, air, air, air, air, air, "#####..............."], None);
    assert_eq!((way.barrier, way.column, way.size), (Barrier::Gap, Some(5), None), "{way:?}");
    // A ceiling and a ledge that are too high to jump on are no ends of the gap.
    let high = ".......##...........";
    let way = level(&[ground, air, high, air, air, air, "#####.......########"], None);
    assert_eq!((way.barrier, way.column, way.tiles), (Barrier::Gap, Some(5), Some(7.0)), "{way:?}");
    // What a jump clears bars nothing: there, the time is too short.
    let low = "..........##........";
    let way = level(&[air, air, air, air, air, low, ground], Some(150));
    assert_eq!((way.barrier, way.size), (Barrier::Unknown, None), "{way:?}");
}

#[test]
fn a_goal_above_needs_a_rise() {
    let (_, answer) = ask(&world(RUNNER, LEDGE, "hero.y > 130"), Planner::Auto, 2_000, |_| {});
    let why = why(&answer);
    assert_eq!(why.highest_jump, 62.0);
    let way = why.way.as_ref().unwrap();
    assert_eq!((way.barrier, way.size), (Barrier::Height, Some(98.0)), "{way:?}");
}

/// Who hops on from a step at once does not rest for two steps, but its jump began there; nor who falls to the very height
/// of a floor.
#[test]
fn a_hop_from_a_step_is_a_jump_of_its_own() {
    let body = "
    collide body with floor: block
    space main {
        bounds rect(0, 0, 320, 240)
        rect floor (0, 0, 320, 16)
        rect floor (100, 16, 40, 32)
        rect floor (150, 16, 40, 64)
        place hero: Runner at (16, 16)
    }
    player 1: hero
";
    for seed in 1..20 {
        let world = world(RUNNER, body, "hero.y > 160");
        let (_, answer) = ask(&world, Planner::Coverage, 5_000, |query| query.settings.seed = seed);
        let why = why(&answer);
        // The longest is one of 63 px; some searches have seen a shorter one.
        assert_eq!(why.highest_jump, 62.0, "seed {seed}");
        assert!((50.0..=63.0).contains(&why.longest_jump), "seed {seed}: {}", why.longest_jump);
    }
}

/// Rooms that a link leads to are told with the link and what it asks for.
#[test]
fn closed_rooms_are_told_with_their_links() {
    let (_, answer) = ask(&world(WALKER, ROOMS, "inside(hero, attic)"), Planner::Auto, 3_000, |_| {});
    let [cellar, attic] = &*why(&answer).rooms else { panic!("{:?}", why(&answer).rooms) };
    assert_eq!((&*cellar.room, cellar.from.as_deref()), ("cellar", Some("hall")));
    assert!(cellar.place.as_ref().unwrap().starts_with("test.hyped:"), "{cellar:?}");
    assert_eq!(cellar.guard.as_ref().unwrap().text, "hero.keys > 2");
    assert_eq!((&*attic.room, &attic.from), ("attic", &None));
}

/// All questions about the first worlds of the examples: the inputs lead to the state that is told, and the simulator
/// agrees with each part: it holds or does not, and with the distance it would.
#[test]
fn what_is_missing_in_the_examples_is_what_the_simulator_misses() {
    let (mut states, mut distances) = (0, 0);
    let slow = ["lode_runner.hyped", "asteroids.hyped", "pac_man.hyped"];
    let paths = files("examples", "hyped").into_iter().filter(|path| !slow.iter().any(|name| path.ends_with(name)));
    for (path, turn) in paths.zip(0..) {
        let level = level_of(&path);
        let compiled = compile_with(&path, level.as_deref().map(LevelFile::new).unwrap_or_default(), &Disk);
        let Compilation { sources, program: Some(program), .. } = compiled else { continue };
        let Some(table) = program.worlds.iter().next().filter(|world| world.open.is_none()) else { continue };
        for (goal, count) in table.goals.ids().zip(0..) {
            for (index, planner) in Planner::ALL.into_iter().enumerate() {
                if !is_long() && (index + turn + count) % 6 != 0 {
                    continue;
                }
                let nodes = sized(60, 1_000);
                let answer = answer(&program, &sources, Target::Goal(goal), planner, nodes, |_| {});
                let Some(why) = &answer.why_not else { continue };
                let nearest = why.nearest.iter().map(|nearest| (&nearest.at, nearest.parts.iter().collect()));
                let each = why.parts.iter().filter_map(|part| Some((part.at.as_ref()?, vec![&part.part])));
                for (at, parts) in nearest.chain(each) {
                    states += 1;
                    distances += confirm(&path, level.as_deref(), at, &parts);
                }
            }
        }
    }
    assert!(states > 60 && distances > 15, "{states} states, {distances} distances");
}

/// A level for a program that leaves its map open.
fn level_of(path: &Path) -> Option<PathBuf> {
    let text = std::fs::read_to_string(path).unwrap();
    if !text.lines().any(|line| line.trim_start().starts_with("map level")) {
        return None;
    }
    let mut levels = files(path.parent()?.to_str()?, "txt");
    levels.sort();
    levels.into_iter().next()
}

/// Asks the parts as goals of their own, and with their distances. Returns the number of distances.
fn confirm(path: &Path, level: Option<&Path>, at: &Point, parts: &[&PartState]) -> usize {
    let mut texts: Vec<(String, bool)> = Vec::new();
    let mut distances = 0;
    for part in parts.iter().filter(|part| !part.text.is_empty()) {
        texts.push((part.text.clone(), part.holds));
        let Some(distance) = part.distance.filter(|distance| *distance > 0.0 && part.unit.starts_with("px")) else {
            continue;
        };
        let is_plain = !part.text.contains(" and ") && !part.text.contains(" or ") && !part.text.contains('(');
        for op in [" >= ", " <= ", " > ", " < "].into_iter().filter(|_| is_plain) {
            let Some((a, b)) = part.text.split_once(op) else { continue };
            let sign = if op.contains('>') { "+" } else { "-" };
            texts.push((format!("{a} {sign} {:.6}{op}{b}", distance + 0.001), true));
            texts.push((format!("{a} {sign} {:.6}{op}{b}", distance - 0.001), false));
            distances += 1;
            break;
        }
    }
    let questions: Vec<ExtraQuestion<'_>> =
        texts.iter().map(|(text, _)| ExtraQuestion { asked: Asked::Goal, world: None, text, origin: "part" }).collect();
    let changes = Changes { questions: &questions, ..Changes::default() };
    let level = level.map(LevelFile::new).unwrap_or_default();
    let compiled = compile_changed(path, level, &changes, &Disk);
    let program = program(compiled);
    let sim = Simulator::new(&program, WORLD);
    let (mut scratch, script) = (sim.scratch(), script_of(&program, WORLD, &at.inputs));
    assert_eq!(script.len(), at.step);
    let mut state = sim.initial(&mut scratch).unwrap();
    for input in script.inputs() {
        sim.step(&mut state, input, &mut scratch).unwrap();
    }
    let player = sim.world().players.iter().next().unwrap().slot;
    assert_eq!(sim.position(&state, player), (at.x, at.y), "{}", path.display());
    for (text, holds) in &texts {
        let goal = sim.world().goal_named(text).unwrap_or_else(|| panic!("{}: {text}", path.display()));
        assert_eq!(sim.goal(&state, goal).unwrap(), *holds, "{}: {text} after {}", path.display(), at.inputs);
    }
    distances
}

/// Several trees find the same on any number of threads.
#[test]
fn threads_do_not_change_the_nearest_state() {
    for (entity, body, goal) in [(RUNNER, GAP, "hero.x > 190"), (WALKER, ROOMS, "hero touching flag")] {
        let with = |threads| {
            let text = world(entity, body, goal);
            ask(&text, Planner::Coverage, 2_000, |query| (query.settings.trees, query.settings.threads) = (4, threads))
                .1
        };
        assert_eq!(with(1), with(3));
    }
}

/// Without the question, nothing is kept.
#[test]
fn nothing_is_kept_unless_it_is_asked_for() {
    let text = world(RUNNER, LEDGE, "hero.y > 130");
    let (_, answer) = ask(&text, Planner::Auto, 500, |query| query.settings.explains = false);
    assert_eq!(answer.why_not, None);
    let program = program(compile(Path::new("test.hyped"), &Text(&text)));
    assert_eq!(program.worlds.len(), 1);
}
