//! The text form of a program, for people and for snapshot tests.

use std::fmt::Write;
use std::mem::discriminant;

use super::{
    Actions, Arithmetic, By, Choice, Domain, Drive, Entity, Expr, ExprId, Function, Look, Origin, Place, Press,
    Program, Push, RefValue, Release, Response, Send, SendId, Shape, Subject, TagSet, TileLayout, World,
};

/// Formats a program.
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

fn look_text(look: &Look) -> String {
    match look {
        Look::Color(color) => color.clone(),
        Look::Picture(path) => format!("\"{path}\""),
    }
}

struct EntityText<'a> {
    p: &'a Program,
    e: &'a Entity,
}

impl EntityText<'_> {
    fn write(&self, out: &mut String) -> Result {
        let (p, e) = (self.p, self.e);
        let look = self.p.entities.find(|of| std::ptr::eq(&**of, e)).and_then(|id| p.looks.of_entity(id));
        let look = look.map_or(String::new(), |look| format!("  look {}", look_text(look)));
        writeln!(out, "entity {}{look}", e.name)?;
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
        for (id, c) in e.chances.pairs() {
            writeln!(out, "  {id} {}: {}..{}", c.name, c.range.0, c.range.1)?;
        }
        for (id, c) in e.colliders.pairs() {
            let numbers: Vec<String> = c.shape.numbers().iter().map(|&r| self.expr(r)).collect();
            let shape = if matches!(c.shape, Shape::Rect(_)) { "rect" } else { "circle" };
            let kinematic = if c.kinematic { "kinematic " } else { "" };
            let guard = c.guard.map_or(String::new(), |g| format!(" when {}", self.expr(g)));
            writeln!(out, "  {id} {kinematic}{}: {shape}({}){guard}", tags(p, c.tags), numbers.join(", "))?;
        }
        for (id, t) in e.touches.pairs() {
            let side = t.side.map_or(String::new(), |s| format!(", {}", s.name()));
            let kept = kept(t.bound, t.tiles);
            writeln!(out, "  {id} ({}, {}{side}){kept}", tags(p, t.mine), tags(p, TagSet::of(t.other)))?;
        }
        for (id, probe) in e.probes.pairs() {
            writeln!(out, "  {id} {}", self.expr(*probe))?;
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
            let vars: Vec<String> = v.vars.iter().map(|&var| self.var(var, v.degree)).collect();
            let sustain = self.expr(v.sustain);
            if let By::Clock { timer, rise, hold, fall, .. } = v.by {
                let (rise, hold, fall) = (self.expr(rise), self.expr(hold), self.expr(fall));
                let times = format!("rises to {sustain} over {rise}, stays for {hold}, falls over {fall}");
                writeln!(out, "  {id} {} by {timer}: {times}, {release}", vars.join(", "))?;
                continue;
            }
            let by = match &v.by {
                By::Button(button) => format!("held({})", e.buttons[*button]),
                By::Axis(axis) => e.axes[*axis].clone(),
                By::Axes([x, y], ways) => {
                    let ways = if ways.is_empty() { "any".to_string() } else { ways.len().to_string() };
                    format!("({}, {}) directions {ways}", e.axes[*x], e.axes[*y])
                }
                By::Clock { .. } => String::new(),
            };
            let peak = v.peak.map_or(String::new(), |peak| {
                let decay = v.decay.map_or("instant".into(), |d| format!("accel {}", self.expr(d)));
                format!(" to {}, decay {decay}", self.expr(peak))
            });
            let vars = vars.join(", ");
            writeln!(out, "  {id} {vars} by {by}: attack {attack}{peak}, sustain {sustain}, release {release}{guard}")?;
        }
        for (id, edge) in e.edges.pairs() {
            let target = edge.target.map_or("stays".into(), |t| format!("-> {}", e.modes[t].path));
            let source = &e.modes[edge.source].path;
            let updates = self.actions(&edge.actions);
            writeln!(out, "  {id} {source} {target} when {}{updates}", self.expr(edge.guard))?;
        }
        for (id, spawn) in e.spawns.pairs() {
            let of = &p.entities[spawn.entity];
            let mut sets: Vec<String> = Vec::new();
            sets.extend(
                spawn.params.iter().map(|(param, x)| format!("{} = {}", of.params[*param].name, self.expr(*x))),
            );
            sets.extend(spawn.updates.iter().map(|u| format!("{} = {}", place(of, u.place), self.expr(u.value))));
            let refs = spawn.refs.iter().map(|r| format!("{} = {}", of.refs[r.reference].name, self.instance(r.value)));
            sets.extend(refs);
            let into = spawn.into.map_or(String::new(), |r| format!(" into {}", e.refs[r].name));
            writeln!(out, "  {id} {}({}){into}", of.name, sets.join(", "))?;
        }
        for (id, follow) in e.follows.pairs() {
            let guard = follow.guard.map_or(String::new(), |g| format!(" when {}", self.expr(g)));
            writeln!(out, "  {id} links{guard}{}", self.actions(&follow.actions))?;
        }
        for clamp in &e.clamps {
            let bound = |b: Option<ExprId>| b.map_or(String::new(), |b| self.expr(b));
            let var = self.var(clamp.var, clamp.degree);
            writeln!(out, "  clamp {var} in {}..{}", bound(clamp.low), bound(clamp.high))?;
        }
        for &invariant in &e.invariants {
            writeln!(out, "  invariant {}", self.expr(invariant))?;
        }
        if e.order.windows(2).any(|pair| pair[0] > pair[1]) {
            let order: Vec<String> = e.order.iter().map(ToString::to_string).collect();
            writeln!(out, "  decides {}", order.join(", "))?;
        }
        self.drives(out, "  always", &e.free)?;
        for (id, group) in e.groups.pairs() {
            let name = group.name.as_deref().unwrap_or("(anonymous)");
            writeln!(out, "  {id} {name}: starts at {}{}", self.choices(&group.choices), e.modes[group.first].path)?;
            for mode in group.modes.from.0..group.modes.to.0 {
                let id = super::ModeId(mode);
                let m = &e.modes[id];
                let entry = self.actions(&m.entry);
                let initial = e.leaves[m.initial].mode;
                let inner = match m.inner {
                    None => String::new(),
                    Some(inner) => format!(" enters {}{}", self.choices(&m.choices), e.modes[inner].path),
                };
                writeln!(out, "    {id} {}{inner}{entry}", m.path)?;
                if m.leaves.from == m.initial && initial == id {
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
                    if !leaf.follows.is_empty() {
                        let list: Vec<String> = leaf.follows.iter().map(ToString::to_string).collect();
                        writeln!(out, "      may go by {}", list.join(", "))?;
                    }
                    let mut reads: Vec<&str> = Vec::new();
                    reads.extend(
                        e.buttons.pairs().filter(|(b, _)| leaf.inputs.buttons >> b.0 & 1 == 1).map(|(_, n)| n.as_str()),
                    );
                    reads.extend(
                        e.axes.pairs().filter(|(a, _)| leaf.inputs.axes >> a.0 & 1 == 1).map(|(_, n)| n.as_str()),
                    );
                    let drawn = e.chances.pairs().filter(|(c, _)| leaf.inputs.chances >> c.0 & 1 == 1);
                    reads.extend(drawn.map(|(_, c)| c.name.as_str()));
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
                Drive::Envelope(id, component) => format!("{id}.{component}"),
            })
            .collect();
        writeln!(out, "{head}: {}", list.join("; "))
    }

    fn var(&self, var: super::VarId, degree: u8) -> String {
        self.e.variable_text(var, degree)
    }

    fn actions(&self, actions: &Actions) -> String {
        let e = self.e;
        let mut list: Vec<String> = Vec::new();
        list.extend(actions.updates.iter().map(|u| format!("{} := {}", place(e, u.place), self.expr(u.value))));
        list.extend(actions.refs.iter().map(|r| format!("{} := {}", e.refs[r.reference].name, self.instance(r.value))));
        list.extend(actions.spawns.iter().map(ToString::to_string));
        list.extend(actions.sends.iter().map(|send| self.send(*send)));
        list.extend(actions.destroys.iter().map(|d| format!("destroy {}", self.instance(*d))));
        if list.is_empty() { String::new() } else { format!(" {{ {} }}", list.join("; ")) }
    }

    fn send(&self, id: SendId) -> String {
        let Send { to, entity, signal, value } = self.e.sends[id];
        let of = &self.p.entities[entity];
        let to = match to {
            Some(subject) => self.instance(RefValue::Of(subject)),
            None => format!("all {}", of.name),
        };
        let value = value.map_or(String::new(), |value| format!("({})", self.expr(value)));
        format!("send {to}.{}{value}", of.signals[signal].name)
    }

    fn instance(&self, value: RefValue) -> String {
        match value {
            RefValue::None => "none".into(),
            RefValue::Of(Subject::Me) => "self".into(),
            RefValue::Of(subject) => self.owner(subject).trim_end_matches('.').to_string(),
        }
    }

    fn owner(&self, of: Subject) -> String {
        match of {
            Subject::Me => String::new(),
            Subject::Slot(slot) => format!("{slot}."),
            Subject::Ref(id) => format!("{}.", self.e.refs[id].name),
            Subject::Touched(touch) => format!("{touch}."),
            Subject::Probed(probe) => format!("{probe}."),
            Subject::Member(_) => "each.".into(),
        }
    }

    fn expr(&self, id: ExprId) -> String {
        let entity = |of: Subject| match of {
            Subject::Me => Some(self.e),
            Subject::Ref(id) => self.e.refs[id].entity.map(|e| &*self.p.entities[e]),
            Subject::Member(id) => Some(&*self.p.entities[id]),
            Subject::Slot(_) | Subject::Touched(_) | Subject::Probed(_) => None,
        };
        expression(self.p, id, &entity, self.e, &|of| self.owner(of))
    }
}

