//! Super Mario Bros.: that he moves as in the game, and what a search says of real levels of the Video Game Level Corpus
//! (see `examples/smb/LICENSE-VGLC.md`).

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use rand::Rng;
use rand_pcg::Pcg32;

use crate::support::{Disk, assert_leads_to, program, script, sized};
use hypedc::analysis::{ConfigurationSpace, at_most, configuration_space, watched_space};
use hypedc::compile::{LevelFile, compile_with};
use hypedc::ir::{GoalId, Origin, Program, SlotId, VarId, WorldId};
use hypedc::reach::query::{Query, Session};
use hypedc::reach::{Argument, Limits, Monitor, Planner, Problem, Settings, Target, Verdict, reach};
use hypedc::sim::{Script, Simulator};
use hypedc::source::{Files, ReadError};
use hypedc::watch::{Progress, Unwatched, Watch};

const WORLD: WorldId = WorldId(0);
const ROOT: &str = "examples/smb/smb.hyped";
const LEVEL: &str = "level.txt";

/// The disk, and one level beside it; texts from the disk are changed.
struct WithLevel<'a>(&'a str, &'a dyn Fn(&str) -> String);

impl Files for WithLevel<'_> {
    fn read(&self, path: &Path) -> Result<String, ReadError> {
        if path == Path::new(LEVEL) { Ok(self.0.to_string()) } else { Ok((self.1)(&Disk.read(path)?)) }
    }

    fn identity(&self, path: &Path) -> PathBuf {
        Disk.identity(path)
    }
}

fn level(text: &str) -> Arc<Program> {
    level_of(text, &str::to_string)
}

/// A level for a program that is changed.
fn level_of(text: &str, change: &dyn Fn(&str) -> String) -> Arc<Program> {
    let map = LevelFile { map: Some(Path::new(LEVEL)), ..LevelFile::default() };
    program(compile_with(Path::new(ROOT), map, &WithLevel(text, change)))
}

fn corpus(name: &str) -> String {
    std::fs::read_to_string(format!("examples/smb/mario-{name}.txt")).unwrap()
}

/// Open ground, 200 tiles long, with something in its rows: the row from below, the column, and the tile.
fn ground(tiles: &[(usize, usize, char)]) -> Arc<Program> {
    let mut rows = vec![vec!['-'; 200]; 14];
    rows[13].fill('X');
    for &(row, column, tile) in tiles {
        rows[13 - row][column] = tile;
    }
    let text: Vec<String> = rows.iter().map(|r| r.iter().collect()).collect();
    level(&text.join("\n"))
}

fn hero(program: &Program) -> SlotId {
    program.worlds[WORLD].slots.find(|s| s.name == "hero").unwrap()
}

/// After each step of a script: where the hero is and how fast, and how many enemies are left.
fn run(program: &Arc<Program>, inputs: &str) -> Vec<Seen> {
    run_script(program, &script(program, inputs))
}

type Seen = ([f64; 2], [f64; 2], usize, bool);

fn run_script(program: &Arc<Program>, script: &Script) -> Vec<Seen> {
    let sim = Simulator::new(program, WORLD);
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    let (world, hero) = (sim.world(), hero(program));
    let mut out = Vec::new();
    for input in script.inputs() {
        sim.step(&mut state, input, &mut scratch).unwrap();
        let of = |degree: u8| [VarId(0), VarId(1)].map(|var| world.layout.slots[hero].var(&state, var, degree));
        let enemies =
            world.slots.pairs().filter(|(id, s)| s.origin == Origin::Tile && world.layout.slots[*id].alive(&state));
        out.push((of(0), of(1), enemies.count(), sim.violated(&state).unwrap().is_some()));
    }
    out
}

