//! Pictures of searches: that they are valid, keep to their frame and stay small, for walks of the simulator through
//! the examples.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use crate::support::{Disk, compile_text, program, sized};
use hypedc::compile::compile;
use hypedc::ir::{Bounds, GoalId, Program, SlotId, SpaceId, WorldId};
use hypedc::sim::{Input, Simulator};
use hypedc::view::{Images, Mark, Node, Part, Picture, Pose, Recorder, Run, Stop, Track, picture_svg};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const WORLD: WorldId = WorldId(0);
const EXAMPLES: [&str; 6] = [
    "examples/paper/test1.hyped",
    "examples/paper/test2.hyped",
    "examples/link.hyped",
    "examples/mario.hyped",
    "examples/car.hyped",
    "examples/balloon.hyped",
];

/// Number of most recent states that are extended.
const OPEN: usize = 3_000;

/// A tree of random inputs, and the way to the node whose place was found last of all places.
#[derive(Default)]
struct Walk {
    nodes: Vec<Node>,
    run: Run,
}

impl Walk {
    /// The stops of the first player.
    fn path(&self) -> &[Stop] {
        self.run.tracks.first().map_or(&[], |track| &track.stops)
    }
}

/// Grows a tree from states in places that few nodes have been in.
fn walk(program: &Arc<Program>, count: usize) -> Walk {
    let sim = Simulator::new(program, WORLD);
    let world = sim.world();
    let player = world.players.iter().next().unwrap().slot;
    let mut scratch = sim.scratch();
    let mut rng = Pcg64::seed_from_u64(7);
    let space = |state: &[u8]| sim.space(state, player);
    let root = sim.initial(&mut scratch).unwrap();
    let node = |parent: usize, state: &[u8]| {
        let (x, y) = sim.position(state, player);
        Node { parent: parent as u32, space: space(state), at: [x as f32, y as f32] }
    };
    let place = |node: &Node| (node.space, (node.at[0] / 8.0) as i32, (node.at[1] / 8.0) as i32);
    let mut nodes = vec![node(0, &root)];
    let mut inputs = vec![(Input::nothing(1), 0)];
    let mut open = vec![(0, root.clone())];
    let mut visits: BTreeMap<_, usize> = BTreeMap::new();
    let (mut latest, mut failures) = (0, 0);
    while nodes.len() < count && failures < 20 * count {
        let some = (0..6).map(|_| rng.random_range(0..open.len()));
        let from = some.min_by_key(|&i| visits.get(&place(&nodes[open[i].0])).copied().unwrap_or(0)).unwrap();
        let (parent, mut state) = open[from].clone();
        let mut input = Input::nothing(1);
        input.0[0].buttons = rng.random_range(0..4);
        input.0[0].axes = std::array::from_fn(|_| f64::from(rng.random_range(-1..=1)));
        let steps = rng.random_range(2..=12);
        let mut lives = true;
        for _ in 0..steps {
            lives &= sim.step(&mut state, &input, &mut scratch).is_ok() && sim.violated(&state) == Ok(None);
            let (x, y) = sim.position(&state, player);
            let bounds = world.spaces[space(&state)].bounds;
            lives &= bounds.is_none_or(|b| (b.left..=b.right).contains(&x) && y >= b.bottom);
            if !lives {
                break;
            }
        }
        if !lives {
            failures += 1;
            continue;
        }
        let node = node(parent, &state);
        let visits = visits.entry(place(&node)).or_insert(0);
        *visits += 1;
        latest = if *visits == 1 { nodes.len() } else { latest };
        let entry = (nodes.len(), state);
        if open.len() < OPEN {
            open.push(entry);
        } else {
            let oldest = rng.random_range(0..OPEN);
            open[oldest] = entry;
        }
        nodes.push(node);
        inputs.push((input, steps));
    }
    let mut way = Vec::new();
    let mut at = latest;
    while at != 0 {
        way.push(at);
        at = nodes[at].parent as usize;
    }
    let (mut state, mut recorder, mut step) = (root, Recorder::new(&sim), 0);
    recorder.observe(0, &Input::nothing(1), &state);
    for &id in way.iter().rev() {
        let (input, steps) = &inputs[id];
        for _ in 0..*steps {
            sim.step(&mut state, input, &mut scratch).unwrap();
            step += 1;
            recorder.observe(step, input, &state);
        }
    }
    Walk { nodes, run: recorder.finish(&state, Vec::new()) }
}

