//! Questions to the instances of an entity, and distances: who counts, when it is looked at, who is nearest.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use crate::support::goals_after as after;

/// Whether a guard of an `A` at (10, 0), which has a reference `b` to `one`, holds in the first step.
fn holds(guard: &str, items: &str) -> bool {
    let text = format!(
        "entity A {{
             ref b: B
             mode still {{ when {guard} -> seen }}
             mode seen {{ }}
         }}
         entity B {{
             discrete n: int 0..9 = 0
             discrete hue: {{red, blue}} = red
             discrete lit: bool = false
             collider b: rect(0, 0, 8, 8)
             mode idle {{ when n > 5 -> busy }}
             mode busy {{ }}
         }}
         entity C {{ }}
         world W {{
             step 1/60
             collide b with wall: block
             space main {{ {items}
                 place a: A at (10, 0) {{ b = one }} }}
             space other {{ place hidden: C at (10, 1) }}
             goal seen: a in seen
         }}"
    );
    after(&text, "-") == ["seen"]
}

const TWO: &str = "place one: B at (40, 30) { n = 3 }
    place two: B at (-20, 0) { n = 7; hue = blue; lit = true }";

#[test]
fn the_instances_of_an_entity_are_counted() {
    for (guard, expected) in [
        ("count(B) == 2", true),
        ("count(B) < 2", false),
        ("count(A) == 1", true),
        ("count(B in idle) == 2", true),
        ("any B in busy", false),
        ("all B in idle", true),
        ("any B", true),
        ("any B.x > 30", true),
        ("any B.x > 40", false),
        ("all B.x > -20", false),
        ("all B.x >= -20", true),
        ("100 > any B.x - x > 20", true),
        ("-20 < any B.x < 40", false),
        ("any B.lit", true),
        ("all B.lit", false),
        ("not all B.lit and any B.hue == blue", true),
        ("all B.hue == blue", false),
        ("any C", true),
        ("count(C) + count(A) + count(B) == 4", true),
        ("any B touching wall", false),
    ] {
        assert_eq!(holds(guard, TWO), expected, "{guard}");
    }
    let floor = format!("{TWO}\nrect wall (-100, -8, 100, 8)");
    let text = |guard| holds(guard, &floor);
    assert!(text("any B touching wall") && !text("all B touching wall") && text("count(B touching wall) == 1"));
    let none = "place one: B at (0, 0)";
    assert!(holds("all B in idle and count(B) == 1", none));
}

#[test]
fn an_entity_without_instances_is_no_mistake() {
    let text =
        "entity A { mode m { when count(B) == 0 and all B in idle and not any B and not nearest B -> n } mode n { } }
        entity B { mode idle { } }
        world W { space main { place a: A at (0, 0) } goal seen: a in n }";
    assert_eq!(after(text, "-"), ["seen"]);
}

#[test]
fn the_state_is_that_at_the_beginning_of_the_step() {
    // Both see no one in `on`, whichever is first; in the next step both see two.
    let text = "entity A {
            discrete seen: int 0..9 = 0
            mode off { when count(A in on) == 0 -> on }
            mode on { when timer >= 1frames and seen == 0 { seen := count(A in on) } }
        }
        world W {
            step 1/60
            space main { place a: A at (0, 0); place b: A at (9, 0) }
            goal both: a.seen == 2 and b.seen == 2
        }";
    assert_eq!(after(text, "-*2"), ["both"]);
    // What is destroyed counts in that step, what is spawned from the next one on.
    let text = "entity Bomb { mode lit { when timer >= 2frames { destroy self } } }
        entity A {
            discrete log: int 0..999 = 0
            mode only {
                when count(Bomb) == 0 and log == 0 { spawn Bomb; log := 1 }
                when log > 0 { log := min(10 * log + count(Bomb), 999) }
            }
        }
        world W {
            step 1/60
            space main { place a: A at (0, 0) }
            limit Bomb 1
            goal g: a.log == 111
            goal h: a.log == 110
        }";
    assert_eq!(after(text, "-*3"), ["g"]);
}

#[test]
fn the_nearest_is_named() {
    let near = |rest: &str, items: &str| holds(rest, items);
    // 42.4 px and 30 px away.
    assert!(near("nearest B as e and e.n == 7", TWO) && !near("nearest B as e and e.n == 3", TWO));
    assert!(near("nearest B within 30 as e and e.x == -20", TWO));
    assert!(!near("nearest B within 29.9 as e and e.x < 99", TWO));
    assert!(!near("nearest B in busy", TWO) && near("nearest B in idle within (20 + 10)", TWO));
    // Itself does not count, nor what is in another space.
    assert!(!near("nearest A", TWO) && !near("nearest C", TWO));
    let tie = "place one: B at (20, 0) { n = 3 }
        place two: B at (0, 0) { n = 7 }";
    assert!(near("nearest B as e and e.n == 3", tie), "the lowest slot of two that are as near");
    let across = "bounds rect(0, 0, 100, 100)
        wrap horizontal
        place one: B at (30, 0) { n = 3 }
        place two: B at (95, 0) { n = 7 }";
    assert!(near("nearest B within 15 as e and e.n == 7", across));
    assert!(!near("nearest B within 14 as e and e.n < 9", across));
}

#[test]
fn what_is_nearest_is_kept_sent_to_and_destroyed() {
    let text = "entity Foe {
            signal hit
            discrete hits: int 0..9 = 0
            mode m { when received(hit) { hits := min(hits + 1, 9) } }
        }
        entity A {
            ref last: Foe
            mode first { when nearest Foe as e -> second { send e.hit; last := e; x := e.x - 2 } }
            mode second { when nearest Foe as e and last is Foe -> third { destroy e } }
            mode third { }
        }
        world W {
            space main {
                place a: A at (0, 0)
                place far: Foe at (90, 0)
                place close: Foe at (50, 0)
            }
            goal hit: close.hits == 1 and far.hits == 0
            goal gone: count(Foe) == 1 and all Foe.x > 80
            goal moved: a.x == 48
        }";
    assert_eq!(after(text, "-"), ["moved"]);
    assert_eq!(after(text, "-*2"), ["gone", "moved"]);
}

#[test]
fn distances_are_euclidean_and_go_around() {
    let one = "place one: B at (40, 40)";
    for (guard, expected) in [
        ("distance(b) == 50", true),
        ("distance((10, 7)) == 7", true),
        ("distance(b, (40, 0)) == 40", true),
        ("near(b, self, 50)", true),
        ("near(b, self, 49.9)", false),
        ("near(self, (10, 3), 3) and near(any B, self, 50)", true),
        ("near(all B, (40, 41), 0.5)", false),
    ] {
        assert_eq!(holds(guard, one), expected, "{guard}");
    }
    let around = "bounds rect(0, 0, 100, 100)
        wrap horizontal
        wrap vertical
        place one: B at (90, 95)";
    assert!(holds("19 < distance(b) < 21 and near(self, b, 21)", around));
}

#[test]
fn what_is_lost_is_near_nothing() {
    let text = "entity A {
            ref b: B
            mode m { when near(b, self, 1000) -> n; when not near(self, b, 1000) -> o }
            mode n { }
            mode o { }
        }
        entity B { }
        world W { space main { place a: A at (0, 0) } goal seen: a in o }";
    assert_eq!(after(text, "-"), ["seen"]);
}
