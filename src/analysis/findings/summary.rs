//! What the analysis of all worlds shows about one entity. Worlds are added one by one: a configuration space takes far
//! more memory than the world's text, so only one is kept at a time.

use std::collections::{BTreeMap, BTreeSet};

use crate::ir::{Entity, EntityId, IdVec, LeafId, ParamId, Program, SlotId, World, WorldId};

use super::super::{ConfigurationSpace, SlotSpace};
use super::Context;
use super::atoms::{ParamUse, Reads};
use super::guards::{Site, sites};
use super::invariants::{Invariants, UnknownInstance};
use super::ranges::{self, OutOfRange};
use super::value_text::Observed;
use crate::analysis::domain::configuration::Configuration;
use crate::analysis::step::evaluate::Reader;

/// A slot of a world with its configurations.
#[derive(Clone, Copy)]
pub(super) struct Occurrence<'a> {
    pub world_id: WorldId,
    pub world: &'a World,
    pub space: &'a ConfigurationSpace,
    pub slot: SlotId,
    pub found: &'a SlotSpace,
}

impl<'a> Occurrence<'a> {
    pub fn reader<'r>(&self, program: &'r Program, at: &'r Configuration) -> Reader<'r>
    where
        'a: 'r,
    {
        self.space.reader(program, self.world, Some((self.slot, at)))
    }
}

/// Results about an entity over all worlds examined so far.
pub(super) struct EntitySummary<'a> {
    pub context: &'a Context<'a>,
    pub id: EntityId,
    pub entity: &'a Entity,
    /// Whether all worlds that contain the entity were analysed completely.
    pub is_known: bool,
    /// Whether an instance can exist.
    pub can_live: bool,
    /// The leaves that can be active.
    pub live: BTreeSet<LeafId>,
    /// The first instance whose analysis was given up.
    pub given_up: Option<UnknownInstance>,
    /// The values of its parameters.
    pub params: IdVec<ParamId, ParamUse>,
    /// Its guards; for an entity of another file, only those copied from a behaviour.
    pub sites: Vec<Site>,
    /// Values that those guards read, by active leaves.
    pub cases: BTreeMap<Vec<LeafId>, Observed>,
    /// The state of its invariants.
    pub invariants: Invariants,
    /// Updates that may leave the range of their variable.
    pub out_of_range: Vec<OutOfRange>,
    /// Whether the entity is declared in the examined file.
    is_ours: bool,
    /// Everything read by guards that values may decide.
    reads: Reads,
}

impl<'a> EntitySummary<'a> {
    /// An empty summary; `is_known` is true if all worlds with the entity are examined.
    pub fn new(context: &'a Context<'a>, id: EntityId, is_known: bool) -> Self {
        let (program, entity) = (context.program, &context.program.entities[id]);
        let is_ours = context.is_ours(id);
        let mut sites = sites(program, entity);
        if !is_ours {
            // For entities of other files, only guards in shared behaviours matter.
            sites.retain(|s| program.spans.exprs[s.guard].is_copy());
        }
        let mut reads = Reads::default();
        for site in sites.iter().filter(|s| s.can_be_decided(program, entity)) {
            reads.add(program, site.guard);
        }
        EntitySummary {
            context,
            id,
            entity,
            is_known,
            can_live: false,
            live: BTreeSet::new(),
            given_up: None,
            params: entity.params.iter().map(|_| ParamUse::default()).collect(),
            sites,
            cases: BTreeMap::new(),
            invariants: Invariants::default(),
            out_of_range: Vec::new(),
            is_ours,
            reads,
        }
    }

    /// Adds the slots of a world that hold the entity; they must be all of them.
    pub fn add(&mut self, slots: &[Occurrence<'_>]) {
        let (given_up, known): (Vec<&Occurrence<'_>>, Vec<_>) = slots.iter().partition(|o| o.found.is_given_up);
        self.is_known &= given_up.is_empty();
        if let (None, Some(first)) = (&self.given_up, given_up.first()) {
            self.given_up = Some(UnknownInstance::of(first));
        }
        let known: Vec<_> = known.into_iter().filter(|o| !o.found.configurations.is_empty()).collect();
        if self.is_ours {
            for o in known.iter().chain(&given_up) {
                self.invariants.add(self.context.program, self.entity, o);
            }
        }
        self.can_live |= !known.is_empty();
        if !self.is_known {
            // Nothing else is reported about it.
            return;
        }
        for o in &known {
            for id in self.entity.params.ids() {
                self.params[id].add(self.context.program, self.entity, o, id);
            }
        }
        let cases: Vec<(&Occurrence<'_>, &Configuration)> =
            known.iter().flat_map(|o| o.found.configurations.iter().map(move |c| (*o, c))).collect();
        for site in &mut self.sites {
            site.add(self.context.program, self.entity, &cases);
        }
        for (o, c) in &cases {
            self.live.extend(&*c.leaves);
            if !self.reads.is_empty() {
                let seen = self.cases.entry(c.leaves.to_vec()).or_default();
                seen.add(&self.reads, o, c);
            }
        }
        if self.is_ours {
            ranges::add(self.context, self.entity, &cases, &mut self.out_of_range);
        }
    }
}
