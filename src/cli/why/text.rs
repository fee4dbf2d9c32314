//! The answers of `hypedc why` as text for people.

use crate::analysis::wording::number;
use crate::why::{Atom, AtomSince, EdgeWhy, Nearly, NearlyEdge, Place, Why, Write};

/// Maximum width of a line of values.
const WIDTH: usize = 110;

/// Colours, where they are wanted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Paint(pub bool);

impl Paint {
    fn with(self, code: &str, text: &str) -> String {
        if self.0 { format!("\u{1b}[{code}m{text}\u{1b}[0m") } else { text.to_string() }
    }

    fn yes(self, text: &str) -> String {
        self.with("32", text)
    }

    fn no(self, text: &str) -> String {
        self.with("31", text)
    }

    fn strong(self, text: &str) -> String {
        self.with("1", text)
    }

    fn quiet(self, text: &str) -> String {
        self.with("2", text)
    }
}

fn since(step: u64, at: u64) -> String {
    match step {
        0 => "from the start".to_string(),
        step if step == at => "as of this step".to_string(),
        step => format!("since step {step}"),
    }
}

/// `, FILE:LINE`
fn line(place: Option<&Place>) -> String {
    place.map_or(String::new(), Place::to_string)
}

/// `12.5 and 20`: the sides of a comparison, unless both are written as numbers anyway.
fn sides(atom: &Atom) -> String {
    atom.sides.map_or(String::new(), |[a, b]| format!(": {} and {}", number(a), number(b)))
}

/// Words in lines of limited width under a heading.
fn block(head: &str, words: &[String], separator: &str) -> String {
    let mut out = String::new();
    let mut row = String::new();
    for word in words {
        if !row.is_empty() && row.chars().count() + separator.len() + word.chars().count() > WIDTH - 12 {
            out.push_str(&format!("  {:9} {row}\n", if out.is_empty() { head } else { "" }));
            row.clear();
        }
        if !row.is_empty() {
            row.push_str(separator);
        }
        row.push_str(word);
    }
    if !row.is_empty() {
        out.push_str(&format!("  {:9} {row}\n", if out.is_empty() { head } else { "" }));
    }
    out
}

/// Why an instance did what it did in a step. `starts` are the modes whose edges were asked about, if some were.
pub(super) fn why_text(head: &str, why: &Why, starts: Option<&[String]>, has_rooms: bool, paint: Paint) -> String {
    let place = if has_rooms { format!(", in `{}`", why.space) } else { String::new() };
    let name = paint.strong(&why.instance);
    let mut out = format!("{head}: {name} at step {} ({:.2} s){place}\n", why.step, why.seconds);
    if why.is_alive {
        let modes =
            why.modes.iter().map(|mode| format!("{} ({})", paint.strong(&mode.mode), since(mode.since, why.step)));
        out.push_str(&block("mode", &modes.collect::<Vec<_>>(), ", "));
        let shown = |kind: &str| matches!(kind, "variable" | "discrete" | "reference" | "timer");
        let values = why.values.iter().filter(|value| shown(&value.kind)).map(|value| match value.kind.as_str() {
            "timer" => format!("{} in {}", value.value, value.name),
            _ => format!("{} = {}", value.name, value.value),
        });
        out.push_str(&block("values", &values.collect::<Vec<_>>(), ", "));
    } else {
        out.push_str(&format!("  {} is not there after this step\n", why.instance));
    }
    for (index, touched) in why.contacts.iter().enumerate() {
        let head = if index == 0 { "touches" } else { "" };
        let whom = if touched.whom.is_empty() { String::new() } else { format!(": {}", touched.whom.join(", ")) };
        let since = paint.quiet(&format!("({})", since(touched.since, why.step)));
        out.push_str(&format!("  {head:9} {}{whom} {since}\n", touched.contact.text));
    }
    match (why.step, why.edges.is_empty(), starts) {
        (0, ..) => out.push_str("  edges     none: nothing has happened before the first step\n"),
        (_, true, Some([])) => out.push_str("  edges     no edge leads there: the mode is entered at the start only\n"),
        (_, true, Some(starts)) => {
            let names: Vec<String> = starts.iter().map(|mode| format!("`{mode}`")).collect();
            out.push_str(&format!(
                "  edges     none of them was tried: they belong to {}, which was not active before this step\n",
                names.join(", ")
            ));
        }
        (_, true, None) => out.push_str("  edges     none: the active modes have no edges\n"),
        (_, false, _) => {
            out.push_str("  edges     in the order in which they were tried:\n");
            why.edges.iter().for_each(|edge| out.push_str(&edge_text(edge, why.step, paint)));
        }
    }
    for (index, write) in why.writes.iter().enumerate() {
        let head = if index == 0 { "written" } else { "" };
        out.push_str(&format!("  {head:9} {}\n", write_text(write, paint)));
    }
    out
}