fn example(path: &str) -> Arc<Program> {
    program(compile(Path::new(path), &Disk))
}

fn draw(program: &Program, walk: &Walk, notes: &[String]) -> String {
    let goal = program.worlds[WORLD].goals.iter().next().map_or("none", |goal| &goal.name);
    draw_goal(program, walk, goal, notes)
}

fn draw_goal(program: &Program, Walk { nodes, run }: &Walk, title: &str, notes: &[String]) -> String {
    let is_good = !run.tracks.is_empty();
    let goals: Vec<GoalId> = program.worlds[WORLD].goal_named(title).into_iter().collect();
    let result = if is_good { "reached" } else { "not found" };
    picture_svg(
        program,
        WORLD,
        &Picture {
            title,
            result,
            is_good,
            goals: &goals,
            nodes,
            traps: &[],
            layers: &[],
            run,
            notes,
            images: &Images::default(),
        },
    )
}

/// A run of the first player without shapes.
fn run(stops: Vec<Stop>) -> Run {
    let poses = stops.iter().map(|stop| Pose { space: stop.space, at: stop.at, parts: Vec::new() }).collect();
    let track = Track { slot: SlotId(0), stops, poses, is_destroyed: false };
    Run { tracks: vec![track], marks: Vec::new(), moments: Vec::new() }
}

/// The numbers in the data of a path, with the letter before each.
fn data(text: &str) -> Vec<(char, f64)> {
    let mut out = Vec::new();
    let (mut command, mut number) = (' ', String::new());
    for c in text.chars().chain(" ".chars()) {
        let goes_on = c.is_ascii_digit() || c == '.' || (c == '-' && number.is_empty());
        if !goes_on && !number.is_empty() {
            out.push((command, std::mem::take(&mut number).parse().unwrap()));
        }
        if goes_on || c == '-' {
            number.push(c);
        } else if c.is_ascii_alphabetic() {
            command = c;
        }
    }
    out
}

/// The extent of a path: least x, greatest x, least y, greatest y.
fn path_extent(text: &str) -> [f64; 4] {
    let mut extent = [f64::MAX, f64::MIN, f64::MAX, f64::MIN];
    let (mut x, mut y) = (0.0, 0.0);
    let mut numbers = data(text).into_iter();
    while let Some((command, first)) = numbers.next() {
        let mut second = || numbers.next().unwrap().1;
        match command {
            'M' | 'L' => (x, y) = (first, second()),
            'H' => x = first,
            'm' | 'l' => (x, y) = (x + first, y + second()),
            'h' => x += first,
            'v' => y += first,
            other => panic!("{other} in {text}"),
        }
        extent = [extent[0].min(x), extent[1].max(x), extent[2].min(y), extent[3].max(y)];
    }
    extent
}

fn is_panel(node: &roxmltree::Node<'_, '_>) -> bool {
    node.tag_name().name() == "svg" && node.has_attribute("x")
}

