//! The reachable states of a small world: breadth-first search over all inputs of single steps, each state once.

use hypedc::ir::{Id, ModeId, Side, TagId};

use std::collections::{BTreeMap, BTreeSet, HashSet};

use hypedc::sema::checked::{Action, By, DriveBy, Entity, Release, Term, TermKind, Type};

use super::evaluate::{longest, touching};
use super::model::{Fault, Keys, Moves, Oracle, State};

/// A contact query: tag of the entity's own collider, tag of the other, side, and whether the other is named.
type Question = (Option<TagId>, TagId, Option<Side>, bool);

/// The parts of an entity's state that are read.
struct Reads {
    /// For modes: the count above which their timers no longer matter; none if each count does.
    timers: Vec<(ModeId, Option<u32>)>,
    questions: Vec<Question>,
    /// The buttons with queries for presses or releases.
    presses: BTreeSet<u32>,
}

/// The result of the search.
pub struct Explored {
    /// For each goal, and then for each `never`, the shortest path to it.
    pub ways: Vec<Option<Vec<Moves>>>,
    /// Whether these are all states.
    pub is_closed: bool,
    /// All states up to this number of steps are included.
    pub depth: usize,
    pub states: usize,
    /// Whether a run-time fault occurred.
    pub faulted: bool,
}

/// A state that was reached.
struct Node {
    /// None once it was extended.
    state: Option<State>,
    parent: usize,
    /// The input that led here.
    input: usize,
    depth: usize,
}

/// Explores a world until all targets are found, or up to a number of states.
pub fn explore(oracle: &Oracle<'_>, most: usize) -> Explored {
    let questions = oracle.world.goals.len() + oracle.world.nevers.len();
    let mut search = Search {
        oracle,
        reads: (0..oracle.world.instances.len()).map(|slot| reads(oracle, slot)).collect(),
        inputs: inputs(oracle),
        nodes: Vec::new(),
        known: HashSet::new(),
        explored: Explored { ways: vec![None; questions], is_closed: true, depth: 0, states: 0, faulted: false },
    };
    match oracle.initial() {
        Ok(first) => search.arrive(first, 0, 0, 0),
        Err(_) => search.explored.faulted = true,
    }
    let mut at = 0;
    while at < search.nodes.len() {
        let depth = search.nodes[at].depth;
        search.explored.depth = depth;
        if search.nodes.len() >= most || search.explored.ways.iter().all(Option::is_some) {
            search.explored.is_closed = false;
            break;
        }
        let state = search.nodes[at].state.take().unwrap();
        for input in 0..search.inputs.len() {
            match oracle.step(&state, &search.inputs[input]) {
                Ok((next, _)) => search.arrive(next, at, input, depth + 1),
                Err(_) => search.explored.faulted = true,
            }
        }
        at += 1;
    }
    search.explored.states = search.nodes.len();
    search.explored
}

/// A search, breadth first.
struct Search<'a> {
    oracle: &'a Oracle<'a>,
    reads: Vec<Reads>,
    inputs: Vec<Moves>,
    nodes: Vec<Node>,
    known: HashSet<Vec<u64>>,
    explored: Explored,
}

impl Search<'_> {
    /// Checks a state: `never` first, then the bounds, then goals. If the run continues, a new state is added.
    fn arrive(&mut self, state: State, parent: usize, input: usize, depth: usize) {
        let Ok((holding, is_over)) = self.look(&state) else {
            self.explored.faulted = true;
            return;
        };
        for question in holding {
            if self.explored.ways[question].is_none() {
                self.explored.ways[question] = Some(self.way(parent, input, depth));
            }
        }
        if !is_over && self.known.insert(key(self.oracle, &self.reads, &state)) {
            self.nodes.push(Node { state: Some(state), parent, input, depth });
        }
    }

    /// The targets that hold, and whether a run ends here.
    fn look(&self, state: &State) -> Result<(Vec<usize>, bool), Fault> {
        let (world, mut holding) = (self.oracle.world, Vec::new());
        for (id, never) in world.nevers.pairs() {
            if self.oracle.predicate(state, &never.predicate)? {
                holding.push(world.goals.len() + id.index());
            }
        }
        if !holding.is_empty() || !self.oracle.in_bounds(state) {
            return Ok((holding, true));
        }
        for (id, goal) in world.goals.pairs() {
            if self.oracle.predicate(state, &goal.predicate)? {
                holding.push(id.index());
            }
        }
        Ok((holding, false))
    }

    /// The inputs that lead to a node, and one more; none where there was no step.
    fn way(&self, parent: usize, input: usize, depth: usize) -> Vec<Moves> {
        if depth == 0 {
            return Vec::new();
        }
        let Node { parent: before, input: led, depth, .. } = self.nodes[parent];
        let mut way = self.way(before, led, depth);
        way.push(self.inputs[input].clone());
        way
    }
}

