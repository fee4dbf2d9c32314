//! The first step at which the same inputs lead two programs apart, in what is active: modes, contacts, edges, spaces,
//! who is there. Positions differ before that, and are not compared: what they lead to is.

use serde::Serialize;

use crate::ir::{EdgeId, Entity, ExprId, Id, ModeId, NeverId, Program, SlotId, Touch, TouchId, World};
use crate::sim::{Instance, Script, Simulator, State};
use crate::source::SourceMap;
use crate::why::{Atom, EdgeWhy, Why, predicate_atoms, why};

/// A program whose run is compared.
#[derive(Clone, Copy)]
pub struct Side<'s> {
    /// The simulator of the world.
    pub sim: &'s Simulator,
    /// The texts of the program.
    pub sources: &'s SourceMap,
    /// The inputs.
    pub script: &'s Script,
    /// `never`s that are questions only, and end no run.
    pub asked: &'s [NeverId],
    /// The predicate that the run leads to, or should.
    pub target: Option<ExprId>,
}

/// How a run ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case", tag = "kind", content = "name")]
pub enum RunEnd {
    /// After all of its inputs.
    Done,
    /// A `never` holds.
    Never(String),
    /// A player left the bounds of its space.
    Outside(String),
    /// By a run-time error.
    Fault,
}

/// What happened on one side in a step.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Happened {
    /// Where the instance is after it, px; null if it is not there.
    pub at: Option<[f64; 2]>,
    /// What happened, a sentence each.
    pub what: Vec<String>,
}

/// A step in which two runs differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Difference {
    /// The step; 0: before the first.
    pub step: u64,
    /// The time after it, s.
    pub seconds: f64,
    /// The instance.
    pub instance: String,
    /// Its space in the old program; null if the world has only one.
    pub space: Option<String>,
    /// In the old program.
    pub old: Happened,
    /// In the new program.
    pub new: Happened,
}

/// How the end of a run differs.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Ended {
    /// Why it ended.
    pub end: RunEnd,
    /// After which step.
    pub step: u64,
    /// Where the first player is then, px; null if it is not there.
    pub at: Option<[f64; 2]>,
    /// The parts of the goal that do not hold then, with the values of comparisons; empty if it holds.
    pub missing: Vec<String>,
}

/// How two runs with the same inputs differ.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "testing", derive(schemars::JsonSchema))]
pub struct Divergence {
    /// The first difference of a player; null if there is none before one of the runs ends.
    pub player: Option<Difference>,
    /// The first difference of another instance, if it is before that of a player.
    pub other: Option<Difference>,
    /// How the old run ends.
    pub old: Ended,
    /// How the new run ends.
    pub new: Ended,
}

/// A run of one side.
struct Run<'s> {
    side: Side<'s>,
    states: Vec<State>,
    /// The edges that were taken in each step.
    taken: Vec<Vec<(SlotId, EdgeId)>>,
    end: RunEnd,
}

/// Maximum number of bytes of states that are kept for each side.
const MAX_BYTES: usize = 1 << 28;

