//! Findings from the configuration space: guards and modes that values decide, invariants that are not proven, updates
//! out of range, bodies that are too fast for what blocks them, goals that nothing reaches. One file per check.
//!
//! A finding holds in all worlds of the program. The worlds are analysed without the bounds that end a search, with a
//! player for every entity that reads inputs, and without limits on the number of things to pick up, so that findings
//! also hold in runs that continue beyond. Worlds are analysed one by one and their results gathered per entity; a
//! configuration space is dropped unless a caller asks for it.

mod atoms;
mod goals;
mod guards;
mod invariants;
mod modes;
mod ranges;
mod summary;
mod tunnelling;
mod value_text;

pub use invariants::{InvariantVerdict, invariants};

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::{Code, Diagnostics};
use crate::ir::{EntityId, ExprId, PlayerId, Program, Slot, SlotId, World, WorldId};
use crate::source::{FileId, SourceMap, Span};
use crate::watch::{Unwatched, Watch};

use super::{ConfigurationSpace, without_counter_bounds};
use crate::analysis::domain::configuration::Configuration;

use summary::{EntitySummary, Occurrence};
use tunnelling::Tunnelling;

/// Maximum number of branches of steps for all worlds of a program: a check runs while somebody types.
const MAX_BRANCHES: usize = 200_000;

/// Findings about the entities of a file. `reported` holds the earlier findings: nothing is reported twice.
pub fn findings(program: &Program, sources: &SourceMap, root: FileId, reported: &Diagnostics) -> Diagnostics {
    examine(program, sources, root, reported, &Unwatched, &mut |_, space| drop(space)).unwrap_or_default()
}

/// The configuration spaces of the worlds whose maps are all known.
pub type Spaces = BTreeMap<WorldId, ConfigurationSpace>;

/// As [`findings`], with the configuration spaces; `None` if the watch stopped it.
pub fn watched_findings(
    program: &Program,
    sources: &SourceMap,
    root: FileId,
    reported: &Diagnostics,
    watch: &dyn Watch,
) -> Option<(Diagnostics, Spaces)> {
    let mut spaces = Spaces::new();
    let found = examine(program, sources, root, reported, watch, &mut |id, space| {
        spaces.insert(id, space);
    })?;
    Some((found, spaces))
}

/// As [`findings`]; passes the configuration space of each world to `emit`.
fn examine(
    program: &Program,
    sources: &SourceMap,
    root: FileId,
    reported: &Diagnostics,
    watch: &dyn Watch,
    emit: &mut dyn FnMut(WorldId, ConfigurationSpace),
) -> Option<Diagnostics> {
    let context = Context { program, sources, root, reported: Reported::new(reported) };
    let mut summaries = EntitySummaries::new();
    let mut tunnelling = Tunnelling::default();
    let mut unreached = Diagnostics::new();
    // Worlds without entities of the file are skipped, so entities in them are not completely known.
    let occurs = |w: &World| w.slots.iter().any(|s| context.is_ours(s.entity));
    let others = program.worlds.iter().filter(|w| !occurs(w));
    let unseen: BTreeSet<EntityId> = others.flat_map(|w| w.slots.iter().map(|s| s.entity)).collect();
    let mut effort = MAX_BRANCHES;
    for (world_id, original) in program.worlds.pairs().filter(|(_, w)| occurs(w)) {
        let world = &*unrestricted(program, original);
        // For the others only the initial states are known.
        let is_looked_at = world.open.is_none() && effort > 0;
        let mut nothing = 0;
        let space =
            without_counter_bounds(program, world, if is_looked_at { &mut effort } else { &mut nothing }, watch);
        let mut entities: BTreeMap<EntityId, Vec<Occurrence<'_>>> = BTreeMap::new();
        for (slot, found) in space.slots.pairs() {
            let occurrence = Occurrence { world_id, world, space: &space, slot, found };
            entities.entry(world.slots[slot].entity).or_default().push(occurrence);
        }
        for (id, slots) in entities {
            let new = || EntitySummary::new(&context, id, !unseen.contains(&id));
            summaries.entry(id).or_insert_with(new).add(&slots);
        }
        if is_looked_at {
            tunnelling.examine(program, world_id, &space, |id| context.is_ours(*id));
            goals::report(&context, world_id, &space, &mut unreached);
            emit(world_id, space);
        }
    }
    if watch.stop() {
        return None;
    }
    let mut found = Diagnostics::new();
    for id in program.entities.ids().filter(|id| context.is_ours(*id)) {
        let summary = summaries.get(&id);
        if let Some(summary) = summary.filter(|a| a.is_known && a.can_live) {
            let explained = modes::modes(summary, &mut found);
            guards::guards(summary, &summaries, &explained, &mut found);
            ranges::report(summary, &mut found);
        }
        invariants::report(&context, id, summary, &mut found);
    }
    tunnelling.report(&mut found);
    found.append(unreached);
    found.trace(sources);
    // Findings in behaviours of other files belong to those files.
    found.retain(|d| d.primary.as_ref().is_some_and(|l| l.span.file() == root));
    Some(found)
}

impl ConfigurationSpace {
    /// Whether a guard of an instance can hold, and whether it can fail, in one of its configurations.
    pub fn turns_out(
        &self,
        program: &Program,
        world: WorldId,
        (slot, at): (SlotId, &Configuration),
        guard: ExprId,
    ) -> (bool, bool) {
        let truth = self.reader(program, &program.worlds[world], Some((slot, at))).truth(guard);
        (truth.can_hold, truth.can_fail)
    }
}

/// The same world without the bounds that end a search, and with a player for every entity that reads inputs.
fn unrestricted<'a>(program: &Program, world: &'a World) -> Cow<'a, World> {
    let waits = |slot: &Slot| {
        let entity = &program.entities[slot.entity];
        slot.player.is_none() && (!entity.buttons.is_empty() || !entity.axes.is_empty())
    };
    if world.spaces.iter().all(|s| s.bounds.is_none()) && !world.slots.iter().any(waits) {
        return Cow::Borrowed(world);
    }
    let mut free = world.clone();
    for space in free.spaces.iter_mut() {
        space.bounds = None;
    }
    for slot in free.slots.iter_mut().filter(|s| waits(s)) {
        slot.player = Some(PlayerId(0));
    }
    Cow::Owned(free)
}

/// The program under examination.
struct Context<'a> {
    program: &'a Program,
    sources: &'a SourceMap,
    /// The file whose entities are reported on.
    root: FileId,
    reported: Reported,
}

impl Context<'_> {
    fn is_ours(&self, id: EntityId) -> bool {
        self.program.spans.entities[id].name.file() == self.root
    }
}

/// Summaries of the entities in the worlds examined so far.
type EntitySummaries<'a> = BTreeMap<EntityId, EntitySummary<'a>>;

/// Spans that already have a finding.
struct Reported(Vec<(Code, Span)>);

impl Reported {
    fn new(found: &Diagnostics) -> Self {
        let spans = found.iter().flat_map(|d| {
            // A trap shows its edges as secondary labels.
            let more = if d.code == Code::Trap { d.secondary.as_slice() } else { &[] };
            d.primary.iter().chain(more).map(|l| (d.code, l.span)).collect::<Vec<_>>()
        });
        Reported(spans.collect())
    }

    /// Whether one of some codes was reported at a place, in it or around it.
    fn of(&self, codes: &[Code], at: Span, sources: &SourceMap) -> bool {
        let (at, _) = sources.trace(at);
        self.0.iter().any(|(code, span)| codes.contains(code) && (at.contains(*span) || span.contains(at)))
    }
}