/// All inputs of a step: every button up or down, every axis at -1, 0 or 1, everything that nature can draw.
fn inputs(oracle: &Oracle<'_>) -> Vec<Moves> {
    let mut all: Vec<Vec<Keys>> = vec![Vec::new()];
    for player in oracle.world.players.iter() {
        let entity = oracle.entity(player.slot.index());
        let mut ways = vec![Keys::default()];
        for button in 0..entity.buttons.len() as u32 {
            let mut down = ways.clone();
            down.iter_mut().for_each(|keys| {
                keys.held.insert(button);
            });
            ways.extend(down);
        }
        for axis in 0..entity.axes.len() {
            let turned = |to: f64| {
                ways.iter().cloned().map(move |mut keys| {
                    keys.axes[axis] = to;
                    keys
                })
            };
            ways = turned(0.0).chain(turned(-1.0)).chain(turned(1.0)).collect();
        }
        all = all
            .iter()
            .flat_map(|before| ways.iter().map(move |keys| [before.clone(), vec![keys.clone()]].concat()))
            .collect();
    }
    let mut moves: Vec<Moves> = all.into_iter().map(|keys| Moves { keys, drawn: Vec::new() }).collect();
    for slot in 0..oracle.world.instances.len() {
        moves.iter_mut().for_each(|moves| moves.drawn.push(Vec::new()));
        for chance in oracle.entity(slot).chances.iter() {
            let drawn = |moves: &Moves, value: i32| {
                let mut moves = moves.clone();
                moves.drawn[slot].push(value);
                moves
            };
            let values = || chance.range.0..=chance.range.1;
            moves = moves.iter().flat_map(|before| values().map(|value| drawn(before, value))).collect();
        }
    }
    moves
}

/// The key of a state.
fn key(oracle: &Oracle<'_>, reads: &[Reads], state: &State) -> Vec<u64> {
    let mut key = Vec::new();
    for (player, held) in oracle.world.players.iter().zip(&state.held) {
        let presses = &reads[player.slot.index()].presses;
        key.push(held.iter().filter(|b| presses.contains(b)).map(|b| 1u64 << b).sum());
    }
    for ((space, cell), left) in &state.broken {
        key.extend([*space as u64, *cell as u64, u64::from(left.unwrap_or(0))]);
    }
    key.push(u64::MAX);
    for (thing, reads) in state.things.iter().zip(reads) {
        let Some(thing) = thing else {
            key.push(0);
            continue;
        };
        key.push(1 + thing.space as u64);
        key.extend(thing.params.iter().map(|p| p.to_bits()));
        key.extend(thing.vars.iter().flatten().map(|p| p.to_bits()));
        key.extend(thing.discretes.iter().map(|d| *d as u64));
        key.extend(thing.refs.iter().chain([&thing.carrier]).map(|r| r.map_or(0, |slot| 1 + slot as u64)));
        for group in &thing.modes {
            key.push(u64::from(group.last().unwrap().0));
        }
        for (mode, limit) in &reads.timers {
            let count = thing.timers.get(mode).copied().unwrap_or(0);
            key.push(u64::from(limit.map_or(count, |limit| count.min(limit))));
        }
        for (envelope, way) in &thing.peaks {
            key.extend([1 + u64::from(*envelope), way[0] as u64, way[1] as u64]);
        }
        key.push(u64::MAX);
        for (signal, sum) in &thing.signals {
            key.extend([1 + u64::from(*signal), (sum + 0.0).to_bits()]);
        }
        key.push(u64::MAX);
        for (mine, other, side, named) in &reads.questions {
            let answers = || touching(thing, *mine, *other, *side);
            if *named {
                key.push(answers().filter_map(|c| c.who).min().map_or(0, |slot| 1 + slot as u64));
                key.push(longest(answers().filter_map(|c| c.tile)).map_or(0, |cell| 1 + cell as u64));
            } else {
                key.push(u64::from(answers().next().is_some()));
            }
        }
    }
    key
}

