//! Evaluates expressions in a state by the language's definition, independently of the simulator; reports its reads.

use hypedc::ir::{
    Arithmetic, By, CompareOp, EdgeId, Entity, EntityId, Expr, ExprId, Function, Id, LeafId, MAX_AXES, ModeId, Press,
    Program, SlotId, Subject, VarId, World, arithmetic, call, compare,
};
use hypedc::sim::state::{buttons, real};
use hypedc::sim::{DrawId, Input};

use super::look::Place;

/// Receives what is read.
pub trait Notes {
    fn note(&self, what: &str);
    fn turned_out(&self, atom: &str, holds: bool);
}

/// Ignores it.
pub struct Nobody;

impl Notes for Nobody {
    fn note(&self, _: &str) {}
    fn turned_out(&self, _: &str, _: bool) {}
}

/// A state and the input of the step that begins there.
#[derive(Clone, Copy)]
pub struct Eye<'a> {
    pub program: &'a Program,
    pub world: &'a World,
    pub state: &'a [u8],
    pub input: &'a Input,
    pub me: SlotId,
    /// The instance that a question to each asks.
    pub member: Option<SlotId>,
    /// The edges that the groups of the instance take in this step.
    pub taken: &'a [Option<Move>],
    pub notes: &'a dyn Notes,
}

/// An edge that is taken.
#[derive(Debug, Clone, Copy)]
pub struct Move {
    pub edge: EdgeId,
    pub target: ModeId,
    pub from: LeafId,
    pub to: LeafId,
}

