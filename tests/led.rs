//! Goals to which no position of a player leads by itself: a mode that an edge with speeds in its guard enters, something
//! that has to be pushed, a supply of which some has to be left, keys and gates. Each is found for several seeds, and its
//! way replays.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::Path;
use std::sync::Arc;

use crate::support::{Disk, assert_leads_to, compile_text, program};
use hypedc::analysis::configuration_space;
use hypedc::compile::{LevelFile, compile, compile_with};
use hypedc::ir::{GoalId, Program, WorldId};
use hypedc::reach::query::{Query, Session};
use hypedc::reach::{Limits, Plan, Planner, Problem, Settings, Target, Verdict, search};
use hypedc::sim::Simulator;
use hypedc::watch::Unwatched;

const WORLD: WorldId = WorldId(0);

/// The way to a goal, with the number of nodes of the search.
fn find(program: &Arc<Program>, goal: &str, (seed, nodes): (u64, u64), planner: Planner) -> Option<(Plan, u64)> {
    let goal = program.worlds[WORLD].goals.pairs().find(|(_, g)| g.name == goal).unwrap().0;
    let query = Query {
        settings: Settings { seed, planner, ..Settings::default() },
        limits: Limits { nodes, ..Limits::default() },
        ..Query::new(vec![Target::Goal(goal)])
    };
    let session = Session::new(program, WORLD, query, &Unwatched);
    let found = session.find(Target::Goal(goal), &Unwatched).unwrap();
    let Verdict::Reached(plan) = found.outcome.verdict else { return None };
    assert_leads_to(&Simulator::new(program, WORLD), &plan.script, goal);
    Some((plan, found.outcome.statistics.nodes))
}

/// A stage of the game, of which there are levels beside the program.
fn stage(level: &str) -> Arc<Program> {
    let examples = Path::new("examples/mega-man");
    let level = LevelFile { map: Some(&examples.join(level)), ..LevelFile::default() };
    program(compile_with(&examples.join("mega_man.hyped"), level, &Disk))
}

#[test]
fn what_has_to_be_slow_or_pushed_is_found() {
    for (name, goal) in [("lander", "landed"), ("crate", "plate")] {
        let program = program(compile(Path::new(&format!("benches/worlds/{name}.hyped")), &Disk));
        let found = (1..=4).filter(|&seed| find(&program, goal, (seed, 300_000), Planner::Auto).is_some());
        assert!(found.count() >= 3, "{name}");
    }
}

#[test]
fn what_lies_behind_locked_doors_is_found() {
    let (guided, auto) = (Planner::DistanceGuided, Planner::Auto);
    for (name, goal, planner) in [
        ("maze", "chalice", guided),
        ("maze", "chalice", auto),
        ("maze_loops", "red_door", guided),
        ("maze_loops", "chalice", auto),
        ("stealth", "away", auto),
    ] {
        let program = program(compile(Path::new(&format!("benches/worlds/{name}.hyped")), &Disk));
        let found = (1..=3).filter(|&seed| find(&program, goal, (seed, 200_000), planner).is_some());
        assert_eq!(found.count(), 3, "{name}, {goal}, {planner:?}");
    }
}

#[test]
fn keys_and_what_opens_gates_lead_the_way() {
    for (name, goal, nodes) in [
        ("maze", "red_door", 5_000),
        ("maze", "chalice", 8_000),
        ("stealth", "away", 30_000),
        ("gallery", "out", 60_000),
    ] {
        let program = program(compile(Path::new(&format!("benches/worlds/{name}.hyped")), &Disk));
        let found = (1..=4).filter(|&seed| find(&program, goal, (seed, nodes), Planner::DistanceGuided).is_some());
        assert_eq!(found.count(), 4, "{name}, {goal}");
    }
}

