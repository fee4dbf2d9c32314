//! The text form of a program: for people, and for tests that hold it.

use std::fmt::Write;

use super::{
    Arithmetic, Choice, CompareOp, Domain, Drive, Entity, Expr, ExprId, Function, Place, Press, Program, Release,
    Response, Side, Subject, TagSet, Update, World,
};

/// The whole program as text.
pub fn text(program: &Program) -> String {
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = write_program(&mut out, program);
    out
}

type Result = std::fmt::Result;

fn write_program(out: &mut String, p: &Program) -> Result {
    for entity in p.entities.iter() {
        EntityText { p, e: entity }.write(out)?;
    }
    for world in p.worlds.iter() {
        write_world(out, p, world)?;
    }
    Ok(())
}

fn tags(p: &Program, set: TagSet) -> String {
    if set == TagSet::ALL {
        return "*".into();
    }
    set.iter().filter_map(|t| p.tags.get(t).map(String::as_str)).collect::<Vec<_>>().join(", ")
}

struct EntityText<'a> {
    p: &'a Program,
    e: &'a Entity,
}

impl EntityText<'_> {
    fn write(&self, out: &mut String) -> Result {
        let (p, e) = (self.p, self.e);
        writeln!(out, "entity {}", e.name)?;
        for (id, param) in e.params.pairs() {
            writeln!(out, "  {id} {} = {}", param.name, self.expr(param.default))?;
        }
        for (id, var) in e.vars.pairs() {
            writeln!(out, "  {id} {var}")?;
        }
        for (id, d) in e.discretes.pairs() {
            let domain = match &d.domain {
                Domain::Int => format!("int {}..{}", d.range.0, d.range.1),
                Domain::Bool => "bool".into(),
                Domain::Set(names) => format!("{{{}}}", names.join(", ")),
            };
            writeln!(out, "  {id} {}: {domain}", d.name)?;
        }
        for (id, name) in e.buttons.pairs() {
            writeln!(out, "  {id} {name}")?;
        }
        for (id, name) in e.axes.pairs() {
            writeln!(out, "  {id} {name}")?;
        }
        for (id, c) in e.colliders.pairs() {
            let rect: Vec<String> = c.rect.iter().map(|&r| self.expr(r)).collect();
            let kinematic = if c.kinematic { "kinematic " } else { "" };
            let guard = c.guard.map_or(String::new(), |g| format!(" when {}", self.expr(g)));
            writeln!(out, "  {id} {kinematic}{}: rect({}){guard}", tags(p, c.tags), rect.join(", "))?;
        }
        for (id, t) in e.touches.pairs() {
            let side = t.side.map_or(String::new(), |s| format!(", {}", side(s)));
            writeln!(out, "  {id} ({}, {}{side})", tags(p, t.mine), tags(p, TagSet::of(t.other)))?;
        }
        for (id, t) in e.timers.pairs() {
            let limits = match &t.thresholds {
                Some(list) => list.iter().map(|&x| self.expr(x)).collect::<Vec<_>>().join(", "),
                None => "anything".into(),
            };
            writeln!(out, "  {id} of {} against {limits}", e.modes[t.mode].path)?;
        }
        for (id, v) in e.envelopes.pairs() {
            let attack = v.attack.map_or("instant".into(), |a| format!("accel {}", self.expr(a)));
            let release = match v.release {
                Release::Hold => "hold".into(),
                Release::To { rate, level } => {
                    let rate = rate.map_or("instant".into(), |r| format!("accel {}", self.expr(r)));
                    format!("{rate} to {}", self.expr(level))
                }
            };
            let guard = v.guard.map_or(String::new(), |g| format!(", while {}", self.expr(g)));
            let axis = &e.axes[v.axis];
            let sustain = self.expr(v.sustain);
            writeln!(
                out,
                "  {id} {} by {axis}: attack {attack}, sustain {sustain}, release {release}{guard}",
                self.var(v.var, v.degree)
            )?;
        }
        for (id, edge) in e.edges.pairs() {
            let target = edge.target.map_or("stays".into(), |t| format!("-> {}", e.modes[t].path));
            let source = &e.modes[edge.source].path;
            let updates = self.updates(&edge.updates);
            writeln!(out, "  {id} {source} {target} when {}{updates}", self.expr(edge.guard))?;
        }
        self.drives(out, "  always", &e.free)?;
        for (id, group) in e.groups.pairs() {
            let name = group.name.as_deref().unwrap_or("(anonymous)");
            writeln!(out, "  {id} {name}: starts at {}{}", self.choices(&group.choices), e.modes[group.first].path)?;
            for mode in group.modes.0.0..group.modes.1.0 {
                let id = super::ModeId(mode);
                let m = &e.modes[id];
                let entry = self.updates(&m.entry);
                let initial = e.leaves[m.initial].mode;
                let inner = match m.inner {
                    None => String::new(),
                    Some(inner) => format!(" enters {}{}", self.choices(&m.choices), e.modes[inner].path),
                };
                writeln!(out, "    {id} {}{inner}{entry}", m.path)?;
                if m.leaves.0 == m.initial && initial == id {
                    let leaf = &e.leaves[m.initial];
                    self.drives(out, &format!("      {}", m.initial), &leaf.drives)?;
                    if !leaf.edges.is_empty() {
                        let list: Vec<String> = leaf.edges.iter().map(ToString::to_string).collect();
                        writeln!(out, "      tries {}", list.join(", "))?;
                    }
                    if !leaf.internal.is_empty() {
                        let list: Vec<String> = leaf.internal.iter().map(ToString::to_string).collect();
                        writeln!(out, "      runs {}", list.join(", "))?;
                    }
                    let mut reads: Vec<&str> = Vec::new();
                    reads.extend(
                        e.buttons.pairs().filter(|(b, _)| leaf.inputs.buttons >> b.0 & 1 == 1).map(|(_, n)| n.as_str()),
                    );
                    reads.extend(
                        e.axes.pairs().filter(|(a, _)| leaf.inputs.axes >> a.0 & 1 == 1).map(|(_, n)| n.as_str()),
                    );
                    if !reads.is_empty() {
                        writeln!(out, "      reads {}", reads.join(", "))?;
                    }
                }
            }
        }
        writeln!(out)
    }

    /// `a if GUARD, else `
    fn choices(&self, choices: &[Choice]) -> String {
        let one = |c: &Choice| format!("{} if {}, else ", self.e.modes[c.mode].path, self.expr(c.guard));
        choices.iter().map(one).collect()
    }

    fn drives(&self, out: &mut String, head: &str, drives: &[Drive]) -> Result {
        if drives.is_empty() {
            return Ok(());
        }
        let list: Vec<String> = drives
            .iter()
            .map(|d| match *d {
                Drive::Coast(var) => format!("{} coasts", self.e.vars[var]),
                Drive::Flow { var, degree, value } => {
                    format!("{} = {}", self.var(var, degree), self.expr(value))
                }
                Drive::Envelope(id) => id.to_string(),
            })
            .collect();
        writeln!(out, "{head}: {}", list.join("; "))
    }

    fn var(&self, var: super::VarId, degree: u8) -> String {
        format!("{}{}", self.e.vars[var], "'".repeat(usize::from(degree)))
    }

    fn updates(&self, updates: &[Update]) -> String {
        if updates.is_empty() {
            return String::new();
        }
        let list: Vec<String> = updates
            .iter()
            .map(|u| {
                let place = match u.place {
                    Place::Var(var, degree) => self.var(var, degree),
                    Place::Discrete(id) => self.e.discretes[id].name.clone(),
                };
                format!("{place} := {}", self.expr(u.value))
            })
            .collect();
        format!(" {{ {} }}", list.join("; "))
    }

    fn expr(&self, id: ExprId) -> String {
        expression(self.p, id, &|_| self.e, &|_| String::new())
    }
}

