//! Lowers a checked program to the tables of the flat IR.

mod actions;
mod leaves;
mod term;
mod world;

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::sema::checked::{self, Checked};
use crate::source::Span;

use crate::ir::{
    Arithmetic, By, Chance, Choice, Clamp, Collider, Discrete, Domain, Edge, Entity, EntityId, EntitySpans, Envelope,
    Expr, ExprId, Follow, FollowId, Function, Group, Id, IdRange, IdVec, Inputs, LeafId, MapLook, Mode, ModeId, Param,
    Program, RareVec, Reference, Release, Shape, Signal, Sum, TagId, TagLook, TagSet, Touch, WorldId, verify,
};
use term::{Context, duration, rate};

/// Lowers a program that was checked without errors. Lowered parts of the checked program are dropped at once unless
/// they are shared, as both are large for a large program.
pub fn lower(checked: Checked) -> Program {
    let Checked { tags, entities, worlds, dimensions, occurrences, breakable, asks_members, entity_looks, .. } =
        checked;
    drop((dimensions, occurrences));
    let mut program = Program { tags: tags.iter().map(|t| t.text.to_string()).collect(), ..Program::default() };
    program.spans.tags = tags.iter().map(|t| t.span).collect();
    program.looks.entities = entity_looks;
    program.entities.reserve(entities.len());
    program.spans.entities.reserve(entities.len());
    // Shared, as there may be many entities.
    let position = ["x", "y"].map(Arc::from);
    let add = |program: &mut Program, entity: &checked::Entity| {
        program.entities.push(shell(entity, &position, &breakable).into());
        program.spans.entities.push(spans(entity).into());
    };
    // Goals add contact queries to entities, and so do entities that ask others: these come first then, and both tables
    // are in memory.
    if asks_members {
        entities.iter().for_each(|entity| add(&mut program, entity));
    }
    for (index, entity) in entities.into_iter().enumerate() {
        if !asks_members {
            add(&mut program, &entity);
        }
        let id = EntityId::from_index(index);
        let from = ExprId::from_index(program.exprs.len());
        entity_code(&mut program, id, &entity, &breakable);
        let to = ExprId::from_index(program.exprs.len());
        program.timer_thresholds(id, from, to);
        program.entity_mut(id).code = IdRange::new(from, to);
    }
    // The contact queries of all worlds must be known before any layout.
    let destructible = world::destructible(&program);
    let predicates: Vec<_> = worlds.iter().map(|w| world::predicates(&mut program, w, &destructible)).collect();
    program.worlds.reserve(predicates.len());
    for (w, predicates) in worlds.into_iter().zip(predicates) {
        let id = program.worlds.len();
        // A look of a tag that nothing has is of nothing.
        let looks = w.looks.iter().filter_map(|(name, look)| {
            let tag = tags.find(|tag| tag.text == name.text)?;
            Some(TagLook { world: WorldId::from_index(id), tag, look: look.clone() })
        });
        program.looks.tags.extend(looks);
        let maps = w.map_looks.iter().map(|map| MapLook { world: WorldId::from_index(id), ..map.clone() });
        program.looks.maps.extend(maps);
        world::lower(&mut program, &w, predicates);
    }
    // A failure is a bug in this module.
    debug_assert_eq!(verify(&program), Ok(()));
    program
}

/// An entity's names and sizes, without code; `position` holds the names of its first variables, `breakable` the tags of
/// tiles that can be broken.
fn shell(e: &checked::Entity, position: &[Arc<str>; 2], breakable: &BTreeSet<TagId>) -> Entity {
    let discretes = e.discretes.iter().map(|d| Discrete {
        name: d.name.text.to_string(),
        domain: match d.ty {
            checked::Type::Bool => Domain::Bool,
            checked::Type::Set(_) => Domain::Set(d.values.to_vec()),
            checked::Type::Int | checked::Type::Real | checked::Type::Ref(_) | checked::Type::AnyRef => Domain::Int,
        },
        range: d.range,
        first: ExprId(0),
    });
    Entity {
        name: (*e.name.text).into(),
        doc: e.doc.as_deref().map(Box::from),
        params: RareVec::new(),
        vars: e
            .vars
            .pairs()
            .map(|(id, v)| position.get(id.index()).map_or_else(|| (&*v.name.text).into(), Arc::clone))
            .collect(),
        first: IdVec::new(),
        discretes: discretes.collect(),
        refs: e.refs.iter().map(|r| Reference { name: r.name.text.to_string(), entity: r.entity }).collect(),
        buttons: e.buttons.iter().map(|b| b.text.to_string()).collect(),
        axes: e.axes.iter().map(|a| a.text.to_string()).collect(),
        chances: e.chances.iter().map(|c| Chance { name: c.name.text.to_string(), range: c.range }).collect(),
        colliders: RareVec::new(),
        groups: RareVec::new(),
        modes: RareVec::new(),
        edges: RareVec::new(),
        envelopes: RareVec::new(),
        leaves: RareVec::new(),
        touches: e
            .bound
            .iter()
            .map(|b| {
                let mine = b.mine.map_or(TagSet::ALL, TagSet::of);
                Touch { mine, other: b.other, side: b.side, bound: true, tiles: breakable.contains(&b.other) }
            })
            .collect(),
        bound: e.bound.len(),
        probes: RareVec::new(),
        timers: RareVec::new(),
        spawns: RareVec::new(),
        signals: e.signals.iter().map(signal).collect(),
        sends: RareVec::new(),
        follows: RareVec::new(),
        clamps: Box::default(),
        invariants: Box::default(),
        order: e.order.clone(),
        free: Box::default(),
        inputs: Inputs::default(),
        code: IdRange::new(ExprId(0), ExprId(0)),
    }
}

