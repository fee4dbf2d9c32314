//! Generated programs: a realistic large one, and shapes that stress one stage each.

#![allow(dead_code, reason = "not every user needs all of it")]

use std::fmt::Write;

/// A deterministic generator of pseudo-random numbers.
struct Draw(u64);

impl Draw {
    fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % end
    }

    fn between(&mut self, low: usize, high: usize) -> usize {
        low + self.below(high - low + 1)
    }
}

/// A program of about that many lines without findings: chapters of constants, behaviours, entities and a world of
/// several rooms, no two alike.
pub fn realistic(lines: usize) -> String {
    let mut out = String::from("// A game in many chapters.\n\n");
    let mut draw = Draw(7);
    let mut chapter = 0;
    // Lines are counted incrementally: a full count each time would take longer than parsing.
    let (mut counted, mut count) = (0, 0);
    while count < lines {
        write_chapter(&mut out, chapter, &mut draw, lines < SMALL);
        count += out[counted..].matches('\n').count();
        counted = out.len();
        chapter += 1;
    }
    out
}

/// A program of less lines than this is one small chapter.
const SMALL: usize = 400;

fn write_chapter(out: &mut String, k: usize, draw: &mut Draw, is_small: bool) {
    let d = draw;
    macro_rules! line {
        ($($part:tt)*) => { writeln!(out, $($part)*).unwrap() };
    }
    line!("// ---- chapter {k} ----\n\nconst gravity_{k} = -{}", d.between(300, 900));
    line!("const unit_{k} = {}\n", d.between(8, 32));
    line!("/// To and fro.\nbehavior Patrol{k}(left, right, speed) {{");
    line!("    mode rightwards {{\n        x' = speed\n        when x >= right -> leftwards\n    }}");
    line!("    mode leftwards {{\n        x' = -speed\n        when x <= left -> rightwards\n    }}\n}}\n");
    line!("/// Up and down, with a rest.\nbehavior Hoist{k}(bottom, top, speed, rest) {{");
    line!("    mode rising {{\n        y' = speed\n        when y >= top -> above\n    }}");
    line!("    mode above {{\n        y' = 0\n        when timer >= rest -> sinking\n    }}");
    line!("    mode sinking {{\n        y' = -speed\n        when y <= bottom -> below\n    }}");
    line!("    mode below {{\n        y' = 0\n        when timer >= rest -> rising\n    }}\n}}\n");
    let heroes = if is_small { 1 } else { d.between(1, 2) };
    for h in 0..heroes {
        write_hero(out, &format!("Hero{k}_{h}"), k, d);
    }
    let creatures = if is_small { 1 } else { d.between(2, 5) };
    for c in 0..creatures {
        write_creature(out, &format!("Creature{k}_{c}"), &format!("Hero{k}_0"), d);
    }
    let platforms = if is_small { 1 } else { d.between(1, 3) };
    for p in 0..platforms {
        write_platform(out, &format!("Platform{k}_{p}"), k, d);
    }
    line!("/// Flies straight on.\nentity Bolt{k} {{\n    param dx = 1\n    param speed = {}", d.between(100, 300));
    line!("    collider arrow: rect(0, 0, 4, 4)\n    mode flying {{\n        x' = dx * speed\n        y' = 0");
    line!("        when touching(arrow, wall) or touching(arrow, enemy) {{ destroy self }}\n    }}\n}}\n");
    write_world(out, k, (heroes, creatures, platforms), d);
}