/// A hall with a locked door on the straight way to the exit, and the key in the far corner: `SIDE` is a way around the
/// door, or a wall.
const HALL: &str = "
    entity Thief {
        param speed: px/s = 90
        axis across, along
        discrete has_key: bool = false
        collider body, thief: rect(0, 0, 12, 12)
        mode walking {
            x' = speed * across
            y' = speed * along
            when touching(body, key) { has_key := true }
        }
    }
    entity Key { collider key: rect(4, 4, 8, 8)
        mode lying { when touching(key, thief) { destroy self } }
    }
    entity Door { kinematic collider door: rect(0, 0, 16, 16) when in locked
        mode locked { when touching(door, thief) as who and who is Thief and who.has_key -> open }
        mode open { }
    }
    world Hall {
        step 1/60
        collide body with wall, door: block
        collide thief with key, exit: sense
        tiles hall 16 x 16 {
            '.': empty
            '#': wall
            'K': spawn Key
            'E': exit
        }
        space main {
            map hall \"
                ################################
                #K.............................#
                ##############################.#
                #..............................#
                #.##############################
                #..............................#
                #.###################SIDE#######
                #.....................#.......E#
                #.............................E#
                ################################
            \"
            place hero: Thief at (200, 18)
            place door: Door at (352, 16)
        }
        player 1: hero
        goal out: hero touching exit
    }
";

#[test]
fn a_gate_counts_only_if_no_way_leads_around_it() {
    // With the way around the door closed, the key comes first, else nobody looks for it.
    for (side, nodes) in [("####", 2_000), ("....", 500)] {
        let program = program(compile_text(&HALL.replace("SIDE", side)));
        let found = (1..=4).filter(|&seed| find(&program, "out", (seed, nodes), Planner::DistanceGuided).is_some());
        assert_eq!(found.count(), 4, "{side}");
    }
}

/// A box on a bench that a hero pushes from the left onto a button, two rooms away from where a straight line leads.
const BOX: &str = "
    entity Hero {
        param speed: px/s = 90
        axis across, along
        collider body: rect(0, 0, 12, 12)
        x' = speed * across
        y' = speed * along
    }
    entity Box { collider box: rect(0, 0, 14, 14)
        x' = 0
        y' = 0
    }
    entity Button { collider plate: rect(4, 4, 8, 8)
        mode up { when touching(plate, box) -> down }
        mode down { }
    }
    entity Lamp { ref plate: Button
        mode dark { when plate in down -> lit }
        mode lit { }
    }
    world W { step 1/60
        collide body, box with wall: block
        collide body with box: block
        collide box with plate: sense
        tiles t 16 x 16 { '.': empty; '#': wall }
        space main {
            map t \"
                ############
                #..........#
                #..........#
                #..........#
                ############
            \"
            place hero: Hero at (20, 20)
            place crate: Box at (60, 33)
            place plate: Button at (144, 32)
            place lamp: Lamp at (160, 48) { plate = plate }
        }
        player 1: hero
        goal light: lamp in lit
    }";

#[test]
fn edges_are_followed_back_through_the_modes_of_others() {
    let program = program(compile_text(BOX));
    for seed in 1..=3 {
        assert!(find(&program, "light", (seed, 60_000), Planner::DistanceGuided).is_some(), "{seed}");
    }
}

/// A car with little fuel: it has to roll for most of the way, to have enough left.
const CAR: &str = "
    entity Car {
        param slow: px/s = 30
        param fast: px/s = 60
        axis across
        button burn
        continuous fuel = 4
        clamp fuel >= 0
        invariant fuel >= 0
        collider body: rect(0, 0, 8, 8)
        mode rolling {
            x' = slow * across
            fuel' = 0
            when held(burn) and fuel > 0 -> driving
        }
        mode driving {
            x' = fast * across
            fuel' = -1
            when not held(burn) or fuel <= 0 -> rolling
        }
    }
    world W { step 1/60
        space main { place car: Car at (0, 0) }
        player 1: car
        goal far: car.x >= 400 and car.fuel >= 1
    }";