#[test]
fn he_moves_as_fast_and_jumps_as_high_as_in_the_game() {
    let program = ground(&[]);
    let fastest = |inputs: &str| run(&program, inputs).iter().map(|(_, v, ..)| v[0]).fold(0.0, f64::max);
    assert_eq!((fastest("-*9 right*240"), fastest("-*9 right+run*240")), (90.0, 150.0));
    let rise = |inputs: &str| run(&program, inputs).iter().map(|(p, ..)| p[1]).fold(0.0, f64::max) - 16.0;
    for (inputs, height) in
        [("-*9 jump*60", 66.0), ("-*9 right*60 right+jump*60", 70.25), ("-*9 right+run*80 right+run+jump*60", 82.5)]
    {
        assert!((rise(inputs) - height).abs() <= 0.1, "{inputs}: {} px", rise(inputs));
    }
    // A dash clears a wall of five tiles, and none of six.
    let beyond = |tiles: usize| {
        let wall: Vec<_> = (1..=tiles).map(|row| (row, 30, 'X')).collect();
        let jumps = (120..190).map(|steps| format!("-*9 right+run*{steps} right+run+jump*90"));
        let far = |inputs: &String| run(&ground(&wall), inputs).last().unwrap().0[0];
        jumps.map(|inputs| far(&inputs)).fold(0.0, f64::max)
    };
    assert!(beyond(5) > 480.0 && beyond(6) <= 480.0, "{} and {}", beyond(5), beyond(6));
    // Letting go early makes it lower; the maximum speed of a fall is 240.
    assert!(rise("-*9 jump*8 -*60") < 45.0);
    let slowest = run(&program, "-*9 jump*90").iter().map(|(_, v, ..)| v[1]).fold(0.0, f64::min);
    assert!((-240.0..-200.0).contains(&slowest), "{slowest}");
}

#[test]
fn enemies_hurt_from_the_side_and_die_under_his_feet() {
    let program = ground(&[(1, 12, 'E')]);
    let walked = run(&program, "-*9 right*200");
    assert!(walked.iter().any(|(.., over)| *over), "he walks into it");
    let waited = run(&program, "-*400");
    assert!(waited.iter().any(|(.., over)| *over), "it walks into him");
    // At the right moment he lands on it, and bounces.
    let lands = (200..330).any(|wait| {
        let seen = run(&program, &format!("-*{wait} jump*20 -*90"));
        let squashed = seen.iter().position(|(.., enemies, _)| *enemies == 0);
        squashed.is_some() && seen.iter().all(|(.., over)| !over)
    });
    assert!(lands);
}

#[test]
fn enemies_sleep_until_they_are_seen_and_turn_at_walls() {
    let program = ground(&[(1, 150, 'E'), (1, 10, 'E'), (1, 14, 'X'), (1, 5, 'X')]);
    let sim = Simulator::new(&program, WORLD);
    let at = |id: SlotId, state: &[u8]| sim.position(state, id).0;
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    let enemies: Vec<SlotId> =
        sim.world().slots.ids().filter(|s| sim.world().slots[*s].origin == Origin::Tile).collect();
    let (near, far) = match at(enemies[0], &state) < 300.0 {
        true => (enemies[0], enemies[1]),
        false => (enemies[1], enemies[0]),
    };
    let nothing = hypedc::sim::Input::nothing(1);
    let (mut least, mut most) = (f64::INFINITY, 0.0f64);
    for _ in 0..900 {
        sim.step(&mut state, &nothing, &mut scratch).unwrap();
        (least, most) = (least.min(at(near, &state)), most.max(at(near, &state)));
    }
    assert_eq!(at(far, &state), 150.0 * 16.0);
    // Between the walls, whose inner sides are at 96 and 224 px.
    assert!((94.0..97.0).contains(&least) && (209.0..212.0).contains(&most), "{least}..{most}");
}

fn search(program: &Arc<Program>, planner: Planner, seed: u64, nodes: u64) -> Verdict {
    let sim = Simulator::new(program, WORLD);
    let problem = Problem::new(&sim, GoalId(0));
    let space = configuration_space(program, WORLD);
    let settings = Settings { planner, seed, ..Settings::default() };
    reach(&problem, &space, &settings, &Limits { nodes, ..Limits::default() }, &Unwatched).unwrap().verdict
}

#[test]
fn real_levels_have_a_way_to_the_right_end() {
    for name in ["1-1", "1-2", "8-1"] {
        let program = level(&corpus(name));
        for seed in sized(1..2, 1..9) {
            match search(&program, Planner::Auto, seed, 100_000) {
                Verdict::Reached(plan) => assert_leads_to(&Simulator::new(&program, WORLD), &plan.script, GoalId(0)),
                other => panic!("{name}, seed {seed}: {other:?}"),
            }
        }
    }
}

/// From the left end to the right one, at the speed of a dash: no way is faster.
fn least_seconds(text: &str) -> f64 {
    let columns = text.lines().map(|row| row.chars().count()).max().unwrap();
    (columns as f64 - 6.0) * 16.0 / 150.0
}

