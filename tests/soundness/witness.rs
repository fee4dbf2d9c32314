//! Predicates that are known to hold, or to fail, in states that runs have reached: whether the analysis says that they
//! never do. They are put into the tables, so that no other world has to be compiled, looked at and run.

use hypedc::analysis::ConfigurationSpace;
use hypedc::ir::{
    CompareOp, DiscreteId, Domain, Expr, ExprId, Origin, Program, SlotId, Subject, TagSet, VarId, World, WorldId,
};
use hypedc::sim::Input;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::sync::Arc;

use super::eye::{Eye, Nobody};
use super::frame::number;

/// Number of predicates per world.
const PREDICATES: usize = 8;

/// A false claim about a predicate.
pub struct Denied {
    pub what: String,
    /// The predicate as text, or its negation, so that it holds; none if it has no text.
    pub holds: Option<String>,
}

/// The first predicate whose truth value in one of some states is claimed to be impossible.
pub fn denied(
    program: &Arc<Program>,
    world: WorldId,
    space: &ConfigurationSpace,
    states: &[Vec<u8>],
    seed: u64,
) -> Option<Denied> {
    if states.is_empty() {
        return None;
    }
    let mut maker =
        Maker { program: Program::clone(program), world: &program.worlds[world], rng: Pcg64::seed_from_u64(seed) };
    let table = &program.worlds[world];
    let mut all: Vec<Part> = Vec::new();
    table.goals.iter().chain(table.nevers.iter()).for_each(|p| questions(program, p.holds, &mut all));
    all.extend((0..PREDICATES).filter_map(|_| maker.predicate(states)));
    let (program, nothing) = (&maker.program, Input::nothing(table.players.len()));
    for (predicate, text) in all {
        let truth = |state: &Vec<u8>| {
            let eye = Eye {
                program,
                world: table,
                state,
                input: &nothing,
                me: SlotId(0),
                member: None,
                taken: &[],
                notes: &Nobody,
            };
            eye.truth(predicate)
        };
        let mut seen = [false; 2];
        states.iter().filter_map(truth).for_each(|holds| seen[usize::from(holds)] = true);
        for holds in [false, true] {
            if seen[usize::from(holds)] && !space.can_evaluate_to(program, world, predicate, holds) {
                let verb = if holds { "holds" } else { "fails" };
                let name = text.clone().unwrap_or_else(|| format!("expression {predicate:?}"));
                let opposite = |text: String| if holds { text } else { format!("not ({text})") };
                return Some(Denied {
                    what: format!("{name} {verb}, which is proven never to"),
                    holds: text.map(opposite),
                });
            }
        }
    }
    None
}

/// A predicate and its parts. An instance is read only if there is one.
fn questions(program: &Program, id: ExprId, out: &mut Vec<Part>) {
    fn is_guard(program: &Program, id: ExprId) -> bool {
        match program.exprs[id] {
            Expr::Alive(_) => true,
            Expr::And(a, b) => is_guard(program, a) && is_guard(program, b),
            _ => false,
        }
    }
    out.push((id, None));
    match program.exprs[id] {
        Expr::And(a, b) | Expr::Or(a, b) if !is_guard(program, a) => {
            questions(program, a, out);
            questions(program, b, out);
        }
        Expr::Not(a) => questions(program, a, out),
        _ => {}
    }
}

/// A program with one more goal.
pub fn with_goal(text: &str, holds: &str) -> Option<String> {
    let mut lines: Vec<String> = text.lines().map(str::to_string).collect();
    let end = lines.iter().rposition(|l| l.trim() == "}")?;
    lines.insert(end, format!("goal witness: {holds}"));
    Some(lines.join("\n") + "\n")
}

struct Maker<'a> {
    program: Program,
    world: &'a World,
    rng: Pcg64,
}

/// An expression, and its text if it has one.
type Part = (ExprId, Option<String>);