impl<'s> Run<'s> {
    /// Plays the script to its end; states are kept as far as memory allows.
    fn new(side: Side<'s>) -> Run<'s> {
        let sim = side.sim;
        let mut run = Run { side, states: Vec::new(), taken: Vec::new(), end: RunEnd::Done };
        let mut scratch = sim.scratch();
        let Ok(mut state) = sim.initial(&mut scratch) else {
            return Run { end: RunEnd::Fault, ..run };
        };
        let most = MAX_BYTES / sim.world().layout.size.max(1);
        let mut inputs = side.script.inputs();
        run.states.push(state.clone());
        run.taken.push(Vec::new());
        for step in 1.. {
            if let Some(end) = over(side, &state) {
                return Run { end, ..run };
            }
            let Some(input) = inputs.next().filter(|_| run.states.len() < most) else { return run };
            let input = sim.draw(0, step, input);
            if sim.step(&mut state, &input, &mut scratch).is_err() {
                return Run { end: RunEnd::Fault, ..run };
            }
            run.states.push(state.clone());
            run.taken.push(sim.taken_edges(&scratch).to_vec());
        }
        run
    }

    fn steps(&self) -> u64 {
        self.states.len().saturating_sub(1) as u64
    }

    fn at(&self, slot: SlotId, step: u64) -> Option<[f64; 2]> {
        let player = self.side.sim.instance(self.states.get(step as usize)?, slot);
        player.is_alive().then(|| player.position().into())
    }

    fn ended(&self) -> Ended {
        let first = self.side.sim.world().players.iter().next();
        let at = first.and_then(|player| self.at(player.slot, self.steps()));
        let Side { sim, sources, target, .. } = self.side;
        let mut missing = Vec::new();
        if let (Some(target), Some(state)) = (target, self.states.last())
            && !sim.holds(state, target).unwrap_or(false)
        {
            let parts = predicate_atoms(sim, sources, state, target);
            missing.extend(parts.iter().filter(|part| part.held != Some(true)).map(part_words));
        }
        Ended { end: self.end.clone(), step: self.steps(), at, missing }
    }
}

/// Why a run is over in a state.
fn over(side: Side<'_>, state: &State) -> Option<RunEnd> {
    let world = side.sim.world();
    let rules = world.nevers.pairs().filter(|(id, _)| !side.asked.contains(id));
    for (_, never) in rules {
        if side.sim.holds(state, never.holds).unwrap_or(false) {
            return Some(RunEnd::Never(never.name.clone()));
        }
    }
    side.sim.left_bounds(state).map(|slot| RunEnd::Outside(world.slots[slot].name.clone()))
}

/// How the runs of two programs differ.
pub fn diverge(old: Side<'_>, new: Side<'_>) -> Divergence {
    let (old, new) = (Run::new(old), Run::new(new));
    let pairs = pairs((old.side.sim.program(), old.side.sim.world()), (new.side.sim.program(), new.side.sim.world()));
    let first = |wanted: bool| first(&old, &new, pairs.iter().filter(|pair| pair.is_player == wanted));
    let player = first(true);
    let other = first(false).filter(|other| player.as_ref().is_none_or(|player| other.step < player.step));
    Divergence { player, other, old: old.ended(), new: new.ended() }
}

/// The first difference among some instances.
fn first<'p>(old: &Run<'_>, new: &Run<'_>, pairs: impl Iterator<Item = &'p Pair> + Clone) -> Option<Difference> {
    for (step, (was, is)) in old.states.iter().zip(&new.states).enumerate() {
        for pair in pairs.clone() {
            let [before, now] = [(old, was, pair.old), (new, is, pair.new)]
                .map(|(run, state, slot)| (run.side.sim.instance(state, slot), run.taken[step].as_slice()));
            if pair.differs(before, now) {
                return Some(difference(old, new, pair, step as u64));
            }
        }
    }
    None
}

/// An instance that both worlds have, and what of its entities corresponds.
struct Pair {
    old: SlotId,
    new: SlotId,
    is_player: bool,
    modes: Vec<Option<ModeId>>,
    edges: Vec<Option<EdgeId>>,
    touches: Vec<Option<TouchId>>,
    /// For each old space its name in the new world, as an index.
    spaces: Vec<Option<crate::ir::SpaceId>>,
}

/// Players are paired by number, others by name.
fn pairs(old: (&Program, &World), new: (&Program, &World)) -> Vec<Pair> {
    let mut pairs = Vec::new();
    for (slot, of) in old.1.slots.pairs() {
        let partner = match of.player {
            Some(player) => {
                let number = old.1.players[player].number;
                new.1.players.iter().find(|player| player.number == number).map(|player| player.slot)
            }
            None => new.1.slot_named(&of.name).filter(|slot| new.1.slots[*slot].player.is_none()),
        };
        let Some(partner) = partner else { continue };
        let entities = [&*old.0.entities[of.entity], &*new.0.entities[new.1.slots[partner].entity]];
        let modes = modes(entities);
        pairs.push(Pair {
            old: slot,
            new: partner,
            is_player: of.player.is_some(),
            edges: edges(entities, &modes),
            modes,
            touches: touches((old.0, entities[0]), (new.0, entities[1])),
            spaces: old.1.spaces.iter().map(|space| new.1.space_named(&space.name)).collect(),
        });
    }
    pairs
}

