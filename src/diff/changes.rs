//! The parts that differ between two outlines. Parts are paired by kind and name, whatever their order; what lost its
//! name, but not its contents, was renamed.

use serde::Serialize;

use super::outline::Part;

/// How a part changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum ChangeKind {
    /// It says something else.
    Changed,
    /// Only the new program has it.
    Added,
    /// Only the old program has it.
    Removed,
    /// It says the same under another name.
    Renamed,
    /// Its edges are the same, and are tried in another order.
    Reordered,
}

/// A part that differs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Change {
    /// How it changed.
    pub change: ChangeKind,
    /// What it is: `param`, `mode`, `edge`.
    pub what: &'static str,
    /// Its name with those of the parts around it; in the old program if it has one there.
    pub name: String,
    /// What it said, or its old name; null if it was not there.
    pub old: Option<String>,
    /// What it says, or its new name; null if it is not there.
    pub new: Option<String>,
    /// Its line in the new program; in the old one if it was removed.
    pub place: String,
}

/// The parts that differ, in the order of the old program; what was added comes last in the part around it.
pub fn changes(old: &[Part], new: &[Part]) -> Vec<Change> {
    let mut found = Vec::new();
    compare(&Path::default(), old, new, &mut found);
    found
}

/// Where parts are.
#[derive(Debug, Clone, Default)]
struct Path(String);

impl Path {
    /// The name of a part there: `Hero.air.rising`, `Hero.air -> rising`, `Valley.main map`.
    fn of(&self, part: &Part) -> String {
        let is_word = part.name.chars().all(|c| c.is_alphanumeric() || c == '_') && !part.name.is_empty();
        match (self.0.is_empty(), is_word) {
            (true, _) => part.name.clone(),
            (false, true) => format!("{}.{}", self.0, part.name),
            (false, false) if part.name.is_empty() => self.0.clone(),
            (false, false) => format!("{} {}", self.0, part.name),
        }
    }
}

fn compare(at: &Path, old: &[Part], new: &[Part], found: &mut Vec<Change>) {
    let partners = pair(old, new);
    let mut is_paired = vec![false; new.len()];
    partners.iter().flatten().for_each(|partner| is_paired[*partner] = true);
    let is_reordered = old.len() == new.len() && {
        let of = |parts: &[Part], index: usize| parts[index].kind == "edge";
        let edges = partners.iter().enumerate().filter(|(index, _)| of(old, *index));
        let order: Option<Vec<usize>> = edges.map(|(_, partner)| *partner).collect();
        order.is_some_and(|order| order.windows(2).any(|pair| pair[0] > pair[1]))
    };
    for (part, partner) in old.iter().zip(&partners) {
        match partner {
            Some(partner) => compare_one(at, part, &new[*partner], found),
            None => found.push(change(ChangeKind::Removed, at, part, (said(part), None), part)),
        }
    }
    for (part, _) in new.iter().zip(&is_paired).filter(|(_, is_paired)| !**is_paired) {
        found.push(change(ChangeKind::Added, at, part, (None, said(part)), part));
    }
    if let (true, Some(first)) = (is_reordered, new.iter().find(|part| part.kind == "edge")) {
        let name = at.0.clone();
        let place = first.place.clone();
        let what = "edge";
        found.push(Change { change: ChangeKind::Reordered, what, name, old: None, new: None, place });
    }
}

/// What a part says; nothing if its name says it all.
fn said(part: &Part) -> Option<String> {
    (!part.text.is_empty()).then(|| part.text.clone())
}

fn change(
    change: ChangeKind,
    at: &Path,
    part: &Part,
    (old, new): (Option<String>, Option<String>),
    there: &Part,
) -> Change {
    Change { change, what: part.kind, name: at.of(part), old, new, place: there.place.clone() }
}

fn compare_one(at: &Path, old: &Part, new: &Part, found: &mut Vec<Change>) {
    if old.name != new.name {
        let names = (Some(old.name.clone()), Some(new.name.clone()));
        found.push(change(ChangeKind::Renamed, at, old, names, new));
    }
    if old.text != new.text {
        let said = |part: &Part| Some(part.text.clone());
        found.push(change(ChangeKind::Changed, at, old, (said(old), said(new)), new));
    }
    compare(&Path(at.of(old)), &old.parts, &new.parts, found);
}

