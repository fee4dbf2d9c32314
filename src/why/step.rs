//! What is known about an instance after a step: its modes and values, and of each edge that was considered in the step,
//! whether its guard held, part by part.

use crate::ir::{EdgeId, Entity, Expr, ExprId, Id, ModeId, Program, SlotId, TouchId, Transition, VarId};
use crate::sim::{Input, Inspection, Instance, Simulator};
use crate::source::{SourceMap, Span, on_one_line};

use super::record::{Atom, Contact, EdgeState, Inspected, Place, Value};

/// Maximum number of parts of a guard that are shown.
const MAX_ATOMS: usize = 32;

/// A step of a run, and the state after it.
#[derive(Clone, Copy)]
pub struct Moment<'m> {
    /// The simulator.
    pub sim: &'m Simulator,
    /// The texts of the program.
    pub sources: &'m SourceMap,
    /// The state before the step and its input with all that nature drew; none before the first step.
    pub before: Option<(&'m [u8], &'m Input)>,
    /// The state after it.
    pub after: &'m [u8],
    /// The edges that instances took in the step, if the simulator told; otherwise it is worked out from the guards.
    pub taken: Option<&'m [(SlotId, EdgeId)]>,
}

/// What is known about the instance of a slot.
pub fn inspect(moment: &Moment<'_>, slot: SlotId) -> Inspected {
    let sim = moment.sim;
    let instance = sim.instance(moment.after, slot);
    let is_alive = instance.is_alive();
    let entity = instance.entity();
    let modes = entity.modes.ids().filter(|mode| instance.is_in(*mode)).map(Id::index);
    Inspected {
        slot: slot.0,
        is_alive,
        modes: modes.collect(),
        values: if is_alive { values(instance) } else { Vec::new() },
        contacts: contacts(moment, slot).into_iter().map(|(_, contact)| contact).collect(),
        edges: edges(moment, slot).into_iter().map(|edge| edge.state).collect(),
    }
}

/// A span as a place.
pub fn place(sources: &SourceMap, span: Span) -> Place {
    let file = sources.file(span.file());
    let at = |byte: u32| file.line_column_utf16(byte as usize);
    let ((line, column), (end_line, end_column)) = (at(span.start()), at(span.end()));
    Place { path: file.path.display().to_string(), line, column, end_line, end_column }
}

fn value(kind: &str, name: impl Into<String>, value: impl Into<String>) -> Value {
    Value { kind: kind.to_string(), name: name.into(), value: value.into() }
}

/// A number as people read it: at most four digits after the point.
pub fn shown(number: f64) -> String {
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
        all.push(value("discrete", &discrete.name, discrete.domain.text(instance.discrete(id))));
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
pub(super) fn contacts(moment: &Moment<'_>, slot: SlotId) -> Vec<(TouchId, Contact)> {
    let instance = moment.sim.instance(moment.after, slot);
    if !instance.is_alive() {
        return Vec::new();
    }
    let (program, entity) = (moment.sim.program(), instance.entity());
    let spans = &program.spans.entities[moment.sim.world().slots[slot].entity].touches;
    let contact = |touch| {
        let text = on_one_line(moment.sources.slice(*spans.get(touch)?));
        let side = entity.touches.get(touch)?.side.map(|side| side.name().to_string());
        Some((touch, Contact { text, side }))
    };
    instance.contacts().filter_map(contact).collect()
}

/// An edge that was considered, with the expressions of the parts of its guard.
pub(super) struct Considered {
    pub id: EdgeId,
    pub state: EdgeState,
    pub parts: Vec<ExprId>,
}

/// The edges that were considered in the step: of each group those of its active modes, in order.
pub(super) fn edges(moment: &Moment<'_>, slot: SlotId) -> Vec<Considered> {
    let Some((state, input)) = moment.before else { return Vec::new() };
    let (sim, sources) = (moment.sim, moment.sources);
    let before = sim.instance(state, slot);
    if !before.is_alive() {
        return Vec::new();
    }
    let program = sim.program();
    let id = sim.world().slots[slot].entity;
    let entity: &Entity = &program.entities[id];
    let step = Inspection::new(sim, state, input);
    let moved = moment.taken.map(|taken| Moved { sim, before: state, after: moment.after, taken });
    let guards = Guards { program, sources, step: &step, slot, moved };
    let mut all = Vec::new();
    for group in entity.groups.ids() {
        let leaf = &entity.leaves[before.leaf(group)];
        // The first edge with a target whose guard holds is taken.
        let mut is_taken = false;
        for &edge in leaf.edges.iter().chain(&leaf.internal) {
            let of = &entity.edges[edge];
            let held = guards.truth(of.guard).unwrap_or(false);
            let taken = match moment.taken {
                Some(taken) => taken.contains(&(slot, edge)),
                None => held && (of.target.is_none() || !is_taken),
            };
            // What the simulator took held, whatever modes of other groups were entered or left.
            let held = held || moment.taken.is_some() && taken;
            is_taken |= taken && of.target.is_some();
            let span = program.spans.entities[id].edges[edge];
            let parts = atoms_of(program, of.guard);
            let state = EdgeState {
                edge: edge.index(),
                from: of.source.index(),
                to: of.target.map(|mode: ModeId| mode.index()),
                held,
                taken,
                place: sources.holds(span).then(|| place(sources, span)),
                atoms: parts.iter().map(|part| guards.atom(*part)).collect(),
            };
            all.push(Considered { id: edge, state, parts });
        }
    }
    all
}

/// The parts of a guard that `and`, `or` and `not` join.
pub(super) fn atoms_of(program: &Program, guard: ExprId) -> Vec<ExprId> {
    let (mut open, mut atoms) = (vec![guard], Vec::new());
    while let Some(id) = open.pop() {
        match program.exprs[id] {
            Expr::And(a, b) | Expr::Or(a, b) => open.extend([b, a]),
            Expr::Not(a) if matches!(program.exprs[a], Expr::And(..) | Expr::Or(..)) => open.push(a),
            _ if atoms.len() < MAX_ATOMS => atoms.push(id),
            _ => {}
        }
    }
    atoms
}

/// Evaluates guards part by part.
pub(super) struct Guards<'a> {
    pub program: &'a Program,
    pub sources: &'a SourceMap,
    pub step: &'a Inspection<'a>,
    pub slot: SlotId,
    /// The states before and after the step, and what was taken in it: they tell which modes are entered and left.
    pub moved: Option<Moved<'a>>,
}

