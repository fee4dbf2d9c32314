//! Tiles that break: what a state takes, which tile is named, faces of neighbours, tiles that come back, saved states.

use std::sync::Arc;

use hypedc::ir::{Program, TileId, WorldId};
use hypedc::sim::{Event, Input, Simulator, State};

use crate::support::{compile_text, program};

/// A world with a map, and a hero of a size at a place who does what a guard says.
fn world(tile: &str, map: &[&str], hero: &str, edges: &str, place: &str) -> Arc<Program> {
    let rows = map.join("\n");
    program(compile_text(&format!(
        "entity Hero {{
             collider body: {hero}
             discrete broken: int 0..99 = 0
             mode only {{ {edges} }}
         }}
         world W {{
             step 1/60
             collide body with wall: block
             tiles t 16 x 16 {{ '.': empty; '#': wall; 'b': {tile} }}
             space main {{
                 map t \"
{rows}
                 \"
                 place hero: Hero at {place}
             }}
             goal cleared: count(brick) == 0
         }}"
    )))
}

struct Run {
    sim: Simulator,
    state: State,
    events: Vec<Event>,
}

impl Run {
    fn new(program: &Arc<Program>) -> Run {
        let sim = Simulator::new(program, WorldId(0));
        let state = sim.initial(&mut sim.scratch()).unwrap();
        Run { sim, state, events: Vec::new() }
    }

    /// Some steps without inputs.
    fn go(&mut self, steps: usize) {
        let mut scratch = self.sim.scratch();
        for _ in 0..steps {
            let before = self.state.clone();
            self.sim.step(&mut self.state, &Input::default(), &mut scratch).unwrap();
            let events = &mut self.events;
            self.sim.events(&before, &self.state, &scratch, &mut |event| events.push(event)).unwrap();
        }
    }

    /// The columns and rows of the broken tiles.
    fn broken(&self) -> Vec<(usize, usize)> {
        let tiles = self.sim.broken_tiles(&self.state);
        tiles
            .into_iter()
            .filter_map(|tile| self.sim.place_of_tile(tile))
            .map(|(_, column, row)| (column, row))
            .collect()
    }

    fn height(&self) -> f64 {
        let hero = self.sim.world().slots.ids().next().unwrap();
        self.sim.position(&self.state, hero).1
    }
}

const BRICK: &str = "wall, brick breakable";

#[test]
fn twenty_thousand_tiles_take_three_kilobytes() {
    let size = |rows: usize| {
        let row = "b".repeat(200);
        let map = vec![row.as_str(); rows];
        let program = world(BRICK, &map, "rect(0, 0, 16, 16)", "when timer > 1 { broken := 0 }", "(0, 2000)");
        program.worlds[WorldId(0)].layout.size
    };
    assert_eq!(size(100) - size(1), 8 * (20_000_usize.div_ceil(64) - 200_usize.div_ceil(64)));
    assert!(size(100) < 3_000, "{}", size(100));
}

#[test]
fn a_world_without_them_takes_nothing() {
    let with = |tile: &str| {
        let text = ["bbb", "###"];
        world(tile, &text, "rect(0, 0, 16, 16)", "when timer > 1 { broken := 0 }", "(0, 100)")
    };
    let (plain, breakable) = (with("wall, brick"), with(BRICK));
    let layout = |program: &Arc<Program>| program.worlds[WorldId(0)].layout.clone();
    assert_eq!(layout(&plain).tiles, None);
    assert_eq!(layout(&breakable).size - layout(&plain).size, 8);
}

#[test]
fn the_longest_edge_is_named_and_of_equal_ones_the_left_one() {
    for (x, column) in [("20", 1), ("28", 2), ("24", 1), ("39.5", 2)] {
        let edges = "y'' = 600; when touching(body, brick, above) as b { destroy b; broken += 1 }";
        let program = world(BRICK, &["bbbb", "....", "...."], "rect(0, 0, 16, 16)", edges, &format!("({x}, 0)"));
        let mut run = Run::new(&program);
        while run.broken().is_empty() {
            run.go(1);
        }
        assert_eq!(run.broken(), [(column, 2)], "at {x}");
        assert!(matches!(run.events.as_slice(), [.., Event::Broken(_)]), "{:?}", run.events.last());
    }
}

#[test]
fn the_most_overlapped_is_named_by_a_probe() {
    for (x, column) in [("20", 1), ("28", 2), ("24", 1)] {
        let edges = "when touching(body at (0, -8), brick) as b { destroy b }";
        let program = world(BRICK, &["....", "bbbb"], "rect(0, 0, 16, 16)", edges, &format!("({x}, 16)"));
        let mut run = Run::new(&program);
        run.go(1);
        assert_eq!(run.broken(), [(column, 0)], "at {x}");
    }
}