fn write_text(write: &Write, paint: Paint) -> String {
    let by = paint.quiet(&format!("({})", write.by));
    match (&write.what, &write.value) {
        (Some(what), Some(value)) if *value == write.text => format!("{what} := {value} {by}"),
        (Some(what), Some(value)) => format!("{what} := {} = {value} {by}", write.text),
        (Some(what), None) => format!("{what} := {} {by}", write.text),
        (None, Some(value)) => format!("{}, {value} {by}", write.text),
        (None, None) => format!("{} {by}", write.text),
    }
}

fn edge_text(edge: &EdgeWhy, step: u64, paint: Paint) -> String {
    let to = edge.to.as_deref().unwrap_or("(stays)");
    let names = format!("{} -> {to}", edge.from);
    let place = paint.quiet(&line(edge.place.as_ref()));
    if !edge.tried {
        return paint.quiet(&format!("    · {names}: not tried, as an edge before it was taken")) + "\n";
    }
    let (sign, what) = match (edge.taken, edge.held) {
        (true, _) => (paint.yes("✓"), ", taken"),
        (false, true) => (paint.no("×"), ", held but was not taken"),
        (false, false) => (paint.no("×"), ""),
    };
    let mut out = format!("    {sign} {}{what}  {place}\n", paint.strong(&names));
    for AtomSince { atom, since: at } in &edge.atoms {
        let sign = match atom.held {
            Some(true) => paint.yes("✓"),
            Some(false) => paint.no("×"),
            None => "?".to_string(),
        };
        // Before the first step nothing is asked.
        let at = if *at <= 1 && step > 1 { 0 } else { *at };
        let since = paint.quiet(&format!("({})", since(at, step)));
        out.push_str(&format!("        {sign} {}{} {since}\n", atom.text, sides(atom)));
    }
    out
}

/// How near the guards of edges came.
pub(super) fn nearly_text(head: &str, nearly: &Nearly, paint: Paint) -> String {
    let name = paint.strong(&nearly.instance);
    let what = nearly.mode.as_ref().map_or("the edge".to_string(), |mode| format!("`{mode}`"));
    let steps = nearly.steps;
    let verb = if nearly.mode.is_some() { "entered" } else { "took" };
    let mut out = match nearly.entered {
        Some(0) => format!("{head}: {name} is in {what} from the start\n"),
        Some(step) => format!("{head}: {name} {verb} {what} in step {step}\n"),
        None => format!("{head}: {name} never {verb} {what} in {steps} steps\n"),
    };
    if nearly.entered.is_some() {
        if let Some(step) = nearly.entered.filter(|step| *step > 0) {
            out.push_str(&format!("  `--at {step}` without `--not` shows why\n"));
        }
        return out;
    }
    if nearly.edges.is_empty() {
        out.push_str("  no edge leads there: the mode is entered at the start only\n");
    }
    // The nearest one first.
    let mut edges: Vec<&NearlyEdge> = nearly.edges.iter().collect();
    edges.sort_by_key(|edge| (edge.considered == 0, edge.missing.len()));
    for edge in edges {
        let to = edge.to.as_deref().unwrap_or("(stays)");
        let names = paint.strong(&format!("{} -> {to}", edge.from));
        out.push_str(&format!("  {names}  {}\n", paint.quiet(&line(edge.place.as_ref()))));
        let Some(step) = edge.step else {
            out.push_str(&format!("    never tried: {} was never in `{}`\n", nearly.instance, edge.from));
            continue;
        };
        let times = if edge.considered == 1 { "one step".to_string() } else { format!("{} steps", edge.considered) };
        if edge.missing.is_empty() {
            let instead = edge.instead.as_ref().map_or("another edge was taken".to_string(), |other| {
                format!("`{other}` comes before it and was taken")
            });
            out.push_str(&format!("    tried in {times}; its guard held in step {step}, but {instead}\n"));
            continue;
        }
        let parts =
            if edge.missing.len() == 1 { "one part".to_string() } else { format!("{} parts", edge.missing.len()) };
        out.push_str(&format!("    tried in {times}; nearest in step {step}, without {parts} of its guard:\n"));
        for missing in &edge.missing {
            let by = missing.distance.map_or(String::new(), |distance| format!(", {} apart", number(distance)));
            out.push_str(&format!("        {} {}{}{by}\n", paint.no("×"), missing.atom.text, sides(&missing.atom)));
        }
    }
    out
}
