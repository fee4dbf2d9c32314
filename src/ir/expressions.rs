//! Traversal of expressions: those that an entity reads at run time, and the operands of an expression.

use super::{Actions, Drive, Entity, Expr, ExprId, Extremes, Id, Program, Release};
use crate::ir::{EntityId, IdVec, ParamId, Step, Subject, TagSet, Timer, TimerId, arithmetic, call, compare};

impl Entity {
    /// The expressions of its flows: of drives, envelopes and clamps.
    pub fn flow_exprs(&self) -> Vec<ExprId> {
        let drives = self.free.iter().chain(self.leaves.iter().flat_map(|l| &l.drives));
        let values = drives.filter_map(|d| match d {
            Drive::Flow { value, .. } => Some(*value),
            Drive::Coast(_) | Drive::Envelope(..) => None,
        });
        let mut out: Vec<ExprId> = values.collect();
        out.extend(self.clamps.iter().flat_map(|c| [c.low, c.high]).flatten());
        for e in self.envelopes.iter() {
            out.push(e.sustain);
            out.extend([e.attack, e.peak, e.decay, e.guard].into_iter().flatten());
            if let Release::To { rate, level } = e.release {
                out.extend(rate);
                out.push(level);
            }
        }
        out
    }

    /// The number of signals that come with a number, the first ones.
    pub fn numbered_signals(&self) -> usize {
        self.signals.iter().take_while(|signal| signal.number.is_some()).count()
    }

    /// All its actions in the discrete phase: on edges, on entry of modes, on links.
    pub fn action_lists(&self) -> impl Iterator<Item = &Actions> {
        self.guarded_actions().map(|(_, actions)| actions)
    }

    /// The expressions that it evaluates.
    pub fn exprs(&self) -> Vec<ExprId> {
        let mut out = self.flow_exprs();
        out.extend(self.edges.iter().map(|e| e.guard));
        out.extend(self.follows.iter().filter_map(|f| f.guard));
        for actions in self.action_lists() {
            out.extend(actions.updates.iter().map(|u| u.value));
        }
        for spawn in self.spawns.iter() {
            out.extend(spawn.params.iter().map(|(_, value)| *value));
            out.extend(spawn.updates.iter().map(|u| u.value));
        }
        out.extend(self.sends.iter().filter_map(|send| send.value));
        out.extend(self.invariants.iter());
        out.extend(self.colliders.iter().filter_map(|c| c.guard));
        out
    }
}

impl Expr {
    /// The instance that an expression reads.
    pub fn subject(self) -> Option<Subject> {
        match self {
            Expr::Param(of, _)
            | Expr::Var(of, ..)
            | Expr::Discrete(of, _)
            | Expr::Touching(of, _)
            | Expr::IsNone(of)
            | Expr::Is(of, _)
            | Expr::InMode(of, _)
            | Expr::InSpace(of, _)
            | Expr::Near { of, .. }
            | Expr::Distance { of, .. } => Some(of),
            Expr::Alive(slot) => Some(Subject::Slot(slot)),
            Expr::Count { of, .. } | Expr::Nearest { of, .. } => Some(Subject::Member(of)),
            Expr::Number(_)
            | Expr::Frames(_)
            | Expr::Bool(_)
            | Expr::Axis(_)
            | Expr::Chance(_)
            | Expr::Timer(_)
            | Expr::Negate(_)
            | Expr::Arithmetic(..)
            | Expr::Call(..)
            | Expr::Compare(..)
            | Expr::And(..)
            | Expr::Or(..)
            | Expr::Not(_)
            | Expr::Button(..)
            | Expr::Probe { .. }
            | Expr::Joint(..)
            | Expr::Received(_)
            | Expr::Sum(_)
            | Expr::Broken(_)
            | Expr::Tiles(_) => None,
        }
    }
}

impl Program {
    /// Whether a probe asks for something with some tags.
    pub fn is_probed(&self, tags: TagSet) -> bool {
        self.exprs.iter().any(|expr| matches!(expr, Expr::Probe { other, .. } if TagSet::of(*other).meets(tags)))
    }