/// Checks what holds of every picture, also that no text covers another; gives how many elements of each class it has.
fn check(svg: &str) -> BTreeMap<String, usize> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let root = document.root_element();
    let size = |name: &str| root.attribute(name).unwrap().parse::<f64>().unwrap();
    let (width, height) = (size("width"), size("height"));
    assert_eq!(root.attribute("viewBox").unwrap(), format!("0 0 {width} {height}"));
    let mut classes = BTreeMap::new();
    let mut texts: Vec<(String, [f64; 4])> = Vec::new();
    for node in document.descendants().filter(|node| node.is_element()) {
        let number = |name: &str| node.attribute(name).map_or(0.0, |text| text.parse::<f64>().unwrap());
        for attribute in node.attributes().filter(|a| a.name() != "xmlns") {
            let decimals = |part: &str| part.bytes().take_while(u8::is_ascii_digit).count();
            let longest = attribute.value().split('.').skip(1).map(decimals).max();
            assert!(longest.unwrap_or(0) <= 2, "{attribute:?}");
        }
        if let Some(class) = node.attribute("class") {
            *classes.entry(class.to_string()).or_insert(0) += 1;
        }
        let group = node.ancestors().skip(1).find(|group| group.tag_name().name() == "g" || is_panel(group));
        let shift = group.map_or([0.0, 0.0], |group| match group.attribute("transform") {
            Some(text) => [0, 1].map(|index| data(text)[index].1),
            None => ["x", "y"].map(|name| group.attribute(name).unwrap().parse().unwrap()),
        });
        let (x, y) = (number("x"), number("y"));
        let [left, right, top, bottom] = match node.tag_name().name() {
            "rect" | "svg" => [x, x + number("width"), y, y + number("height")],
            // Only a circle of the goal may stand out; the panel cuts it.
            "circle" if node.attribute("class") == Some("goal") => continue,
            "circle" => [number("cx"), number("cx"), number("cy"), number("cy")],
            "path" => path_extent(node.attribute("d").unwrap()),
            "text" => {
                // No letter is narrower on average.
                let text = 4.0 * node.text().unwrap().chars().count() as f64;
                let centered = matches!(node.attribute("class"), Some("verdict" | "number"));
                if centered { [x - text / 2.0, x + text / 2.0, y, y] } else { [x, x + text, y, y] }
            }
            _ => continue,
        };
        let inside = left + shift[0] >= -0.02 && right + shift[0] <= width + 0.02;
        let inside = inside && top + shift[1] >= -0.02 && bottom + shift[1] <= height + 0.02;
        if let Some(text) = node.text().filter(|_| node.tag_name().name() == "text") {
            let extent = [left + shift[0], right + shift[0], top + shift[1] - 8.0, bottom + shift[1]];
            for (other, b) in &texts {
                let apart = extent[1] <= b[0] || b[1] <= extent[0] || extent[3] <= b[2] || b[3] <= extent[2];
                assert!(apart, "`{text}` and `{other}`");
            }
            texts.push((text.to_string(), extent));
        }
        assert!(inside, "{left} {right} {top} {bottom} at {shift:?} of {width} {height}: {node:?}");
    }
    classes
}

#[test]
fn pictures_of_the_examples_are_valid_and_keep_to_their_frame() {
    for path in EXAMPLES {
        let program = example(path);
        let walk = walk(&program, 4_000);
        assert!(walk.nodes.len() > 500 && walk.path().len() > 20, "{path}: {}", walk.nodes.len());
        let svg = draw(&program, &walk, &["4,000 nodes".into(), "a < b & \"c\"".into()]);
        let classes = check(&svg);
        for class in ["title", "tree", "heat", "route", "dot", "start", "end", "ghost", "air"] {
            assert!(classes.contains_key(class), "{path} has no {class}");
        }
        assert!(svg.contains("a &lt; b &amp; &quot;c&quot;"));
        assert_eq!(svg, draw(&program, &walk, &["4,000 nodes".into(), "a < b & \"c\"".into()]));
    }
}

#[test]
fn a_picture_without_a_search_shows_the_level() {
    for path in EXAMPLES {
        let program = example(path);
        let classes = check(&draw(&program, &Walk::default(), &[]));
        assert!(classes.contains_key("hero") && classes.keys().any(|class| class.starts_with("tile ")), "{path}");
        for class in ["tree", "route", "dot", "start", "end", "ghost"] {
            assert!(!classes.contains_key(class), "{path} has {class}");
        }
    }
}