fn write_hero(out: &mut String, name: &str, k: usize, d: &mut Draw) {
    macro_rules! line {
        ($($part:tt)*) => { writeln!(out, $($part)*).unwrap() };
    }
    line!("/// Runs, jumps, throws bolts, can be hurt.\nentity {name} {{");
    line!("    param fall_limit = -{}\n    param run_speed = {}", d.between(250, 400), d.between(80, 120));
    line!("    param run_accel = {}\n    param jump_speed = {}", d.between(300, 700), d.between(180, 280));
    line!("    // Letting go of the button early cuts the jump.\n    param jump_cut = {}\n", d.between(40, 100));
    line!("    axis horizontal\n    button jump, shoot\n\n    discrete hearts: int 0..3 = 3");
    line!(
        "    discrete facing: {{left, right}} = right\n    discrete coins: int 0..99 = 0\n    continuous charge = 0\n"
    );
    line!("    invariant 0 <= charge <= 2\n    collider body, player: rect(1, 0, 14, 22) when not in life.dead");
    line!("    collider sword: rect(14, 4, 8, 4) when in bow.drawing and facing == right");
    line!("    collider sword: rect(-8, 4, 8, 4) when in bow.drawing and facing == left");
    line!("    clamp y' >= fall_limit\n    y'' = gravity_{k}\n");
    line!("    group movement {{\n        mode air {{\n            envelope x' by horizontal {{");
    line!(
        "                attack accel run_accel / 2\n                sustain run_speed\n                release hold\n            }}"
    );
    line!("            when touching(body, wall, below) and y' <= 0 -> ground");
    line!("            mode falling {{ }}\n            mode rising {{");
    line!("                when not held(jump) -> falling {{ y' := min(y', jump_cut) }}");
    line!("                when y' <= 0 -> falling\n            }}\n        }}\n        mode ground {{");
    line!("            envelope x' by horizontal {{\n                attack accel run_accel");
    line!("                sustain run_speed\n                release accel run_accel\n            }}");
    line!("            when pressed(jump) -> rising {{ y' := jump_speed }}");
    line!("            when not touching(body, wall, below) -> falling\n        }}\n    }}");
    line!("    group look {{\n        mode ahead {{\n            when horizontal < 0 {{ facing := left }}");
    line!("            when horizontal > 0 {{ facing := right }}\n        }}\n    }}");
    line!("    group bow {{\n        mode ready {{\n            charge' = 0");
    line!("            when pressed(shoot) and coins > {} -> drawing", d.below(5));
    line!(
        "            when pressed(shoot) -> drawing {{\n                spawn Bolt{k}(x = x + if(facing == left, -8, 16), y = y + 8,"
    );
    line!("                    dx = if(facing == left, -1, 1))\n            }}\n        }}");
    line!("        mode drawing {{\n            charge' = 1\n            when charge > 1.{} -> ready", d.between(1, 9));
    line!("            when timer >= 0.{}s -> ready\n        }}\n    }}", d.between(20, 90));
    line!("    group life {{\n        mode safe {{");
    line!("            when touching(body, enemy) and hearts <= 1 -> dead {{ hearts := 0 }}");
    line!("            when touching(body, enemy) -> hurt {{ hearts := max(hearts - 1, 0) }}\n        }}");
    line!(
        "        /// Invulnerable for a moment.\n        mode hurt {{\n            when timer >= 1.{}s -> safe\n        }}",
        d.below(9)
    );
    line!("        mode dead {{ }}\n    }}\n    group purse {{\n        mode open {{");
    line!("            when touching(body, coin) {{ coins := min(coins + 1, 99) }}\n        }}\n    }}\n}}\n");
}

