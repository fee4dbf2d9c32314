//! Questions to the instances of an entity, by the letter of the reference: every instance is looked at.

use hypedc::ir::{EntityId, Subject};
use hypedc::sema::checked::{Members, Nearest, Term};

use super::evaluate::Code;
use super::model::Fault;

impl Code<'_> {
    /// The instances of an entity for which something holds, in the order of their slots.
    fn members(&self, of: EntityId, holds: &Term) -> Result<Vec<usize>, Fault> {
        let mut found = Vec::new();
        for slot in 0..self.state.things.len() {
            let is_one = self.state.things[slot].is_some() && self.oracle.entity_id(slot) == of;
            if is_one && (Code { member: Some(slot), ..*self }).holds(holds)? {
                found.push(slot);
            }
        }
        Ok(found)
    }

    /// The number of instances for which something holds.
    pub fn count(&self, asked: &Members) -> Result<f64, Fault> {
        Ok(self.members(asked.of, &asked.holds)?.len() as f64)
    }

    /// The nearest other instance in the same space; the first of several.
    pub fn nearest(&self, asked: &Nearest) -> Result<Option<usize>, Fault> {
        let me = self.state.things[self.me.unwrap()].as_ref().unwrap();
        let mut found: Option<(usize, f64)> = None;
        for slot in self.members(asked.of, &asked.holds)? {
            let other = self.state.things[slot].as_ref().unwrap();
            if Some(slot) == self.me || other.space != me.space {
                continue;
            }
            let way = self.way(slot, me.position());
            if found.is_none_or(|(_, least)| way < least) {
                found = Some((slot, way));
            }
        }
        Ok(found.map(|(slot, _)| slot))
    }

    /// The distance of an instance to a point.
    pub fn distance(&self, of: Subject, x: &Term, y: &Term) -> Result<f64, Fault> {
        let slot = self.slot(of).ok_or(Fault::ReadNone)?;
        Ok(self.way(slot, (self.value(x)?, self.value(y)?)))
    }

    fn way(&self, slot: usize, (x, y): (f64, f64)) -> f64 {
        let thing = self.state.things[slot].as_ref().unwrap();
        let at = thing.position();
        let dx = self.oracle.shortest(thing.space, 0, at.0 - x);
        let dy = self.oracle.shortest(thing.space, 1, at.1 - y);
        (dx * dx + dy * dy).sqrt()
    }
}