#[test]
fn many_nodes_make_a_small_picture() {
    let nodes = sized(100_000, 300_000);
    for path in ["examples/paper/test1.hyped", "tests/maps/smb.hyped"] {
        let program = example(path);
        let walk = walk(&program, nodes);
        assert_eq!(walk.nodes.len(), nodes, "{path}");
        let svg = draw(&program, &walk, &[]);
        check(&svg);
        assert!(svg.len() < 1_000_000, "{path}: {} bytes", svg.len());
    }
}

/// Nodes that are far away or no numbers, and a path that leaves the picture.
#[test]
fn what_is_out_of_reach_of_the_picture_is_left_out() {
    let program = example(EXAMPLES[0]);
    let at = [[8.0, 64.0], [f32::NAN, 64.0], [1e30, f32::INFINITY], [-5e6, 2.0], [40.0, 70.0]];
    let nodes: Vec<Node> = at.iter().map(|&at| Node { parent: 0, space: SpaceId(0), at }).collect();
    let at = [[8.0, 64.0], [9.0, 64.0], [1e12, -1e12], [f64::NAN, 0.0], [20.0, 64.0]];
    let stop = |(step, &at)| Stop { step, space: SpaceId(0), at, changes: true, jumps: false };
    let run = run((0..).zip(&at).map(stop).collect());
    let classes = check(&draw(&program, &Walk { nodes, run }, &[]));
    // The legend has one of each, too, but for the tree's.
    assert_eq!((classes["tree"], classes["route"], classes["dot"]), (1, 1 + 1, 2 + 1));
}

const ROOMS: &str = "entity Ball {
    param speed = 60
    axis horizontal, vertical
    collider body: rect(-4, -4, 8, 8)
    mode roll {
        x' = horizontal * speed
        y' = vertical * speed
        follow links
    }
}
entity Door {
    kinematic collider door: rect(0, 0, 8, 16)
    mode shut { }
    mode open { }
}
world Rooms {
    step 1/60
    collide body with rock, door: block
    collide body with ledge: block from above
    collide body with \"a <b>\", spikes, flag: sense
    tiles stone 16 x 16 {
        '.': empty
        '#': rock
        'F': flag
        '^': spikes
        '=': ledge
        '?': \"a <b>\"
        '~': water
    }
    space cave {
        map stone \"
            #...F#
            #.==.#
            #?..^~
            ######
        \"
        place hero: Ball at (24, 24)
        place gate: Door at (64, 16)
        link rect(32, 48, 16, 8) -> yard at rect(0, 0, 16, 8)
        link rect(16, 56, 8, 8) -> cave at rect(64, 24, 8, 8)
    }
    space yard { bounds rect(-32, -32, 64, 64) }
    space attic { bounds rect(0, 0, 64, 32) }
    player 1: hero
    goal corner: hero.x > 8 and hero.y >= 4 and inside(hero, yard)
    goal there: near(hero, (56, 40), 8) and hero touching flag
    never hurt: hero touching spikes
}
";

fn rooms() -> (Arc<Program>, Walk) {
    let program = program(compile_text(ROOMS));
    let (cave, yard) = (SpaceId(0), SpaceId(1));
    let at = [
        (cave, [24.0, 24.0], true, false),
        (cave, [24.0, 40.0], false, false),
        (cave, [24.0, 58.0], false, false),
        (cave, [70.0, 28.0], false, true),
        (cave, [50.0, 28.0], true, false),
        (cave, [40.0, 46.0], true, false),
        (yard, [8.0, 0.0], false, true),
        (yard, [12.0, 8.0], true, false),
    ];
    let stop = |(step, (space, at, changes, jumps))| Stop { step, space, at, changes, jumps };
    let stops: Vec<Stop> = (0..).zip(at).map(stop).collect();
    let nodes = stops.iter().enumerate().map(|(index, stop)| Node {
        parent: index.saturating_sub(1) as u32,
        space: stop.space,
        at: stop.at.map(|x| x as f32),
    });
    let nodes = nodes.collect();
    let entity = &program.entities[program.worlds[WORLD].slots[SlotId(0)].entity];
    let tags = entity.colliders.iter().next().unwrap().tags;
    let body = Part { bounds: Bounds::new([-4.0, -4.0, 8.0, 8.0]), round: false, tags };
    let mut run = run(stops);
    run.tracks[0].poses.iter_mut().for_each(|pose| pose.parts = vec![body]);
    (program, Walk { nodes, run })
}