#[test]
fn ways_that_are_found_are_as_fast_as_a_player_who_knows_the_level() {
    for name in ["1-1", "1-3", "5-3"] {
        let (text, program) = (corpus(name), level(&corpus(name)));
        let session = Session::new(&program, WORLD, Query::new(vec![Target::Goal(GoalId(0))]), &Unwatched);
        let found = session.find(Target::Goal(GoalId(0)), &Unwatched).unwrap();
        let Verdict::Reached(plan) = &found.outcome.verdict else { panic!("{name}: not found") };
        assert_leads_to(&Simulator::new(&program, WORLD), &plan.script, GoalId(0));
        let (seconds, least) = (plan.steps as f64 / 60.0, least_seconds(&text));
        assert!(seconds < 1.5 * least, "{name}: {seconds:.1} s of play, at least {least:.1} s");
    }
}

#[test]
fn he_starts_on_the_ground_of_any_level_and_jumps_over_its_top_but_cannot_stand_there() {
    // Two rows of ground with a block on it.
    let mut rows = vec!["-".repeat(60); 12];
    rows.extend(["-".repeat(2) + "XX" + &"-".repeat(56), "X".repeat(60), "X".repeat(60)]);
    let start = |rows: &[String]| {
        let program = level(&rows.join("\n"));
        let at = &program.worlds[WORLD].slots[hero(&program)].vars;
        let (x, y) = (at[VarId(0)][0], at[VarId(1)][0]);
        (program, x, y)
    };
    let (_, x, y) = start(&rows);
    assert_eq!((x, y), (40.0, 48.0));
    // A level of four rows stops no jump.
    let low = &rows[11..];
    let seen = run(&start(low).0, "-*9 jump*60");
    let highest = seen.iter().map(|(p, ..)| p[1]).fold(0.0, f64::max);
    assert!((highest - 114.0).abs() <= 0.1 && seen.iter().all(|(.., over)| !over), "{highest}");
    // With a block up to its top, he comes over that block, and no further if he lands on it.
    let mut walled = low.to_vec();
    for row in &mut walled[..2] {
        row.replace_range(10..20, &"X".repeat(10));
    }
    let program = start(&walled).0;
    let lands = (60..120).map(|steps| run(&program, &format!("-*9 right+run*{steps} right+run+jump*120")));
    let over: Vec<_> = lands.filter(|seen| seen.iter().any(|(p, ..)| p[0] > 160.0 && p[1] >= 64.0)).collect();
    assert!(!over.is_empty(), "he comes over it");
    assert!(over.iter().all(|seen| seen.iter().any(|(p, .., over)| *over && p[1] == 64.0)), "and is out there");
}

#[test]
fn a_gap_of_twenty_tiles_is_never_jumped() {
    // The first gap of the level, wider: from its left edge on, twenty columns have no ground and nothing above it.
    let text = corpus("1-1");
    let mut rows: Vec<Vec<char>> = text.lines().map(|row| row.trim().chars().collect()).collect();
    let gap = rows[13].iter().position(|c| *c == '-').unwrap();
    for row in &mut rows {
        row[gap..gap + 20].fill('-');
    }
    let text: Vec<String> = rows.iter().map(|r| r.iter().collect()).collect();
    let program = level(&text.join("\r\n"));
    let verdict = search(&program, Planner::Auto, 1, 40_000);
    assert!(!matches!(verdict, Verdict::Reached(_)), "{verdict:?}");
}

/// The level 1-1 whose ground is missing for some columns from the tenth on, and what stood there; without its enemies if
/// that is asked.
fn gap(tiles: usize, has_enemies: bool) -> Arc<Program> {
    let cut = |row: &str| -> String {
        let columns = row.chars().enumerate();
        let kept = columns.map(|(at, tile)| match tile {
            _ if (10..10 + tiles).contains(&at) => '-',
            'E' if !has_enemies => '-',
            _ => tile,
        });
        kept.collect()
    };
    level(&corpus("1-1").lines().map(cut).collect::<Vec<_>>().join("\n"))
}

/// Whether the analysis of falls rules the end of the level out, for runs on which nothing that may never be is.
fn is_ruled_out(program: &Arc<Program>) -> bool {
    let end = program.worlds[WORLD].goals.find(|goal| goal.name == "end").unwrap();
    !by_flight(program, 150_000).can_hold(program, WORLD, end)
}