#[test]
fn what_is_used_up_ends_a_branch() {
    let program = program(compile_text(CAR));
    for planner in [Planner::Auto, Planner::Coverage] {
        for seed in 1..=3 {
            assert!(find(&program, "far", (seed, 40_000), planner).is_some(), "{planner:?} {seed}");
        }
    }
}

/// Two planners that go on from each other's ways need no more than the better one alone, or little more.
#[test]
fn who_is_dead_for_good_is_followed_no_further() {
    // A flyer, whom thorns kill, and a goal that is too far away for so few nodes: the number of modes of its states.
    let modes = |dead: &str, lift: &str, goal: &str| {
        let text = format!(
            "entity Hero {{
                param speed = 120
                axis fly, climb
                collider body: rect(0, 0, 16, 16)
                mode alive {{ x' = speed * fly; y' = speed * climb; when touching(body, thorn) -> dead }}
                mode dead {{ {dead} }}
            }}
            entity Lift {{ collider lift: rect(0, 0, 8, 8) }}
            world W {{
                step 1/20
                collide body with thorn, flag: sense
                collide body with lift: block, carry
                space main {{
                    rect thorn (120, -200, 16, 400)
                    rect flag (90000, 16, 16, 16)
                    place hero: Hero at (64, 16)
                    {lift}
                }}
                player 1: hero
                goal out: {goal}
            }}"
        );
        let program = program(compile_text(&text));
        let space = configuration_space(&program, WORLD);
        let sim = Simulator::new(&program, WORLD);
        let problem = Problem::new(&sim, GoalId(0));
        let settings = Settings { planner: Planner::Coverage, ..Settings::default() };
        let limits = Limits { nodes: 200, ..Limits::default() };
        let outcome = search(&problem, &space, &settings, &limits, &Unwatched).unwrap();
        assert_eq!((outcome.statistics.nodes, outcome.verdict), (200, Verdict::NotFound), "{dead} {goal}");
        outcome.covered.all.modes
    };
    let (still, far) = ("x' = 0; y' = 0", "hero.x > 90000");
    for goal in [far, "90000 < hero.x", "hero touching flag", "hero in alive and hero.x > 90000"] {
        assert_eq!(modes(still, "", goal), 1, "{goal}");
    }
    // A corpse that falls changes its place along y only.
    let falls = "x' = 0; y'' = -300";
    assert_eq!(modes(falls, "", far), 1);
    assert_eq!(modes(falls, "", "hero.y > 90000"), 2);
    // One that slides, comes to life again, or may be carried, can get there.
    assert_eq!(modes("x' = 10; y' = 0", "", far), 2);
    assert_eq!(modes("x' = 0; y' = 0; when timer >= 2s -> alive", "", far), 2);
    assert_eq!(modes(still, "place lift: Lift at (0, 300)", far), 2);
}

#[test]
fn ways_are_exchanged() {
    let program = stage("megaman_1_1.txt");
    for seed in 1..=2 {
        assert!(find(&program, "end", (seed, 200_000), Planner::Auto).is_some(), "{seed}");
    }
}

/// Up a tower of twenty rooms, where single extensions from all places between the ledges found no way out of the first ones.
#[test]
fn a_tower_is_climbed_jump_by_jump() {
    let program = stage("megaman_1_3.txt");
    for seed in 1..=3 {
        assert!(find(&program, "end", (seed, 60_000), Planner::DistanceGuided).is_some(), "{seed}");
    }
}

#[test]
fn a_beam_that_is_stuck_gives_way_to_a_wider_one() {
    let program = program(compile(Path::new("examples/platforms.hyped"), &Disk));
    for seed in 1..=3 {
        // Where no tree ended by itself, the first one wandered about for 14,000 steps.
        let (plan, _) = find(&program, "flag", (seed, 200_000), Planner::Beam).unwrap();
        assert!(plan.steps < 1_000, "seed {seed}: {} steps", plan.steps);
    }
}

