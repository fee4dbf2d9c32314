//! The parts of a goal in a state, in words.

use crate::ir::{Expr, ExprId, SlotId, Subject};
use crate::sim::Simulator;
use crate::source::{SourceMap, code_on_one_line};
use crate::why::place;

use super::approach::Approach;
use super::lack::{Atom, Gauge, Term};
use super::record::PartState;
use super::unit::Unit;

/// A number as people read it: the smaller, the more digits.
pub(super) fn shown(number: f64) -> String {
    let text = match number.abs() {
        100.0.. => format!("{number:.0}"),
        10.0.. => format!("{number:.1}"),
        _ => format!("{number:.2}"),
    };
    if !text.contains('.') {
        return text;
    }
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

/// A distance with its unit.
pub(super) fn distance_words(distance: f64, unit: &str) -> String {
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    if distance > 0.0 && distance < 0.005 {
        return format!("less than 0.01{unit}");
    }
    format!("{}{unit}", shown(distance))
}

/// Describes parts of a goal.
pub(super) struct Describer<'a> {
    pub sim: &'a Simulator,
    pub sources: &'a SourceMap,
}

impl Describer<'_> {
    /// The text of an expression on one line, without comments.
    pub fn text(&self, id: ExprId) -> String {
        let span = self.sim.program().spans.exprs[id];
        if !self.sources.holds(span) {
            return String::new();
        }
        code_on_one_line(self.sources.slice(span))
    }

    /// A part of a goal in a state; `id` is the expression that it was made of.
    pub fn part(&self, id: ExprId, term: &Term, state: &[u8]) -> PartState {
        let (text, part) = (self.text(id), self.term(term, state));
        let words = part.words.strip_prefix(&format!("`{text}` ")).unwrap_or(&part.words).to_string();
        PartState { text, words, ..part }
    }

    fn term(&self, term: &Term, state: &[u8]) -> PartState {
        let alive = |slot| self.sim.world().layout.slots[slot].alive(state);
        match term {
            Term::Atom(atom) => self.atom(atom, state),
            Term::While(slot, inner) if alive(*slot) => self.term(inner, state),
            Term::While(slot, _) => {
                let words = format!("`{}` is gone", self.sim.world().slots[*slot].name);
                PartState { text: String::new(), holds: false, distance: None, unit: String::new(), words }
            }
            Term::Unless(slot, inner) if alive(*slot) => self.term(inner, state),
            Term::Unless(..) => holds(String::new(), Unit::NONE),
            Term::All(terms) => {
                let parts: Vec<PartState> = terms.iter().map(|term| self.term(term, state)).collect();
                let count = parts.len();
                let mut missing: Vec<PartState> = parts.into_iter().filter(|part| !part.holds).collect();
                match missing.len() {
                    0 => holds(String::new(), Unit::NONE),
                    1 => inner(missing.swap_remove(0)),
                    several => PartState {
                        text: String::new(),
                        holds: false,
                        distance: None,
                        unit: String::new(),
                        words: format!("{several} of {count} conditions are missing"),
                    },
                }
            }
            Term::Any(terms) => {
                let cost = |term: &&Term| term.cost(self.sim, state, f64::INFINITY);
                let least = terms.iter().min_by(|a, b| cost(a).total_cmp(&cost(b)));
                least.map_or(holds(String::new(), Unit::NONE), |term| inner(self.term(term, state)))
            }
        }
    }

    fn atom(&self, atom: &Atom, state: &[u8]) -> PartState {
        let lack = atom.lack(self.sim, state, f64::INFINITY);
        let not = if atom.wanted { "" } else { "not " };
        let text = format!("{not}{}", self.text(atom.id));
        if lack.holds {
            return holds(text, atom.unit);
        }
        let distance = lack.distance.filter(|distance| distance.is_finite());
        let misses = |distance: f64| format!("misses by {}", distance_words(distance, &atom.unit.name()));
        let words = match (&atom.gauge, distance) {
            (Gauge::Numbers(.., Some(approach)), Some(distance)) => {
                let misses = if distance == 0.0 { "is at the limit".to_string() } else { misses(distance) };
                format!("{misses}{}", self.next_edge(approach, state))
            }
            (Gauge::Var(..) | Gauge::Numbers(..), Some(0.0)) => "is at the limit and has to be beyond it".to_string(),
            (Gauge::Var(..) | Gauge::Numbers(..), Some(distance)) if atom.unit.is_time() => {
                let steps = (distance / self.sim.world().step.seconds()).round();
                format!("{} ({steps} step{})", misses(distance), if steps == 1.0 { "" } else { "s" })
            }
            (Gauge::Contact(_), Some(0.0)) => "is there, but does not touch it like that".to_string(),
            (Gauge::Circle(..), Some(distance)) if !atom.wanted => {
                format!("is {} too near", distance_words(distance, &atom.unit.name()))
            }
            (Gauge::Room(slot, _), distance) => {
                let is_in = self.is_in_room(*slot, state);
                distance.map_or(format!("does not hold: {is_in}"), |rooms| format!("{}: {is_in}", rooms_away(rooms)))
            }
            (Gauge::Mode(asked, approach), edges) => {
                let instance = self.sim.instance(state, approach.slot);
                let modes = &instance.entity().modes;
                let mode = instance.entity().leaves[instance.leaf(modes[*asked].group)].mode;
                let is_in = format!("is in `{}`", modes[mode].path);
                match edges {
                    None => format!("{is_in}, from where no edge leads there"),
                    Some(1.0) => is_in,
                    Some(edges) => format!("{is_in}, {edges} edges away"),
                }
            }
            (Gauge::Contact(contact), None) if !contact.is_in_room(self.sim, state) => {
                let slot = contact.slot();
                match contact.rooms_away(self.sim.space(state, slot)) {
                    Some(rooms) => format!("{}: {}", rooms_away(rooms.into()), self.is_in_room(slot, state)),
                    None => "has nothing to touch".to_string(),
                }
            }
            (Gauge::Contact(contact), None) if !contact.has_body(self.sim, state) => {
                "the body that would touch it is not there".to_string()
            }
            (Gauge::Truth | Gauge::Value(_), _) => self.value(atom, state).unwrap_or("does not hold".to_string()),
            (_, Some(distance)) => misses(distance),
            (_, None) => "does not hold".to_string(),
        };
        PartState { text, holds: false, distance, unit: atom.unit.name(), words }
    }

    /// The edge that has to be taken next, and what its guard lacks: `` (edge at hero.hyped:35: `touching(body, key)` misses
    /// by 12 px)``; empty if there is none.
    fn next_edge(&self, approach: &Approach, state: &[u8]) -> String {
        let Some((edge, guard)) = approach.nearest(self.sim, state) else { return String::new() };
        let entity = self.sim.world().slots[approach.slot].entity;
        let span = self.sim.program().spans.entities[entity].edges[edge];
        if !self.sources.holds(span) {
            return String::new();
        }
        let parts = guard.iter().map(|term| self.term(term, state));
        let missing: Vec<String> = parts.filter(|part| !part.holds).map(|part| part.phrase()).collect();
        let missing = if missing.is_empty() { String::new() } else { format!(": {}", missing.join(" and ")) };
        format!(" (edge at {}{missing})", place(self.sources, span))
    }

    /// `hero` is in `hall`
    fn is_in_room(&self, slot: SlotId, state: &[u8]) -> String {
        let world = self.sim.world();
        format!("`{}` is in `{}`", world.slots[slot].name, world.spaces[self.sim.space(state, slot)].name)
    }

    /// What a named value is, where it is compared.
    fn value(&self, atom: &Atom, state: &[u8]) -> Option<String> {
        let exprs = &self.sim.program().exprs;
        let named = |id: ExprId| match exprs[id] {
            Expr::Discrete(Subject::Slot(slot), discrete) => Some((slot, discrete)),
            _ => None,
        };
        let (slot, discrete) = match exprs[atom.id] {
            Expr::Compare(_, a, b) => named(a).or(named(b))?,
            _ => named(atom.id)?,
        };
        let instance = self.sim.instance(state, slot);
        let discrete_of = &instance.entity().discretes[discrete];
        Some(format!("is `{}`", discrete_of.domain.text(instance.discrete(discrete))))
    }
}

fn rooms_away(rooms: f64) -> String {
    if rooms == 1.0 { "misses by a room".to_string() } else { format!("misses by {rooms} rooms") }
}

/// A part that holds.
pub(super) fn holds(text: String, unit: Unit) -> PartState {
    PartState { text, holds: true, distance: Some(0.0), unit: unit.name(), words: "holds".to_string() }
}

/// A part of a part, which the text around it does not name.
fn inner(mut part: PartState) -> PartState {
    if !part.text.is_empty() && !part.holds {
        part.words = format!("`{}` {}", part.text, part.words);
        part.text = String::new();
    }
    part
}
