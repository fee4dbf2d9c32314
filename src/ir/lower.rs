//! Lowering: a checked program into the tables.

use crate::sema::checked::{self, Checked};
use crate::source::Span;

use super::fold::{Context, rate};
use super::{
    Arithmetic, Choice, Collider, Discrete, Domain, Edge, Entity, EntityId, EntitySpans, Envelope, Expr, ExprId,
    Function, Group, Id, IdVec, Inputs, LeafId, Mode, ModeId, Param, Program, Release, TagSet, Update, leaf, verify,
    world,
};

/// Lowers a program that checked without errors.
pub fn lower(checked: &Checked) -> Program {
    let mut program = Program { tags: checked.tags.iter().map(|t| t.text.clone()).collect(), ..Program::default() };
    program.spans.tags = checked.tags.iter().map(|t| t.span).collect();
    // Goals add contact questions to entities that are lowered already, so all entities must exist first.
    for entity in checked.entities.iter() {
        program.entities.push(shell(entity));
        program.spans.entities.push(spans(entity));
    }
    for (id, entity) in checked.entities.pairs() {
        let from = ExprId::from_index(program.exprs.len());
        entity_code(&mut program, id, entity);
        let to = ExprId::from_index(program.exprs.len());
        program.timer_thresholds(id, from, to);
    }
    // Contact questions of every world, before any layout counts them.
    let predicates: Vec<_> = checked.worlds.iter().map(|w| world::predicates(&mut program, w)).collect();
    for (w, predicates) in checked.worlds.iter().zip(predicates) {
        world::lower(&mut program, w, predicates);
    }
    verify::verify(&program);
    program
}

/// An entity's names and sizes, without code.
fn shell(e: &checked::Entity) -> Entity {
    let discretes = e.discretes.iter().map(|d| Discrete {
        name: d.name.text.clone(),
        domain: match &d.ty {
            checked::Type::Bool => Domain::Bool,
            checked::Type::Set(names) => Domain::Set(names.clone()),
            checked::Type::Int | checked::Type::Real => Domain::Int,
        },
        range: d.range,
    });
    Entity {
        name: e.name.text.clone(),
        doc: e.doc.clone(),
        params: IdVec::new(),
        vars: e.vars.iter().map(|v| v.name.text.clone()).collect(),
        discretes: discretes.collect(),
        buttons: e.buttons.iter().map(|b| b.text.clone()).collect(),
        axes: e.axes.iter().map(|a| a.text.clone()).collect(),
        colliders: IdVec::new(),
        groups: IdVec::new(),
        modes: IdVec::new(),
        edges: IdVec::new(),
        envelopes: IdVec::new(),
        leaves: IdVec::new(),
        touches: IdVec::new(),
        timers: IdVec::new(),
        free: Vec::new(),
        inputs: Inputs::default(),
    }
}

fn spans(e: &checked::Entity) -> EntitySpans {
    EntitySpans {
        name: e.name.span,
        params: e.params.iter().map(|p| p.name.span).collect(),
        vars: e.vars.iter().map(|v| v.name.span).collect(),
        discretes: e.discretes.iter().map(|d| d.name.span).collect(),
        buttons: e.buttons.iter().map(|b| b.span).collect(),
        axes: e.axes.iter().map(|a| a.span).collect(),
        colliders: e.colliders.iter().map(|c| c.span).collect(),
        groups: e.groups.iter().map(|g| g.name.as_ref().map_or(e.name.span, |n| n.span)).collect(),
        touches: IdVec::new(),
        modes: e.modes.iter().map(|m| m.name.span).collect(),
        edges: e.edges.iter().map(|x| x.span).collect(),
        envelopes: e.envelopes.iter().map(|x| x.span).collect(),
    }
}

fn entity_code(program: &mut Program, id: EntityId, e: &checked::Entity) {
    let context = Context { me: Some(id), slots: &|_| id };
    for param in e.params.iter() {
        let default = program.term(&param.default, &context);
        program.entities[id].params.push(Param { name: param.name.text.clone(), default });
    }
    for collider in e.colliders.iter() {
        let rect = [0, 1, 2, 3].map(|i| program.term(&collider.rect[i], &context));
        let guard = collider.guard.as_ref().map(|g| program.term(g, &context));
        let tags = collider.tags.iter().copied().collect::<TagSet>();
        program.entities[id].colliders.push(Collider { tags, kinematic: collider.kinematic, rect, guard });
    }
    for envelope in e.envelopes.iter() {
        let envelope = lower_envelope(program, envelope, &context);
        program.entities[id].envelopes.push(envelope);
    }
    for edge in e.edges.iter() {
        let guard = program.term(&edge.guard, &context);
        let updates = lower_updates(program, &edge.updates, &context);
        program.entities[id].edges.push(Edge { source: edge.source, target: edge.target, guard, updates });
    }
    modes(program, id, e, &context);
    let tables = leaf::drives(program, e, &context);
    let built = leaf::leaves(program, id, e, &tables);
    let entity = &mut program.entities[id];
    entity.inputs = built.always;
    entity.free = tables.free;
    entity.leaves = built.leaves;
}

