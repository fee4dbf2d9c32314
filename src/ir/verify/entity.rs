//! Verifies an entity: modes are a forest in preorder with their leaves, leaves agree with the modes, and everything
//! driven, updated, spawned and destroyed exists.

use crate::ir::{
    Actions, By, Chance, Clamp, Collider, Discrete, Domain, Drive, Edge, Entity, EntityId, EntitySpans, Envelope, Expr,
    ExprId, Follow, Group, GroupId, Id, IdVec, Inputs, Leaf, LeafId, MAX_AXES, MAX_BUTTONS, MAX_CHANCES, MAX_INT,
    MAX_MODES, Mode, ModeId, Param, Place, Program, RefUpdate, Reference, Release, Send, Signal, Spawn, Timer, Touch,
    Update, VarId,
};

use super::code::{Code, Facts, Owner};
use super::{At, Checked, Invalid, all_exist, each, each_of, ensure, exists, range, same, tags};

/// The verifier of an entity.
struct EntityVerifier<'p> {
    program: &'p Program,
    code: &'p Code<'p>,
    id: EntityId,
    entity: &'p Entity,
}

pub(super) fn verify(program: &Program, code: &Code<'_>, id: EntityId, entity: &Entity) -> Checked {
    let verifier = EntityVerifier { program, code, id, entity };
    verifier.tables()?;
    verifier.modes()?;
    verifier.leaves()?;
    verifier.behaviour()?;
    verifier.spans(&program.spans.entities[id]).at("spans")
}