fn side(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
        Side::Above => "above",
        Side::Below => "below",
    }
}

/// An expression with the names of its entity; `owner` names an instance with a dot after it.
fn expression<'a>(
    p: &Program,
    id: ExprId,
    entity: &dyn Fn(Subject) -> &'a Entity,
    owner: &dyn Fn(Subject) -> String,
) -> String {
    let sub = |id| expression(p, id, entity, owner);
    let me = || entity(Subject::Me);
    match p.exprs[id] {
        Expr::Number(n) => n.to_string(),
        Expr::Frames(n) => format!("{n}frames"),
        Expr::Bool(b) => b.to_string(),
        Expr::Param(param) => me().params.get(param).map_or_else(|| param.to_string(), |p| p.name.clone()),
        Expr::Var(of, var, degree) => {
            format!("{}{}{}", owner(of), entity(of).vars[var], "'".repeat(usize::from(degree)))
        }
        Expr::Discrete(of, d) => format!("{}{}", owner(of), entity(of).discretes[d].name),
        Expr::Axis(axis) => me().axes[axis].clone(),
        Expr::Timer(timer) => format!("timer({})", me().modes[me().timers[timer].mode].path),
        Expr::Negate(a) => format!("-{}", sub(a)),
        Expr::Arithmetic(op, a, b) => {
            let op = match op {
                Arithmetic::Add => "+",
                Arithmetic::Subtract => "-",
                Arithmetic::Multiply => "*",
                Arithmetic::Divide => "/",
            };
            format!("({} {op} {})", sub(a), sub(b))
        }
        Expr::Call(function, args) => {
            let (name, count) = match function {
                Function::Min => ("min", 2),
                Function::Max => ("max", 2),
                Function::Clamp => ("clamp", 3),
                Function::If => ("if", 3),
                Function::Abs => ("abs", 1),
                Function::Sign => ("sign", 1),
                Function::Floor => ("floor", 1),
                Function::Ceil => ("ceil", 1),
                Function::Round => ("round", 1),
                Function::Sqrt => ("sqrt", 1),
                Function::Sin => ("sin", 1),
                Function::Cos => ("cos", 1),
                Function::Atan2 => ("atan2", 2),
            };
            let args: Vec<String> = args.iter().take(count).map(|&a| sub(a)).collect();
            format!("{name}({})", args.join(", "))
        }
        Expr::Compare(op, a, b) => {
            let op = match op {
                CompareOp::Equal => "==",
                CompareOp::Unequal => "!=",
                CompareOp::Less => "<",
                CompareOp::AtMost => "<=",
                CompareOp::Greater => ">",
                CompareOp::AtLeast => ">=",
            };
            format!("{} {op} {}", sub(a), sub(b))
        }
        Expr::And(a, b) => format!("({} and {})", sub(a), sub(b)),
        Expr::Or(a, b) => format!("({} or {})", sub(a), sub(b)),
        Expr::Not(a) => format!("not {}", sub(a)),
        Expr::Button(press, button) => {
            let word = match press {
                Press::Pressed => "pressed",
                Press::Held => "held",
                Press::Released => "released",
            };
            format!("{word}({})", me().buttons[button])
        }
        Expr::Touching(of, touch) => format!("{}{touch}", owner(of)),
        Expr::InMode(of, mode) => format!("{}in {}", owner(of), entity(of).modes[mode].path),
        Expr::InSpace(of, space) => format!("{}in {space}", owner(of)),
        Expr::Near { of, x, y, radius } => {
            format!("near({}, ({}, {}), {})", owner(of).trim_end_matches('.'), sub(x), sub(y), sub(radius))
        }
    }
}

