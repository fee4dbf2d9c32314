//! What the edges that an instance took have done, with the entries of the modes that they entered: values and references
//! that were written, instances that were spawned and destroyed, signals that were sent.

use crate::ir::{
    Actions, Domain, Entity, Place as Written, RefValue, Send, SendId, SlotId, Subject, Transition, Update,
};
use crate::sim::Inspection;
use crate::source::{Span, on_one_line};

use super::run::Write;
use super::step::{Moment, place, shown};
use super::whom::tile_words;

/// Maximum number of receivers that are named.
const MAX_NAMED: usize = 4;

/// What an instance did in a step, in order.
pub(super) fn writes(moment: &Moment<'_>, slot: SlotId) -> Vec<Write> {
    let Some((before, input)) = moment.before else { return Vec::new() };
    let Moment { sim, sources, .. } = *moment;
    let id = sim.world().slots[slot].entity;
    let entity = &sim.program().entities[id];
    let doer = Doer { moment, before, step: Inspection::new(sim, before, input), slot, entity };
    let mut all = Vec::new();
    for &(_, edge) in moment.taken.unwrap_or_default().iter().filter(|(of, _)| *of == slot) {
        let of = &entity.edges[edge];
        let from = &entity.modes[of.source].path;
        let by = match of.target {
            Some(target) => format!("{from} -> {}", entity.modes[target].path),
            None => format!("{from}, which stays"),
        };
        let line = sim.program().spans.entities[id].edges[edge];
        let by = match sources.holds(line) {
            true => format!("{by}, line {}", place(sources, line).line),
            false => by,
        };
        let group = entity.modes[of.source].group;
        let (was, is) = (sim.instance(before, slot), sim.instance(moment.after, slot));
        if let Some(target) = of.target.filter(|_| is.is_alive()) {
            let transition = Transition { group, from: was.leaf(group), target, to: is.leaf(group) };
            for mode in transition.entered(entity) {
                doer.add(&mut all, &entity.modes[mode].entry, &format!("entering {}", entity.modes[mode].path));
            }
        }
        doer.add(&mut all, &of.actions, &by);
    }
    all
}

/// An instance in a step.
struct Doer<'m> {
    moment: &'m Moment<'m>,
    before: &'m [u8],
    step: Inspection<'m>,
    slot: SlotId,
    entity: &'m Entity,
}

impl Doer<'_> {
    /// Adds what some actions did.
    fn add(&self, all: &mut Vec<Write>, actions: &Actions, by: &str) {
        let write =
            |what: Option<String>, text: String, value: Option<String>| Write { what, text, value, by: by.to_string() };
        for update in &actions.updates {
            let (what, value) = self.update(update);
            let text = self.slice(self.moment.sim.program().spans.exprs[update.value]);
            all.push(write(Some(what), text, value));
        }
        for update in &actions.refs {
            let name = self.name(update.value).unwrap_or_else(|| "none".to_string());
            all.push(write(Some(self.entity.refs[update.reference].name.clone()), name.clone(), Some(name)));
        }
        let id = self.moment.sim.world().slots[self.slot].entity;
        for &spawn in &actions.spawns {
            let text = self.slice(self.moment.sim.program().spans.entities[id].spawns[spawn]);
            all.push(write(None, text, None));
        }
        for &send in &actions.sends {
            let (text, received) = self.send(send);
            all.push(write(None, text, Some(received)));
        }
        for &what in &actions.destroys {
            let name = self.name(what).unwrap_or_else(|| "nothing, as there is none".to_string());
            all.push(write(None, format!("destroy {name}"), None));
        }
    }

    /// What an update wrote, and the value.
    fn update(&self, update: &Update) -> (String, Option<String>) {
        let value = self.step.value(self.slot, update.value).ok();
        match update.place {
            Written::Var(var, degree) => (self.entity.variable_text(var, degree), value.map(shown)),
            Written::Discrete(discrete) => {
                let of = &self.entity.discretes[discrete];
                let word = |value: f64| match &of.domain {
                    Domain::Int => shown(value),
                    named => named.text(value as i32),
                };
                (of.name.clone(), value.map(word))
            }
            Written::Ref(reference) => (self.entity.refs[reference].name.clone(), None),
        }
    }

    /// A signal as it was sent, and who received it.
    fn send(&self, id: SendId) -> (String, String) {
        let sim = self.moment.sim;
        let Send { to, entity, signal, value } = self.entity.sends[id];
        let of = &sim.program().entities[entity];
        let number = value.and_then(|value| self.step.value(self.slot, value).ok());
        let number = number.map_or(String::new(), |number| format!("({})", shown(number)));
        let receives = |slot: &SlotId| {
            let instance = sim.instance(self.before, *slot);
            sim.world().slots[*slot].entity == entity && instance.is_alive()
        };
        let (to, received): (String, Vec<SlotId>) = match to {
            Some(subject) => {
                let slot = self.step.target(self.slot, RefValue::Of(subject)).0;
                let name = self.name(RefValue::Of(subject)).unwrap_or_else(|| "none".to_string());
                (name, slot.filter(receives).into_iter().collect())
            }
            None => (format!("all {}", of.name), sim.world().slots.ids().filter(receives).collect()),
        };
        let mut names: Vec<String> =
            received.iter().take(MAX_NAMED).map(|slot| format!("`{}`", sim.world().slots[*slot].name)).collect();
        if received.len() > MAX_NAMED {
            names.push(format!("{} more", received.len() - MAX_NAMED));
        }
        let received = match names.is_empty() {
            true => "lost, as nobody is there to receive it".to_string(),
            false => format!("received by {}", names.join(", ")),
        };
        (format!("send {to}.{}{number}", of.signals[signal].name), received)
    }

    /// The name of what a value stands for; none if that is nothing.
    fn name(&self, value: RefValue) -> Option<String> {
        if value == RefValue::Of(Subject::Me) {
            return Some("self".to_string());
        }
        let sim = self.moment.sim;
        match self.step.target(self.slot, value) {
            (Some(slot), _) => Some(format!("`{}`", sim.world().slots[slot].name)),
            (None, Some(tile)) => {
                let (space, column, row) = sim.place_of_tile(tile)?;
                Some(tile_words(&sim.world().spaces[space], column, row))
            }
            (None, None) => None,
        }
    }

    fn slice(&self, span: Span) -> String {
        let sources = self.moment.sources;
        if sources.holds(span) { on_one_line(sources.slice(span)) } else { String::new() }
    }
}