fn lower_updates(program: &mut Program, updates: &[checked::Update], context: &Context<'_>) -> Vec<Update> {
    updates.iter().map(|u| Update { place: u.place, value: program.term(&u.value, context) }).collect()
}

fn lower_envelope(program: &mut Program, e: &checked::Envelope, context: &Context<'_>) -> Envelope {
    let sustain = program.term(&e.sustain, context);
    let zero = |program: &mut Program, span: Span| program.push(Expr::Number(0.0), span);
    let level = match &e.release {
        checked::Release::To(_, Some(level)) => program.term(level, context),
        checked::Release::To(_, None) | checked::Release::Hold => zero(program, e.span),
    };
    let timed = |r: &checked::Rate| matches!(r, checked::Rate::Over(_));
    let any_timed = timed(&e.attack) || matches!(&e.release, checked::Release::To(r, _) if timed(r));
    let distance = if any_timed {
        let way = program.push(Expr::Arithmetic(Arithmetic::Subtract, sustain, level), e.span);
        program.push(Expr::Call(Function::Abs, [way; 3]), e.span)
    } else {
        level
    };
    let attack = rate(program, &e.attack, distance, context, e.span);
    let release = match &e.release {
        checked::Release::Hold => Release::Hold,
        checked::Release::To(r, _) => Release::To { rate: rate(program, r, distance, context, e.span), level },
    };
    let guard = e.driven_while.as_ref().map(|g| program.term(g, context));
    Envelope { var: e.var, degree: e.degree, axis: e.axis, sustain, attack, release, guard }
}

/// Modes and groups. Checked modes are in preorder already, group by group.
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
        while let Some(child) = first_of(e, &e.modes[mode].children) {
            mode = child;
        }
        LeafId(first_leaf[mode.index()])
    };
    for (mode, m) in e.modes.pairs() {
        let entry = lower_updates(program, &m.entry, context);
        let choices = choices_of(program, e, &m.children, context);
        let (first, after) = leaves[mode.index()];
        program.entities[id].modes.push(Mode {
            path: m.path.join("."),
            parent: m.parent,
            end: ModeId(ends[mode.index()]),
            group: m.group,
            leaves: (LeafId(first), LeafId(after)),
            initial: initial(mode),
            chooses: !choices.is_empty(),
            choices,
            inner: first_of(e, &m.children),
            entry,
        });
    }
    // A mode chooses if anything inside it does; inner modes come later, so from the last to the first.
    let table = &mut program.entities[id].modes;
    for mode in (0..count as u32).rev().map(ModeId) {
        if let Some(parent) = table[mode].parent {
            table[parent].chooses |= table[mode].chooses;
        }
    }
    for group in e.groups.iter() {
        let first = group.modes.first().copied().unwrap_or(ModeId(0));
        let choices = choices_of(program, e, &group.modes, context);
        let end = group.modes.last().map_or(0, |last| ends[last.index()]);
        program.entities[id].groups.push(Group {
            name: group.name.as_ref().map(|n| n.text.clone()),
            modes: (first, ModeId(end)),
            first: first_of(e, &group.modes).unwrap_or(first),
            choices,
        });
    }
}

/// The modes marked `initial when`.
fn choices_of(program: &mut Program, e: &checked::Entity, modes: &[ModeId], context: &Context<'_>) -> Vec<Choice> {
    let guarded = modes.iter().filter_map(|&mode| e.modes[mode].initial_when.as_ref().map(|guard| (mode, guard)));
    guarded.map(|(mode, guard)| Choice { guard: program.term(guard, context), mode }).collect()
}

/// The mode marked `initial`, else the first.
fn first_of(e: &checked::Entity, modes: &[ModeId]) -> Option<ModeId> {
    modes.iter().copied().find(|&m| e.modes[m].marked_initial).or(modes.first().copied())
}
