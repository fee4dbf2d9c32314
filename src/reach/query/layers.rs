//! Who gets where: one world for players of different skill, each of whom has fewer inputs than the next: longer holds, or
//! no run button. What one of them does, all do who have those inputs, too.

use std::collections::BTreeSet;
use std::sync::{Mutex, PoisonError};

use crate::ir::{NeverId, SpaceId};
use crate::sim::{Scratch, Simulator};
use crate::source::SourceMap;
use crate::watch::Watch;

use super::super::conclusion::Conclusion;
use super::super::explore::{Explored, Explorer, Observer};
use super::super::outcome::Outcome;
use super::super::problem::Target;
use super::answer::Answer;
use super::session::{Query, QueryError, Session};

/// The side of the cells in which positions are kept, px.
pub const STEP: f64 = 4.0;

/// Which inputs a player has.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Skill {
    /// Inputs that are held for at least so many steps.
    Hold(u16),
    /// Inputs that never make a predicate hold: that of a `never` of the world, which is a question only for others.
    Without(NeverId),
    /// Inputs without some buttons, for each player.
    Unpressed(Vec<u64>),
    /// All.
    Any,
}

impl Skill {
    /// Whether these are all inputs that another skill has, and perhaps more.
    pub fn contains(&self, other: &Skill) -> bool {
        match (self, other) {
            (Skill::Any, _) => true,
            (Skill::Hold(few), Skill::Hold(many)) => few <= many,
            // To hold an input for one step is no restriction.
            (Skill::Hold(steps), _) => *steps <= 1,
            _ => self == other,
        }
    }

    /// A query, asked for a player with this skill.
    pub fn query(&self, query: &Query) -> Query {
        let mut query = query.clone();
        match self {
            Skill::Hold(steps) => query.min_hold = query.min_hold.max(*steps),
            Skill::Without(never) => {
                query.asked.retain(|asked| asked != never);
                query.without.push(*never);
            }
            Skill::Unpressed(buttons) => {
                query.unpressed.resize(query.unpressed.len().max(buttons.len()), 0);
                query.unpressed.iter_mut().zip(buttons).for_each(|(all, more)| *all |= more);
            }
            Skill::Any => {}
        }
        query
    }
}

/// A cell of 4 × 4 px in which the position of a player was: the space, the column, and the row from the bottom.
pub type Cell = (SpaceId, i32, i32);

/// Sees where players are, and what they stand on.
pub struct Footprints {
    explorer: Explorer,
    cells: Mutex<BTreeSet<Cell>>,
}

impl Footprints {
    /// For a world of which nothing was seen yet.
    pub fn new(sim: &Simulator) -> Self {
        Footprints { explorer: Explorer::new(sim), cells: Mutex::default() }
    }

    /// What was seen.
    pub fn seen(&self) -> Seen {
        let cells = self.cells.lock().unwrap_or_else(PoisonError::into_inner).clone();
        Seen { explored: self.explorer.explored(), cells }
    }
}

impl Observer for Footprints {
    fn see(&self, sim: &Simulator, state: &[u8], scratch: &Scratch) {
        self.explorer.see(sim, state, scratch);
        let mut cells = self.cells.lock().unwrap_or_else(PoisonError::into_inner);
        for player in sim.world().players.iter() {
            let instance = sim.instance(state, player.slot);
            if instance.is_alive() {
                let (x, y) = instance.position();
                let cell = |at: f64| (at / STEP).floor() as i32;
                cells.insert((instance.space(), cell(x), cell(y)));
            }
        }
    }
}

/// Where players were.
#[derive(Debug, Clone, PartialEq)]
pub struct Seen {
    /// Rooms, what they stood on, modes, edges.
    pub explored: Explored,
    /// The cells that they were in.
    pub cells: BTreeSet<Cell>,
}

impl Seen {
    /// With what somebody else saw.
    fn add(&mut self, other: &Seen) {
        self.explored.add(&other.explored);
        self.cells.extend(&other.cells);
    }
}

/// What a player with some skill can do, as far as searches know.
#[derive(Debug)]
pub struct Layer {
    /// The inputs.
    pub skill: Skill,
    /// Where it was, and all those were whose inputs it has.
    pub seen: Seen,
    /// The answer to each question.
    pub answers: Vec<LayerAnswer>,
    /// The search that went wherever it can.
    pub exploration: Outcome,
}