#[test]
fn a_face_inside_of_a_wall_is_open_once_its_neighbour_is_broken() {
    // Along a floor of bricks the hero walks over the seams. Where one is missing, it is stopped by the next one's side.
    let edges = "x' = 120; y'' = -900; when x > 30 and touching(body at (-1, -8), brick) as b and broken == 0 { destroy b; broken += 1 }";
    let program = world(BRICK, &["......", "......", "bbbbbb", "######"], "rect(0, 0, 8, 8)", edges, "(4, 32)");
    let mut run = Run::new(&program);
    run.go(120);
    let hero = run.sim.world().slots.ids().next().unwrap();
    assert_eq!(run.broken().len(), 1);
    let (column, _) = run.broken()[0];
    let (x, y) = run.sim.position(&run.state, hero);
    assert_eq!((x, y), ((column + 1) as f64 * 16.0 - 8.0, 16.0), "it lies in the gap, against the right side");
}

#[test]
fn a_tile_is_back_after_its_steps_and_pushes_out_what_stands_in_it() {
    let edges =
        "y'' = if(broken > 0, 0, -600); when touching(body, brick, below) as b { destroy b; broken += 1; y' := -60 }
                 when broken > 0 and y <= 6 { y' := 0 }";
    let tile = "wall, brick breakable restore after 10frames";
    let program = world(tile, &["...", "...", "bbb"], "rect(0, 0, 8, 8)", edges, "(4, 17)");
    let mut run = Run::new(&program);
    while run.broken().is_empty() {
        run.go(1);
    }
    let tile = run.sim.broken_tiles(&run.state)[0];
    // The step that broke it is the first one.
    assert_eq!(run.sim.steps_until_restored(&run.state, tile), 9);
    run.go(8);
    assert_eq!(run.broken(), [(0, 0)]);
    let saved = run.sim.save(&run.state);
    run.go(1);
    assert!(run.broken().is_empty() && run.height() < 16.0, "{}", run.height());
    assert!(run.events.contains(&Event::Restored(TileId(tile.0))));
    run.go(1);
    assert_eq!(run.height(), 16.0, "it is pushed out on top, from where it came");
    // A saved state goes on alike; one with a wrong count is refused.
    assert_eq!(run.sim.load(&saved).unwrap().len(), run.state.len());
    let at = saved.len() - run.state.len() + run.sim.world().layout.tiles.as_ref().unwrap().restoring;
    let mut damaged = saved;
    damaged[at] = 11;
    assert!(run.sim.load(&damaged).is_err());
}

#[test]
fn what_is_left_is_counted() {
    let edges = "when touching(body, brick, below) as b { destroy b; broken += 1 }; y'' = -900";
    let program = world(BRICK, &[".", ".", "b", "b", "#"], "rect(0, 0, 8, 8)", edges, "(4, 64)");
    let mut run = Run::new(&program);
    let goal = run.sim.world().goals.ids().next().unwrap();
    assert!(!run.sim.goal(&run.state, goal).unwrap());
    run.go(90);
    assert_eq!(run.broken().len(), 2);
    assert!(run.sim.goal(&run.state, goal).unwrap());
}

#[test]
fn an_entity_counts_the_tiles_of_the_world_it_is_in() {
    let entities = "
        entity Hero {
            collider body: rect(0, 0, 16, 16)
            x' = 120
            mode only { when touching(body at (4, 0), coin) as c { destroy c } }
        }
        entity Door {
            discrete left: int 0..99 = 99
            mode shut {
                when true { left := count(coin) }
                when count(coin) == 0 -> open
            }
            mode open { }
        }";
    let world = |name: &str, row: &str| {
        format!(
            "world {name} {{
                 tiles t 16 x 16 {{ '.': empty; 'o': coin breakable; 'O': coin }}
                 space main {{
                     map t \"
{row}
                     \"
                     place hero: Hero at (0, 0)
                     place door: Door at (0, 0)
                 }}
             }}"
        )
    };
    let worlds = [world("Two", "...o...o"), world("None", "........"), world("Fixed", "..oO....")];
    let program = program(compile_text(&format!("{entities}{}", worlds.concat())));
    for (world, all) in [(0, vec![2, 1, 0]), (1, vec![0]), (2, vec![2, 1])] {
        let sim = Simulator::new(&program, WorldId(world));
        let mut scratch = sim.scratch();
        let mut state = sim.initial(&mut scratch).unwrap();
        let door = sim.world().slot_named("door").unwrap();
        let mut seen = Vec::new();
        for _ in 0..80 {
            sim.step(&mut state, &Input::default(), &mut scratch).unwrap();
            seen.push(sim.instance(&state, door).discrete(hypedc::ir::DiscreteId(0)));
        }
        seen.dedup();
        assert_eq!(seen, all, "world {world}");
        let opens = all.contains(&0);
        let instance = sim.instance(&state, door);
        let is_open = instance.modes().any(|mode| instance.entity().modes[mode].path == "open");
        assert_eq!(is_open, opens, "world {world}");
    }
}