/// The new mode of each old one: of the same path, or else at the same place of a group of as many modes.
fn modes([old, new]: [&Entity; 2]) -> Vec<Option<ModeId>> {
    let partner = |(id, mode): (ModeId, &crate::ir::Mode)| {
        new.mode_named(&mode.path).or_else(|| {
            let is_alike = old.modes.len() == new.modes.len() && old.groups.len() == new.groups.len();
            new.modes.get(id).filter(|_| is_alike).filter(|other| old.mode_named(&other.path).is_none()).map(|_| id)
        })
    };
    old.modes.pairs().map(partner).collect()
}

/// The new edge of each old one: between the same modes, of several the one at the same place among them.
fn edges([old, new]: [&Entity; 2], modes: &[Option<ModeId>]) -> Vec<Option<EdgeId>> {
    let partner = |(id, edge): (EdgeId, &crate::ir::Edge)| {
        let (source, target) = (modes[edge.source.index()]?, edge.target.map(|target| modes[target.index()]));
        let target = target.map_or(Some(None), |target| target.map(Some))?;
        let is_like = |other: &crate::ir::Edge| (other.source, other.target) == (edge.source, edge.target);
        let place = old.edges.pairs().take_while(|(other, _)| *other < id).filter(|(_, other)| is_like(other)).count();
        let alike = new.edges.pairs().filter(|(_, other)| (other.source, other.target) == (source, target));
        alike.map(|(id, _)| id).nth(place)
    };
    old.edges.pairs().map(partner).collect()
}

/// The new contact query of each old one: of the same tags and side.
fn touches(old: (&Program, &Entity), new: (&Program, &Entity)) -> Vec<Option<TouchId>> {
    let words = |program: &Program, touch: &Touch| {
        let mut mine: Vec<String> = touch.mine.iter().filter_map(|tag| program.tags.get(tag).cloned()).collect();
        mine.sort_unstable();
        (mine, program.tags.get(touch.other).cloned(), touch.side)
    };
    let partner = |touch: &Touch| {
        let wanted = words(old.0, touch);
        new.1.touches.find(|other| words(new.0, other) == wanted)
    };
    old.1.touches.iter().map(partner).collect()
}