fn signal(signal: &checked::Signal) -> Signal {
    let number = signal.number.as_ref();
    let number = number.map(|sum| Sum { name: sum.name.text.to_string(), is_whole: sum.ty() == checked::Type::Int });
    Signal { name: signal.name.text.to_string(), number }
}

fn spans(e: &checked::Entity) -> EntitySpans {
    EntitySpans {
        name: e.name.span,
        params: e.params.iter().map(|p| p.name.span).collect(),
        vars: e.vars.iter().map(|v| v.name.span).collect(),
        discretes: e.discretes.iter().map(|d| d.name.span).collect(),
        buttons: e.buttons.iter().map(|b| b.span).collect(),
        axes: e.axes.iter().map(|a| a.span).collect(),
        chances: e.chances.iter().map(|c| c.name.span).collect(),
        colliders: e.colliders.iter().map(|c| c.span).collect(),
        groups: e.groups.iter().map(|g| g.name.as_ref().map_or(e.name.span, |n| n.span)).collect(),
        touches: e.bound.iter().map(|b| b.span).collect(),
        refs: e.refs.iter().map(|r| r.name.span).collect(),
        spawns: RareVec::new(),
        follows: e.modes.iter().flat_map(|m| &m.follows).map(|f| f.span).collect(),
        invariants: e.invariants.iter().map(|i| i.span).collect(),
        modes: e.modes.iter().map(|m| m.name.span).collect(),
        edges: e.edges.iter().map(|x| x.span).collect(),
        envelopes: e.envelopes.iter().map(|x| x.span).collect(),
    }
}

