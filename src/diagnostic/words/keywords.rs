//! Descriptions of the keywords: one or two sentences and an example each. The full reference is `grammar/README.md`.

/// The description of a keyword.
#[derive(Debug, Clone, Copy)]
pub struct Meaning {
    /// The keyword.
    pub word: &'static str,
    /// What it says.
    pub description: &'static str,
    /// Statements that contain the keyword.
    pub example: &'static str,
}

/// Names that every program has, unless it declares others.
pub const KNOWN_NAMES: &[Meaning] = &[
    means("pi", "Half a turn in radians: the constant 3.14159….", "mode spinning { angle' = pi / 2 }"),
    means("tau", "A full turn in radians: twice `pi`.", "mode spinning { angle' = tau / 4 }"),
    means(
        "start",
        "Where this instance was placed or spawned: `start.x` and `start.y`, px from the space's lower-left corner.",
        "when x > start.x + 64 -> back",
    ),
];

/// The description of a keyword, if the word is one.
pub fn meaning(word: &str) -> Option<&'static Meaning> {
    MEANINGS.iter().find(|meaning| meaning.word == word)
}

const fn means(word: &'static str, description: &'static str, example: &'static str) -> Meaning {
    Meaning { word, description, example }
}

/// The descriptions of all keywords.
pub const MEANINGS: &[Meaning] = &[
    // Items.
    means(
        "import",
        "Takes in what another file declares. The path is relative to this file; a file that is named twice is read once.",
        "import \"parts/slime.hyped\"",
    ),
    means(
        "const",
        "A value for the whole program. Without a unit it takes the dimension that each place asks for.",
        "const tile = 16\nconst third_row: px = 3 * tile",
    ),
    means(
        "entity",
        "A kind of thing in the game, as a hybrid automaton: variables that flow, modes, and edges between them. `x` and \
         `y` are always there; `y` points up.",
        "entity Slime {\n    param speed = 30\n    collider enemy: rect(0, 0, 16, 16)\n    x' = speed\n}",
    ),
    means(
        "behavior",
        "A piece of an entity with parameters, which `use` puts in place. Other names in it are looked up where it is used.",
        "behavior Falls(pull) {\n    y'' = -pull\n}",
    ),
    means(
        "world",
        "A level: rules of contact, spaces with what is in them, players, and the questions to ask.",
        "world Room {\n    step 1/60\n    space main {\n        place hero: Hero at (32, 16)\n    }\n    player 1: hero\n}",
    ),
    // Members of entities.
    means(
        "param",
        "A number or truth value that is fixed for each instance. `place`, `spawn` and levels may set it; the default may \
         read constants and the parameters above.",
        "param speed = 60\nparam sprint: px/s = 2 * speed",
    ),
    means(
        "continuous",
        "A variable that flows, as `x` and `y` do, with its derivatives `charge'` and `charge''`. It begins at the value \
         given, or at 0.",
        "continuous charge = 0",
    ),
    means(
        "discrete",
        "A variable that only updates change: a whole number of a range, a truth value, or one of some names.",
        "discrete keys: int 0..9 = 0\ndiscrete facing: {left, right} = right",
    ),
    means("int", "Whole numbers from one constant to another, both included.", "discrete keys: int 0..9 = 0"),
    means("bool", "`true` or `false`.", "discrete armed: bool = false"),
    means(
        "ref",
        "Refers to another instance, or is `none`. Of a `ref owner: any` only `x` and `y` can be read until `is` narrows it.",
        "ref target: Slime",
    ),
    means("button", "The buttons that the entity reads, with `pressed`, `held` and `released`.", "button jump, run"),
    means(
        "axis",
        "The axes that the entity reads: numbers from -1 to 1, for any expression.",
        "axis horizontal\nx' = 60 * horizontal",
    ),
    means(
        "chance",
        "A whole number that nature draws anew in each step, each value as likely as the others. It is read like an axis: \
         in guards, updates and flows.",
        "chance roll: 1..6",
    ),
    means(
        "collider",
        "A shape that moves with the entity, and tags by which `collide` and `touching` refer to it. With `when` it is \
         there only while the guard holds.",
        "collider body, player: rect(0, 0, 16, 16)\ncollider blade: rect(16, 6, 12, 4) when in stab",
    ),
    means(
        "kinematic",
        "The collider pushes what can move and is never pushed itself: a lift, a door.",
        "kinematic collider lift: rect(0, 0, 48, 8)",
    ),
    means(
        "clamp",
        "A soft bound of a continuous variable or its velocity: what would leave it is cut off, and nothing else changes.",
        "clamp x' in -50..50\nclamp y >= 20",
    ),
    means(
        "invariant",
        "What always holds of the entity. `hypedc check` tries to prove it; a run reports it when it does not hold. It changes \
         nothing.",
        "invariant 0 <= y <= 160",
    ),
    means(
        "condition",
        "A name for a guard, in an entity, a mode or a world. Wherever it is used, its expression is meant.",
        "condition on_floor = touching(body, wall, below)",
    ),
    means("use", "Puts a behavior in place, with all of its parameters by name.", "use Falls(pull = 400)"),
    // Modes and edges.
    means(
        "group",
        "Modes beside those of other groups: each group has one active mode at any time. Groups belong to the entity \
         itself.",
        "group hurt {\n    mode no { when pressed(jump) -> yes }\n    mode yes { when timer >= 2s -> no }\n}",
    ),
    means(
        "mode",
        "A state with flows, envelopes, edges and further modes. Of the modes beside each other exactly one is active; the \
         first one written comes first.",
        "mode ground {\n    y' = 0\n    when pressed(jump) -> air { y' := 160 }\n}",
    ),
    means(
        "always",
        "Edges of an entity that are looked at whatever modes are active. They lead nowhere; `timer` is the time since \
         the instance was made.",
        "always {\n    when touching(body, coin) as c { coins += 1; destroy c }\n}",
    ),
    means(
        "initial",
        "The mode that comes first, instead of the first one written. With a guard over constants and parameters: if that \
         holds.",
        "initial mode falling { }\ninitial when level >= 2 mode big { }",
    ),
    means(
        "when",
        "An edge: if the guard holds, it leads to a mode, or without a target only makes its updates. Outer modes are \
         looked at first, then the order of the text counts. Colliders, links and `follow links` take a guard as well.",
        "when pressed(jump) and touching(wall, below) -> air { y' := 160 }",
    ),
    means(
        "else",
        "An edge for the other case: its guard is the negation of that of the `when` before it in the same mode.",
        "when held(jump) { y' := 160 }\nelse -> waiting",
    ),
    means(
        "follow",
        "While this mode is active, the instance goes through a link in whose rectangle it is. The updates run as it does.",
        "follow links when held(up) { doors := doors + 1 }",
    ),
    means("links", "The `link` lines of the world's spaces.", "follow links"),
    means(
        "spawn",
        "Makes an instance: it sets parameters, variables and references by name, and begins where the spawner is unless \
         `x` and `y` are given. In a tile set: a tile in which an instance stands as the world begins.",
        "when pressed(fire) { ball := spawn Fireball(y = y + 8, owner = self) }",
    ),
    means(
        "destroy",
        "Removes an instance at the end of the step; references to it become `none`. Of `none` it does nothing.",
        "when timer >= 0.5 { destroy self }",
    ),
    means(
        "signal",
        "What an entity can be sent. With a number in brackets, the numbers of all that is sent in a step add up: \
         `score.points`. A number without a dimension is whole. What is sent in one step is received in the next.",
        "signal hit\nsignal score(points)\nsignal push(speed: px/s)",
    ),
    means(
        "send",
        "Sends a signal to what a reference holds, to `self`, or to `all` instances of an entity. Guards and updates of \
         edges read it in the next step. Sent to `none`, it is lost.",
        "when touching(body, ship) as s and s is Ship { send s.score(100) }\nwhen pressed(open) { send all Door.open }",
    ),
    // Envelopes.
    means(
        "envelope",
        "Drives a variable by an input, with a ramp up and a ramp down. It is a flow in all respects.",
        "envelope x' by horizontal {\n    attack accel 300\n    sustain 60\n    release accel 150\n}",
    ),
    means(
        "by",
        "What drives the envelope: an axis, a truth value such as `held(run)`, or as many axes as variables.",
        "envelope charge by held(run) { sustain 100 }",
    ),
    means(
        "fixed",
        "The envelope runs once, by the timer of the mode it is in.",
        "envelope reach fixed {\n    attack over 0.2s to 16\n    sustain for 0.1s\n    release over 0.2s to 0\n}",
    ),
    means(
        "directions",
        "Number of directions of an envelope of two variables: 2 to 64, or `any`. The nearest one is taken.",
        "envelope (x', y') by (horizontal, vertical) directions 8 { sustain 60 }",
    ),
    means(
        "attack",
        "How fast the variable goes to the sustain level once it is driven; with `to`, first to a peak. At once if left out.",
        "attack accel 300\nattack over 0.1s to 120",
    ),
    means("decay", "How fast it goes from the peak to the sustain level. At once if left out.", "decay over 0.2s"),
    means(
        "sustain",
        "The level at which it stays while driven. In a `fixed` envelope: how long it stays at the peak.",
        "sustain 60\nsustain for 0.1s",
    ),
    means(
        "release",
        "How fast it goes back, to 0 or to a level, when it is no longer driven; `hold` keeps it. At once if left out.",
        "release accel 150\nrelease over 0.1s to 20\nrelease hold",
    ),
    means("while", "While this does not hold, it is as if nothing drove the envelope.", "while touching(wall, below)"),
    means("for", "How long a `fixed` envelope stays at its peak.", "sustain for 0.1s"),
    means("instant", "At once, in one step.", "attack instant"),
    means("accel", "The rate at which the level changes: by this much each second.", "attack accel 300"),
    means("over", "At a constant rate, from one level to the other in this time.", "release over 0.2s"),
    means("hold", "The variable keeps the value that it has when it is no longer driven.", "release hold"),
    means("to", "The peak of an attack, or the level that a release goes to.", "attack over 0.1s to 120"),
    // Expressions.
    means(
        "and",
        "Both hold. The right side is not evaluated if the left one is false.",
        "when x > 0 and held(run) -> fast",
    ),
    means(
        "or",
        "At least one holds. The right side is not evaluated if the left one is true.",
        "when x < 0 or y < 0 -> out",
    ),
    means("not", "It does not hold.", "when not held(run) -> walking"),
    means(
        "in",
        "Whether a mode is active: one's own (`in air`), that of a reference or of an instance (`hero in air`). After \
         `clamp` it stands before the bounds.",
        "when in movement.air -> hanging\nclamp x' in -50..50",
    ),
    means(
        "is",
        "Whether a reference refers to an entity, or to nothing. After `is`, its members can be read in the same `and` and \
         in the updates.",
        "when target is Slime and target.x > x -> chasing",
    ),
    means(
        "as",
        "Gives a name: in a guard to the instance that is touched, in a tile set to the instance that a tile makes.",
        "when touching(body, coin) as c and c is Coin { destroy c }",
    ),
    means("if", "The second argument if the first holds, else the third.", "x' = if(facing == left, -30, 30)"),
    means("true", "The truth value of what holds.", "discrete armed: bool = true"),
    means("false", "The truth value of what does not hold.", "discrete armed: bool = false"),
    means("none", "The value of a reference that refers to nothing.", "x = if(target is none, 40, target.x)"),
    means("self", "This instance.", "when timer >= 0.5 { destroy self }"),
    means(
        "timer",
        "Seconds since the mode in which it is written was entered; `timer(MODE)` is that of another mode.",
        "when timer >= 0.5 -> resting",
    ),
    means(
        "any",
        "In a guard or a predicate: that it holds of at least one instance of an entity.",
        "never crowd: any Slime in squashed or any Slime.x > 100",
    ),
    means(
        "all",
        "In a guard or a predicate: that it holds of every living instance of an entity.",
        "goal solved: all Crate in placed",
    ),
    means(
        "nearest",
        "That there is another instance of an entity in this space. `as` names the one that is nearest.",
        "when pressed(fire) and nearest Slime in awake within 80 as s { send s.hit }",
    ),
    means(
        "within",
        "How far away the nearest instance of an entity may be, px.",
        "when nearest Slime within 80 -> alert",
    ),
    means(
        "touching",
        "In a predicate: whether an instance touches something with a tag.",
        "goal flag: hero touching flag",
    ),
    // Worlds.
    means("step", "The length of a step, s; 1/60 without this line.", "step 1/60"),
    means(
        "collide",
        "Which colliders can touch, by their tags, and what a contact does. All others pass through each other.",
        "collide body with wall: block\ncollide body with enemy: sense",
    ),
    means("with", "Separates the tags of the two sides.", "collide body, crate with wall: block"),
    means(
        "block",
        "What can move is pushed out, and its velocity into the surface becomes 0.",
        "collide body with wall: block",
    ),
    means("sense", "The contact is seen by `touching`, and does nothing more.", "collide body with coin: sense"),
    means(
        "from",
        "`block from above` is a contact only for what comes from above. After `map` it precedes a text file of rows.",
        "collide body with cloud: block from above",
    ),
    means(
        "above",
        "`block from above`: only what comes from above is blocked, a platform to jump through. In `place … at (x, above \
         TAG)`: on the lowest tile with the tag over which there is room.",
        "collide body with cloud: block from above",
    ),
    means(
        "keep",
        "What is blocked is only pushed out; its velocity stays, so that a bounce can be an update.",
        "collide ball with floor: block, keep velocity",
    ),
    means(
        "velocity",
        "`keep velocity`: what is blocked is only pushed out, and goes on as fast as it was.",
        "collide ball with floor: block, keep velocity",
    ),
    means(
        "bounce",
        "In `collide … : block`: the velocity into the surface is turned back by this share, from 0 to 1, instead of being \
         set to 0.",
        "collide ball with wall: block, bounce 1",
    ),
    means(
        "carry",
        "What has the left tags and stands on what has the right ones moves along with it.",
        "collide body with lift: block, carry",
    ),
    means(
        "tiles",
        "A tile set: how large its tiles are, px, and what each character of a map means. `empty` is no tag at all.",
        "tiles room 16 x 16 {\n    '.': empty\n    '#': wall\n    'S': spawn Slime\n}",
    ),
    means(
        "slope",
        "After the tags of a tile: the two ends of a line, px from the tile's lower-left corner. Below it the tile is solid.",
        "tiles room 16 x 16 { '/': wall slope (0, 0)-(16, 16) }",
    ),
    means(
        "breakable",
        "After the tags of a tile: `destroy` can break it, where `as` names it. It is one bit of the state.",
        "tiles room 16 x 16 { '#': brick breakable }",
    ),
    means(
        "restore",
        "`restore after TIME` behind `breakable`: a broken tile is back that long after it was broken.",
        "tiles room 16 x 16 { '#': brick breakable restore after 8s }",
    ),
    means(
        "after",
        "`restore after TIME` behind `breakable`: a broken tile is back that long after it was broken.",
        "tiles room 16 x 16 { '#': brick breakable restore after 8s }",
    ),
    means("x", "Separates the width and the height of a tile, px.", "tiles room 16 x 16 { '.': empty }"),
    means(
        "limit",
        "Maximum number of instances of an entity that are alive at any time. An entity that is spawned needs one.",
        "limit Fireball 2",
    ),
    means(
        "look",
        "What a thing looks like in pictures and on the page of `hypedc play`: a colour, or a PNG file in the folder of the \
         program. In an entity it is that of the instances, in a world that of what has a tag. No run depends on it.",
        "look coin, gem: #ffd040\nlook water: \"water.png\"",
    ),
    means("player", "Gives an instance the inputs of a player.", "player 1: hero"),
    means(
        "goal",
        "A question for `hypedc reach`: can this become true?",
        "goal over: hero.x > 256 and not hero in dead",
    ),
    means(
        "never",
        "A predicate that must never hold: it ends a branch of a search, and a run reports it.",
        "never fell: hero.y < 0",
    ),
    means(
        "space",
        "A room with coordinates of its own; instances in different spaces never touch.",
        "space main {\n    place hero: Hero at (32, 16)\n}",
    ),
    means(
        "map",
        "The tiles of the space: rows in the text with a tile set, or a level from a file. The lower-left corner is (0, 0).",
        "map room \"\n    ....\n    ####\n\"",
    ),
    means("vglc", "A level of the Video Game Level Corpus, with its legend.", VGLC),
    means("legend", "The JSON file that gives each character of the level its tags.", VGLC),
    means("tile", "Width and height of a tile of the level, px.", VGLC),
    means(
        "level",
        "A map that the command line names (`--map`). After `ldtk`: which level of the project.",
        "map level room",
    ),
    means(
        "tiled",
        "A map of Tiled, `.tmx` or `.tmj`. The block says what its names mean.",
        "map tiled \"cave.tmx\" {\n    blob: spawn Slime\n    Rock: wall\n}",
    ),
    means("ldtk", "A level of a project of LDtk.", "map ldtk \"world.ldtk\" level \"Cave\" { Rock: wall }"),
    means(
        "place",
        "Makes an instance with a name. The block sets parameters, first values of variables, and references.",
        "place slime: Slime at (96, 16) { speed = 40 }",
    ),
    means(
        "at",
        "Where an instance begins, or where a link leads: px, from the space's lower-left corner. In `touching(body at \
         (16, 0), wall)`: how far the collider is moved, to ask whether that place is taken.",
        "when pressed(jump) and not touching(body at (0, 16), wall) { y := y + 16 }",
    ),
    means(
        "link",
        "A way from a rectangle of this space to one of another space, for those in a mode with `follow links`.",
        LINK,
    ),
    means(
        "rect",
        "A rectangle: lower-left corner, width, height; px. By itself, with tags, it is geometry that never moves.",
        "rect wall (0, 0, 320, 16)\nbounds rect(-32, 0, 512, 256)",
    ),
    means(
        "bounds",
        "Where runs end: in the step in which a player is below the rectangle or beside it. Without it, a run ends at \
         no border.",
        "bounds rect(-32, 0, 512, 256)",
    ),
    means(
        "wrap",
        "Makes two borders of the space one: what leaves at the one comes in at the other. The borders are those of \
         `bounds`, or of the map.",
        "wrap horizontal\nwrap vertical",
    ),
    // Tests.
    means(
        "test",
        "What `hypedc test` checks: claims about the run of some inputs, and about all runs. No run depends on it.",
        TEST,
    ),
    means(
        "inputs",
        "The inputs of a test's run, as an input script, or in a file after `from`. Several lines are one script.",
        TEST,
    ),
    means("seed", "`chance seed N` in a test: what nature draws, as `hypedc sim --chance seed=N` draws it.", SEED),
    means(
        "expect",
        "In a test: a predicate that holds in the run of its inputs, `at` a time, `by` a time, `always` or `never`.",
        TEST,
    ),
    means("end", "`at end`, `by end`: after the last step of the run of a test.", TEST),
    means(
        "reachable",
        "In a test: a search finds inputs after which the predicate holds, and they are replayed.",
        "test \"the exit\" { reachable hero.x > 300 within 20s }",
    ),
    means(
        "unreachable",
        "In a test: it is proven that no inputs lead to the predicate. That a search finds none is not enough.",
        "test \"the exit\" { unreachable hero.x > 300 without hero.keys > 0 }",
    ),
    means(
        "unfound",
        "In a test: a search within its budget does not find the predicate, which proves nothing.",
        "test \"nobody falls\" { unfound hero.y < 0 within 20s }",
    ),
    means(
        "without",
        "In a test: only ways on which a predicate never holds. After `not`: there is a way, and none without it.",
        "test \"the key\" { reachable hero.x > 300 not without hero.keys > 0 }",
    ),
];

const TEST: &str = "test \"it walks\" {\n    inputs \"right*60\"\n    expect hero.x > 50 at 1s\n    expect hero.y >= 0 always\n    \
                    expect hero.x > 90 by end\n}";
const SEED: &str = "test \"a six\" {\n    chance seed 7\n    expect hero.y > 5 by 2s\n}";

const VGLC: &str = "map vglc \"one.txt\" legend \"legend.json\" tile 16 x 16 { 'E': spawn Slime }";
const LINK: &str = "link rect(64, 0, 16, 16) -> cellar at rect(0, 32, 16, 16) when hero.keys > 0";