/// The part of the key for the instance in a slot.
fn reads(oracle: &Oracle<'_>, slot: usize) -> Reads {
    let entity = oracle.entity(slot);
    let mut reads = Reads { timers: Vec::new(), questions: Vec::new(), presses: BTreeSet::new() };
    let mut times: BTreeMap<ModeId, Option<f64>> = BTreeMap::new();
    let mut see = |term: &Term| walk(term, &mut |term| note(oracle, term, &mut times, &mut reads));
    terms(entity, &mut see);
    for question in oracle.world.goals.iter().chain(oracle.world.nevers.iter()) {
        see(&question.predicate);
    }
    for guard in oracle.world.spaces.iter().flat_map(|s| &s.links).filter_map(|l| l.guard.as_ref()) {
        see(guard);
    }
    for envelope in entity.envelopes.iter() {
        if let By::Clock(mode) = envelope.by {
            times.insert(mode, None);
        }
    }
    let limit = |most: f64| (0..).find(|count| oracle.seconds(f64::from(*count)) > most).unwrap();
    reads.timers = times.into_iter().map(|(mode, most)| (mode, most.map(limit))).collect();
    reads.timers.sort_unstable();
    reads
}

fn note(oracle: &Oracle<'_>, term: &Term, times: &mut BTreeMap<ModeId, Option<f64>>, reads: &mut Reads) -> bool {
    match &term.kind {
        TermKind::Compare(_, sides) => {
            let [a, b] = sides.as_ref();
            for (timer, other) in [(a, b), (b, a)] {
                let constant = match &other.kind {
                    TermKind::Number(n) => Some(*n),
                    TermKind::Quantity(quantity) => Some(quantity.0),
                    TermKind::Frames(n) => Some(oracle.seconds(*n)),
                    _ => None,
                };
                if let (TermKind::Timer(mode), Some(constant)) = (&timer.kind, constant) {
                    let most = times.entry(*mode).or_insert(Some(0.0));
                    *most = most.map(|m| m.max(constant));
                    return false;
                }
            }
        }
        TermKind::Timer(mode) => {
            times.insert(*mode, None);
        }
        TermKind::Touching(asked) => {
            let question = (asked.mine, asked.other, asked.side, asked.bound.is_some());
            if !reads.questions.contains(&question) {
                reads.questions.push(question);
            }
        }
        TermKind::Button(press, id) if *press != hypedc::ir::Press::Held => {
            reads.presses.insert(id.0);
        }
        _ => {}
    }
    true
}

/// Visits a term and, if the visitor returns true, its parts.
fn walk(term: &Term, visit: &mut dyn FnMut(&Term) -> bool) {
    if !visit(term) {
        return;
    }
    match &term.kind {
        TermKind::Negate(a) | TermKind::Not(a) => walk(a, visit),
        TermKind::Arithmetic(_, sides) | TermKind::Compare(_, sides) | TermKind::And(sides) | TermKind::Or(sides) => {
            let [a, b] = sides.as_ref();
            walk(a, visit);
            walk(b, visit);
        }
        TermKind::Call(call) => call.1.iter().for_each(|a| walk(a, visit)),
        TermKind::Near(asked) => asked.1.iter().for_each(|a| walk(a, visit)),
        TermKind::Distance(asked) => asked.1.iter().for_each(|a| walk(a, visit)),
        TermKind::Members(asked) => walk(&asked.holds, visit),
        TermKind::Nearest(asked) => walk(&asked.holds, visit),
        TermKind::Count(of) => of.iter().for_each(|a| walk(a, visit)),
        _ => {}
    }
}

/// All terms of an entity that are read while it lives.
fn terms(entity: &Entity, see: &mut dyn FnMut(&Term)) {
    fn actions(all: &[Action], see: &mut dyn FnMut(&Term)) {
        for action in all {
            match action {
                Action::Update(update) if !matches!(update.value.ty, Type::Ref(_)) => see(&update.value),
                Action::Spawn(spawn) => spawn.given.iter().for_each(|(_, term)| see(term)),
                Action::Send(send) => send.number.iter().for_each(&mut *see),
                _ => {}
            }
        }
    }
    for collider in entity.colliders.iter() {
        collider.guard.iter().chain(collider.shape.numbers()).for_each(&mut *see);
    }
    let drives = entity.drives.iter().chain(entity.modes.iter().flat_map(|m| &m.drives));
    for drive in drives {
        if let DriveBy::Flow(term) = &drive.by {
            see(term);
        }
    }
    for mode in entity.modes.iter() {
        actions(&mode.entry, see);
        for follow in &mode.follows {
            follow.guard.iter().for_each(&mut *see);
            actions(&follow.actions, see);
        }
    }
    for edge in entity.edges.iter() {
        see(&edge.guard);
        actions(&edge.actions, see);
    }
    for e in entity.envelopes.iter() {
        let levels = e.peak.iter().chain([&e.sustain]).chain(&e.sustain_for).chain(&e.driven_while);
        levels.for_each(&mut *see);
        if let Release::To(_, Some(level)) = &e.release {
            see(level);
        }
    }
    entity.clamps.iter().flat_map(|c| c.low.iter().chain(&c.high)).for_each(see);
}