fn entity_code(program: &mut Program, id: EntityId, e: &checked::Entity, breakable: &BTreeSet<TagId>) {
    let context = Context { me: Some(id), slots: &|_| id, indestructible: &|_| false, tiles: None };
    for param in e.params.iter() {
        let default = program.term(&param.default, &context);
        program.entity_mut(id).params.push(Param { name: param.name.text.to_string(), default });
    }
    for var in e.vars.iter() {
        let first = var.initial.as_ref().map(|first| program.term(first, &context));
        program.entity_mut(id).first.push(first);
    }
    for (index, discrete) in e.discretes.pairs() {
        let first = program.term(&discrete.initial, &context);
        program.entity_mut(id).discretes[index].first = first;
    }
    for probe in e.probes.iter() {
        let expr = match probe {
            checked::BoundProbe::Place(checked::Probe { mine, other, offset, .. }, _) => {
                let offset = offset.each_ref().map(|offset| program.term(offset, &context));
                let tiles = breakable.contains(other);
                Expr::Probe { mine: *mine, other: *other, offset, bound: true, tiles }
            }
            checked::BoundProbe::Nearest(checked::Nearest { of, holds, .. }, _) => {
                Expr::Nearest { of: *of, holds: program.term(holds, &context) }
            }
        };
        let probe = program.push(expr, probe.span());
        program.entity_mut(id).probes.push(probe);
    }
    for collider in e.colliders.iter() {
        let shape = match &collider.shape {
            checked::Shape::Rect(numbers) => Shape::Rect([0, 1, 2, 3].map(|i| program.term(&numbers[i], &context))),
            checked::Shape::Circle(numbers) => Shape::Circle([0, 1, 2].map(|i| program.term(&numbers[i], &context))),
        };
        let guard = collider.guard.as_ref().map(|g| program.term(g, &context));
        let tags = collider.tags.iter().copied().collect::<TagSet>();
        program.entity_mut(id).colliders.push(Collider { tags, kinematic: collider.kinematic, shape, guard });
    }
    for envelope in e.envelopes.iter() {
        let envelope = lower_envelope(program, id, envelope, &context);
        program.entity_mut(id).envelopes.push(envelope);
    }
    for (index, mode) in e.modes.pairs() {
        for drive in &mode.drives {
            if let checked::DriveBy::Envelope(envelope) = drive.by {
                program.entity_mut(id).envelopes[envelope].mode = Some(index);
            }
        }
    }
    program.entity_mut(id).edges.reserve(e.edges.len());
    for edge in e.edges.iter() {
        let guard = program.term(&edge.guard, &context);
        let actions = actions::lower(program, id, &edge.actions, &context);
        let (source, target, needs) = (edge.source, edge.target, edge.needs.clone());
        program.entity_mut(id).edges.push(Edge { source, target, guard, actions, needs });
    }
    for follow in e.modes.iter().flat_map(|m| &m.follows) {
        let guard = follow.guard.as_ref().map(|g| program.term(g, &context));
        let actions = actions::lower(program, id, &follow.actions, &context);
        let needs = follow.needs.clone();
        let _: FollowId = program.entity_mut(id).follows.push(Follow { guard, actions, needs });
    }
    let mut bound = |b: &Option<checked::Term>| b.as_ref().map(|b| program.term(b, &context));
    let clamps = e.clamps.iter().map(|clamp| {
        let (low, high) = (bound(&clamp.low), bound(&clamp.high));
        Clamp { var: clamp.var, degree: clamp.degree, low, high }
    });
    program.entity_mut(id).clamps = clamps.collect();
    program.entity_mut(id).invariants = e.invariants.iter().map(|i| program.term(i, &context)).collect();
    modes(program, id, e, &context);
    let tables = leaves::drives(program, e, &context);
    let built = leaves::leaves(program, id, e, &tables);
    let entity = program.entity_mut(id);
    entity.inputs = built.always;
    entity.free = tables.free;
    entity.leaves = built.leaves.into();
}

fn lower_envelope(program: &mut Program, id: EntityId, e: &checked::Envelope, context: &Context<'_>) -> Envelope {
    let sustain = program.term(&e.sustain, context);
    let zero = |program: &mut Program, span: Span| program.push(Expr::Number(0.0), span);
    let level = match &e.release {
        checked::Release::To(_, Some(level)) => program.term(level, context),
        checked::Release::To(_, None) | checked::Release::Hold => zero(program, e.span),
    };
    let peak = e.peak.as_ref().map(|p| program.term(p, context));
    let distance = |program: &mut Program, a: ExprId, b: ExprId| {
        let way = program.push(Expr::Arithmetic(Arithmetic::Subtract, a, b), e.span);
        program.push(Expr::Call(Function::Abs, [way; 3]), e.span)
    };
    if let checked::By::Clock(mode) = e.by {
        let way = distance(program, sustain, level);
        let rise = duration(program, &e.attack, way, context, e.span);
        let hold = match &e.sustain_for {
            Some(time) => program.term(time, context),
            None => zero(program, e.span),
        };
        let fall = match &e.release {
            checked::Release::To(rate, _) => duration(program, rate, way, context, e.span),
            checked::Release::Hold => zero(program, e.span),
        };
        let still = program.push(Expr::Arithmetic(Arithmetic::Add, hold, fall), e.span);
        let total = program.push(Expr::Arithmetic(Arithmetic::Add, rise, still), e.span);
        return Envelope {
            mode: Some(mode),
            vars: e.vars.clone(),
            degree: e.degree,
            by: By::Clock { timer: program.timer(id, mode), rise, hold, fall, total },
            sustain,
            attack: None,
            peak: None,
            decay: None,
            release: Release::To { rate: None, level },
            guard: None,
        };
    }
    let top = peak.unwrap_or(sustain);
    let rise = distance(program, top, level);
    let attack = rate(program, &e.attack, rise, context, e.span);
    let sink = distance(program, top, sustain);
    let decay = rate(program, &e.decay, sink, context, e.span);
    let fall = distance(program, sustain, level);
    let release = match &e.release {
        checked::Release::Hold => Release::Hold,
        checked::Release::To(r, _) => Release::To { rate: rate(program, r, fall, context, e.span), level },
    };
    let by = match &e.by {
        checked::By::Button(button) => By::Button(*button),
        checked::By::Axis(axis) => By::Axis(*axis),
        checked::By::Axes(axes, ways) => {
            let at = |i: usize| axes.get(i).copied().unwrap_or(crate::ir::AxisId(0));
            By::Axes([at(0), at(1)], ways.map_or(Vec::new(), directions))
        }
        checked::By::Clock(_) => By::Button(crate::ir::ButtonId(0)),
    };
    let guard = e.driven_while.as_ref().map(|g| program.term(g, context));
    let (vars, degree) = (e.vars.clone(), e.degree);
    Envelope { mode: None, vars, degree, by, sustain, attack, peak, decay, release, guard }
}