fn write_creature(out: &mut String, name: &str, prey: &str, d: &mut Draw) {
    macro_rules! line {
        ($($part:tt)*) => { writeln!(out, $($part)*).unwrap() };
    }
    let phases = d.between(2, 12);
    line!("/// Paces, and changes its mind {phases} times.\nentity {name} {{\n    param pace = {}", d.between(20, 60));
    line!(
        "    param stride = 0.{}\n    param sight = {}\n    param wave: 1/s = {}",
        d.between(10, 99),
        d.between(50, 150),
        d.between(2, 40)
    );
    line!("    ref prey: {prey}\n");
    line!("    discrete dx: int -1..1 = 1\n    discrete hp: int 0..{phases} = {phases}\n");
    line!("    collider body, enemy: rect(0, 0, {}, {})\n", d.between(8, 16), d.between(8, 16));
    line!("    mode alive {{\n        when hp == 0 {{ destroy self }}");
    for p in 0..phases {
        let next = (p + 1) % phases;
        let (a, b) = (d.between(1, 9), d.between(2, 40));
        line!(
            "        mode phase{p} {{\n            x' = dx * pace * {}.{a}\n            y' = pace * sin(timer * wave)",
            d.below(3)
        );
        line!("            when touching(body, sword) -> phase{next} {{ hp := max(hp - 1, 0); dx := -dx }}");
        // The first two phases read all variables.
        match if p < 2 { p + 1 } else { d.below(3) } {
            0 => line!("            when timer >= stride * {b} -> phase{next} {{ dx := -dx }}"),
            1 => line!("            when timer > stride and prey is {prey} and abs(prey.x - x) < sight -> phase{next}"),
            _ => line!(
                "            when prey is {prey} and prey.x > x + {b} and prey in life.hurt or timer > {b} -> phase{next} {{ dx := 1 }}"
            ),
        }
        line!("        }}");
    }
    line!("    }}\n}}\n");
}

fn write_platform(out: &mut String, name: &str, k: usize, d: &mut Draw) {
    macro_rules! line {
        ($($part:tt)*) => { writeln!(out, $($part)*).unwrap() };
    }
    line!("entity {name} {{\n    param speed = {}\n    param left_x = {}", d.between(10, 60), d.between(50, 150));
    line!("    param wave: 1/s = {}", d.between(1, 5));
    line!(
        "    param right_x = {}\n    kinematic collider platform, wall: rect(0, -8, 4 * unit_{k}, 8)",
        d.between(200, 300)
    );
    line!("    group across {{\n        use Patrol{k}(left = left_x, right = right_x, speed = speed)\n    }}");
    if name.ends_with('0') || d.below(2) == 0 {
        line!(
            "    group along {{\n        use Hoist{k}(bottom = 20, top = {}, speed = speed / 2, rest = 1 / wave)\n    }}",
            d.between(50, 150)
        );
    } else {
        line!("    group along {{ mode floating {{\n        y' = speed * cos(timer * wave)\n    }} }}");
    }
    line!("}}\n");
}

fn write_world(out: &mut String, k: usize, (heroes, creatures, platforms): (usize, usize, usize), d: &mut Draw) {
    macro_rules! line {
        ($($part:tt)*) => { writeln!(out, $($part)*).unwrap() };
    }
    line!(
        "world World{k} {{\n    step 1/60\n\n    collide body with wall: block\n    collide player with enemy, coin: sense"
    );
    line!("    collide sword with enemy: sense\n    collide arrow with wall, enemy: sense\n");
    line!("    tiles land 16 x 16 {{\n        '.': empty\n        '#': wall\n        'o': coin\n    }}\n");
    let rooms = d.between(2, 6);
    for r in 0..rooms {
        line!("    space room{r} {{\n        map land \"");
        let (columns, rows) = (d.between(24, 40), d.between(10, 16));
        for row in 0..rows {
            out.push_str("            ");
            for column in 0..columns {
                let border = row == 0 || row + 1 == rows || column == 0 || column + 1 == columns;
                let inside = row + 3 < rows && column > 6 && d.below(9) == 0;
                let coin = !inside && d.below(20) == 0;
                out.push(if border || inside {
                    '#'
                } else if coin {
                    'o'
                } else {
                    '.'
                });
            }
            out.push('\n');
        }
        line!("        \"");
        if r == 0 {
            for h in 0..heroes {
                line!("        place hero{h}: Hero{k}_{h} at ({}, 16)", 20 + 24 * h);
            }
        }
        for c in 0..creatures {
            let x = d.between(18, 60);
            line!(
                "        place creature{r}_{c}: Creature{k}_{c} at ({x}, 16) {{ prey = hero0; pace = {} }}",
                d.between(20, 60)
            );
        }
        for p in 0..platforms {
            line!(
                "        place platform{r}_{p}: Platform{k}_{p} at (120, {}) {{\n            left_x = 100",
                40 + 8 * p
            );
            line!("            right_x = {}\n        }}", d.between(150, 250));
        }
        let next = (r + 1) % rooms;
        line!("        link rect({}, 16, 8, 32) -> room{next} at rect(20, 16, 8, 32)", 16 * columns - 24);
        line!("    }}\n");
    }
    line!("    limit Bolt{k} {}", d.between(2, 8));
    for h in 0..heroes {
        line!("    player {}: hero{h}", h + 1);
    }
    line!(
        "    goal rich: hero0.coins > {}\n    goal far: hero0.x > {} and not hero0 in life.dead",
        d.between(3, 30),
        d.between(200, 300)
    );
    line!("    never died: hero0 in life.dead\n}}\n");
}

