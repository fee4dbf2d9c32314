//! Probes, `touching(body at (16, 0), wall)`: which places count as taken, when they are looked at, and whom they name.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use crate::support::goals_after as after;

/// Whether a probe of an `A`, placed at a point with a body of 16 by 16, finds something in a space.
fn finds(probe: &str, at: (f64, f64), items: &str) -> bool {
    let (x, y) = at;
    let text = format!(
        "entity A {{
             collider body: rect(0, 0, 16, 16)
             collider far: rect(100, 0, 4, 4)
             collider disc: circle(8, 8, 8)
             collider gone: rect(0, 0, 16, 16) when in seen
             mode still {{ when {probe} -> seen }}
             mode seen {{ }}
         }}
         entity B {{
             param up: 1 = 1
             collider b: rect(0, 0, 16, 16) when up > 0
         }}
         entity Ball {{ collider ball: circle(0, 0, 8) }}
         world W {{
             tiles t 16 x 16 {{ '.': empty; '#': wall; 'o': spot }}
             space main {{ {items}
                 place a: A at ({x}, {y}) }}
             space other {{ rect elsewhere (0, 0, 99, 99) }}
             goal seen: a in seen
         }}"
    );
    after(&text, "-") == ["seen"]
}

const MAP: &str = "map t \"
    ...
    .#.
    ...
    \"
    ";

#[test]
fn a_place_beside_is_not_taken() {
    // The wall is at (16, 16), as large as the body.
    assert!(finds("touching(body at (16, 0), wall)", (0.0, 16.0), MAP));
    assert!(!finds("touching(body at (0, 0), wall)", (0.0, 16.0), MAP), "it lies against it");
    assert!(!finds("touching(body at (32, 0), wall)", (0.0, 16.0), MAP));
    assert!(!finds("touching(body at (16, 16), wall)", (0.0, 16.0), MAP));
    assert!(!finds("touching(body at (0.0009, 0), wall)", (0.0, 16.0), MAP), "not deeper than the tolerance");
    assert!(finds("touching(body at (0.0011, 0), wall)", (0.0, 16.0), MAP));
    assert!(!finds("touching(body at (0.5, -16), wall)", (0.0, 16.0), MAP), "a corner beside a corner");
    assert!(finds("touching(body at (0.5, -15.9), wall)", (0.0, 16.0), MAP));
    assert!(finds("touching(far at (-84, 0), wall)", (0.0, 16.0), MAP), "its other collider");
    assert!(!finds("touching(body at (-1000, 0), wall)", (0.0, 16.0), MAP), "beyond the map there is nothing");
    assert!(!finds("touching(body at (16, 0), spot)", (0.0, 16.0), MAP));
}

#[test]
fn rectangles_and_instances_of_the_same_space_count() {
    let rect = "rect post (40, 0, 2, 2)";
    assert!(finds("touching(body at (25, 0), post)", (0.0, 0.0), rect));
    assert!(!finds("touching(body at (24, 0), post)", (0.0, 0.0), rect));
    assert!(!finds("touching(body at (0, 0), elsewhere)", (0.0, 0.0), rect), "that is in the other space");
    let others = "place b: B at (32, 0)";
    assert!(finds("touching(body at (32, 0), b)", (0.0, 0.0), others));
    assert!(!finds("touching(body at (16, 0), b)", (0.0, 0.0), others));
    assert!(!finds("touching(body at (32, 0), b)", (0.0, 0.0), "place b: B at (32, 0) { up = 0 }"));
    assert!(!finds("touching(body at (0, 0), body)", (0.0, 0.0), others), "nobody meets itself");
    assert!(!finds("touching(body at (0, 0), far)", (0.0, 0.0), others));
    assert!(!finds("touching(gone at (32, 0), b)", (0.0, 0.0), others), "a collider that is not there");
}

#[test]
fn circles_are_discs() {
    let ball = "place ball: Ball at (40, 24)";
    // The corner of the square around the ball is at (32, 16).
    assert!(!finds("touching(body at (17, 1), ball)", (0.0, 0.0), ball));
    assert!(finds("touching(body at (20, 4), ball)", (0.0, 0.0), ball));
    assert!(!finds("touching(disc at (20, 4), ball)", (0.0, 0.0), ball));
    assert!(finds("touching(disc at (22, 8), ball)", (0.0, 0.0), ball));
    assert!(!finds("touching(disc at (1, 1), wall)", (0.0, 0.0), MAP));
    assert!(finds("touching(disc at (9, 9), wall)", (0.0, 0.0), MAP));
}

#[test]
fn guards_see_the_state_before_and_flows_the_one_after_the_edges() {
    let text = "entity A {
         param cell: px = 16
         collider body: rect(0, 0, 16, 16)
         discrete n: int 0..9 = 0
         continuous seen = 0
         seen' = if(touching(body at (cell, 0), body), 10, 0)
         mode only { when touching(body at (cell, 0), body) and n < 9 { n += 1 } }
     }
     entity B {
         collider body: rect(0, 0, 16, 16)
         mode away { when timer >= 2frames -> here { x := 16 } }
         mode here { when timer >= 1frames { destroy self } }
     }
     world W {
         step 1/10
         space main { place a: A at (0, 0); place b: B at (64, 0) }
         goal flow: a.seen > 0.5
         goal twice: a.seen > 1.5
         goal guard: a.n == 1
         goal gone: not any B
     }";
    assert!(after(text, "-*2").is_empty());
    assert_eq!(after(text, "-*3"), ["flow"], "the guard was asked before the update");
    // In the fourth step the guard sees it; it is destroyed, so the flow does not.
    assert_eq!(after(text, "-*4"), ["flow", "guard", "gone"]);
    assert_eq!(after(text, "-*6"), ["flow", "guard", "gone"]);
}

#[test]
fn a_probe_names_the_first_instance_by_its_slot_and_no_wall() {
    let text = "entity A {
         ref who: B
         collider body: rect(0, 0, 16, 16)
         mode only {
             when touching(body at (0, 16), b) as c and c is B -> done { x := c.x; who := c; destroy c }
         }
         mode done { }
     }
     entity B { collider b: rect(0, 0, 16, 16) }
     world W {
         space main {
             rect b (-8, 16, 32, 16)
             place late: B at (99, 99)
             place right: B at (8, 16)
             place left: B at (-8, 16)
             place a: A at (0, 0) { who = late }
         }
         goal right: a.x == 8
         goal left: a.x == -8
         goal rest: count(B) == 2
     }";
    assert_eq!(after(text, "-"), ["right", "rest"]);
    let alone = text.replace("place right: B at (8, 16)", "").replace("place left: B at (-8, 16)", "");
    assert!(after(&alone, "-").is_empty(), "a rectangle has no name");
}
