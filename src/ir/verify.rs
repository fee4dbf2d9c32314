//! One look at every id after lowering, so that later stages may index without asking. Each struct is taken apart
//! without `..`, so that a new field does not build before it is looked at. A failure is a bug of the compiler.

use super::{
    Actions, By, Clamp, Drive, Edge, Entity, Envelope, ExprId, Follow, Id, Leaf, Link, Mode, Program, RefUpdate,
    RefValue, Release, Slot, Space, Spawn, Subject, Update, World,
};

/// Asserts, in builds with debug assertions, that every id of a program is of its table.
pub(super) fn verify(program: &Program) {
    if !cfg!(debug_assertions) {
        return;
    }
    let Program { tags, exprs, entities, worlds, spans } = program;
    assert!(tags.len() <= 64, "tags fit a word");
    assert_eq!(tags.len(), spans.tags.len(), "a span for each tag");
    for (id, entity) in entities.pairs() {
        assert_eq!(entity.touches.len(), spans.entities[id].touches.len(), "a span for each contact question");
    }
    assert_eq!(exprs.len(), spans.exprs.len(), "a span for each expression");
    assert_eq!(entities.len(), spans.entities.len(), "spans for each entity");
    assert_eq!(worlds.len(), spans.worlds.len(), "spans for each world");
    for (id, expr) in exprs.pairs() {
        for operand in expr.operands() {
            assert!(operand < id, "{operand:?} stands before {id:?}");
        }
    }
    for entity in entities.iter() {
        verify_entity(program, entity);
    }
    for world in worlds.iter() {
        verify_world(program, world);
    }
}

fn verify_entity(program: &Program, entity: &Entity) {
    let expr = |id: ExprId| assert!(id.index() < program.exprs.len(), "{id:?} exists");
    let updates = |list: &[Update]| list.iter().for_each(|u| expr(u.value));
    let instance = |value: RefValue| match value {
        RefValue::Of(Subject::Ref(id)) => assert!(id.index() < entity.refs.len(), "a reference exists"),
        RefValue::Of(Subject::Touched(id)) => assert!(id.index() < entity.bound, "a bound question exists"),
        RefValue::Of(Subject::Me | Subject::Slot(_)) | RefValue::None => {}
    };
    let actions = |a: &Actions| {
        let Actions { updates: list, refs, spawns, destroys } = a;
        updates(list);
        for RefUpdate { reference, value } in refs {
            assert!(reference.index() < entity.refs.len(), "a reference exists");
            instance(*value);
        }
        assert!(spawns.iter().all(|s| s.index() < entity.spawns.len()), "a spawn exists");
        destroys.iter().copied().for_each(instance);
    };
    let Entity {
        name: _,
        doc: _,
        params,
        vars,
        first,
        discretes,
        refs: _,
        buttons,
        axes,
        colliders,
        groups,
        modes,
        edges,
        envelopes,
        leaves,
        touches,
        bound,
        timers,
        spawns,
        follows,
        clamps,
        invariants,
        order,
        free,
        inputs: _,
        code,
    } = entity;
    assert!(code.0 <= code.1 && code.1.index() <= program.exprs.len(), "an entity's code is of the arena");
    assert!(buttons.len() <= 64 && axes.len() <= 8, "inputs fit their masks");
    params.iter().for_each(|p| expr(p.default));
    assert_eq!(first.len(), vars.len(), "a first value for each variable");
    first.iter().flatten().copied().chain(discretes.iter().map(|d| d.first)).for_each(expr);
    for collider in colliders.iter() {
        collider.shape.numbers().iter().copied().chain(collider.guard).for_each(expr);
    }
    assert!(touches.iter().enumerate().all(|(i, t)| t.bound == (i < *bound)), "bound questions come first");
    for Spawn { entity: of, into: _, params: given, updates: list, refs } in spawns.iter() {
        let of = &program.entities[*of];
        assert!(given.iter().all(|(p, _)| p.index() < of.params.len()), "a given parameter exists");
        given.iter().for_each(|(_, e)| expr(*e));
        updates(list);
        assert!(refs.iter().all(|r| r.reference.index() < of.refs.len()), "a given reference exists");
        refs.iter().for_each(|r| instance(r.value));
    }
    for Follow { guard, actions: a, needs: _ } in follows.iter() {
        guard.iter().copied().for_each(expr);
        actions(a);
    }
    for Clamp { var, degree, low, high } in clamps {
        assert!(var.index() < vars.len() && *degree <= 1, "a clamped variable exists");
        low.iter().chain(high).copied().for_each(expr);
    }
    invariants.iter().copied().for_each(expr);
    assert_eq!(order.len(), groups.len(), "every group is decided once");
    for (id, mode) in modes.pairs() {
        let Mode { path: _, parent, end, group, leaves: inside, initial, choices, chooses: _, inner, entry } = mode;
        assert!(parent.is_none_or(|p| p < id) && end.index() <= modes.len() && *end > id, "modes are in preorder");
        assert!(group.index() < groups.len(), "a mode's group exists");
        assert!(inside.0 <= *initial && *initial < inside.1 && inside.1.index() <= leaves.len(), "a leaf is inside");
        actions(entry);
        assert!(inner.is_none_or(|i| id < i && i < *end), "the initial mode inside is inside");
        assert!(choices.iter().all(|c| id < c.mode && c.mode < *end), "a choice is inside");
        choices.iter().for_each(|c| expr(c.guard));
    }
    for edge in edges.iter() {
        let Edge { source, target, guard, actions: a, needs: _ } = edge;
        expr(*guard);
        actions(a);
        assert!(target.is_none_or(|t| modes[t].group == modes[*source].group), "an edge stays in its group");
    }
    for envelope in envelopes.iter() {
        let Envelope { mode: _, vars: driven, degree, by, sustain, attack, peak, decay, release, guard } = envelope;
        assert!(
            !driven.is_empty() && driven.iter().all(|v| v.index() < vars.len()) && *degree <= 2,
            "driven variables"
        );
        if let By::Clock { timer, rise, hold, fall, total } = by {
            assert!(timer.index() < timers.len(), "a clock exists");
            [*rise, *hold, *fall, *total].into_iter().for_each(expr);
        }
        let rate_and_level = match *release {
            Release::Hold => (None, None),
            Release::To { rate, level } => (rate, Some(level)),
        };
        let (rate, level) = rate_and_level;
        let parts = [Some(*sustain), *attack, *peak, *decay, *guard, rate, level];
        parts.into_iter().flatten().for_each(expr);
    }
    for (id, leaf) in leaves.pairs() {
        let Leaf { mode, path, drives, edges: tried, internal, follows: followed, inputs: _ } = leaf;
        assert!(followed.iter().all(|f| f.index() < follows.len()), "`follow links` exists");
        assert_eq!(path.last(), Some(mode), "a leaf's path ends at it");
        assert_eq!(modes[*mode].leaves.0, id, "leaves are numbered in preorder");
        assert!(tried.iter().all(|&e| edges[e].target.is_some()), "tried edges lead somewhere");
        assert!(internal.iter().all(|&e| edges[e].target.is_none()), "internal edges stay");
        let driven = drives.iter().chain(free).count();
        assert!(driven <= vars.len(), "a variable is driven once");
    }
    for drive in free.iter().chain(leaves.iter().flat_map(|l| &l.drives)) {
        match *drive {
            Drive::Coast(var) => assert!(var.index() < vars.len(), "a driven variable exists"),
            Drive::Flow { var, degree, value } => {
                assert!(var.index() < vars.len() && degree <= 2, "a driven variable exists");
                expr(value);
            }
            Drive::Envelope(id, component) => {
                assert!(id.index() < envelopes.len(), "an envelope exists");
                assert!(usize::from(component) < envelopes[id].vars.len(), "a component exists");
            }
        }
    }
    assert!(timers.iter().all(|t| t.mode.index() < modes.len()), "a timer's mode exists");
}