impl Pair {
    fn differs(
        &self,
        (old, was_taken): (Instance<'_>, &[(SlotId, EdgeId)]),
        (new, is_taken): (Instance<'_>, &[(SlotId, EdgeId)]),
    ) -> bool {
        if !old.is_alive() || !new.is_alive() {
            return old.is_alive() != new.is_alive();
        }
        if self.spaces[old.space().index()] != Some(new.space()) {
            return true;
        }
        let mut modes = old.modes().map(|mode| self.modes[mode.index()]).zip(new.modes());
        if modes.any(|(before, now)| before != Some(now)) {
            return true;
        }
        let mut touches = self.touches.iter().enumerate().filter_map(|(touch, partner)| Some((touch, (*partner)?)));
        if touches.any(|(touch, partner)| old.touches(TouchId::from_index(touch)) != new.touches(partner)) {
            return true;
        }
        let was = |edge: EdgeId| was_taken.contains(&(self.old, edge));
        let is = |edge: EdgeId| is_taken.contains(&(self.new, edge));
        let mut edges = self.edges.iter().enumerate().filter_map(|(edge, partner)| Some((edge, (*partner)?)));
        edges.any(|(edge, partner)| was(EdgeId::from_index(edge)) != is(partner))
    }
}

/// What happened on both sides in a step.
fn difference(old: &Run<'_>, new: &Run<'_>, pair: &Pair, step: u64) -> Difference {
    let explained = |run: &Run<'_>, slot| why(run.side.sim, run.side.sources, (run.side.script, 0), step, slot).ok();
    let (was, is) = (explained(old, pair.old), explained(new, pair.new));
    let world = new.side.sim.world();
    let partner = |edge: usize| pair.edges.get(edge).copied().flatten().map(|edge| edge.index());
    let back = |edge: usize| pair.edges.iter().position(|new| new.is_some_and(|new| new.index() == edge));
    let before = Happened { at: old.at(pair.old, step), what: sentences(was.as_ref(), is.as_ref(), &back) };
    let now = Happened { at: new.at(pair.new, step), what: sentences(is.as_ref(), was.as_ref(), &partner) };
    let has_rooms = old.side.sim.world().spaces.len() > 1;
    Difference {
        step,
        seconds: world.step.times(u32::try_from(step).unwrap_or(u32::MAX)),
        instance: world.slots[pair.new].name.clone(),
        space: was.as_ref().filter(|_| has_rooms).map(|was| was.space.clone()),
        old: before,
        new: now,
    }
}

/// What happened on one side and not on the other. `partner` finds this side's edge for one of the other side.
fn sentences(this: Option<&Why>, other: Option<&Why>, partner: &dyn Fn(usize) -> Option<usize>) -> Vec<String> {
    let Some(this) = this else { return vec!["the run is over".to_string()] };
    if !this.is_alive {
        return vec!["is not there".to_string()];
    }
    let mut all = Vec::new();
    if other.is_some_and(|other| other.is_alive && other.space != this.space) {
        all.push(format!("is in `{}`", this.space));
    }
    let counterpart = |edge: &EdgeWhy| partner(edge.edge).and_then(|id| this.edges.iter().find(|mine| mine.edge == id));
    let same = |mine: &EdgeWhy| {
        let others = other.map_or(&[][..], |other| &other.edges);
        others.iter().any(|edge| edge.taken && partner(edge.edge) == Some(mine.edge))
    };
    for edge in this.edges.iter().filter(|edge| edge.taken && !same(edge)) {
        all.push(format!("{} is taken{}{}", names(edge), line(edge), because(edge, true)));
    }
    for edge in other.iter().flat_map(|other| &other.edges).filter(|edge| edge.taken) {
        let Some(mine) = counterpart(edge).filter(|mine| !mine.taken) else { continue };
        let why = if mine.tried { because(mine, false) } else { ": an edge before it was taken".to_string() };
        all.push(format!("{} is not taken{}{why}", names(mine), line(mine)));
    }
    let holds = |why: &Why, text: &str| why.contacts.iter().any(|touched| touched.contact.text == text);
    for touched in this.contacts.iter().filter(|of| other.is_some_and(|other| !holds(other, &of.contact.text))) {
        let whom = if touched.whom.is_empty() { String::new() } else { format!(": {}", touched.whom.join(", ")) };
        all.push(format!("{} holds{whom}", touched.contact.text));
    }
    for touched in other.iter().flat_map(|other| &other.contacts).filter(|of| !holds(this, &of.contact.text)) {
        all.push(format!("{} does not hold", touched.contact.text));
    }
    let modes: Vec<&str> = this.modes.iter().map(|mode| mode.mode.as_str()).collect();
    let others: Vec<&str> = other.iter().flat_map(|other| &other.modes).map(|mode| mode.mode.as_str()).collect();
    let different: Vec<&str> = modes.iter().copied().filter(|mode| !others.contains(mode)).collect();
    if !different.is_empty() {
        all.push(format!("is in {}", different.join(", ")));
    } else if all.is_empty() {
        all.push(format!("is in {}", modes.join(", ")));
    }
    all
}

/// `rising -> falling`
fn names(edge: &EdgeWhy) -> String {
    match &edge.to {
        Some(to) => format!("`{} -> {to}`", edge.from),
        None => format!("an edge of `{}` that stays", edge.from),
    }
}

/// ` (game.hyped:12)`
fn line(edge: &EdgeWhy) -> String {
    edge.place.as_ref().map_or(String::new(), |place| format!(" ({}:{})", place.path, place.line))
}

/// The parts of a guard that held, or that did not.
fn because(edge: &EdgeWhy, held: bool) -> String {
    let parts = edge.atoms.iter().map(|of| &of.atom).filter(|atom| atom.held == Some(held));
    let parts: Vec<String> = parts.map(part_words).collect();
    match parts.is_empty() {
        true => String::new(),
        false => format!(": {} {}", parts.join(", "), if held { "held" } else { "did not hold" }),
    }
}

/// A part of a guard or of a goal: `hero.y >= 60` (56 and 60)
fn part_words(atom: &Atom) -> String {
    match atom.sides {
        Some([a, b]) => format!("`{}` ({} and {})", atom.text, number(a), number(b)),
        None => format!("`{}`", atom.text),
    }
}

/// A number with at most two digits after the point.
fn number(number: f64) -> String {
    let text = format!("{number:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_string() } else { text.to_string() }
}
