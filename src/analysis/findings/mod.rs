//! What the configuration space tells of a program: guards and modes that values decide, invariants that are not proven,
//! ranges that are left, bodies that are too fast for what blocks them. Each check has a file of its own.
//!
//! A finding holds of all worlds of the program together. The worlds are looked at without the bounds at which a search
//! stops, and with a player for every entity that reads inputs: what is never said to happen does not happen in a run
//! that goes on beyond, either. Nor does it matter how many things there are to be picked up.

mod guards;
mod invariants;
mod judge;
mod modes;
mod ranges;
mod tunnelling;
mod words;

pub use invariants::{InvariantVerdict, invariants};

use std::collections::BTreeMap;

use crate::diagnostic::{Code, Diagnostics};
use crate::ir::{Entity, EntityId, ExprId, PlayerId, Program, SlotId, World, WorldId};
use crate::source::{FileId, SourceMap, Span};
use crate::watch::{Unwatched, Watch};

use super::configuration::Configuration;
use super::evaluate::Reader;
use super::{ConfigurationSpace, SlotSpace, with_any_supply};

/// So many ways of steps are looked at for all worlds of a program: a check is to answer while one types.
const MOST_EFFORT: usize = 200_000;

/// Looks for what values tell of the entities of a file. `said` is what was found before: nothing is said twice.
pub fn findings(program: &Program, sources: &SourceMap, root: FileId, said: &Diagnostics) -> Diagnostics {
    watched_findings(program, sources, root, said, &Unwatched).map(|(found, _)| found).unwrap_or_default()
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
    let is_ours = |id: &EntityId| program.spans.entities[*id].name.file == root;
    // Where nothing of the file is in a world, there is nothing to tell.
    let occurs = |w: &World| w.slots.iter().any(|s| is_ours(&s.entity));
    let free = freed(program);
    let (mut worlds, mut unknown) = (Spaces::new(), Spaces::new());
    let mut effort = MOST_EFFORT;
    for (id, world) in program.worlds.pairs().filter(|(_, w)| occurs(w)) {
        match world.open.is_none() && effort > 0 {
            true => worlds.insert(id, with_any_supply(&free, id, &mut effort, watch)),
            // Of the others it is known how they begin.
            false => unknown.insert(id, with_any_supply(&free, id, &mut 0, watch)),
        };
    }
    if watch.stop() {
        return None;
    }
    let scene = Scene { program: &free, original: program, worlds, unknown, sources, said: Said::new(said) };
    let mut found = Diagnostics::new();
    for id in program.entities.ids().filter(is_ours) {
        let subject = scene.subject(id);
        if subject.is_known && !subject.slots.is_empty() {
            let explained = modes::modes(&subject, &mut found);
            guards::guards(&subject, &explained, &mut found);
            ranges::ranges(&subject, &mut found);
        }
        invariants::report(&subject, &mut found);
    }
    tunnelling::tunnelling(&scene, is_ours, &mut found);
    found.trace(sources);
    // What stands in a behaviour of another file is that file's affair.
    found.retain(|d| d.primary.as_ref().is_some_and(|l| l.span.file == root));
    Some((found, scene.worlds))
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

/// The same worlds, without the bounds at which a search stops, and with a player for all who read inputs.
fn freed(program: &Program) -> Program {
    let mut free = program.clone();
    for world in free.worlds.iter_mut() {
        for space in world.spaces.iter_mut() {
            space.bounds = None;
        }
        for slot in world.slots.iter_mut() {
            let entity = &program.entities[slot.entity];
            if !entity.buttons.is_empty() || !entity.axes.is_empty() {
                slot.player = slot.player.or(Some(PlayerId(0)));
            }
        }
    }
    free
}

/// The worlds of a program, and what they can be.
struct Scene<'a> {
    /// Without bounds.
    program: &'a Program,
    original: &'a Program,
    /// Those with all their maps.
    worlds: Spaces,
    /// Those that were not looked at: everything is possible.
    unknown: Spaces,
    sources: &'a SourceMap,
    said: Said,
}

impl Scene<'_> {
    fn subject(&self, id: EntityId) -> Subject<'_> {
        let of = |w: &World| w.slots.iter().any(|s| s.entity == id);
        let mut slots = Vec::new();
        let mut given_up = Vec::new();
        let mut is_known = true;
        let mut is_anywhere = false;
        for (world_id, world) in self.program.worlds.pairs().filter(|(_, w)| of(w)) {
            is_anywhere = true;
            let Some(space) = self.worlds.get(&world_id).or_else(|| self.unknown.get(&world_id)) else {
                is_known = false;
                continue;
            };
            for slot in world.slots.ids().filter(|s| world.slots[*s].entity == id) {
                let found = &space.slots[slot];
                is_known &= !found.is_given_up;
                let occurrence = Occurrence { world_id, world, space, slot, found };
                if found.is_given_up {
                    given_up.push(occurrence);
                } else if !found.configurations.is_empty() {
                    slots.push(occurrence);
                }
            }
        }
        Subject { scene: self, id, entity: &self.program.entities[id], slots, given_up, is_known, is_anywhere }
    }
}

/// An entity in all worlds.
struct Subject<'a> {
    scene: &'a Scene<'a>,
    id: EntityId,
    entity: &'a Entity,
    /// Where there can be an instance.
    slots: Vec<Occurrence<'a>>,
    /// Where there may be an instance of which nothing is known.
    given_up: Vec<Occurrence<'a>>,
    /// Whether any world has it.
    is_anywhere: bool,
    /// Whether that is all there is to know of it.
    is_known: bool,
}

/// A slot of a world with what can be in it.
#[derive(Clone, Copy)]
struct Occurrence<'a> {
    world_id: WorldId,
    world: &'a World,
    space: &'a ConfigurationSpace,
    slot: SlotId,
    found: &'a SlotSpace,
}

impl<'a> Occurrence<'a> {
    fn reader<'r>(&self, program: &'r Program, at: &'r Configuration) -> Reader<'r>
    where
        'a: 'r,
    {
        self.space.reader(program, self.world, Some((self.slot, at)))
    }
}

impl<'a> Subject<'a> {
    /// Every configuration in all worlds.
    fn configurations(&self) -> impl Iterator<Item = (&Occurrence<'a>, &'a Configuration)> {
        self.slots.iter().flat_map(|o| o.found.configurations.iter().map(move |c| (o, c)))
    }
}

/// The places of which something was said already.
struct Said(Vec<(Code, Span)>);

impl Said {
    fn new(found: &Diagnostics) -> Self {
        let places = found.iter().flat_map(|d| {
            // What a trap's edges are is said by its labels.
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