/// An expression with the names of its entity; `owner` names an instance with a dot after it.
fn expression<'a>(
    p: &Program,
    id: ExprId,
    entity: &dyn Fn(Subject) -> Option<&'a Entity>,
    none: &'a Entity,
    owner: &dyn Fn(Subject) -> String,
) -> String {
    let sub = |id| expression(p, id, entity, none, owner);
    let me = || entity(Subject::Me).unwrap_or(none);
    let name = |of| match of {
        Subject::Me => "self".to_string(),
        of => owner(of).trim_end_matches('.').to_string(),
    };
    match p.exprs[id] {
        Expr::Number(n) => n.to_string(),
        Expr::Frames(n) => format!("{n}frames"),
        Expr::Bool(b) => b.to_string(),
        Expr::Param(of, param) => {
            let name = entity(of).and_then(|e| e.params.get(param));
            format!("{}{}", owner(of), name.map_or_else(|| param.to_string(), |p| p.name.clone()))
        }
        Expr::Var(of, var, degree) => {
            let name = entity(of).and_then(|e| e.vars.get(var)).cloned();
            let name = name.unwrap_or_else(|| {
                ["x", "y"].get(var.0 as usize).map_or_else(|| var.to_string().into(), |n| (*n).into())
            });
            format!("{}{name}{}", owner(of), "'".repeat(usize::from(degree)))
        }
        Expr::Discrete(of, d) => {
            let name = entity(of).and_then(|e| e.discretes.get(d));
            format!("{}{}", owner(of), name.map_or_else(|| d.to_string(), |d| d.name.clone()))
        }
        Expr::Joint(mode, entering) => {
            format!("{}({})", if entering { "entering" } else { "exiting" }, me().modes[mode].path)
        }
        Expr::Received(signal) => format!("received({})", me().signals[signal].name),
        Expr::Sum(id) => {
            let signal = &me().signals[id];
            format!("{}.{}", signal.name, signal.number.as_ref().map_or("", |number| &number.name))
        }
        Expr::IsNone(of) => format!("{} is none", owner(of).trim_end_matches('.')),
        Expr::Is(of, e) => format!("{} is {}", owner(of).trim_end_matches('.'), p.entities[e].name),
        Expr::Alive(slot) => format!("{}alive", owner(Subject::Slot(slot))),
        Expr::Axis(axis) => me().axes[axis].clone(),
        Expr::Chance(chance) => me().chances[chance].name.clone(),
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
                Function::Mod => ("mod", 2),
            };
            let args: Vec<String> = args.iter().take(count).map(|&a| sub(a)).collect();
            format!("{name}({})", args.join(", "))
        }
        Expr::Compare(op, a, b) => {
            let op = op.symbol();
            format!("{} {op} {}", sub(a), sub(b))
        }
        // The grouping of operands of one word means nothing.
        Expr::And(a, b) | Expr::Or(a, b) => {
            let whole = &p.exprs[id];
            let operand = |id: ExprId| {
                let is_same = discriminant(&p.exprs[id]) == discriminant(whole);
                let text = sub(id);
                let inner = text.strip_prefix('(').and_then(|text| text.strip_suffix(')')).filter(|_| is_same);
                inner.map(str::to_string).unwrap_or(text)
            };
            let word = if matches!(whole, Expr::And(..)) { "and" } else { "or" };
            format!("({} {word} {})", operand(a), operand(b))
        }
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
        Expr::Probe { mine, other, offset: [x, y], bound, tiles } => {
            let kept = kept(bound, tiles);
            format!("touching({} at ({}, {}), {}){kept}", p.tags[mine], sub(x), sub(y), p.tags[other])
        }
        Expr::InMode(of, mode) => {
            let path = entity(of).and_then(|e| e.modes.get(mode)).map_or_else(|| mode.to_string(), |m| m.path.clone());
            format!("{}in {path}", owner(of))
        }
        Expr::Broken(tag) => format!("broken({})", p.tags[tag]),
        Expr::Tiles(tag) => format!("tiles({})", p.tags[tag]),
        Expr::InSpace(of, space) => format!("{}in {space}", owner(of)),
        Expr::Count { of, holds } => format!("count({} where {})", p.entities[of].name, sub(holds)),
        Expr::Nearest { of, holds } => format!("nearest({} where {})", p.entities[of].name, sub(holds)),
        Expr::Distance { of, x, y } => {
            format!("distance({}, ({}, {}))", name(of), sub(x), sub(y))
        }
        Expr::Near { of, x, y, radius } => {
            format!("near({}, ({}, {}), {})", name(of), sub(x), sub(y), sub(radius))
        }
    }
}