fn verify_world(program: &Program, world: &World) {
    let World { name: _, step, spaces, slots, players, collide: _, goals, nevers, open, layout } = world;
    assert!(open.is_none_or(|s| s.index() < spaces.len()), "an open space exists");
    assert!(step.numerator > 0 && step.denominator > 0, "a step is positive");
    assert_eq!(layout.slots.len(), slots.len(), "a layout for each slot");
    assert_eq!(layout.players.len(), players.len(), "a layout for each player");
    for slot in slots.iter() {
        let Slot {
            name: _,
            origin: _,
            entity,
            space,
            player,
            params,
            vars,
            discretes,
            refs,
            timer_limits,
            is_fixed: _,
        } = slot;
        let entity = &program.entities[*entity];
        assert!(space.index() < spaces.len() && player.is_none_or(|p| p.index() < players.len()), "a slot's ids");
        assert_eq!(params.len(), entity.params.len(), "a value for each parameter");
        assert_eq!(vars.len(), entity.vars.len(), "a value for each variable");
        assert_eq!(discretes.len(), entity.discretes.len(), "a value for each variable");
        assert_eq!(refs.len(), entity.refs.len(), "a value for each reference");
        assert!(refs.iter().flatten().all(|t| t.index() < slots.len()), "a reference leads to a slot");
        assert_eq!(timer_limits.len(), entity.timers.len(), "a limit for each timer");
    }
    for Space { name: _, map: _, solids: _, bounds: _, links } in spaces.iter() {
        for Link { from: _, space, to: _, guard } in links {
            assert!(space.index() < spaces.len(), "a link leads to a space");
            assert!(guard.is_none_or(|g| g.index() < program.exprs.len()), "a guard exists");
        }
    }
    for predicate in goals.iter().chain(nevers.iter()) {
        assert!(predicate.holds.index() < program.exprs.len(), "a predicate exists");
    }
}