impl EntityVerifier<'_> {
    fn expr(&self, id: ExprId) -> Checked {
        self.code.check(Owner::Entity(self.id), id, &mut Facts::new())
    }

    fn optional(&self, id: Option<ExprId>) -> Checked {
        id.map_or(Ok(()), |id| self.expr(id))
    }

    /// Checks each table by itself.
    fn tables(&self) -> Checked {
        let Entity {
            name: _,
            doc: _,
            params,
            vars,
            first,
            discretes,
            refs,
            buttons,
            axes,
            chances,
            colliders,
            groups,
            modes,
            edges: _,
            envelopes,
            leaves: _,
            touches,
            bound,
            probes,
            timers,
            spawns: _,
            signals,
            sends: _,
            follows: _,
            clamps,
            invariants,
            order,
            free: _,
            inputs,
            code,
        } = self.entity;
        ensure(code.from <= code.to && code.to.index() <= self.program.exprs.len(), "it is not of the arena")
            .at("code")?;
        ensure(vars.len() >= 2, "`x` and `y` come first").at("vars")?;
        ensure(buttons.len() <= MAX_BUTTONS, "there are more than fit a set").at("buttons")?;
        ensure(axes.len() <= MAX_AXES, "there are more than fit a set").at("axes")?;
        ensure(chances.len() <= MAX_CHANCES, "there are more than fit a set").at("chances")?;
        each("chances", chances, |_, Chance { name: _, range: (low, high) }| {
            let fits = low <= high && [low, high].iter().all(|end| (-MAX_INT..=MAX_INT).contains(*end));
            ensure(fits, "it is no range of whole numbers").at("range")
        })?;
        ensure(modes.len() <= MAX_MODES, "there are more than a state can number").at("modes")?;
        self.inputs(*inputs).at("inputs")?;
        each("params", params, |_, Param { name: _, default }| self.expr(*default).at("default"))?;
        same(first.len(), vars.len()).at("first")?;
        each("first", first, |_, first| self.optional(*first))?;
        each("discretes", discretes, |_, Discrete { name: _, domain, range: (low, high), first }| {
            let fits = match domain {
                Domain::Int => low <= high,
                Domain::Bool => (*low, *high) == (0, 1),
                Domain::Set(names) => *low == 0 && usize::try_from(*high).is_ok_and(|high| high + 1 == names.len()),
            };
            ensure(fits, "the range is not that of its values").at("range")?;
            self.expr(*first).at("first")
        })?;
        each("refs", refs, |_, Reference { name: _, entity }| {
            entity.map_or(Ok(()), |entity| exists(entity, &self.program.entities)).at("entity")
        })?;
        each("colliders", colliders, |_, Collider { tags: of, kinematic: _, shape, guard }| {
            tags(*of, self.program).at("tags")?;
            shape.numbers().iter().try_for_each(|number| self.expr(*number)).at("shape")?;
            self.optional(*guard).at("guard")?;
            let mut read = shape.numbers().iter().chain(guard);
            ensure(read.all(|id| self.code.asks_no_probe(*id)), "a probe asks for it")
        })?;
        each("probes", probes, |_, probe| {
            self.expr(*probe)?;
            let is_bound = matches!(self.program.exprs[*probe], Expr::Probe { bound: true, .. } | Expr::Nearest { .. });
            ensure(is_bound, "it is not a probe that keeps whom it finds")
        })?;
        ensure(*bound <= touches.len(), "there are not as many contact queries").at("bound")?;
        each("touches", touches, |id, Touch { mine, other, side: _, bound: keeps, tiles }| {
            tags(*mine, self.program).at("mine")?;
            exists(*other, &self.program.tags).at("other")?;
            ensure(*keeps == (id.index() < *bound), "those that keep whom they find come first").at("bound")?;
            ensure(*keeps || !tiles, "a query that keeps nothing keeps no tile").at("tiles")
        })?;
        let numbered = self.entity.numbered_signals();
        each("signals", signals, |id, Signal { name: _, number }| {
            ensure(number.is_some() == (id.index() < numbered), "those with a number come first").at("number")
        })?;
        each("timers", timers, |_, Timer { mode, thresholds }| {
            exists(*mode, modes).at("mode")?;
            each_of("thresholds", thresholds.as_deref().unwrap_or_default(), |id| self.expr(*id))
        })?;
        each_of("clamps", clamps, |Clamp { var, degree, low, high }| {
            exists(*var, vars).at("var")?;
            ensure(*degree <= 1, "accelerations have no soft bounds").at("degree")?;
            self.optional(*low).at("low")?;
            self.optional(*high).at("high")
        })?;
        each_of("invariants", invariants, |id| self.expr(*id))?;
        each("envelopes", envelopes, |_, envelope| self.envelope(envelope))?;
        let mut flows = self.entity.flow_exprs().into_iter().filter(|id| id.index() < self.program.exprs.len());
        ensure(flows.all(|id| self.code.asks_no_members(self.id, id)), "a flow asks each instance").at("leaves")?;
        let mut decided = order.clone();
        decided.sort_unstable();
        ensure(decided.iter().copied().eq(groups.ids()), "each group is decided once").at("order")
    }

    /// Checks that inputs are among those that it reads.
    fn inputs(&self, Inputs { buttons, axes, chances }: Inputs) -> Checked {
        let fit = |set: u64, count: usize| count >= 64 || set >> count == 0;
        ensure(
            fit(buttons, self.entity.buttons.len())
                && fit(u64::from(axes), self.entity.axes.len())
                && fit(u64::from(chances), self.entity.chances.len()),
            "it has no such input",
        )
    }

    fn envelope(&self, envelope: &Envelope) -> Checked {
        let Envelope { mode, vars, degree, by, sustain, attack, peak, decay, release, guard } = envelope;
        let entity = self.entity;
        mode.map_or(Ok(()), |mode| exists(mode, &entity.modes)).at("mode")?;
        ensure((1..=2).contains(&vars.len()), "it drives one variable or two").at("vars")?;
        all_exist(vars, &entity.vars).at("vars")?;
        ensure(*degree <= 2, "there are no derivatives but the first and the second").at("degree")?;
        match by {
            By::Button(button) => exists(*button, &entity.buttons),
            By::Axis(axis) => exists(*axis, &entity.axes),
            By::Axes(axes, directions) => {
                all_exist(axes, &entity.axes)?;
                ensure(vars.len() == 2, "two axes drive two variables")?;
                directions.iter().try_for_each(|direction| super::finite(direction))
            }
            By::Clock { timer, rise, hold, fall, total } => {
                exists(*timer, &entity.timers)?;
                [rise, hold, fall, total].into_iter().try_for_each(|id| self.expr(*id))
            }
        }
        .at("by")?;
        let (rate, level) = match *release {
            Release::Hold => (None, None),
            Release::To { rate, level } => (rate, Some(level)),
        };
        [Some(*sustain), *attack, *peak, *decay, rate, level, *guard].into_iter().try_for_each(|id| self.optional(id))
    }

    /// Checks the modes: group by group, in preorder, each with its leaves.
    fn modes(&self) -> Checked {
        let Entity { groups, modes, leaves, .. } = self.entity;
        let mut next = ModeId(0);
        each("groups", groups, |_, Group { name: _, modes: inside, first, choices }| {
            range(*inside, modes).at("modes")?;
            ensure(inside.from == next, "groups lie one after another").at("modes")?;
            next = inside.to;
            let outermost = |mode: ModeId| inside.contains(mode) && modes[mode].parent.is_none();
            ensure(outermost(*first), "it is none of the group's outermost modes").at("first")?;
            each_of("choices", choices, |choice| {
                ensure(outermost(choice.mode), "it is none of the group's outermost modes").at("mode")?;
                self.expr(choice.guard).at("guard")
            })
        })?;
        ensure(next.index() == modes.len(), "each mode is of a group").at("groups")?;
        let mut leaf = LeafId(0);
        each("modes", modes, |id, mode| {
            let Mode { path: _, parent, end, group, leaves: inside, initial, choices, chooses, inner, entry } = mode;
            exists(*group, groups).at("group")?;
            ensure(groups[*group].modes.contains(id), "it is not among its group's modes").at("group")?;
            ensure(*end > id && *end <= groups[*group].modes.to, "descendants follow it, in its group").at("end")?;
            // The parent is the previous mode or one of its ancestors.
            let mut around = id.0.checked_sub(1).map(ModeId).filter(|before| modes[*before].group == *group);
            while let Some(mode) = around.filter(|mode| modes[*mode].end <= id) {
                around = modes[mode].parent;
            }
            ensure(*parent == around, "it lies in another mode").at("parent")?;
            ensure(around.is_none_or(|around| *end <= modes[around].end), "it ends after what is around it")
                .at("end")?;
            range(*inside, leaves).at("leaves")?;
            let is_leaf = end.0 == id.0 + 1;
            ensure(inside.from == leaf && (!is_leaf || inside.len() == 1), "they are not the leaves inside")
                .at("leaves")?;
            leaf.0 += u32::from(is_leaf);
            ensure(inside.contains(*initial), "it is not inside").at("initial")?;
            let child = |mode: ModeId| mode.index() < modes.len() && modes[mode].parent == Some(id);
            ensure(inner.map_or(is_leaf, child), "it is not directly inside").at("inner")?;
            ensure(!is_leaf || choices.is_empty(), "there is nothing to choose from").at("choices")?;
            each_of("choices", choices, |choice| {
                ensure(child(choice.mode), "it is not directly inside").at("mode")?;
                self.expr(choice.guard).at("guard")
            })?;
            let within = (id.0 + 1..end.0).map(ModeId).any(|mode| modes[mode].chooses);
            ensure(*chooses == (within || !choices.is_empty()), "it does not say what its choices do").at("chooses")?;
            self.actions(entry, &mut Facts::new()).at("entry")
        })?;
        ensure(leaf.index() == leaves.len(), "each mode without modes inside is a leaf").at("leaves")?;
        // Backwards, as descendants come later.
        let mut entered: Vec<LeafId> = vec![LeafId(0); modes.len()];
        for (id, mode) in modes.pairs().rev() {
            let after = mode.end.0.checked_sub(id.0 + 1).filter(|inside| *inside > 0);
            let leaf = after.and(mode.inner).map_or(mode.leaves.from, |inner| entered[inner.index()]);
            entered[id.index()] = leaf;
            let ends = modes.get(mode.end).map_or(leaves.len(), |next| next.leaves.from.index());
            let place = format!("modes[{}]", id.index());
            ensure(mode.initial == leaf, "it is not what is entered").at("initial").at(&place)?;
            ensure(mode.leaves.to.index() == ends, "they are not the leaves inside").at("leaves").at(&place)?;
        }
        Ok(())
    }

    /// Checks the active modes, edges and drives of each leaf.
    fn leaves(&self) -> Checked {
        let Entity { vars, groups, modes, edges, leaves, follows, free, .. } = self.entity;
        let mut owners: IdVec<VarId, Option<GroupId>> = vars.iter().map(|_| None).collect();
        each("leaves", leaves, |id, leaf| {
            let Leaf { mode, path, drives, edges: tried, internal, follows: followed, inputs } = leaf;
            exists(*mode, modes).at("mode")?;
            let of = &modes[*mode];
            ensure(of.inner.is_none() && of.leaves.from == id, "it is not this leaf's").at("mode")?;
            let mut around = Some(*mode);
            for active in path.iter().rev() {
                ensure(around == Some(*active), "it is not what lies around the mode").at("path")?;
                around = modes[*active].parent;
            }
            ensure(around.is_none(), "it is not all that lies around the mode").at("path")?;
            let edge = |id: &crate::ir::EdgeId, leads: bool| {
                exists(*id, edges)?;
                let Edge { source, target, .. } = &edges[*id];
                ensure(path.contains(source), "it is not an edge of what is active")?;
                ensure(target.is_some() == leads, "it is tried where it does not belong")
            };
            each_of("edges", tried, |id| edge(id, true))?;
            each_of("internal", internal, |id| edge(id, false))?;
            all_exist(followed, follows).at("follows")?;
            self.inputs(*inputs).at("inputs")?;
            each_of("drives", drives, |drive| {
                let var = self.drive(*drive)?;
                ensure(owners[var].is_none_or(|owner| owner == of.group), "another group drives it, too")?;
                owners[var] = Some(of.group);
                Ok(())
            })
        })?;
        let mut is_driven: IdVec<VarId, bool> = vars.iter().map(|_| false).collect();
        each_of("free", free, |drive| {
            let var = self.drive(*drive)?;
            ensure(owners[var].is_none() && !is_driven[var], "it is driven twice")?;
            is_driven[var] = true;
            Ok(())
        })?;
        ensure(vars.ids().all(|var| is_driven[var] || owners[var].is_some()), "a variable is not driven").at("free")?;
        each("leaves", leaves, |_, leaf| {
            let group = modes[leaf.mode].group;
            let wanted = vars.ids().filter(|var| owners[*var] == Some(group));
            let driven = leaf.drives.iter().map(|drive| driven(self.entity, *drive));
            ensure(driven.eq(wanted.map(Some)), "it does not drive each variable of its group once").at("drives")
        })?;
        ensure(!groups.is_empty() || modes.is_empty(), "modes are of groups").at("groups")
    }

    /// The variable that a drive drives.
    fn drive(&self, drive: Drive) -> Result<VarId, Invalid> {
        let entity = self.entity;
        match drive {
            Drive::Coast(var) => exists(var, &entity.vars)?,
            Drive::Flow { var, degree, value } => {
                exists(var, &entity.vars)?;
                ensure(degree <= 2, "there are no derivatives but the first and the second")?;
                self.expr(value)?;
            }
            Drive::Envelope(id, _) => exists(id, &entity.envelopes)?,
        }
        driven(entity, drive).ok_or_else(|| Invalid::new("the envelope has no such component"))
    }

    /// Checks edges, links and spawns.
    fn behaviour(&self) -> Checked {
        let Entity { modes, edges, follows, refs, spawns, sends, .. } = self.entity;
        each("edges", edges, |_, Edge { source, target, guard, actions, needs }| {
            exists(*source, modes).at("source")?;
            if let Some(target) = target {
                exists(*target, modes).at("target")?;
                ensure(modes[*target].group == modes[*source].group, "it is of another group").at("target")?;
            }
            self.guarded(Some(*guard), actions)?;
            all_exist(needs, refs).at("needs")
        })?;
        each("follows", follows, |_, Follow { guard, actions, needs }| {
            self.guarded(*guard, actions)?;
            all_exist(needs, refs).at("needs")
        })?;
        // Actions are checked in context, with the facts of the guard.
        let of_actions = self.entity.action_lists().flat_map(|actions| &actions.spawns);
        let mut happens: Vec<_> = of_actions.copied().collect();
        happens.sort_unstable();
        ensure(happens.into_iter().eq(spawns.ids()), "each happens in one place").at("spawns")?;
        let mut sent: Vec<_> = self.entity.action_lists().flat_map(|actions| actions.sends.iter().copied()).collect();
        sent.sort_unstable();
        ensure(sent.into_iter().eq(sends.ids()), "each happens in one place").at("sends")
    }

    fn guarded(&self, guard: Option<ExprId>, actions: &Actions) -> Checked {
        let mut facts = Facts::new();
        if let Some(guard) = guard {
            self.code.check(Owner::Entity(self.id), guard, &mut facts).at("guard")?;
            self.code.learn(guard, true, &mut facts);
        }
        self.actions(actions, &mut facts).at("actions")
    }

    fn actions(&self, actions: &Actions, facts: &mut Facts) -> Checked {
        let Actions { updates, refs, spawns, destroys, sends } = actions;
        self.updates(updates, self.entity, facts).at("updates")?;
        self.references(refs, self.entity).at("refs")?;
        all_exist(spawns, &self.entity.spawns).at("spawns")?;
        for id in spawns {
            self.spawn(&self.entity.spawns[*id], facts).at(&format!("spawns[{}]", id.index()))?;
        }
        all_exist(sends, &self.entity.sends).at("sends")?;
        for id in sends {
            self.send(&self.entity.sends[*id], facts).at(&format!("sends[{}]", id.index()))?;
        }
        each_of("destroys", destroys, |what| self.code.instance(Owner::Entity(self.id), *what))
    }

    fn send(&self, send: &Send, facts: &mut Facts) -> Checked {
        let Send { to, entity, signal, value } = *send;
        exists(entity, &self.program.entities).at("entity")?;
        let of = &self.program.entities[entity];
        exists(signal, &of.signals).at("signal")?;
        if let Some(to) = to {
            self.code.subject(Owner::Entity(self.id), to).at("to")?;
        }
        ensure(value.is_some() == of.signals[signal].number.is_some(), "it has no number, or one too many")
            .at("value")?;
        value.map_or(Ok(()), |value| self.code.check(Owner::Entity(self.id), value, facts).at("value"))
    }

    fn spawn(&self, spawn: &Spawn, facts: &mut Facts) -> Checked {
        let Spawn { entity, into, params, updates, refs } = spawn;
        exists(*entity, &self.program.entities).at("entity")?;
        let of = &self.program.entities[*entity];
        if let Some(into) = into {
            exists(*into, &self.entity.refs).at("into")?;
            ensure(self.entity.refs[*into].entity.is_none_or(|may| may == *entity), "it refers to others")
                .at("into")?;
        }
        each_of("params", params, |(param, value)| {
            exists(*param, &of.params)?;
            self.code.check(Owner::Entity(self.id), *value, facts)
        })?;
        self.updates(updates, of, facts).at("updates")?;
        self.references(refs, of).at("refs")
    }

    fn updates(&self, updates: &[Update], of: &Entity, facts: &mut Facts) -> Checked {
        each_of("", updates, |Update { place, value }| {
            match *place {
                Place::Var(var, degree) => {
                    exists(var, &of.vars)?;
                    ensure(degree <= 2, "there are no derivatives but the first and the second")?;
                }
                Place::Discrete(id) => exists(id, &of.discretes)?,
                Place::Ref(_) => return Err(Invalid::new("a reference gets an instance, not a number")),
            }
            self.code.check(Owner::Entity(self.id), *value, facts)
        })
    }

    fn references(&self, updates: &[RefUpdate], of: &Entity) -> Checked {
        each_of("", updates, |RefUpdate { reference, value }| {
            exists(*reference, &of.refs)?;
            self.code.instance(Owner::Entity(self.id), *value)
        })
    }

    fn spans(&self, spans: &EntitySpans) -> Checked {
        let EntitySpans {
            name: _,
            params,
            vars,
            discretes,
            refs,
            spawns,
            follows,
            invariants,
            buttons,
            axes,
            chances,
            colliders,
            groups,
            touches,
            modes,
            edges,
            envelopes,
        } = spans;
        let e = self.entity;
        let counts = [
            (params.len(), e.params.len()),
            (vars.len(), e.vars.len()),
            (discretes.len(), e.discretes.len()),
            (refs.len(), e.refs.len()),
            (spawns.len(), e.spawns.len()),
            (follows.len(), e.follows.len()),
            (invariants.len(), e.invariants.len()),
            (buttons.len(), e.buttons.len()),
            (axes.len(), e.axes.len()),
            (chances.len(), e.chances.len()),
            (colliders.len(), e.colliders.len()),
            (groups.len(), e.groups.len()),
            (touches.len(), e.touches.len()),
            (modes.len(), e.modes.len()),
            (edges.len(), e.edges.len()),
            (envelopes.len(), e.envelopes.len()),
        ];
        counts.into_iter().try_for_each(|(count, wanted)| same(count, wanted))
    }
}

/// The variable of a drive; `None` if an envelope has no such component.
fn driven(entity: &Entity, drive: Drive) -> Option<VarId> {
    match drive {
        Drive::Coast(var) | Drive::Flow { var, .. } => Some(var),
        Drive::Envelope(id, component) => entity.envelopes[id].vars.get(usize::from(component)).copied(),
    }
}
