//! The signatures of the functions and of the atoms of guards, with a sentence each.

/// A signature of a function.
#[derive(Debug, Clone, Copy)]
pub struct Signature {
    /// The function.
    pub name: &'static str,
    /// What it is called with.
    pub parameters: &'static [&'static str],
    /// What it gives.
    pub doc: &'static str,
}

impl Signature {
    /// The call as it is written, and what it gives: `` `abs(a)`: The size of a number… ``.
    pub fn line(&self) -> String {
        format!("`{}({})`: {}", self.name, self.parameters.join(", "), self.doc)
    }
}

/// The signatures of all functions; overloads of a function are adjacent.
pub const SIGNATURES: &[Signature] = &[
    Signature { name: "min", parameters: &["a", "b"], doc: "The smaller of two numbers." },
    Signature { name: "max", parameters: &["a", "b"], doc: "The larger of two numbers." },
    Signature { name: "abs", parameters: &["a"], doc: "The size of a number, without its sign." },
    Signature { name: "sign", parameters: &["a"], doc: "-1, 0 or 1." },
    Signature { name: "clamp", parameters: &["value", "low", "high"], doc: "The nearest number between two." },
    Signature { name: "floor", parameters: &["a"], doc: "The next whole number below." },
    Signature { name: "ceil", parameters: &["a"], doc: "The next whole number above." },
    Signature { name: "round", parameters: &["a"], doc: "The nearest whole number, half away from zero." },
    Signature { name: "sqrt", parameters: &["a"], doc: "The square root; of a negative number it stops the step." },
    Signature { name: "sin", parameters: &["angle"], doc: "The sine of an angle in radians." },
    Signature { name: "cos", parameters: &["angle"], doc: "The cosine of an angle in radians." },
    Signature { name: "atan2", parameters: &["y", "x"], doc: "The angle of a direction, in radians." },
    Signature {
        name: "mod",
        parameters: &["a", "b"],
        doc: "`a` less the whole multiple of `b` below it: from 0 to before `b`.",
    },
    Signature { name: "if", parameters: &["condition", "a", "b"], doc: "`a` if the condition holds, else `b`." },
    Signature { name: "pressed", parameters: &["button"], doc: "The button went down at this step." },
    Signature { name: "held", parameters: &["button"], doc: "The button is down." },
    Signature { name: "released", parameters: &["button"], doc: "The button went up at this step." },
    Signature { name: "touching", parameters: &["tag"], doc: "A collider touches something with the tag." },
    Signature {
        name: "touching",
        parameters: &["tag", "side"],
        doc: "On a side of this instance's collider: `left`, `right`, `above` or `below`.",
    },
    Signature {
        name: "touching",
        parameters: &["own tag", "tag"],
        doc: "Only colliders of this instance with this tag.",
    },
    Signature { name: "touching", parameters: &["own tag", "tag", "side"], doc: "Only on one of its sides." },
    Signature {
        name: "touching",
        parameters: &["own tag at (x, y)", "tag"],
        doc: "Whether a place is taken: this instance's collider, moved by (x, y), would overlap something with the tag.",
    },
    Signature {
        name: "timer",
        parameters: &["mode"],
        doc: "Seconds since the mode was entered; 0 while it is not active.",
    },
    Signature { name: "entering", parameters: &["mode"], doc: "A mode of another group is entered in this step." },
    Signature { name: "exiting", parameters: &["mode"], doc: "A mode of another group is left in this step." },
    Signature {
        name: "received",
        parameters: &["signal"],
        doc: "The signal was sent to this instance in the step before; in guards and updates of edges.",
    },
    Signature { name: "lost", parameters: &["reference"], doc: "The reference is `none`." },
    Signature {
        name: "near",
        parameters: &["instance", "(x, y)", "radius"],
        doc: "The distance of the instance to a point, or to another instance, is at most the radius; px.",
    },
    Signature {
        name: "distance",
        parameters: &["reference"],
        doc: "The distance of this instance to another one, or to a point `(x, y)`; px.",
    },
    Signature { name: "distance", parameters: &["instance", "(x, y)"], doc: "The distance of another instance." },
    Signature {
        name: "count",
        parameters: &["entity"],
        doc: "The number of living instances of an entity; with `in MODE` or `touching TAG`, of those for which that \
              holds.",
    },
    Signature {
        name: "count",
        parameters: &["tag"],
        doc: "The number of tiles with a tag that are there, in all spaces of the world.",
    },
    Signature { name: "inside", parameters: &["instance", "space"], doc: "The instance is in the space." },
    Signature {
        name: "rect",
        parameters: &["x", "y", "width", "height"],
        doc: "A rectangle: its lower-left corner, relative to the position, and its sides; px.",
    },
    Signature {
        name: "circle",
        parameters: &["x", "y", "radius"],
        doc: "A circle: its centre, relative to the position, and its radius; px.",
    },
];