/// How a step changed modes.
#[derive(Clone, Copy)]
pub(super) struct Moved<'a> {
    pub sim: &'a Simulator,
    pub before: &'a [u8],
    pub after: &'a [u8],
    pub taken: &'a [(SlotId, EdgeId)],
}

impl Moved<'_> {
    /// Whether a mode of an instance was entered (true) or left; none if the instance is gone.
    fn joint(&self, slot: SlotId, mode: ModeId, is_entered: bool) -> Option<bool> {
        let (was, is) = (self.sim.instance(self.before, slot), self.sim.instance(self.after, slot));
        let entity = was.entity();
        let group = entity.modes[mode].group;
        let mut taken = self.taken.iter().filter(|(of, _)| *of == slot).map(|(_, edge)| &entity.edges[*edge]);
        let Some(target) = taken.find(|edge| entity.modes[edge.source].group == group && edge.target.is_some()) else {
            return Some(false);
        };
        if !is.is_alive() {
            return None;
        }
        let transition = Transition { group, from: was.leaf(group), target: target.target?, to: is.leaf(group) };
        Some(if is_entered { transition.enters(entity, mode) } else { transition.leaves(entity, mode) })
    }
}

impl Guards<'_> {
    pub fn truth(&self, id: ExprId) -> Option<bool> {
        match (self.program.exprs[id], self.moved) {
            (Expr::Joint(mode, is_entered), Some(moved)) => moved.joint(self.slot, mode, is_entered),
            (Expr::Not(a), Some(_)) if matches!(self.program.exprs[a], Expr::Joint(..)) => {
                self.truth(a).map(|held| !held)
            }
            _ => self.step.value(self.slot, id).ok().map(|value| value != 0.0),
        }
    }

    pub fn atom(&self, id: ExprId) -> Atom {
        let sides = sides(self.program, id, |id| self.step.value(self.slot, id).ok());
        Atom { text: atom_text(self.program, self.sources, id), held: self.truth(id), sides }
    }
}

/// The values of both sides of a comparison, or of a negated one.
pub(super) fn sides(program: &Program, id: ExprId, value: impl Fn(ExprId) -> Option<f64>) -> Option<[f64; 2]> {
    let compared = match program.exprs[id] {
        Expr::Not(inner) => inner,
        _ => id,
    };
    let Expr::Compare(_, a, b) = program.exprs[compared] else { return None };
    Some([value(a)?, value(b)?])
}

/// The text of a part. A comparison with an argument of a behaviour is put together from both sides, as they are in
/// different texts.
pub(super) fn atom_text(program: &Program, sources: &SourceMap, id: ExprId) -> String {
    let slice = |id: ExprId| on_one_line(sources.slice(program.spans.exprs[id]));
    let text = slice(id);
    match program.exprs[id] {
        Expr::Compare(op, a, b) if !text.contains(['<', '>', '=']) => {
            format!("{} {} {}", slice(a), op.symbol(), slice(b))
        }
        _ => text,
    }
}