/// What the analysis of falls says, with at most some configurations. Searches look at each of their states whether it is
/// one of them.
fn by_flight(program: &Arc<Program>, effort: usize) -> ConfigurationSpace {
    let nevers: Vec<_> = program.worlds[WORLD].nevers.iter().map(|never| never.holds).collect();
    let space = watched_space(program, WORLD, &nevers, &Unwatched).by_flight(
        program,
        WORLD,
        &nevers,
        &mut at_most(effort),
        &Unwatched,
    );
    let sim = Simulator::new(program, WORLD);
    let monitor = Monitor::new(&space, program, WORLD);
    let end = program.worlds[WORLD].goals.find(|goal| goal.name == "end").unwrap();
    for planner in [Planner::Coverage, Planner::DistanceGuided] {
        let problem = Problem::new(&sim, end).monitored(&monitor);
        let settings = Settings { planner, ..Settings::default() };
        hypedc::reach::search(&problem, &space, &settings, &Limits { nodes: 2_000, ..Limits::default() }, &Unwatched)
            .unwrap();
    }
    assert!(monitor.refutation().is_none(), "{:?}", monitor.refutation());
    space
}

/// He runs at 2.5 px a step and jumps for 64 steps at most: over ten tiles and what his body overlaps, but not over more
/// than two above that.
#[test]
fn a_gap_that_no_jump_crosses_is_proven() {
    for (tiles, is_too_wide) in [(9, false), (13, true), (16, true)] {
        assert_eq!(is_ruled_out(&gap(tiles, false)), is_too_wide, "{tiles}");
    }
}

/// Whom he steps on throws him up, but only where they can be.
#[test]
fn a_gap_among_enemies_is_proven() {
    assert!(is_ruled_out(&gap(20, true)));
}

/// The most nodes that a search has had.
#[derive(Default)]
struct MostNodes(AtomicU64);

impl Watch for MostNodes {
    fn stop(&self) -> bool {
        false
    }

    fn progress(&self, progress: Progress) {
        self.0.fetch_max(progress.nodes, Ordering::Relaxed);
    }
}

/// A search that comes no nearer to the goal has its answer long before its nodes are spent.
#[test]
fn a_search_that_is_stuck_ends_with_the_analysis_of_falls() {
    let program = gap(20, true);
    let sim = Simulator::new(&program, WORLD);
    let (problem, space) = (Problem::new(&sim, GoalId(0)), configuration_space(&program, WORLD));
    let (settings, limits, watch) = (Settings::default(), Limits::default(), MostNodes::default());
    let verdict = reach(&problem, &space, &settings, &limits, &watch).unwrap().verdict;
    assert!(matches!(verdict, Verdict::Unreachable(Argument::Analysis(_))), "{verdict:?}");
    let most = watch.0.into_inner();
    assert!(most < limits.nodes / 2, "{most} nodes");
}

/// A level with a wall of some tiles on flat ground. What stands at the left edge of the picture is no tile.
fn wall(tiles: usize) -> String {
    let rows = (0..14).map(|row| match row {
        13 => "X".repeat(60),
        row if 13 - row <= tiles => "-".repeat(30) + "XX" + &"-".repeat(28),
        _ => "-".repeat(60),
    });
    rows.collect::<Vec<_>>().join("\n")
}

/// A jump rises by 82.5 px at most; where tiles meet in a wall there is nothing to stand on.
#[test]
fn a_wall_that_no_jump_comes_over_is_proven() {
    for (tiles, is_too_high) in [(5, false), (6, true), (8, true)] {
        assert_eq!(is_ruled_out(&level(&wall(tiles))), is_too_high, "{tiles}");
    }
    assert!(matches!(search(&level(&wall(5)), Planner::Auto, 1, 20_000), Verdict::Reached(_)));
}

/// Columns of tiles, each so many high.
fn columns(heights: impl Iterator<Item = usize>) -> Arc<Program> {
    let heights: Vec<usize> = heights.collect();
    let row = |row: usize| heights.iter().map(|height| if 14 - row <= *height { 'X' } else { '-' }).collect();
    level(&(0..14).map(row).collect::<Vec<String>>().join("\n"))
}

/// Up by one tile he jumps 131 px far, and 132 take him over nine tiles to where his corner alone is over the edge: the push
/// is along the axis of least penetration, so he does not land there.
#[test]
fn what_comes_down_beside_an_edge_does_not_land_on_it() {
    for (tiles, is_too_wide) in [(8, false), (9, true)] {
        let heights = (0..6 + tiles + 10).map(|at| [7, 0, 8][usize::from(at >= 6) + usize::from(at >= 6 + tiles)]);
        assert_eq!(is_ruled_out(&columns(heights)), is_too_wide, "{tiles}");
    }
}

