//! What the worlds of a program tell of an entity, gathered world by world: what a world can be takes far more memory than
//! its text, so that no more than one of them is kept at a time.

use std::collections::{BTreeMap, BTreeSet};

use crate::ir::{Entity, EntityId, IdVec, LeafId, ParamId, Program, SlotId, World, WorldId};

use super::super::{ConfigurationSpace, SlotSpace};
use super::Scene;
use super::guards::{Site, sites};
use super::invariants::{Invariants, Nothing};
use super::judge::{Given, Reads};
use super::ranges::{self, Leaving};
use super::words::Seen;
use crate::analysis::domain::configuration::Configuration;
use crate::analysis::step::evaluate::Reader;

/// A slot of a world with what can be in it.
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

/// An entity in all worlds that were looked at.
pub(super) struct Account<'a> {
    pub scene: &'a Scene<'a>,
    pub id: EntityId,
    pub entity: &'a Entity,
    /// Whether that is all there is to know of it.
    pub is_known: bool,
    /// Whether there can be an instance.
    pub can_live: bool,
    /// The leaves that can be active.
    pub live: BTreeSet<LeafId>,
    /// The first instance of which nothing is known, if there is any.
    pub given_up: Option<Nothing>,
    /// What its parameters are given.
    pub params: IdVec<ParamId, Given>,
    /// Its guards; of an entity of another file those that are copies.
    pub sites: Vec<Site>,
    /// What those guards read can be, by the leaves that are active.
    pub cases: BTreeMap<Vec<LeafId>, Seen>,
    /// What it comes to with its invariants.
    pub invariants: Invariants,
    /// Updates that may leave a range.
    pub leaving: Vec<Leaving>,
    /// Whether it is of the file that is examined.
    is_ours: bool,
    /// What is read by guards that values may decide.
    reads: Reads,
}

impl<'a> Account<'a> {
    /// Of an entity of which nothing has been seen yet; `is_known` tells that all worlds that have it are examined.
    pub fn new(scene: &'a Scene<'a>, id: EntityId, is_known: bool) -> Self {
        let (program, entity) = (scene.program, &scene.program.entities[id]);
        let is_ours = scene.is_ours(id);
        let mut sites = sites(program, entity);
        if !is_ours {
            // Of others nothing is reported but what concerns all who use a behaviour.
            sites.retain(|s| program.spans.exprs[s.guard].is_copy());
        }
        let mut reads = Reads::default();
        for site in sites.iter().filter(|s| s.can_be_decided(program, entity)) {
            reads.add(program, site.guard);
        }
        Account {
            scene,
            id,
            entity,
            is_known,
            can_live: false,
            live: BTreeSet::new(),
            given_up: None,
            params: entity.params.iter().map(|_| Given::default()).collect(),
            sites,
            cases: BTreeMap::new(),
            invariants: Invariants::default(),
            leaving: Vec::new(),
            is_ours,
            reads,
        }
    }

    /// Adds what can be in some slots of a world, which are all that it has of the entity.
    pub fn add(&mut self, slots: &[Occurrence<'_>]) {
        let (given_up, known): (Vec<&Occurrence<'_>>, Vec<_>) = slots.iter().partition(|o| o.found.is_given_up);
        self.is_known &= given_up.is_empty();
        if let (None, Some(first)) = (&self.given_up, given_up.first()) {
            self.given_up = Some(Nothing::of(first));
        }
        let known: Vec<_> = known.into_iter().filter(|o| !o.found.configurations.is_empty()).collect();
        if self.is_ours {
            for o in known.iter().chain(&given_up) {
                self.invariants.add(self.scene.program, self.entity, o);
            }
        }
        self.can_live |= !known.is_empty();
        if !self.is_known {
            // Nothing more is reported of it.
            return;
        }
        for o in &known {
            for id in self.entity.params.ids() {
                self.params[id].add(self.scene.program, self.entity, o, id);
            }
        }
        let cases: Vec<(&Occurrence<'_>, &Configuration)> =
            known.iter().flat_map(|o| o.found.configurations.iter().map(move |c| (*o, c))).collect();
        for site in &mut self.sites {
            site.add(self.scene.program, self.entity, &cases);
        }
        for (o, c) in &cases {
            self.live.extend(&c.leaves);
            if !self.reads.is_empty() {
                let seen = self.cases.entry(c.leaves.clone()).or_default();
                seen.add(&self.reads, o, c);
            }
        }
        if self.is_ours {
            ranges::add(self.scene, self.entity, &cases, &mut self.leaving);
        }
    }
}
