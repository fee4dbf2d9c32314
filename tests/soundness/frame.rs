//! The frame of reference in which a world is written: the same world can be written mirrored, or somewhere else. Every
//! coordinate that a program reads or writes goes through here.

/// How the coordinates of a world are transformed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Frame {
    /// Whether the world is mirrored; the map stays where it is.
    pub is_mirrored: bool,
    /// Number of tiles by which everything is moved to the right, and up.
    pub tiles: (u32, u32),
}

/// A frame with the numbers of a world: `x` is written as `sign * x + offset`.
#[derive(Debug, Clone, Copy)]
pub struct Axes {
    sign: i8,
    offset: [f64; 2],
}

impl Axes {
    /// The frame for maps of a width, with tiles of a size.
    pub fn new(frame: Frame, width: f64, tile: f64) -> Self {
        let (right, up) = frame.tiles;
        let sign = if frame.is_mirrored { -1 } else { 1 };
        let own = if frame.is_mirrored { width } else { 0.0 };
        Axes { sign, offset: [own + f64::from(right) * tile, f64::from(up) * tile] }
    }

    /// Whether all is written as it is.
    pub fn is_own(self) -> bool {
        self.sign > 0 && self.offset == [0.0; 2]
    }

    fn of(self, variable: &str) -> Option<(i8, f64)> {
        match variable.trim_end_matches('\'') {
            "x" => Some((self.sign, self.offset[0])),
            "y" => Some((1, self.offset[1])),
            _ => None,
        }
    }

    /// The text that reads a variable of an instance, such as `x'` of `friend.`; of the own one if the prefix is empty.
    pub fn read(self, of: &str, variable: &str) -> String {
        let is_derivative = variable.contains('\'');
        match self.of(variable) {
            None | Some((1, 0.0)) => format!("{of}{variable}"),
            Some((1, _)) if is_derivative => format!("{of}{variable}"),
            Some((1, offset)) => format!("({of}{variable} - {offset})"),
            Some(_) if is_derivative => format!("(-{of}{variable})"),
            Some((_, offset)) => format!("({offset} - {of}{variable})"),
        }
    }

    /// The value to which a variable is set.
    pub fn write(self, variable: &str, value: &str) -> String {
        let is_derivative = variable.contains('\'');
        match self.of(variable) {
            None | Some((1, 0.0)) => value.to_string(),
            Some((1, _)) if is_derivative => value.to_string(),
            Some((1, offset)) => format!("({value}) + {offset}"),
            Some(_) if is_derivative => format!("-({value})"),
            Some((_, offset)) => format!("{offset} - ({value})"),
        }
    }

    /// A level of an envelope that drives a variable; never of a position.
    pub fn level(self, variable: &str, value: &str) -> String {
        if self.is_flipped(variable) { format!("-({value})") } else { value.to_string() }
    }

    /// Whether a variable changes its sign.
    pub fn is_flipped(self, variable: &str) -> bool {
        self.of(variable).is_some_and(|(sign, _)| sign < 0)
    }

    /// An axis of the player.
    pub fn axis(self, axis: &str) -> String {
        if self.sign < 0 && axis == "horizontal" { "(-horizontal)".into() } else { axis.into() }
    }

    /// A side of a contact.
    pub fn side(self, side: &'static str) -> &'static str {
        match (self.sign < 0, side) {
            (true, "left") => "right",
            (true, "right") => "left",
            _ => side,
        }
    }

    /// A point of a space.
    pub fn point(self, x: f64, y: f64) -> String {
        let x = f64::from(self.sign) * x + self.offset[0];
        format!("({}, {})", number(x), number(y + self.offset[1]))
    }

    /// A rectangle of a space.
    pub fn rect(self, [x, y, width, height]: [f64; 4]) -> String {
        let left = if self.sign < 0 { -x - width } else { x } + self.offset[0];
        format!("({}, {}, {}, {})", number(left), number(y + self.offset[1]), number(width), number(height))
    }

    /// The first corner of a rectangle, or the centre of a circle without a width, relative to a position.
    pub fn beside(self, x: &str, width: &str) -> String {
        match (self.sign < 0, width) {
            (false, _) => x.to_string(),
            (true, "") => format!("-({x})"),
            (true, _) => format!("-({x}) - ({width})"),
        }
    }

    /// A row of a map.
    pub fn row(self, row: &str, tiles: (u32, u32)) -> String {
        let own: String = if self.sign < 0 { row.chars().rev().collect() } else { row.to_string() };
        ".".repeat(tiles.0 as usize) + &own
    }
}

/// A number in the language's syntax.
pub fn number(x: f64) -> String {
    if x < 0.0 { format!("-{}", -x) } else { format!("{}", x.abs()) }
}