fn write_world(out: &mut String, p: &Program, w: &World) -> Result {
    writeln!(out, "world {}", w.name)?;
    writeln!(out, "  step {}/{}", w.step.numerator, w.step.denominator)?;
    for c in &w.collide {
        let response = match c.response {
            Response::Sense => "sense",
            Response::Block { keep_velocity: false } => "block",
            Response::Block { keep_velocity: true } => "block, keep velocity",
        };
        writeln!(out, "  {} with {}: {response}", tags(p, c.left), tags(p, c.right))?;
    }
    for (id, space) in w.spaces.pairs() {
        write!(out, "  {id} {}", space.name)?;
        if let Some(b) = space.bounds {
            write!(out, " in {}..{}, {}..{}", b.left, b.right, b.bottom, b.top)?;
        }
        for solid in &space.solids {
            let b = solid.bounds;
            write!(out, "\n    {} at {}..{}, {}..{}", tags(p, solid.tags), b.left, b.right, b.bottom, b.top)?;
        }
        let Some(map) = &space.map else {
            writeln!(out)?;
            continue;
        };
        writeln!(out, "\n    {} x {} tiles of {} x {} px", map.columns, map.rows, map.tile.0, map.tile.1)?;
        for kind in map.kinds.iter().filter(|k| !k.tags.is_empty()) {
            writeln!(out, "    {} {}", kind.symbol, tags(p, kind.tags.iter().copied().collect()))?;
        }
        for row in (0..map.rows).rev() {
            let cells = map.cells.iter().skip(row * map.columns).take(map.columns);
            let symbols: String = cells.filter_map(|&c| map.kinds.get(usize::from(c))).map(|k| k.symbol).collect();
            writeln!(out, "    {symbols}")?;
        }
    }
    for (id, slot) in w.slots.pairs() {
        let e = &p.entities[slot.entity];
        let player = slot.player.map_or(String::new(), |n| format!(", player {}", w.players[n].number));
        writeln!(out, "  {id} {}: {} in {}{player}", slot.name, e.name, slot.space)?;
        let mut values: Vec<String> = Vec::new();
        values.extend(e.params.pairs().map(|(id, param)| format!("{} = {}", param.name, slot.params[id])));
        values.extend(e.vars.pairs().map(|(id, name)| format!("{name} = {:?}", slot.vars[id])));
        values.extend(e.discretes.pairs().map(|(id, d)| format!("{} = {}", d.name, slot.discretes[id])));
        writeln!(out, "    {}", values.join(", "))?;
        for (timer, limit) in slot.timer_limits.pairs().filter(|(_, l)| **l != u32::MAX) {
            writeln!(out, "    {timer} saturates at {limit}")?;
        }
        let at = &w.layout.slots[id];
        writeln!(
            out,
            "    at vars {} discretes {} timers {} leaves {} space {} alive {} touches {}",
            at.vars, at.discretes, at.timers, at.leaves, at.space, at.alive, at.touches
        )?;
    }
    let entity = |of: Subject| match of {
        Subject::Slot(slot) => &p.entities[w.slots[slot].entity],
        Subject::Me => &p.entities[super::EntityId(0)],
    };
    let owner = |of: Subject| match of {
        Subject::Slot(slot) => format!("{}.", w.slots[slot].name),
        Subject::Me => String::new(),
    };
    for (id, goal) in w.goals.pairs() {
        writeln!(out, "  {id} {}: {}", goal.name, expression(p, goal.holds, &entity, &owner))?;
    }
    for (id, never) in w.nevers.pairs() {
        writeln!(out, "  {id} {}: {}", never.name, expression(p, never.holds, &entity, &owner))?;
    }
    writeln!(out, "  a state is {} bytes", w.layout.size)?;
    writeln!(out)
}