/// The answer to a question for a player.
#[derive(Debug, Clone)]
pub struct LayerAnswer {
    /// The answer.
    pub answer: Answer,
    /// The layer of which it is the answer: a way that somebody with fewer inputs found, or a proof about somebody with
    /// more.
    pub of: usize,
}

/// How the inputs of layers are told apart: a session is about one of them.
pub struct LayerSession<'a> {
    /// The session, of [`Skill::query`].
    pub session: &'a Session,
    /// The skill.
    pub skill: Skill,
    /// A goal that nothing reaches.
    pub nowhere: Target,
}

impl LayerSession<'_> {
    /// Explores, then asks each question that no layer before has a way for.
    ///
    /// [`QueryError`] if a question cannot be asked.
    pub fn layer(
        &self,
        before: &[Layer],
        sources: &SourceMap,
        watch_of: &mut dyn FnMut(Option<Target>, &mut dyn FnMut(&dyn Watch)),
    ) -> Result<Layer, QueryError> {
        let session = self.session;
        let footprints = Footprints::new(session.simulator());
        let mut explored = None;
        watch_of(None, &mut |watch| explored = Some(session.wander(self.nowhere, &footprints, watch)));
        let exploration = explored.unwrap_or_else(|| Ok(Outcome::stopped(session.query().settings.planner)))?;
        let included: Vec<(usize, &Layer)> =
            before.iter().enumerate().filter(|(_, layer)| self.skill.contains(&layer.skill)).collect();
        let (mut known, mut open) = (Vec::new(), Vec::new());
        for (index, target) in session.query().targets.iter().enumerate() {
            let path = Conclusion::of_path(*target);
            let answers = included.iter().filter_map(|(_, layer)| layer.answers.get(index));
            let way = answers.filter(|known| known.answer.verdict == path).min_by_key(|known| known.answer.steps);
            match way {
                Some(way) => known.push(Some(way.clone())),
                None => {
                    let mut found = None;
                    watch_of(Some(*target), &mut |watch| {
                        found = Some(session.find_observed(*target, &footprints, watch));
                    });
                    known.push(None);
                    open.extend(found.transpose()?.map(|found| (index, found)));
                }
            }
        }
        // After all searches: one can withdraw the proof of another.
        for (index, mut found) in open {
            let answer = session.answer(&mut found, sources);
            known[index] = Some(LayerAnswer { answer, of: before.len() });
        }
        let mut seen = footprints.seen();
        included.iter().for_each(|(_, layer)| seen.add(&layer.seen));
        Ok(Layer { skill: self.skill.clone(), seen, answers: known.into_iter().flatten().collect(), exploration })
    }
}

/// Gives each layer the proofs about layers with more inputs, where it has no answer of its own.
pub fn share_proofs(layers: &mut [Layer]) {
    for index in 0..layers.len() {
        let skill = layers[index].skill.clone();
        for question in 0..layers[index].answers.len() {
            let is_open = |answer: &Answer| answer.verdict.is_open() || answer.verdict == Conclusion::Exhausted;
            if !layers[index].answers.get(question).is_some_and(|own| is_open(&own.answer)) {
                continue;
            }
            let wider = layers.iter().filter(|other| other.skill.contains(&skill));
            let proof = wider
                .filter_map(|other| other.answers.get(question))
                .find(|other| other.answer.verdict == Conclusion::ProvenUnreachable && !other.answer.is_withdrawn);
            if let Some(proof) = proof.cloned() {
                layers[index].answers[question] = proof;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn longer_holds_are_fewer_inputs() {
        let (a, b) = (Skill::Without(NeverId(0)), Skill::Without(NeverId(1)));
        let c = Skill::Unpressed(vec![1]);
        assert!(Skill::Hold(6).contains(&Skill::Hold(20)) && !Skill::Hold(20).contains(&Skill::Hold(6)));
        assert!([&Skill::Hold(9), &a, &b, &c, &Skill::Any].iter().all(|skill| Skill::Any.contains(skill)));
        assert!(a.contains(&a) && !a.contains(&b) && !a.contains(&Skill::Hold(20)) && !Skill::Hold(2).contains(&a));
        assert!(Skill::Hold(1).contains(&a) && !a.contains(&Skill::Any) && c.contains(&c) && !c.contains(&a));
    }
}