/// A number of unit vectors, counterclockwise from the right; those along the axes are exact.
fn directions(ways: u32) -> Vec<[f64; 2]> {
    let at = |k: u32| {
        // Reduced to the first octant, so that mirrored directions are exact mirror images.
        let turn = f64::from(k) / f64::from(ways);
        let quarter = (turn * 4.0).floor();
        let rest = turn * 4.0 - quarter;
        let angle = |part: f64| part * std::f64::consts::FRAC_PI_2;
        let (sin, cos) = if rest == 0.0 {
            (0.0, 1.0)
        } else if rest == 0.5 {
            (std::f64::consts::FRAC_1_SQRT_2, std::f64::consts::FRAC_1_SQRT_2)
        } else if rest < 0.5 {
            (libm::sin(angle(rest)), libm::cos(angle(rest)))
        } else {
            (libm::cos(angle(1.0 - rest)), libm::sin(angle(1.0 - rest)))
        };
        match quarter as u32 % 4 {
            0 => [cos, sin],
            1 => [-sin, cos],
            2 => [-cos, -sin],
            _ => [sin, -cos],
        }
    };
    (0..ways).map(at).collect()
}

/// Lowers modes and groups. Checked modes are already in preorder, group by group.
fn modes(program: &mut Program, id: EntityId, e: &checked::Entity, context: &Context<'_>) {
    let count = e.modes.len();
    let mut ends = vec![0u32; count];
    let mut leaves = vec![(0u32, 0u32); count];
    let mut leaf_count = 0;
    let mut first_leaf = vec![0u32; count];
    for (mode, m) in e.modes.pairs() {
        first_leaf[mode.index()] = leaf_count;
        leaf_count += u32::from(m.children.is_empty());
    }
    for (mode, m) in e.modes.pairs().rev() {
        let end = m.children.last().map_or(mode.0 + 1, |last| ends[last.index()]);
        ends[mode.index()] = end;
        let after = first_leaf.get(end as usize).copied().unwrap_or(leaf_count);
        leaves[mode.index()] = (first_leaf[mode.index()], after);
    }
    let initial = |mode: ModeId| {
        let mut mode = mode;
        while let Some(child) = e.default_mode(&e.modes[mode].children) {
            mode = child;
        }
        LeafId(first_leaf[mode.index()])
    };
    for (mode, m) in e.modes.pairs() {
        let entry = actions::lower(program, id, &m.entry, context);
        let choices = choices_of(program, e, &m.children, context);
        let (first, after) = leaves[mode.index()];
        program.entity_mut(id).modes.push(Mode {
            path: m.path.join("."),
            parent: m.parent,
            end: ModeId(ends[mode.index()]),
            group: m.group,
            leaves: IdRange::new(LeafId(first), LeafId(after)),
            initial: initial(mode),
            chooses: !choices.is_empty(),
            choices,
            inner: e.default_mode(&m.children),
            entry,
        });
    }
    // A mode chooses if any descendant does; descendants come later, so this runs backwards.
    let table = &mut program.entity_mut(id).modes;
    for mode in (0..count as u32).rev().map(ModeId) {
        if let Some(parent) = table[mode].parent {
            table[parent].chooses |= table[mode].chooses;
        }
    }
    for group in e.groups.iter() {
        let first = group.modes.first().copied().unwrap_or(ModeId(0));
        let choices = choices_of(program, e, &group.modes, context);
        let end = group.modes.last().map_or(0, |last| ends[last.index()]);
        program.entity_mut(id).groups.push(Group {
            name: group.name.as_ref().map(|n| n.text.to_string()),
            modes: IdRange::new(first, ModeId(end)),
            first: e.default_mode(&group.modes).unwrap_or(first),
            choices,
        });
    }
}

/// The modes marked `initial when`.
fn choices_of(program: &mut Program, e: &checked::Entity, modes: &[ModeId], context: &Context<'_>) -> Vec<Choice> {
    let guarded = modes.iter().filter_map(|&mode| e.modes[mode].initial_when.as_ref().map(|guard| (mode, guard)));
    guarded.map(|(mode, guard)| Choice { guard: program.term(guard, context), mode }).collect()
}