#[test]
fn a_small_picture() {
    let (program, walk) = rooms();
    let svg = draw(&program, &walk, &["8 nodes, 7 steps (0.12 s)".into()]);
    check(&svg);
    let body = svg.split_once("</style>\n").unwrap().1;
    insta::assert_snapshot!("rooms", body);
}

#[test]
fn the_path_is_cut_at_links_and_the_doors_are_numbered() {
    let (program, walk) = rooms();
    let svg = draw(&program, &walk, &[]);
    let document = roxmltree::Document::parse(&svg).unwrap();
    let texts = |class: &str| {
        let nodes = document.descendants().filter(|node| node.attribute("class") == Some(class));
        nodes.filter_map(|node| node.text().map(str::to_string)).collect::<Vec<_>>()
    };
    assert_eq!(texts("number"), ["1", "1", "2", "2"]);
    assert_eq!(texts("head"), ["cave", "yard", "attic"]);
    assert_eq!(texts("quiet"), ["75 % of the states found", "25 % of the states found", "never entered"]);
    let routes = document.descendants().filter(|node| node.attribute("class") == Some("route"));
    let strokes: Vec<usize> = routes.map(|node| node.attribute("d").unwrap().matches('M').count()).collect();
    assert_eq!(strokes[..2], [2, 1]);
}

#[test]
fn goals_are_drawn_where_they_lie() {
    let (program, walk) = rooms();
    let goals = |name: &str| {
        let svg = draw_goal(&program, &walk, name, &[]);
        let document = roxmltree::Document::parse(&svg).unwrap();
        let drawn = document.descendants().filter(|node| node.attribute("class") == Some("goal"));
        let inside = drawn.filter(|node| node.parent().is_some_and(|group| is_panel(&group)));
        let named = |node: roxmltree::Node<'_, '_>, name: &str| node.attribute(name).unwrap().to_string();
        inside
            .map(|node| match node.tag_name().name() {
                "circle" => ["cx", "cy", "r"].map(|name| named(node, name)).join(" "),
                _ => ["x", "y", "width", "height"].map(|name| named(node, name)).join(" "),
            })
            .collect::<Vec<_>>()
    };
    // All at 4 to 1: the cave is 96 by 64.
    assert_eq!(goals("there"), ["224 96 32"]);
    assert_eq!(goals("corner").len(), 1);
    assert!(goals("nothing").is_empty());
}

const ARMED: &str = "entity Armed {
    continuous reach = 6
    discrete side: {left, right} = right
    collider feet: rect(-4, 0, 8, 2)
    collider body: rect(-8, 0, 16, 24) when in tall
    collider body: rect(-6, 0, 12, 12) when not in tall and side == right
    collider sword: rect(6, 4, reach, 2) when reach > 1 and side == right
    collider sword: rect(-6 - reach, 4, reach, 2) when side == left
    mode small { }
    mode tall { }
}
world Hall {
    step 1/60
    space main {
        bounds rect(-50, -50, 100, 100)
        place hero: Armed at (0, 0)
    }
    player 1: hero
    goal long: hero.reach > 9
}
";

#[test]
fn instances_look_as_they_do_at_first() {
    let program = program(compile_text(ARMED));
    let stop = Stop { step: 0, space: SpaceId(0), at: [0.0, 0.0], changes: false, jumps: false };
    let svg = draw(&program, &Walk { nodes: Vec::new(), run: run(vec![stop]) }, &[]);
    let document = roxmltree::Document::parse(&svg).unwrap();
    let rects = document.descendants().filter(|node| node.attribute("class") == Some("hero ghostly"));
    let inside = rects.filter(|node| node.parent().is_some_and(|group| is_panel(&group)));
    let size = |name: &str, node: roxmltree::Node<'_, '_>| node.attribute(name).unwrap().parse::<f64>().unwrap() / 4.0;
    let sizes: Vec<[f64; 2]> = inside.map(|node| [size("width", node), size("height", node)]).collect();
    assert_eq!(sizes, [[8.0, 2.0], [12.0, 12.0], [6.0, 2.0]]);
    // The path runs through the middle of the largest box whose shape never changes: the body's, 6 px over the feet.
    let start = document.descendants().find(|node| node.attribute("class") == Some("start")).unwrap();
    let panel = start.parent().unwrap();
    let height = size("height", panel);
    assert_eq!(height / 2.0 - size("cy", start), 6.0);
}