#[test]
fn auto_goes_on_from_its_first_way_to_faster_ones() {
    let mut is_faster = false;
    for (file, goal) in
        [("examples/platforms.hyped", "flag"), ("examples/mario.hyped", "flag"), ("benches/worlds/tower.hyped", "bell")]
    {
        let program = program(compile(Path::new(file), &Disk));
        let sim = Simulator::new(&program, WORLD);
        let space = configuration_space(&program, WORLD);
        let id = program.worlds[WORLD].goals.find(|of| of.name == goal).unwrap();
        let problem = Problem::new(&sim, id);
        for seed in 1..=2 {
            let found = |hastens| {
                let settings = Settings { seed, hastens, ..Settings::default() };
                let outcome = search(&problem, &space, &settings, &Limits::default(), &Unwatched).unwrap();
                let Verdict::Reached(plan) = outcome.verdict else { panic!("{file}, seed {seed}: not found") };
                assert_leads_to(&sim, &plan.script, id);
                (plan.steps, outcome.statistics.nodes)
            };
            let ((first, few), (fast, more)) = (found(false), found(true));
            assert!(
                fast <= first && more >= few,
                "{file}, seed {seed}: {first} and {fast} steps, {few} and {more} nodes"
            );
            is_faster |= fast < first;
        }
    }
    assert!(is_faster);
}

/// A pillar among spikes, and a ledge beyond them, under a ceiling: only a jump from the last pixels of the pillar, with the
/// button released at one step or two, leads there.
const PILLAR: &str = r#"
entity Pit {
    axis horizontal
    button jump
    collider body, player: rect(2, 0, 12, 16)
    clamp y' >= -240
    mode alive {
        when touching(player, hazard) -> dead
        mode air {
            envelope x' by horizontal {
                attack accel 400
                sustain 75
                release accel 400
            }
            when touching(body, solid, below) -> ground
            mode falling { y'' = -900 }
            mode rising {
                y'' = -400
                when not held(jump) or y' <= 0 -> falling
            }
        }
        initial mode ground {
            y' = 0
            envelope x' by horizontal {
                attack accel 400
                sustain 75
                release accel 400
            }
            when not touching(body, solid, below) -> falling
            when pressed(jump) -> rising { y' := 225 }
        }
    }
    mode dead {
        x' = 0
        y' = 0
    }
}

world Stage {
    step 1/60
    collide body with solid: block
    collide player with hazard: sense
    tiles stage 16 x 16 {
        '.': empty
        '#': solid
        'H': solid, hazard
    }
    space main {
        map stage "
            ...........
            ........#..
            ...........
            ...........
            ...........
            HHHH#HHH###
        "
        place pit: Pit at (62, 16)
    }
    player 1: pit
    goal over: pit in ground and pit.x > 120
    never died: pit in dead
}
"#;

#[test]
fn a_jump_that_few_inputs_make_is_found_by_its_misses() {
    let program = program(compile_text(PILLAR));
    for seed in 1..=5 {
        let found = find(&program, "over", (seed, 20_000), Planner::LedgeGuided);
        assert!(found.is_some(), "seed {seed}");
    }
}

#[test]
fn who_begins_in_the_air_is_led_to_the_first_ledge() {
    let program = program(compile_text(&PILLAR.replace("Pit at (62, 16)", "Pit at (62, 40)")));
    for planner in [Planner::LedgeGuided, Planner::Auto] {
        assert!(find(&program, "over", (1, 20_000), planner).is_some(), "{planner:?}");
    }
}

#[test]
fn without_ledges_the_search_by_ledges_goes_on_from_anywhere() {
    let program = program(compile_text(
        "entity Ship {
            param speed: px/s = 60
            axis across
            mode flying { x' = across * speed }
        }
        world Space {
            space main { place ship: Ship at (0, 0) }
            player 1: ship
            goal away: ship.x > 300
        }",
    ));
    assert!(find(&program, "away", (1, 2_000), Planner::LedgeGuided).is_some());
}