/// An expression that reads the instances of a world.
fn world_expression(p: &Program, w: &World, id: ExprId) -> String {
    let Some(none) = p.entities.iter().next() else { return String::new() };
    let entity = |of: Subject| match of {
        Subject::Slot(slot) => Some(&*p.entities[w.slots[slot].entity]),
        _ => None,
    };
    let owner = |of: Subject| match of {
        Subject::Slot(slot) => format!("{}.", w.slots[slot].name),
        _ => String::new(),
    };
    expression(p, id, &entity, none, &owner)
}

/// Formats the target of an update.
fn place(e: &Entity, place: Place) -> String {
    match place {
        Place::Var(var, degree) => e.variable_text(var, degree),
        Place::Discrete(id) => e.discretes[id].name.clone(),
        Place::Ref(id) => e.refs[id].name.clone(),
    }
}

fn write_world(out: &mut String, p: &Program, w: &World) -> Result {
    writeln!(out, "world {}", w.name)?;
    writeln!(out, "  step {}/{}", w.step.numerator, w.step.denominator)?;
    for c in &w.collide {
        let Response { push, stop, carry, bounce } = c.response;
        let push = match push {
            Push::Sense => "sense",
            Push::FromAbove => "block from above",
            Push::Block => "block",
        };
        let keep = if stop || c.response.push == Push::Sense { "" } else { ", keep velocity" };
        let carry = if carry { ", carry" } else { "" };
        let bounce = if bounce.is_none() { String::new() } else { format!(", bounce {}", bounce.share()) };
        writeln!(out, "  {} with {}: {push}{keep}{carry}{bounce}", tags(p, c.left), tags(p, c.right))?;
    }
    for (id, space) in w.spaces.pairs() {
        write!(out, "  {id} {}", space.name)?;
        if let Some(b) = space.bounds {
            write!(out, " in {}..{}, {}..{}", b.left, b.right, b.bottom, b.top)?;
        }
        for (period, axis) in space.periods.iter().zip(["x", "y"]) {
            if let Some(period) = period {
                write!(out, ", {axis} wraps {}..{}", period.low, period.high)?;
            }
        }
        for solid in &space.solids {
            let b = solid.bounds;
            write!(out, "\n    {} at {}..{}, {}..{}", tags(p, solid.tags), b.left, b.right, b.bottom, b.top)?;
        }
        for link in &space.links {
            let side = |b: super::Bounds| format!("{}..{}, {}..{}", b.left, b.right, b.bottom, b.top);
            let guard = link.guard.map_or(String::new(), |g| format!(" when {}", world_expression(p, w, g)));
            write!(out, "\n    link {} -> {} at {}{guard}", side(link.from), link.space, side(link.to))?;
        }
        let Some(map) = &space.map else {
            writeln!(out)?;
            continue;
        };
        writeln!(out, "\n    {} x {} tiles of {} x {} px", map.columns, map.rows, map.tile.0, map.tile.1)?;
        for kind in map.kinds.iter().filter(|k| !k.tags.is_empty()) {
            let breakable = kind.breakable.map_or(String::new(), |breakable| match breakable.restore {
                Some(steps) => format!(" breakable, restored after {steps} steps"),
                None => " breakable".into(),
            });
            let slope = kind
                .slope
                .map_or(String::new(), |slope| format!(" slope (0, {})-({}, {})", slope.left, map.tile.0, slope.right));
            writeln!(out, "    {} {}{slope}{breakable}", kind.symbol, tags(p, kind.tags.iter().copied().collect()))?;
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
        if slot.origin == Origin::Free {
            let at = &w.layout.slots[id];
            writeln!(out, "  {id} {}: free, at {}..{}", slot.name, at.block.0, at.block.1)?;
            continue;
        }
        writeln!(out, "  {id} {}: {} in {}{player}", slot.name, e.name, slot.space)?;
        let mut values: Vec<String> = Vec::new();
        values.extend(e.params.pairs().map(|(id, param)| format!("{} = {}", param.name, slot.params[id])));
        values.extend(e.vars.pairs().map(|(id, name)| format!("{name} = {:?}", slot.vars[id])));
        values.extend(e.discretes.pairs().map(|(id, d)| format!("{} = {}", d.name, slot.discretes[id])));
        let target = |t: super::SlotId| w.slots[t].name.clone();
        let refs =
            e.refs.pairs().map(|(id, r)| format!("{} = {}", r.name, slot.refs[id].map_or("none".into(), target)));
        values.extend(refs);
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
    for limit in &w.limits {
        writeln!(out, "  at most {} {}", limit.count, p.entities[limit.entity].name)?;
    }
    for (id, goal) in w.goals.pairs() {
        writeln!(out, "  {id} {}: {}", goal.name, world_expression(p, w, goal.holds))?;
    }
    for (id, never) in w.nevers.pairs() {
        writeln!(out, "  {id} {}: {}", never.name, world_expression(p, w, never.holds))?;
    }
    if let Some(tiles) = &w.layout.tiles {
        let TileLayout { broken, count, restoring, restored } = tiles;
        writeln!(out, "  {count} breakable tiles at {broken}, {restored} of them restored by {restoring}")?;
    }
    writeln!(out, "  a state is {} bytes", w.layout.size)?;
    writeln!(out)
}

/// What a contact query or a probe keeps.
fn kept(bound: bool, tiles: bool) -> &'static str {
    match (bound, tiles) {
        (true, true) => " as an instance or a tile",
        (true, false) => " as an instance",
        (false, _) => "",
    }
}