impl<'a> Eye<'a> {
    pub fn entity(&self, slot: SlotId) -> &'a Entity {
        &self.program.entities[self.world.slots[slot].entity]
    }

    pub fn instance(&self, of: Subject) -> Option<SlotId> {
        let mine = &self.world.layout.slots[self.me];
        match of {
            Subject::Me => Some(self.me),
            Subject::Slot(slot) => Some(slot),
            Subject::Ref(id) => mine.reference(self.state, id),
            Subject::Touched(id) => mine.touched(self.state, id),
            Subject::Probed(id) => match self.program.exprs[self.entity(self.me).probes[id]] {
                Expr::Probe { mine, other, offset, bound, tiles } => {
                    match self.look((mine, other), offset, (bound, tiles))? {
                        Place::Instance(slot) => Some(slot),
                        Place::Free | Place::Static | Place::Tile => None,
                    }
                }
                Expr::Nearest { of, holds } => self.nearest(of, holds)?,
                _ => None,
            },
            Subject::Member(_) => self.member,
        }
    }

    /// The value of a number; none if reading it stops the run.
    pub fn number(&self, id: ExprId) -> Option<f64> {
        let slots = &self.world.layout.slots;
        let finite = |x: f64| x.is_finite().then_some(x);
        match self.program.exprs[id] {
            Expr::Number(n) => Some(n),
            Expr::Frames(n) => Some(n * self.world.step.seconds()),
            Expr::Param(of, param) => {
                let slot = self.instance(of)?;
                self.notes.note(if of == Subject::Me { "own parameter" } else { "parameter of another" });
                match slots[slot].params {
                    Some(at) => Some(real(self.state, at + 8 * param.index())),
                    None => self.world.slots[slot].params.get(param).copied(),
                }
            }
            Expr::Var(of, var, degree) => {
                let slot = self.instance(of)?;
                self.notes.note(if of == Subject::Me { "own variable" } else { "variable of another" });
                Some(slots[slot].var(self.state, var, degree))
            }
            Expr::Discrete(of, discrete) => {
                let slot = self.instance(of)?;
                self.notes.note(if of == Subject::Me { "own discrete" } else { "discrete of another" });
                Some(f64::from(slots[slot].discrete(self.state, discrete)))
            }
            Expr::Tiles(tag) => {
                self.notes.note("an entity counts tiles");
                let maps = self.world.spaces.iter().filter_map(|space| space.map.as_ref());
                let tags = maps.flat_map(|map| map.cells.iter().map(|cell| &map.kinds[usize::from(*cell)].tags));
                Some(tags.filter(|tags| tags.contains(&tag)).count() as f64)
            }
            Expr::Broken(tag) => {
                self.notes.note("broken tiles are counted");
                let mut count = 0.0;
                for (space, table) in self.world.spaces.pairs() {
                    let Some(map) = &table.map else { continue };
                    let has = |cell: &usize| map.kinds[usize::from(map.cells[*cell])].tags.contains(&tag);
                    count += self.broken(space).iter().filter(|cell| has(cell)).count() as f64;
                }
                Some(count)
            }
            Expr::Axis(axis) => {
                let player = self.world.slots[self.me].player;
                let value = player.map_or(0.0, |p| self.input.of(p).axes[axis.index() % MAX_AXES]);
                self.notes.note(match value {
                    0.0 => "axis at 0",
                    -1.0 | 1.0 => "axis at an end",
                    _ => "axis at a fraction",
                });
                Some(value)
            }
            Expr::Chance(chance) => {
                let before = self.world.slots.ids().take_while(|slot| *slot != self.me);
                let before: usize = before.map(|slot| self.entity(slot).chances.len()).sum();
                let (low, high) = self.entity(self.me).chances[chance].range;
                let value = self.input.1.get(DrawId((before + chance.index()) as u32)).unwrap_or(low);
                self.notes.note(match value {
                    _ if value == low => "the least that is drawn",
                    _ if value == high => "the greatest that is drawn",
                    _ => "what is drawn between",
                });
                Some(f64::from(value))
            }
            Expr::Timer(timer) => {
                let count = slots[self.me].timer(self.state, timer);
                self.notes.note(if count == 0 { "timer at 0" } else { "timer that counts" });
                Some(self.world.step.times(count))
            }
            Expr::Count { of, holds } => {
                let count = self.members(of, holds)?.len();
                self.notes.note(match count {
                    0 => "a count of none",
                    1 => "a count of one",
                    _ => "a count of several",
                });
                Some(count as f64)
            }
            Expr::Distance { of, x, y } => {
                let slot = self.instance(of)?;
                self.notes.note("distance");
                finite(self.way(slot, (self.number(x)?, self.number(y)?)))
            }
            Expr::Negate(a) => Some(-self.number(a)?),
            Expr::Sum(sum) => {
                self.notes.note("the number of a signal");
                Some(slots[self.me].sum(self.state, sum))
            }
            Expr::Arithmetic(op, a, b) => {
                let (a, b) = (self.number(a)?, self.number(b)?);
                self.notes.note(match op {
                    Arithmetic::Add => "+",
                    Arithmetic::Subtract => "-",
                    Arithmetic::Multiply => "*",
                    Arithmetic::Divide => "/",
                });
                (op != Arithmetic::Divide || b != 0.0).then(|| arithmetic(op, a, b)).and_then(finite)
            }
            Expr::Call(Function::If, [condition, a, b]) => {
                let holds = self.truth(condition)?;
                self.notes.turned_out("if", holds);
                self.number(if holds { a } else { b })
            }
            Expr::Call(function, [a, b, c]) => {
                self.notes.note(function_name(function));
                finite(call(function, [self.number(a)?, self.number(b)?, self.number(c)?]))
            }
            _ => Some(f64::from(u8::from(self.truth(id)?))),
        }
    }

    /// Whether a guard holds; none if reading it stops the run.
    pub fn truth(&self, id: ExprId) -> Option<bool> {
        let atom = |name: &str, holds: bool| {
            self.notes.turned_out(name, holds);
            Some(holds)
        };
        let slots = &self.world.layout.slots;
        match self.program.exprs[id] {
            Expr::Bool(b) => Some(b),
            Expr::Compare(op, a, b) => {
                let (a, b) = (self.number(a)?, self.number(b)?);
                atom(op_name(op), compare(op, a, b))
            }
            Expr::And(a, b) => {
                let holds = self.truth(a)? && self.truth(b)?;
                atom("and", holds)
            }
            Expr::Or(a, b) => {
                let holds = self.truth(a)? || self.truth(b)?;
                atom("or", holds)
            }
            Expr::Not(a) => {
                let holds = !self.truth(a)?;
                atom("not", holds)
            }
            Expr::Button(press, button) => {
                let player = self.world.slots[self.me].player;
                let now = player.map_or(0, |p| self.input.of(p).buttons) >> button.index() & 1 == 1;
                let old = player.map_or(0, |p| buttons(self.state, self.world.layout.players[p])) >> button.index() & 1;
                match press {
                    Press::Pressed => atom("pressed", now && old == 0),
                    Press::Held => atom("held", now),
                    Press::Released => atom("released", !now && old == 1),
                }
            }
            Expr::Touching(of, touch) => {
                let holds = self.instance(of).is_some_and(|s| slots[s].touch(self.state, touch));
                let question = self.instance(of).and_then(|s| self.entity(s).touches.get(touch));
                let name = match question {
                    Some(t) if t.bound => "touching as",
                    Some(t) if t.side.is_some() => "touching on a side",
                    _ => "touching",
                };
                atom(name, holds)
            }
            Expr::Probe { mine, other, offset, bound, tiles } => {
                let found = self.look((mine, other), offset, (bound, tiles))?;
                if found == Place::Tile {
                    self.notes.note("a place with a breakable tile");
                }
                if matches!(found, Place::Instance(_)) {
                    self.notes.note("a place with an instance");
                }
                atom(if bound { "touching at, as" } else { "touching at" }, found != Place::Free)
            }
            Expr::Joint(mode, is_entering) => {
                let modes = &self.entity(self.me).modes;
                let group = modes[mode].group;
                let holds = self.taken.get(group.index()).copied().flatten().is_some_and(|m| {
                    let there = if is_entering { m.to } else { m.from };
                    let is_active = |leaf: LeafId| modes[mode].leaves.contains(leaf);
                    let is_around = mode < m.target && m.target < modes[mode].end;
                    is_active(there) && !(is_around && is_active(m.from))
                });
                atom(if is_entering { "entering" } else { "exiting" }, holds)
            }
            Expr::Received(signal) => atom("received", slots[self.me].signal(self.state, signal)),
            Expr::IsNone(of) => atom("is none", self.instance(of).is_none()),
            Expr::Is(of, entity) => {
                atom("is ENTITY", self.instance(of).is_some_and(|s| self.world.slots[s].entity == entity))
            }
            Expr::Alive(slot) => atom("alive", slots[slot].alive(self.state)),
            Expr::InMode(of, mode) => {
                let name = if of == Subject::Me { "in MODE" } else { "in MODE of another" };
                let holds = self.instance(of).is_some_and(|slot| {
                    let modes = &self.entity(slot).modes;
                    modes.get(mode).is_some_and(|m| {
                        let leaf = slots[slot].leaf(self.state, m.group);
                        m.leaves.contains(leaf)
                    })
                });
                atom(name, holds)
            }
            Expr::InSpace(of, space) => {
                atom("inside", self.instance(of).is_some_and(|s| slots[s].space(self.state) == space))
            }
            Expr::Near { of, x, y, radius } => {
                let Some(slot) = self.instance(of) else { return atom("near", false) };
                let way = self.way(slot, (self.number(x)?, self.number(y)?));
                atom("near", way <= self.number(radius)?)
            }
            Expr::Nearest { of, holds } => {
                let found = self.nearest(of, holds)?;
                atom("nearest", found.is_some())
            }
            _ => Some(self.number(id)? != 0.0),
        }
    }

    /// The instances of an entity for which something holds.
    fn members(&self, of: EntityId, holds: ExprId) -> Option<Vec<SlotId>> {
        let mut found = Vec::new();
        for (slot, s) in self.world.slots.pairs() {
            let is_one = s.entity == of && self.world.layout.slots[slot].alive(self.state);
            if is_one && (Eye { member: Some(slot), ..*self }).truth(holds)? {
                found.push(slot);
            }
        }
        Some(found)
    }

    /// The nearest other instance in the same space for which something holds.
    fn nearest(&self, of: EntityId, holds: ExprId) -> Option<Option<SlotId>> {
        let slots = &self.world.layout.slots;
        let (mine, at) = (&slots[self.me], |slot: SlotId, axis| slots[slot].var(self.state, VarId(axis), 0));
        let me = (at(self.me, 0), at(self.me, 1));
        let mut found = self.members(of, holds)?;
        found.retain(|slot| *slot != self.me && slots[*slot].space(self.state) == mine.space(self.state));
        // Stable: of several that are as near, the first slot.
        found.sort_by(|a, b| self.way(*a, me).total_cmp(&self.way(*b, me)));
        Some(found.first().copied())
    }

    /// The distance of an instance to a point, by the shortest way around.
    fn way(&self, slot: SlotId, to: (f64, f64)) -> f64 {
        let layout = &self.world.layout.slots[slot];
        let at = |axis: u32| layout.var(self.state, VarId(axis), 0);
        let (mut dx, mut dy) = (at(0) - to.0, at(1) - to.1);
        let periods = self.world.spaces[layout.space(self.state)].periods;
        for (way, period) in [&mut dx, &mut dy].into_iter().zip(periods) {
            if let Some(period) = period {
                *way -= period.size() * (*way / period.size()).round();
            }
        }
        (dx * dx + dy * dy).sqrt()
    }

    /// The edge that a group takes in this step, if nothing stops the run; groups that it waits for are in `taken`.
    pub fn decide(&self, group: hypedc::ir::GroupId) -> Option<Move> {
        let entity = self.entity(self.me);
        let from = self.world.layout.slots[self.me].leaf(self.state, group);
        let edge =
            entity.leaves[from].edges.iter().copied().find(|e| self.truth(entity.edges[*e].guard) == Some(true))?;
        let target = entity.edges[edge].target?;
        let mut at = &entity.modes[target];
        while at.chooses {
            let Some(inner) = at.inner else { break };
            let chosen = at.choices.iter().find(|c| self.truth(c.guard) == Some(true));
            at = &entity.modes[chosen.map_or(inner, |c| c.mode)];
        }
        Some(Move { edge, target, from, to: at.initial })
    }
}

fn op_name(op: CompareOp) -> &'static str {
    match op {
        CompareOp::Less => "<",
        CompareOp::AtMost => "<=",
        CompareOp::Greater => ">",
        CompareOp::AtLeast => ">=",
        CompareOp::Equal => "==",
        CompareOp::Unequal => "!=",
    }
}

fn function_name(function: Function) -> &'static str {
    match function {
        Function::Min => "min",
        Function::Max => "max",
        Function::Abs => "abs",
        Function::Sign => "sign",
        Function::Clamp => "clamp()",
        Function::Floor => "floor",
        Function::Ceil => "ceil",
        Function::Round => "round",
        Function::Sqrt => "sqrt",
        Function::Sin => "sin",
        Function::Cos => "cos",
        Function::Atan2 => "atan2",
        Function::Mod => "mod",
        Function::If => "if",
    }
}

/// The driver of an envelope.
pub fn by_name(by: &By) -> &'static str {
    match by {
        By::Button(_) => "by a button",
        By::Axis(_) => "by an axis",
        By::Axes(_, ways) if ways.is_empty() => "by two axes, any direction",
        By::Axes(..) => "by two axes, directions",
        By::Clock { .. } => "fixed",
    }
}
