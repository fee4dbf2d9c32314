//! What the configuration space tells of a program: guards and modes that values decide, invariants that are not proven,
//! ranges that are left, bodies that are too fast for what blocks them. Each check has a file of its own.
//!
//! A finding holds of all worlds of the program together. The worlds are examined without the bounds at which a search
//! stops, and with a player for every entity that reads inputs: what is never said to happen does not happen in a run
//! that goes on beyond, either. Nor does it matter how many things there are to be picked up. They are examined one by
//! one, and what they tell of each entity is gathered: what a world can be is not kept, unless a caller asks for it.

mod account;
mod guards;
mod invariants;
mod judge;
mod modes;
mod ranges;
mod tunnelling;
mod words;

pub use invariants::{InvariantVerdict, invariants};

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use crate::diagnostic::{Code, Diagnostics};
use crate::ir::{EntityId, ExprId, PlayerId, Program, Slot, SlotId, World, WorldId};
use crate::source::{FileId, SourceMap, Span};
use crate::watch::{Unwatched, Watch};

use super::{ConfigurationSpace, without_counter_bounds};
use crate::analysis::domain::configuration::Configuration;

use account::{Account, Occurrence};
use tunnelling::Tunnelling;

/// The most ways of steps that are examined for all worlds of a program: a check answers while one types.
const MAX_EFFORT: usize = 200_000;

/// Looks for what values tell of the entities of a file. `said` is what was found before: nothing is reported twice.
pub fn findings(program: &Program, sources: &SourceMap, root: FileId, said: &Diagnostics) -> Diagnostics {
    look(program, sources, root, said, &Unwatched, &mut |_, space| drop(space)).unwrap_or_default()
}

/// What the worlds of a program can be, those with all their maps.
pub type Spaces = BTreeMap<WorldId, ConfigurationSpace>;

/// As [`findings`], and what the worlds can be; nothing if the watch stopped it.
pub fn watched_findings(
    program: &Program,
    sources: &SourceMap,
    root: FileId,
    said: &Diagnostics,
    watch: &dyn Watch,
) -> Option<(Diagnostics, Spaces)> {
    let mut spaces = Spaces::new();
    let found = look(program, sources, root, said, watch, &mut |id, space| {
        spaces.insert(id, space);
    })?;
    Some((found, spaces))
}

/// As [`findings`]; gives away what each world with all its maps can be, as soon as it is read.
fn look(
    program: &Program,
    sources: &SourceMap,
    root: FileId,
    said: &Diagnostics,
    watch: &dyn Watch,
    give: &mut dyn FnMut(WorldId, ConfigurationSpace),
) -> Option<Diagnostics> {
    let scene = Scene { program, sources, root, said: Said::new(said) };
    let mut accounts = Accounts::new();
    let mut tunnelling = Tunnelling::default();
    // Where nothing of the file is in a world, there is nothing to tell; what else is there is not known altogether.
    let occurs = |w: &World| w.slots.iter().any(|s| scene.is_ours(s.entity));
    let others = program.worlds.iter().filter(|w| !occurs(w));
    let unseen: BTreeSet<EntityId> = others.flat_map(|w| w.slots.iter().map(|s| s.entity)).collect();
    let mut effort = MAX_EFFORT;
    for (world_id, original) in program.worlds.pairs().filter(|(_, w)| occurs(w)) {
        let world = &*freed(program, original);
        // Of the others it is known how they begin.
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
            let new = || Account::new(&scene, id, !unseen.contains(&id));
            accounts.entry(id).or_insert_with(new).add(&slots);
        }
        if is_looked_at {
            tunnelling.look(program, world_id, &space, |id| scene.is_ours(*id));
            give(world_id, space);
        }
    }
    if watch.stop() {
        return None;
    }
    let mut found = Diagnostics::new();
    for id in program.entities.ids().filter(|id| scene.is_ours(*id)) {
        let account = accounts.get(&id);
        if let Some(account) = account.filter(|a| a.is_known && a.can_live) {
            let explained = modes::modes(account, &mut found);
            guards::guards(account, &accounts, &explained, &mut found);
            ranges::report(account, &mut found);
        }
        invariants::report(&scene, id, account, &mut found);
    }
    tunnelling.report(&mut found);
    found.trace(sources);
    // What is in a behaviour of another file is that file's affair.
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

/// The same world, without the bounds at which a search stops, and with a player for all who read inputs.
fn freed<'a>(program: &Program, world: &'a World) -> Cow<'a, World> {
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

/// What is examined.
struct Scene<'a> {
    program: &'a Program,
    sources: &'a SourceMap,
    /// The file whose entities are reported on.
    root: FileId,
    said: Said,
}

impl Scene<'_> {
    fn is_ours(&self, id: EntityId) -> bool {
        self.program.spans.entities[id].name.file() == self.root
    }
}

/// The entities that are in worlds that were looked at.
type Accounts<'a> = BTreeMap<EntityId, Account<'a>>;

/// The places of which something was said already.
struct Said(Vec<(Code, Span)>);

impl Said {
    fn new(found: &Diagnostics) -> Self {
        let places = found.iter().flat_map(|d| {
            // What a trap's edges are is shown by its labels.
            let more = if d.code == Code::Trap { d.secondary.as_slice() } else { &[] };
            d.primary.iter().chain(more).map(|l| (d.code, l.span)).collect::<Vec<_>>()
        });
        Said(places.collect())
    }

    /// Whether one of some codes was found at a place, in it or around it.
    fn of(&self, codes: &[Code], at: Span, sources: &SourceMap) -> bool {
        let (at, _) = sources.trace(at);
        self.0.iter().any(|(code, span)| codes.contains(code) && (at.contains(*span) || span.contains(at)))
    }
}
