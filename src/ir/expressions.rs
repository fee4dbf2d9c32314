//! Which expressions there are: those that an entity reads as it runs, and those that one is made of.

use super::{Actions, Drive, Entity, Expr, ExprId, Id, Program, Release};

impl Entity {
    /// The expressions that decide how its variables flow: those of drives, envelopes and clamps.
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

    /// All that it can do in the discrete phase: on edges, as it enters modes, as it follows links.
    pub fn action_lists(&self) -> impl Iterator<Item = &Actions> {
        let edges = self.edges.iter().map(|edge| &edge.actions);
        let entries = self.modes.iter().map(|mode| &mode.entry);
        edges.chain(entries).chain(self.follows.iter().map(|follow| &follow.actions))
    }

    /// The expressions that it compares with, writes and flows by.
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
        out.extend(self.invariants.iter());
        out.extend(self.colliders.iter().filter_map(|c| c.guard));
        out
    }
}

impl Program {
    /// Some expressions and all that they are made of, each once, in order.
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
    /// The expressions that it is made of.
    pub fn operands(self) -> Vec<ExprId> {
        match self {
            Expr::Negate(a) | Expr::Not(a) => vec![a],
            Expr::Arithmetic(_, a, b) | Expr::Compare(_, a, b) | Expr::And(a, b) | Expr::Or(a, b) => {
                vec![a, b]
            }
            Expr::Call(_, args) => args.to_vec(),
            Expr::Near { of: _, x, y, radius } => vec![x, y, radius],
            Expr::Number(_)
            | Expr::Frames(_)
            | Expr::Bool(_)
            | Expr::Param(..)
            | Expr::Joint(..)
            | Expr::IsNone(_)
            | Expr::Is(..)
            | Expr::Alive(_)
            | Expr::Var(..)
            | Expr::Discrete(..)
            | Expr::Axis(_)
            | Expr::Timer(_)
            | Expr::Button(..)
            | Expr::Touching(..)
            | Expr::InMode(..)
            | Expr::InSpace(..) => Vec::new(),
        }
    }
}