/// A shape that stresses one stage: its name, and its generator by size.
pub type Shape = (&'static str, fn(usize) -> String);

/// The shapes. The work should be proportional to the size.
pub const SHAPES: &[Shape] = &[
    ("modes of one entity", |n| {
        let modes = (0..n).map(|i| {
            format!(
                "mode m{i} {{ x' = {i}\n when timer > 1.{i} and held(go) -> m{}\n when x > {i} -> m{} }}\n",
                (i + 1) % n,
                i * 7 % n
            )
        });
        format!("entity A {{ button go\n {} }}\n", modes.collect::<String>())
    }),
    ("edges of one mode", |n| {
        let edges = (0..n).map(|i| format!("when x > {i} and y < {} -> m{}\n", i * 13 % n, i % 9));
        let modes = (0..9).map(|i| format!("mode m{i} {{ when timer > 1 -> m0 }}\n"));
        format!("entity A {{ mode a {{ {} }}\n{} }}\n", edges.collect::<String>(), modes.collect::<String>())
    }),
    ("groups", |n| {
        let groups = (0..n).map(|i| {
            format!(
                "group g{i} {{ mode a {{ when in g{}.b -> b }}\n mode b {{ when x > {i} -> a {{ c := {} }} }} }}\n",
                (i + 1) % n,
                i % 9
            )
        });
        format!(
            "entity A {{ discrete c: int 0..9 = 0\n mode z {{ when c > 3 -> z }} \n{} }}\n",
            groups.collect::<String>()
        )
    }),
    ("colliders and contact queries", |n| {
        let colliders = (0..n).map(|i| format!("collider t{}: rect({i}, 0, 8, 8) when c == {}\n", i % 50, i % 9));
        let edges = (0..n).map(|i| format!("when touching(t{}, t{}) {{ c := {} }}\n", i % 50, i / 50 % 50, i % 9));
        format!(
            "entity A {{ discrete c: int 0..9 = 0\n {} mode a {{ {} }} }}\nworld W {{ collide t0 with t1: sense\n space s {{ place a: A at (0, 0) }} }}\n",
            colliders.collect::<String>(),
            edges.collect::<String>()
        )
    }),
    ("parameters that hang on each other", |n| {
        let params = (1..n).map(|i| format!("param p{i} = p{} * 2\n", i - 1));
        format!("entity A {{ param p0 = 1\n {} x' = p{} }}\n", params.collect::<String>(), n - 1)
    }),
    ("constants that hang on each other", |n| {
        let constants = (1..n).map(|i| format!("const c{i} = c{} + 1\n", i - 1));
        format!("const c0 = 1\n{} entity A {{ x' = c{} }}\n", constants.collect::<String>(), n - 1)
    }),
    ("variables that nothing reads", |n| {
        let entities = (0..n).map(|i| format!("entity A{i} {{ continuous v = 0\n discrete d: int 0..9 = 0\n ref r: A{i}\n mode a {{ v' = 1\n when timer > 1 -> a {{ v := 0 }} }} }}\n"));
        format!("{}world W {{ space s {{ place a: A0 at (0, 0) }} }}\n", entities.collect::<String>())
    }),
    ("references to whatever there is", |n| {
        let entities = (0..n).map(|i| format!("entity A{i} {{ ref r: any\n discrete hp: int 0..9 = 0\n collider t: rect(0, 0, 1, 1)\n mode a {{ x' = r.x - x\n when touching(t, t) as o and o.x > {i} and o.hp > 3 {{ r := none; hp := 1 }} }} }}\n"));
        entities.collect()
    }),
    ("instances", |n| {
        let places =
            (0..n).map(|i| format!("place p{i}: A at ({}, 200) {{ speed = {i}; friend = p{} }}\n", 20 * i, i * 7 % n));
        let goals = (0..n / 10).map(|i| format!("goal g{i}: p{i}.x > {i} and p{} in b\n", i * 9));
        format!(
            "entity A {{ param speed = 1\n ref friend: A\n collider body: rect(0, 0, 8, 8)\n mode a {{ x' = speed\n when friend.x > x -> b }}\n mode b {{ }} }}\n
            world W {{ collide body with wall: block\n space s {{ rect wall (0, 0, 9000, 8)\n {} }}\n {} }}\n",
            places.collect::<String>(), goals.collect::<String>()
        )
    }),
    ("instances and walls", |n| {
        let places = (0..n).map(|i| format!("place p{i}: A at ({}, 20)\n", 20 * i));
        let walls = (0..n).map(|i| format!("rect wall ({}, 0, 18, 8)\n", 20 * i));
        format!(
            "entity A {{ collider body: rect(0, 0, 8, 8)\n x' = 3 }}\nworld W {{ collide body with wall: block\n space s {{ {}{} }} }}\n",
            walls.collect::<String>(),
            places.collect::<String>()
        )
    }),
    ("collide lines", |n| {
        let lines = (0..n)
            .map(|i| format!("collide t{}, u{} with u{}: {}\n", i % 30, i % 7, i / 30 % 30, ["block", "sense"][i % 2]));
        let colliders = (0..30).map(|i| {
            format!("collider t{i}, u{i}: rect(0, 0, 8, 8)\n when touching(t{i}, u{})\n{{ c := 1 }}\n", i * 7 % 30)
        });
        let places = (0..n.min(5_000)).map(|i| format!("place p{i}: A at ({}, 20)\n", 20 * i));
        format!(
            "entity A {{ discrete c: int 0..9 = 0\n {} }}\nworld W {{ {} space s {{ {} }} }}\n",
            colliders.collect::<String>().replace("when", "// when").replace("{ c", "// { c"),
            lines.collect::<String>(),
            places.collect::<String>()
        )
    }),
    ("rooms", |n| {
        let rooms = (0..n).map(|i| format!("space s{i} {{ rect wall (0, 0, 90, 8)\n link rect(80, 8, 8, 8) -> s{} at rect(0, 8, 8, 8)\n place p{i}: A at (20, 20) }}\n", (i + 1) % n));
        format!(
            "entity A {{ collider body: rect(0, 0, 8, 8)\n mode a {{ x' = 3\n follow links }} }}\nworld W {{ collide body with wall: block\n {} }}\n",
            rooms.collect::<String>()
        )
    }),
    ("settings of one instance and of one spawn", |n| {
        let params: String = (0..n).map(|i| format!("param p{i} = 1\n")).collect();
        let settings: String = (0..n).map(|i| format!("p{i} = 2\n")).collect();
        let spawned: String = (0..n).map(|i| format!("p{i} = 2,\n")).collect();
        let goals: String = (0..n).map(|i| format!("goal g{i}: a.p{i} > 3\n")).collect();
        format!(
            "entity A {{ {params} }}\nentity B {{ mode a {{ when timer > 1 {{ spawn A({spawned} x = 1) }} }} }}\nworld W {{ space s {{ place a: A at (0, 0) {{ {settings} }} }}\n {goals} }}\n"
        )
    }),
    ("updates of one edge", |n| {
        let variables: String = (0..n).map(|i| format!("discrete d{i}: int 0..9 = 0\n")).collect();
        let updates: String = (0..n).map(|i| format!("d{i} := 1\n")).collect();
        format!("entity A {{ {variables} mode a {{ {updates}\nwhen timer > 1 {{ {updates} }} }} }}\n")
    }),
    ("parameters that are products", |n| {
        let params = (0..n).map(|i| format!("param p{i} = 1\n"));
        let products = (0..n).map(|i| format!("param q{i} = p{i} * p{}\n", (i + 1) % n));
        format!("entity A {{ {}{} x' = q0 }}\n", params.collect::<String>(), products.collect::<String>())
    }),
    ("comparisons that make a chain", |n| {
        let params = (0..=n).map(|i| format!("param p{i} = 1\n"));
        let edges = (0..n).map(|i| format!("when p{i} > p{} {{ x := 1 }}\n", i + 1));
        format!("entity A {{ {} mode a {{ {} x' = p0 }} }}\n", params.collect::<String>(), edges.collect::<String>())
    }),
    ("arguments of a behaviour", |n| {
        let formals = (0..n).map(|i| format!("v{i}")).collect::<Vec<_>>().join(",\n");
        let actuals = (0..n).map(|i| format!("v{i} = 1")).collect::<Vec<_>>().join(",\n");
        format!("behavior B({formals}) {{ x' = v0 }}\nentity A {{ use B({actuals}) }}\n")
    }),
    ("worlds", |n| {
        let worlds = (0..n).map(|i| format!("world W{i} {{ collide body with wall: block\n space s {{ rect wall (0, 0, 90, 8)\n place p: A{i} at (20, 20) }}\n player 1: p }}\n"));
        let entities = (0..n).map(|i| format!("entity A{i} {{ button go\n collider body: rect(0, 0, 8, 8)\n mode a {{ when held(go) and touching(body, wall) -> b }}\n mode b {{ }} }}\n"));
        format!("{}{}", entities.collect::<String>(), worlds.collect::<String>())
    }),
    ("rows of a map", |n| {
        let rows = (0..n).map(|i| format!("{}\n", "#..o.#....".repeat(3 + i % 7 / 7)));
        format!(
            "entity A {{ collider body: rect(0, 0, 8, 8)\n x' = 3 }}\nworld W {{ collide body with wall: block\n tiles t 16 x 16 {{ '.': empty\n '#': wall\n 'o': coin }}\n space s {{ map t \"\n{}\"\n place a: A at (20, 20) }} }}\n",
            rows.collect::<String>()
        )
    }),
    ("uses of a behaviour", |n| {
        let entities = (0..n).map(|i| format!("entity A{i} {{ use B(v = {i}, w = x + 1) }}\n"));
        format!(
            "behavior B(v, w) {{ mode a {{ x' = v\n when w > 3 -> b }}\n mode b {{ when w < 3 -> a }} }}\n{}",
            entities.collect::<String>()
        )
    }),
    ("behaviours", |n| {
        let behaviors = (1..n).map(|i| format!("behavior B{i}(v) {{ param p{i} = v\n }}\n"));
        let entities = (1..n).map(|i| format!("entity A{i} {{ use B{i}(v = {i})\n x' = p{i} }}\n"));
        format!("{}{}", behaviors.collect::<String>(), entities.collect::<String>())
    }),
    ("spawns", |n| {
        let entities = (0..n).map(|i| format!("entity A{i} {{ param v = 1\n mode a {{ x' = v\n when timer > 1 {{ spawn A{}(x = x, v = {i}) }} }} }}\n", (i * 7 + 1) % n));
        format!("{}world W {{ space s {{ place a: A0 at (0, 0) }} }}\n", entities.collect::<String>())
    }),
    ("unknown names", |n| {
        let entities = (0..n).map(|i| format!("entity A{i} {{ param speed{i} = 1\n x' = sped{i} + speed{i}\n mode aa{i} {{ when y > hihg -> bb{i} }} }}\n"));
        entities.collect()
    }),
    ("unknown names in one entity", |n| {
        let params = (0..n).map(|i| format!("param speed{i} = 1\n"));
        let modes = (0..n).map(|i| format!("mode m{i} {{ x' = spede{i}\n when y > 1 -> mm{i} }}\n"));
        format!("entity A {{ {}{} }}\n", params.collect::<String>(), modes.collect::<String>())
    }),
    ("unknown names in a world", |n| {
        let places =
            (0..n).map(|i| format!("place p{i}: Ball{i} at (wid{i}, 200) {{ sped = {i} }}\ngoal g{i}: q{i}.x > 3\n"));
        let (places, goals): (Vec<_>, Vec<_>) = places
            .map(|p| {
                let (a, b) = p.split_once('\n').unwrap();
                (a.to_string() + "\n", b.to_string())
            })
            .unzip();
        format!("entity A {{ x' = 3 }}\nworld W {{ space s {{ {} }}\n {} }}\n", places.concat(), goals.concat())
    }),
    ("duplicates", |n| {
        (0..n).map(|i| format!("const a = {i}\nentity E {{ param p = 1\n param p = 2\n x' = p }}\n")).collect()
    }),
    ("wrong types and dimensions", |n| {
        let entities =
            (0..n).map(|i| format!("entity A{i} {{ param v = 1\n x' = v\n y'' = v\n mode a {{ when x -> a }} }}\n"));
        entities.collect()
    }),
    ("warnings", |n| {
        let entities = (0..n).map(|i| format!("entity A{i} {{ param unread = 1\n mode a {{ when x > 1 -> b\n when x > 2 -> c }}\n mode b {{ when false -> a }}\n mode c {{ }}\n mode d {{ }} }}\n"));
        entities.collect()
    }),
    ("findings on one line", |n| {
        let entities = (0..n).map(|i| format!("entity A{i} {{ x' = lost }}; "));
        entities.collect()
    }),
    ("syntax errors", |n| {
        (0..n).map(|i| format!("entity A{i} {{ param = 3\n mode {{ when -> }} }}\nmoed b{i}\n")).collect()
    }),
    ("braces that do not match", |n| {
        (0..n).map(|i| format!("entity A{i} {{\n    mode a {{\n        x' = 1\n    }}\n\n")).collect()
    }),
    ("stray braces", |n| (0..n).map(|i| format!("entity A{i} {{\n    x' = 1\n    }}\n}}\n")).collect()),
    ("headers without braces", |n| (0..n).map(|i| format!("entity A{i}\n    mode a\n        x' = 1\n")).collect()),
    ("open quotes", |n| {
        (0..n)
            .map(|i| format!("import \"file{i}\nworld W{i} {{ space s {{ map t \"\n...\n place a: A at (0, 0) }} }}\n"))
            .collect()
    }),
    ("maps without a quote", |n| (0..n).map(|_| "map land\n".to_string()).collect()),
    ("blank lines in parentheses", |n| {
        format!("const a = (\n{}1)\nconst b = max({}1, x(\n{}", "\n".repeat(n), " \n".repeat(n), "\n".repeat(n))
    }),
    ("comments", |n| {
        (0..n).map(|i| format!("/// Says {i}.\n// and {i}\n/// and more\nconst c{i} = {i} // {i}\n")).collect()
    }),
    ("a documented entity", |n| format!("{}entity A {{ x' = 3 }}\n", "/// One more line.\n".repeat(n))),
];
