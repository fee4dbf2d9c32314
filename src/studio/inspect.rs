//! What is known about an instance in a frame: its modes and values, and of each edge that was considered in the step
//! before, whether its guard held, part by part.

use crate::ir::{Domain, Expr, ExprId, Id, ModeId, Program, Side, SlotId, VarId};
use crate::sim::{Inspection, Instance};
use crate::source::SourceMap;

use super::history::History;
use super::project::place;
use super::protocol::{Atom, Contact, EdgeState, Inspected, Value};

/// Maximum number of parts of a guard that are shown.
const MAX_ATOMS: usize = 32;

/// What is known about the instance of a slot in the current frame of a history.
pub(super) fn inspect(history: &History, sources: &SourceMap, slot: SlotId) -> Inspected {
    let sim = history.sim();
    let instance = sim.instance(history.state(), slot);
    let is_alive = instance.is_alive();
    let entity = instance.entity();
    let modes = entity.modes.ids().filter(|mode| instance.is_in(*mode)).map(Id::index);
    Inspected {
        slot: slot.0,
        is_alive,
        modes: modes.collect(),
        values: if is_alive { values(instance) } else { Vec::new() },
        contacts: contacts(sim.program(), sources, instance),
        edges: edges(history, sources, slot),
    }
}

fn value(kind: &str, name: impl Into<String>, value: impl Into<String>) -> Value {
    Value { kind: kind.to_string(), name: name.into(), value: value.into() }
}

/// A number as people read it: at most four digits after the point.
fn shown(number: f64) -> String {
    let text = format!("{number:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}

fn values(instance: Instance<'_>) -> Vec<Value> {
    let entity = instance.entity();
    let mut all = Vec::new();
    for var in entity.vars.ids() {
        for degree in 0..=2 {
            let number = instance.var(var, degree);
            // Positions are always of interest, derivatives where there are any.
            if degree < 2 && var.index() < VarId::XY.len() || degree == 0 || number != 0.0 {
                all.push(value("variable", entity.variable_text(var, degree), shown(number)));
            }
        }
    }
    for (id, discrete) in entity.discretes.pairs() {
        let number = instance.discrete(id);
        let text = match &discrete.domain {
            Domain::Set(_) => instance.discrete_name(id).unwrap_or_default().to_string(),
            Domain::Bool => (number != 0).to_string(),
            Domain::Int => number.to_string(),
        };
        all.push(value("discrete", &discrete.name, text));
    }
    for (id, reference) in entity.refs.pairs() {
        let target = instance.reference(id).map_or("none", |target| target.name());
        all.push(value("reference", &reference.name, target));
    }
    for timer in entity.timers.iter() {
        if instance.is_in(timer.mode) {
            let seconds = instance.time_in(timer.mode).unwrap_or_default();
            all.push(value("timer", &entity.modes[timer.mode].path, format!("{} s", shown(seconds))));
        }
    }
    for (id, param) in entity.params.pairs() {
        all.push(value("parameter", &param.name, shown(instance.param(id))));
    }
    all
}

/// The contact queries that hold.
fn contacts(program: &Program, sources: &SourceMap, instance: Instance<'_>) -> Vec<Contact> {
    if !instance.is_alive() {
        return Vec::new();
    }
    let entity = instance.entity();
    let Some(id) = program.entity_named(&entity.name) else { return Vec::new() };
    let spans = &program.spans.entities[id].touches;
    let side = |side: Side| match side {
        Side::Left => "left",
        Side::Right => "right",
        Side::Above => "above",
        Side::Below => "below",
    };
    let contact = |touch| {
        let text = on_one_line(sources.slice(*spans.get(touch)?));
        let side = entity.touches.get(touch)?.side.map(|of| side(of).to_string());
        Some(Contact { text, side })
    };
    instance.contacts().filter_map(contact).collect()
}

fn on_one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The edges that were considered in the step that led to the current frame.
fn edges(history: &History, sources: &SourceMap, slot: SlotId) -> Vec<EdgeState> {
    let Some((state, input)) = history.last_step() else { return Vec::new() };
    let (sim, program) = (history.sim(), history.sim().program());
    let before = sim.instance(state, slot);
    let Some(id) = program.entity_named(&before.entity().name).filter(|_| before.is_alive()) else {
        return Vec::new();
    };
    let entity = &program.entities[id];
    let step = Inspection::new(sim, state, &input);
    let guards = Guards { program, sources, step: &step, slot };
    let mut all = Vec::new();
    for group in entity.groups.ids() {
        let leaf = &entity.leaves[before.leaf(group)];
        // The first edge with a target whose guard holds is taken.
        let mut is_taken = false;
        for &edge in leaf.edges.iter().chain(&leaf.internal) {
            let of = &entity.edges[edge];
            let held = guards.truth(of.guard).unwrap_or(false);
            let taken = held && (of.target.is_none() || !is_taken);
            is_taken |= taken && of.target.is_some();
            let span = program.spans.entities[id].edges[edge];
            all.push(EdgeState {
                edge: edge.index(),
                from: of.source.index(),
                to: of.target.map(|mode: ModeId| mode.index()),
                held,
                taken,
                place: sources.holds(span).then(|| place(sources, span)),
                atoms: guards.atoms(of.guard),
            });
        }
    }
    all
}

/// Evaluates guards part by part.
struct Guards<'a> {
    program: &'a Program,
    sources: &'a SourceMap,
    step: &'a Inspection<'a>,
    slot: SlotId,
}

impl Guards<'_> {
    fn truth(&self, id: ExprId) -> Option<bool> {
        self.step.value(self.slot, id).ok().map(|value| value != 0.0)
    }

    /// The parts that `and`, `or` and `not` join.
    fn atoms(&self, guard: ExprId) -> Vec<Atom> {
        let (mut open, mut atoms) = (vec![guard], Vec::new());
        while let Some(id) = open.pop() {
            match self.program.exprs[id] {
                Expr::And(a, b) | Expr::Or(a, b) => open.extend([b, a]),
                Expr::Not(a) if matches!(self.program.exprs[a], Expr::And(..) | Expr::Or(..)) => open.push(a),
                _ if atoms.len() < MAX_ATOMS => atoms.push(self.atom(id)),
                _ => {}
            }
        }
        atoms
    }

    fn atom(&self, id: ExprId) -> Atom {
        let compared = match self.program.exprs[id] {
            Expr::Not(a) => a,
            _ => id,
        };
        let sides = match self.program.exprs[compared] {
            Expr::Compare(_, a, b) => {
                let side = |id| self.step.value(self.slot, id).ok();
                side(a).zip(side(b)).map(|(a, b)| [a, b])
            }
            _ => None,
        };
        let text = on_one_line(self.sources.slice(self.program.spans.exprs[id]));
        Atom { text, held: self.truth(id), sides }
    }
}