/// He comes up to the roof, and is out as soon as he stands there: what he lands on surely touches him.
#[test]
fn nobody_walks_over_the_roof() {
    for (wall, is_over) in [(13, true), (14, false)] {
        let heights = (0..30).map(|at| [9, wall, 1][usize::from(at >= 14) + usize::from(at >= 20)]);
        assert_eq!(!is_ruled_out(&columns(heights)), is_over, "{wall}");
    }
}

/// High pillars of three tiles, eight tiles apart, after open ground with stairs: each jump begins where the last one has
/// landed, at speed, and comes above the top of the level.
fn pillars(count: usize) -> String {
    let width = 60 + count * 11;
    let mut rows = vec![vec!['-'; width]; 14];
    for (at, row) in rows.iter_mut().enumerate() {
        let height = 14 - at;
        for (column, tile) in row.iter_mut().enumerate() {
            let beyond = column.checked_sub(40);
            let top = match beyond {
                None => 1 + column.saturating_sub(29).min(9),
                Some(at) if at < count * 11 && at % 11 >= 8 => 10,
                // Beyond the last pillar there is ground again.
                Some(at) => usize::from(at >= count * 11 + 8),
            };
            if height <= top {
                *tile = 'X';
            }
        }
    }
    rows.iter().map(|row| row.iter().collect::<String>()).collect::<Vec<_>>().join("\n")
}

#[test]
fn a_way_over_high_pillars_is_found_by_a_beam_and_by_auto() {
    let program = level(&pillars(5));
    let sim = Simulator::new(&program, WORLD);
    for planner in [Planner::Beam, Planner::Auto] {
        for seed in 1..=3 {
            let found = search(&program, planner, seed, 200_000);
            let Verdict::Reached(plan) = found else { panic!("{planner:?}, seed {seed}: {found:?}") };
            assert_leads_to(&sim, &plan.script, GoalId(0));
            let seen = run_script(&program, &plan.script);
            assert!(seen.iter().any(|(p, ..)| p[1] + 15.0 > 14.0 * 16.0), "{planner:?}, seed {seed}: over the top");
        }
    }
}

/// Levels of random clumps of tiles, gaps and enemies: whatever a search comes to, with bodies of several sizes and at other
/// speeds, the analysis of falls has told.
#[test]
fn falls_in_random_levels_are_told() {
    const BODIES: [&str; 4] = ["rect(2, 0, 12, 15)", "rect(0, 0, 16, 16)", "rect(3, 0, 10, 24)", "rect(5, 0, 6, 6)"];
    const COLUMNS: usize = 20;
    let mut told = 0;
    for seed in sized(0..12, 0..1_000) {
        let mut random = Pcg32::new(seed, 1);
        let mut below = |limit: u32| random.next_u32() % limit;
        let mut rows = vec![vec!['-'; COLUMNS]; 14];
        for _ in 0..4 + below(12) {
            let (column, row) = (below(COLUMNS as u32) as usize, below(13) as usize);
            let (width, height) = (1 + below(6) as usize, 1 + below(3) as usize);
            let tile = ['X', 'X', 'X', 'X', 'X', 'X', 'X', 'X', 'S', 'S', '?', 'E'][below(12) as usize];
            let cells = if tile == 'E' { (1, 1) } else { (width, height) };
            for row in rows.iter_mut().skip(row).take(cells.1) {
                row[column..(column + cells.0).min(COLUMNS)].fill(tile);
            }
        }
        let (gap, wide) = (5 + below(8) as usize, below(10) as usize);
        rows[13].fill('X');
        rows[13][gap..(gap + wide).min(COLUMNS - 1)].fill('-');
        // He starts on the ground, with nothing around him.
        rows[10..13].iter_mut().for_each(|row| row[..5].fill('-'));
        let text = rows.iter().map(|row| row.iter().collect::<String>()).collect::<Vec<_>>().join("\n");
        let body = BODIES[below(4) as usize];
        let run_speed = ["150", "150", "90", "230"][below(4) as usize];
        let program = level_of(&text, &|source| {
            let speed = format!("run_speed = {run_speed}");
            source.replace("rect(2, 0, 12, 15)", body).replace("run_speed = 150", &speed)
        });
        let space = by_flight(&program, sized(60_000, 400_000));
        told += usize::from(!std::ptr::eq(space.finest(), &space));
    }
    assert!(told >= 2, "{told} levels were told");
}