impl Maker<'_> {
    fn push(&mut self, expr: Expr) -> ExprId {
        self.program.exprs.push(expr)
    }

    fn one<T: Clone>(&mut self, of: &[T]) -> Option<T> {
        (!of.is_empty()).then(|| of[self.rng.random_range(0..of.len())].clone())
    }

    /// A conjunction that holds in one of some states.
    fn predicate(&mut self, states: &[Vec<u8>]) -> Option<Part> {
        let state = &states[self.rng.random_range(0..states.len())];
        let count = self.rng.random_range(1..4);
        let parts: Vec<Part> = (0..count).filter_map(|_| self.part(state)).collect();
        let and = |maker: &mut Self, (a, one): Part, (b, other): Part| {
            let text = one.zip(other).map(|(one, other)| format!("{one} and {other}"));
            (maker.push(Expr::And(a, b)), text)
        };
        parts.into_iter().reduce(|a, b| and(self, a, b))
    }

    /// An atom that holds in a state.
    fn part(&mut self, state: &[u8]) -> Option<Part> {
        let world = self.world;
        let slots: Vec<SlotId> = world.slots.ids().filter(|s| world.layout.slots[*s].alive(state)).collect();
        let slot = self.one(&slots)?;
        let s = &world.slots[slot];
        let all: Vec<SlotId> = world.slots.pairs().filter(|(_, o)| o.entity == s.entity).map(|(id, _)| id).collect();
        match s.origin == Origin::Named {
            true => {
                let (atom, text) = self.atom(state, slot, &[slot], &s.name)?;
                Some((atom, text))
            }
            // Others have no name.
            false => {
                let name = format!("any {}", self.program.entities[s.entity].name);
                self.atom(state, slot, &all, &name)
            }
        }
    }

    /// The atom of one of some slots: of any of them that is alive.
    fn of_any(&mut self, slots: &[SlotId], atom: impl Fn(&mut Self, Subject) -> Expr) -> Option<ExprId> {
        let mut some: Vec<ExprId> = Vec::new();
        for slot in slots {
            let is_alive = self.push(Expr::Alive(*slot));
            let atom = atom(self, Subject::Slot(*slot));
            let atom = self.push(atom);
            some.push(self.push(Expr::And(is_alive, atom)));
        }
        // A balanced tree, as the compiler makes it: expressions are read by recursion.
        while some.len() > 1 {
            let halves = some.chunks(2).map(|pair| match *pair {
                [a, b] => self.push(Expr::Or(a, b)),
                _ => pair[0],
            });
            some = halves.collect();
        }
        some.pop()
    }

    fn atom(&mut self, state: &[u8], slot: SlotId, slots: &[SlotId], who: &str) -> Option<Part> {
        let (world, s) = (self.world, &self.world.slots[slot]);
        let layout = &world.layout.slots[slot];
        let entity = self.program.entities[s.entity].clone();
        let is_named = slots == [slot] && s.origin == Origin::Named;
        let var = |var: VarId, degree: u8| Some(layout.var(state, var, degree)).filter(|x| x.abs() < 1e12);
        match self.rng.random_range(0..9) {
            0..=2 => {
                let (id, degree) = (self.one(&entity.vars.ids().collect::<Vec<_>>())?, self.rng.random_range(0..3));
                let value = var(id, degree)?;
                let ops = [(CompareOp::AtLeast, ">="), (CompareOp::AtMost, "<="), (CompareOp::Equal, "==")];
                let (op, sign) = self.one(&ops)?;
                let known = self.push(Expr::Number(value));
                let expr = self.of_any(slots, |maker, of| {
                    let read = maker.push(Expr::Var(of, id, degree));
                    // An operand has a lower number.
                    let known = maker.push(maker.program.exprs[known]);
                    Expr::Compare(op, read, known)
                })?;
                let name = format!("{who}.{}{}", entity.vars[id], "'".repeat(usize::from(degree)));
                Some((expr, is_named.then(|| format!("{name} {sign} {}", number(value)))))
            }
            3 => {
                let (x, y) = (var(VarId(0), 0)?, var(VarId(1), 0)?);
                let (radius, text) = self.one(&[(0.001, "0.001"), (0.0, "0"), (4.0, "4")])?;
                let expr = self.of_any(slots, |maker, of| {
                    let [x, y, radius] = [x, y, radius].map(|n| maker.push(Expr::Number(n)));
                    Expr::Near { of, x, y, radius }
                })?;
                Some((expr, Some(format!("near({who}, ({}, {}), {text})", number(x), number(y)))))
            }
            4 | 5 => {
                let paths = entity.groups.ids().flat_map(|g| entity.leaves[layout.leaf(state, g)].path.clone());
                let mode = self.one(&paths.collect::<Vec<_>>())?;
                let expr = self.of_any(slots, |_, of| Expr::InMode(of, mode))?;
                Some((expr, Some(format!("{who} in {}", entity.modes[mode].path))))
            }
            6 => {
                let space = layout.space(state);
                let expr = self.of_any(slots, |_, of| Expr::InSpace(of, space))?;
                Some((expr, Some(format!("inside({who}, {})", world.spaces[space].name))))
            }
            7 => {
                let id: DiscreteId = self.one(&entity.discretes.ids().collect::<Vec<_>>())?;
                let (value, discrete) = (layout.discrete(state, id), &entity.discretes[id]);
                let expr = self.of_any(slots, |maker, of| {
                    let read = maker.push(Expr::Discrete(of, id));
                    let known = maker.push(Expr::Number(f64::from(value)));
                    Expr::Compare(CompareOp::Equal, read, known)
                })?;
                let value = match &discrete.domain {
                    Domain::Int => value.to_string(),
                    Domain::Bool => (value != 0).to_string(),
                    Domain::Set(names) => names[value as usize].clone(),
                };
                Some((expr, is_named.then(|| format!("{who}.{} == {value}", discrete.name))))
            }
            _ => {
                let held = entity.touches.ids().filter(|t| layout.touch(state, *t));
                let id = self.one(&held.collect::<Vec<_>>())?;
                let touch = &entity.touches[id];
                let expr = self.of_any(slots, |_, of| Expr::Touching(of, id))?;
                let is_plain = touch.side.is_none() && !touch.bound && touch.mine == TagSet::ALL;
                let name = &self.program.tags[touch.other];
                Some((expr, is_plain.then(|| format!("{who} touching \"{name}\""))))
            }
        }
    }
}