    /// Some expressions and all their operands, each once, in order.
    pub fn with_operands(&self, mut open: Vec<ExprId>) -> Vec<ExprId> {
        let mut seen = vec![false; self.exprs.len()];
        let mut out = Vec::new();
        while let Some(id) = open.pop() {
            if !std::mem::replace(&mut seen[id.index()], true) {
                out.push(id);
                open.extend(self.exprs[id].operands());
            }
        }
        out.sort_unstable();
        out
    }
}

impl Expr {
    /// Its operands.
    pub fn operands(self) -> Vec<ExprId> {
        match self {
            Expr::Negate(a) | Expr::Not(a) => vec![a],
            Expr::Arithmetic(_, a, b) | Expr::Compare(_, a, b) | Expr::And(a, b) | Expr::Or(a, b) => {
                vec![a, b]
            }
            Expr::Call(_, args) => args.to_vec(),
            Expr::Near { of: _, x, y, radius } => vec![x, y, radius],
            Expr::Distance { of: _, x, y } => vec![x, y],
            Expr::Count { of: _, holds } | Expr::Nearest { of: _, holds } => vec![holds],
            Expr::Probe { offset, .. } => offset.to_vec(),
            Expr::Number(_)
            | Expr::Frames(_)
            | Expr::Bool(_)
            | Expr::Param(..)
            | Expr::Joint(..)
            | Expr::Received(_)
            | Expr::Sum(_)
            | Expr::IsNone(_)
            | Expr::Is(..)
            | Expr::Alive(_)
            | Expr::Var(..)
            | Expr::Discrete(..)
            | Expr::Axis(_)
            | Expr::Chance(_)
            | Expr::Timer(_)
            | Expr::Button(..)
            | Expr::Touching(..)
            | Expr::InMode(..)
            | Expr::Broken(_)
            | Expr::Tiles(_)
            | Expr::InSpace(..) => Vec::new(),
        }
    }
}

impl Program {
    /// The count above which each timer's value no longer matters: the first whose time exceeds everything that it is
    /// compared with. The compared values may read parameters if these are known.
    pub fn timer_limits(
        &self,
        entity: EntityId,
        params: Option<&IdVec<ParamId, f64>>,
        step: Step,
    ) -> IdVec<TimerId, u32> {
        let unknown = IdVec::new();
        let params = params.unwrap_or(&unknown);
        let limit = |timer: &Timer| {
            let Some(thresholds) = &timer.thresholds else {
                return u32::MAX;
            };
            let mut greatest = 0.0f64;
            for &id in thresholds {
                match self.constant(id, params, step) {
                    Some(value) => greatest = greatest.greatest(value),
                    None => return u32::MAX,
                }
            }
            let estimate = (greatest / step.seconds()).floor();
            if estimate >= f64::from(u32::MAX - 2) {
                return u32::MAX;
            }
            let mut count = estimate as u32;
            while step.times(count) <= greatest && count < u32::MAX {
                count += 1;
            }
            count
        };
        self.entities[entity].timers.iter().map(limit).collect()
    }

    /// The value of an expression that reads only parameters and the step; `None` if it reads more, or has no finite
    /// value.
    pub fn constant(&self, id: ExprId, params: &IdVec<ParamId, f64>, step: Step) -> Option<f64> {
        let value = |id| self.constant(id, params, step);
        let result = match self.exprs[id] {
            Expr::Number(n) => n,
            Expr::Frames(n) => step.frames(n),
            Expr::Bool(b) => f64::from(u8::from(b)),
            // NaN is unknown.
            Expr::Param(Subject::Me, p) => params.get(p).copied().filter(|p| p.is_finite())?,
            Expr::Negate(a) => -value(a)?,
            Expr::Not(a) => f64::from(u8::from(value(a)? == 0.0)),
            Expr::And(a, b) => f64::from(u8::from(value(a)? != 0.0 && value(b)? != 0.0)),
            Expr::Or(a, b) => f64::from(u8::from(value(a)? != 0.0 || value(b)? != 0.0)),
            Expr::Arithmetic(op, a, b) => arithmetic(op, value(a)?, value(b)?),
            Expr::Compare(op, a, b) => f64::from(u8::from(compare(op, value(a)?, value(b)?))),
            Expr::Call(function, [a, b, c]) => call(function, [value(a)?, value(b)?, value(c)?]),
            _ => return None,
        };
        result.is_finite().then_some(result)
    }
}