/// A picture of many rooms and a level of many small tiles are still small.
#[test]
fn large_levels_make_small_pictures() {
    let mut rng = Pcg64::seed_from_u64(3);
    let (columns, rows) = (600, 400);
    let row = |rng: &mut Pcg64| (0..columns).map(|_| if rng.random_bool(0.5) { '#' } else { '.' }).collect::<String>();
    let map: Vec<String> = (0..rows).map(|_| row(&mut rng)).collect();
    let mut rooms = String::new();
    for room in 0..60 {
        rooms.push_str(&format!("    space room{room} {{ bounds rect(0, 0, 100, {}) }}\n", 20 + room));
    }
    let text = ROOMS.replace("            #...F#\n", &format!("            {}\n", map.join("\n            ")));
    let text = text.replace("            #.==.#\n            #?..^~\n            ######\n", "");
    let text = text.replace("    space attic", &format!("{rooms}    space attic"));
    let program = program(compile_text(&text));
    let svg = draw(&program, &Walk::default(), &[]);
    assert_eq!(check(&svg)["head"], 63);
    assert!(svg.len() < 1_000_000, "{} bytes", svg.len());
}

/// A slope is drawn as what is below its line, cut at the border of the picture.
#[test]
fn slopes_are_drawn_as_what_is_below_them() {
    let text =
        "entity Hero { param speed = 60; axis horizontal; collider body: rect(0, 0, 16, 16); x' = speed * horizontal }
        world W {
            collide body with wall: block
            tiles t 16 x 16 { '.': empty; '#': wall; '/': wall slope (0, 0)-(16, 16) }
            space main {
                map t \"\n....\n./#.\n####\n\"
                place hero: Hero at (0, 16)
            }
            player 1: hero
        }";
    let program = program(compile_text(text));
    let walk = walk(&program, 20);
    let svg = draw(&program, &walk, &[]);
    let path = svg.lines().find(|line| line.contains("class=\"tile")).unwrap();
    assert!(path.contains('L') && path.contains('h'), "boxes and a triangle: {path}");
}

/// Classes of the elements of a picture of a run in a world.
fn classes_of_run(text: &str, inputs: &str) -> (String, BTreeMap<String, usize>) {
    let program = program(compile_text(text));
    let sim = Simulator::new(&program, WORLD);
    let mut scratch = sim.scratch();
    let mut state = sim.initial(&mut scratch).unwrap();
    let mut recorder = Recorder::new(&sim);
    let players = program.worlds[WORLD].players.len();
    recorder.observe(0, &Input::nothing(players), &state);
    for (step, input) in (1..).zip(crate::support::script(&program, inputs).inputs()) {
        sim.step(&mut state, input, &mut scratch).unwrap();
        recorder.observe(step, input, &state);
    }
    let mark = Mark { name: "first".into(), is_never: false, step: 1, seconds: 0.02 };
    let svg = draw(&program, &Walk { nodes: Vec::new(), run: recorder.finish(&state, vec![mark]) }, &[]);
    let classes = check(&svg);
    (svg, classes)
}