/// The partner of each old part among the new ones: the same kind and name; of several the one that says the same, or
/// else the next one. What has no partner then is paired with what says the same, or almost the same, under a name that
/// was not there.
fn pair(old: &[Part], new: &[Part]) -> Vec<Option<usize>> {
    let mut partners: Vec<Option<usize>> = vec![None; old.len()];
    let mut is_taken = vec![false; new.len()];
    let mut round = |is_partner: &dyn Fn(&Part, &Part) -> bool| {
        for (part, partner) in old.iter().zip(&mut partners).filter(|(_, partner)| partner.is_none()) {
            *partner = new.iter().zip(&is_taken).position(|(other, is_taken)| !is_taken && is_partner(part, other));
            partner.iter().for_each(|index| is_taken[*index] = true);
        }
    };
    round(&Part::is_same);
    round(&|part, other| (part.kind, &part.name) == (other.kind, &other.name));
    let is_new = |other: &Part| !old.iter().any(|part| (part.kind, &part.name) == (other.kind, &other.name));
    let can_be = |part: &Part, other: &Part| part.kind == other.kind && is_label(part) && is_new(other);
    round(&|part, other| can_be(part, other) && part.says_the_same(other));
    round(&|part, other| can_be(part, other) && is_alike(part, other));
    partners
}

/// Whether a name is but a label of what a part says: two numbers of the same value are not the same number.
fn is_label(part: &Part) -> bool {
    !part.parts.is_empty() || ["goal", "never", "condition", "place"].contains(&part.kind)
}

/// Whether most of the parts inside say the same.
fn is_alike(part: &Part, other: &Part) -> bool {
    let same = part.parts.iter().filter(|mine| other.parts.iter().any(|of| of.is_same(mine))).count();
    2 * same > part.parts.len().max(other.parts.len())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(kind: &'static str, name: &str, text: &str, parts: Vec<Part>) -> Part {
        Part { kind, name: name.into(), text: text.into(), place: "a:1".into(), parts }
    }

    fn texts(old: &[Part], new: &[Part]) -> Vec<String> {
        let text = |c: &Change| format!("{:?} {} {} {:?} {:?}", c.change, c.what, c.name, c.old, c.new);
        changes(old, new).iter().map(text).collect()
    }

    #[test]
    fn parts_are_paired_by_name_and_by_what_they_say() {
        let edge = |name, text| part("edge", name, text, Vec::new());
        let hero = |speed, edges| {
            let mode = part("mode", "air", "", edges);
            part("entity", "Hero", "", vec![part("param", "speed", speed, Vec::new()), mode])
        };
        let old = [hero("1", vec![edge("-> a", "when x"), edge("-> a", "when y"), edge("-> b", "when z")])];
        assert!(texts(&old, &old).is_empty());
        let new = [hero("2", vec![edge("-> a", "when y"), edge("-> b", "when z")])];
        assert_eq!(
            texts(&old, &new),
            [r#"Changed param Hero.speed Some("1") Some("2")"#, r#"Removed edge Hero.air -> a Some("when x") None"#]
        );
        let new = [hero("1", vec![edge("-> b", "when z"), edge("-> a", "when x"), edge("-> a", "when y")])];
        assert_eq!(texts(&old, &new), ["Reordered edge Hero.air None None"]);
        let renamed = [Part { name: "Knight".into(), ..old[0].clone() }];
        let hero_to_knight = r#"Renamed entity Hero Some("Hero") Some("Knight")"#;
        assert_eq!(texts(&old, &renamed), [hero_to_knight]);
        // Renamed and changed, if most of it is as it was.
        let number = |name: &str, text: &str| part("param", name, text, Vec::new());
        let three =
            |name: &str, last| [part("entity", name, "", vec![number("a", "1"), number("b", "2"), number("c", last)])];
        assert_eq!(
            texts(&three("Hero", "3"), &three("Knight", "4")),
            [hero_to_knight, r#"Changed param Hero.c Some("3") Some("4")"#]
        );
        // Two numbers of the same value are two numbers.
        assert_eq!(
            texts(&[number("a", "16")], &[number("b", "16")]),
            [r#"Removed param a Some("16") None"#, r#"Added param b None Some("16")"#]
        );
    }
}