const CROWD: &str = "
entity Runner {
    axis horizontal
    param speed = 60
    collider body: rect(0, 0, 16, 16)
    collider eye: rect(4, 4, 4, 4)
    x' = speed * horizontal
    mode running { when x > 100 -> running { x := 8 } }
}
entity Cart {
    kinematic collider cart: rect(0, 0, 24, 8)
    x' = 40
    always { when x > 200 { destroy self } }
}
world Track {
    collide body with cart: block
    collide cart with fence: block
    collide eye with cart: sense
    space main {
        bounds rect(0, 0, 320, 120)
        rect fence (0, 100, 320, 8)
        place one: Runner at (8, 0)
        place two: Runner at (8, 40)
        place cart: Cart at (150, 70)
        place rest: Cart at (20, 80)
    }
    player 1: one
    player 2: two
    goal far: one.x > 90
}
";

#[test]
fn all_that_moves_is_drawn() {
    let (svg, classes) = classes_of_run(CROWD, "right+2:right*80 right+2:left*40");
    // Each player has a way of its own; the legend has them, too.
    for class in ["route", "route p2", "start p2", "end p2", "ghost p2", "hero p2", "trail", "mover", "gone"] {
        assert!(classes.contains_key(class), "no {class}: {classes:?}");
    }
    // The body, and what it sees with as an outline.
    assert_eq!((classes["hero"], classes["hero sensor"]), (1 + 1, 1));
    // Nothing of the players touches the fence.
    assert!(classes.contains_key("tile dim"));
    assert!(svg.contains("fence (no contact with players)") && svg.contains("path of two, from start to end"));
    assert!(classes["reached"] > 1 && svg.contains("first: step 1, 0.02 s"));
}

/// A line ends where something is put elsewhere, and begins again where it arrives.
#[test]
fn no_line_follows_a_jump() {
    let longest = |svg: &str, class: &str| {
        let document = roxmltree::Document::parse(svg).unwrap();
        let paths = document.descendants().filter(|node| node.attribute("class") == Some(class));
        let ways = paths.filter(|node| node.parent().is_some_and(|group| is_panel(&group)));
        let lines: Vec<Vec<(char, f64)>> = ways.map(|node| data(node.attribute("d").unwrap())).collect();
        let xs = |line: &Vec<(char, f64)>| line.iter().step_by(2).copied().collect::<Vec<_>>();
        let moves = lines.iter().flat_map(|line| {
            let xs = xs(line);
            xs.windows(2).filter(|pair| pair[1].0 == 'L').map(|pair| (pair[1].1 - pair[0].1).abs()).collect::<Vec<_>>()
        });
        moves.fold(0.0, f64::max)
    };
    // At 4 to 1, 100 px are 400: no move of a step is longer than its own 4.
    let (svg, classes) = classes_of_run(CROWD, "right*150");
    assert!(classes["door"] > 2, "{classes:?}");
    let moved = longest(&svg, "route");
    assert!(moved > 1.0 && moved < 10.0, "{moved}");
    let wrapped = CROWD.replace("bounds rect(0, 0, 320, 120)", "bounds rect(0, 0, 320, 120)\n        wrap horizontal");
    let wrapped = wrapped.replace("when x > 100 -> running { x := 8 }", "");
    let (svg, classes) = classes_of_run(&wrapped, "right*400");
    assert!(!classes.contains_key("door"));
    let moved = longest(&svg, "route");
    assert!(moved > 1.0 && moved < 10.0, "{moved}");
}

#[test]
fn long_levels_are_folded() {
    let program = example("tests/maps/smb.hyped");
    let svg = draw(&program, &Walk::default(), &[]);
    let classes = check(&svg);
    let document = roxmltree::Document::parse(&svg).unwrap();
    let panels: Vec<_> = document.descendants().filter(is_panel).collect();
    assert!(panels.len() > 1, "{}", panels.len());
    // Two marks at each cut.
    assert_eq!((classes["fold"], classes["cut"]), (2 * (panels.len() - 1), 2 * (panels.len() - 1)));
    let number = |node: &roxmltree::Node<'_, '_>, name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap();
    assert!(panels.windows(2).all(|pair| number(&pair[0], "y") + number(&pair[0], "height") < number(&pair[1], "y")));
    let size = document.root_element();
    assert!(number(&size, "width") < 1500.0, "{}", number(&size, "width"));
}
