//! What is shown between the words: dimensions of parameters, what variables can be, how high and how long a jump goes;
//! and above worlds and goals, what can be run.

use crate::ir::{EntityId, Id, IdVec, ModeId, ParamId, Place, VarId};

use gen_lsp_types as types;
use gen_lsp_types::{CodeLens, Command, InlayHint, InlayHintKind};
use serde_json::json;

use crate::sema::checked::{Action, Checked, DriveBy, Edge, Entity, Term, TermKind};
use crate::sema::{ConstantContext, evaluate};
use crate::source::{FileId, Span};
use crate::syntax::ast::{Item, Name, WorldItem};
use crate::syntax::{self};

use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::uri::path_of;
use crate::lsp::values::written;
use crate::lsp::view::{Failure, Known, View};

impl View {
    pub(in crate::lsp) fn inlay_hints(
        &self,
        params: types::InlayHintParams,
    ) -> Result<Option<Vec<InlayHint>>, Failure> {
        let path = path_of(&params.text_document.uri);
        let encoding = self.client.encoding;
        let Some((known, file)) = self.programs(&path).find_map(|known| Some((known, known.now.file(&path)?))) else {
            return Ok(None);
        };
        let snapshot = &*known.now;
        let bytes = snapshot.text(file).bytes(params.range, encoding);
        let mut hints = Hints { known, snapshot, file, found: Vec::new() };
        for (id, entity) in snapshot.ide.checked.entities.pairs() {
            hints.entity(&snapshot.ide.checked, id, entity);
        }
        hints.found.sort();
        hints.found.dedup();
        let inside = hints.found.into_iter().filter(|(at, _)| bytes.start <= *at && *at <= bytes.end);
        let text = snapshot.text(file);
        let hints = inside.map(|(at, label)| InlayHint {
            position: text.position(at, encoding),
            kind: label.starts_with(':').then_some(InlayHintKind::Type),
            padding_left: Some(!label.starts_with(':')),
            label: label.into(),
            text_edits: None,
            tooltip: None,
            padding_right: None,
            data: None,
        });
        Ok(Some(hints.collect()))
    }

    pub(in crate::lsp) fn code_lenses(&self, params: types::CodeLensParams) -> Result<Option<Vec<CodeLens>>, Failure> {
        let path = path_of(&params.text_document.uri);
        let Some(document) = self.documents.get(&path) else { return Ok(None) };
        let (tree, _) = syntax::parse(FileId(0), document.text.code());
        let uri = &document.uri.0;
        let mut out = Vec::new();
        let mut lens = |at: Span, title: &str, command: &str, arguments: Vec<serde_json::Value>| {
            out.push(CodeLens {
                range: document.text.range(at.range(), self.client.encoding),
                command: Some(Command {
                    title: title.into(),
                    tooltip: None,
                    command: command.into(),
                    arguments: Some(arguments),
                }),
                data: None,
            });
        };
        for item in &tree.items {
            let Item::World(world) = item else { continue };
            let name = &world.name.text;
            lens(world.name.span, "▶ simulate", "hypedc.sim", vec![json!(uri), json!(name)]);
            let goals = world.items.iter().filter_map(|i| if let WorldItem::Goal(q) = i { Some(q) } else { None });
            for goal in goals {
                let arguments = vec![json!(uri), json!(name), json!(goal.name.text)];
                lens(goal.name.span, "▶ can it be reached?", "hypedc.reach", arguments);
            }
        }
        Ok(Some(out))
    }
}

/// Gathers the hints of a file.
struct Hints<'a> {
    known: &'a Known,
    snapshot: &'a Snapshot,
    file: FileId,
    /// The byte at which each is shown, and its words.
    found: Vec<(usize, String)>,
}

impl Hints<'_> {
    fn add(&mut self, at: Span, label: String) {
        // What is in a behaviour means different things where it is put.
        if at.file() == self.file {
            self.found.push((at.range().end, label));
        }
    }

    fn entity(&mut self, checked: &Checked, id: EntityId, entity: &Entity) {
        for (param, p) in entity.params.pairs().filter(|(_, p)| p.dimension.is_none()) {
            if let Some(dimension) = checked.dimensions.params.get(&(id, param)).filter(|d| *d != "1") {
                self.add(p.name.span, format!(": {dimension}"));
            }
        }
        for (var, v) in entity.vars.pairs().filter(|(_, v)| v.dimension.is_none() && v.name.span != entity.name.span) {
            if let Some(dimension) = checked.dimensions.vars.get(&(id, var)).filter(|d| *d != "1") {
                self.add(v.name.span, format!(": {dimension}"));
            }
        }
        let bounded = entity.vars.iter().map(|v| &v.name).filter(|name| name.span != entity.name.span);
        let plain = entity.discretes.iter().filter(|d| matches!(d.ty, crate::sema::checked::Type::Int));
        for (name, declared) in bounded.map(|name| (name, None)).chain(plain.map(|d| (&d.name, Some(d.range)))) {
            self.bounds(entity, name, declared);
        }
        let params = parameters(entity);
        for edge in entity.edges.iter() {
            self.jump(entity, edge, &params);
        }
    }

    /// What a variable is at most, in all of its modes.
    fn bounds(&mut self, entity: &Entity, name: &Name, declared: Option<(i32, i32)>) {
        let Some(ranges) = &self.known.ranges else { return };
        let known = ranges.get(&entity.name.text, &name.text);
        let all = known.iter().filter_map(|m| m.values.first()).filter_map(crate::analysis::Values::hull);
        let Some(hull) = all.reduce(crate::analysis::Interval::or) else { return };
        let is_news = declared.is_none_or(|(low, high)| (f64::from(low), f64::from(high)) != (hull.low, hull.high));
        if is_news && (hull.low.is_finite() || hull.high.is_finite()) {
            self.add(self.line_end(name.span), format!("is {}", written(&hull.into())));
        }
    }

    /// The end of the line of a place, its comment left out.
    fn line_end(&self, at: Span) -> Span {
        let text = self.snapshot.ide.compilation.sources.file(at.file()).text();
        let rest = text.get(at.range().end..).unwrap_or_default();
        let line = rest.split(['\n', '\r', ';', '}']).next().unwrap_or_default();
        let line = line.split("//").next().unwrap_or_default().trim_end();
        let end = at.range().end + line.len();
        Span::new(at.file(), end, end)
    }

    /// How high and how long it goes up where an edge sets an upward velocity and leads to where it falls.
    fn jump(&mut self, entity: &Entity, edge: &Edge, params: &IdVec<ParamId, f64>) {
        let context = ConstantContext { params: Some(params), step: None };
        let value = |term: &Term| evaluate(term, context).ok().filter(|v| v.is_finite());
        let height = VarId::from_index(1);
        for action in &edge.actions {
            let Action::Update(update) = action else { continue };
            if update.place != Place::Var(height, 1) {
                continue;
            }
            let Some(speed) = value(&update.value).filter(|v| *v > 0.0) else { continue };
            let Some(leaf) = entered(entity, edge.target.unwrap_or(edge.source)) else { continue };
            let Some(pull) = falls(entity, leaf, height).and_then(&value).filter(|v| *v < 0.0) else { continue };
            let (rise, time) = (speed * speed / (-2.0 * pull), speed / -pull);
            let mut label = format!("up to {} px in {} s", short(rise), short(time));
            if ends_by_contact(entity, leaf) {
                label = format!("{label}, {} s in the air", short(2.0 * time));
            }
            self.add(update.span, label);
        }
    }
}

/// The values of parameters where nothing is set; those that are not known are not numbers.
fn parameters(entity: &Entity) -> IdVec<ParamId, f64> {
    let mut params: IdVec<ParamId, f64> = IdVec::new();
    for param in entity.params.iter() {
        let context = ConstantContext { params: Some(&params), step: None };
        let value = evaluate(&param.default, context).unwrap_or(f64::NAN);
        params.push(value);
    }
    params
}

/// The leaf that is entered with a mode, where that does not depend on a guard.
fn entered(entity: &Entity, mode: ModeId) -> Option<ModeId> {
    let mut at = mode;
    loop {
        let inside = &entity.modes[at].children;
        if inside.iter().any(|child| entity.modes[*child].initial_when.is_some()) {
            return None;
        }
        let Some(first) = inside.iter().find(|c| entity.modes[**c].marked_initial).or(inside.first()) else {
            return Some(at);
        };
        at = *first;
    }
}

/// Whether nothing but contacts ends a mode or what is around it.
fn ends_by_contact(entity: &Entity, leaf: ModeId) -> bool {
    let mut at = Some(leaf);
    while let Some(id) = at {
        let mode = &entity.modes[id];
        let mut edges = mode.edges.iter().map(|edge| &entity.edges[*edge]).filter(|edge| edge.target.is_some());
        if !edges.all(|edge| needs_contact(&edge.guard)) {
            return false;
        }
        at = mode.parent;
    }
    true
}

/// Whether a guard holds only while something is touched.
fn needs_contact(guard: &Term) -> bool {
    match &guard.kind {
        TermKind::Touching(_) => true,
        TermKind::And(sides) => sides.iter().any(needs_contact),
        TermKind::Or(sides) => sides.iter().all(needs_contact),
        _ => false,
    }
}

/// The acceleration of a variable in a mode, if a flow of it or of what is around it gives one.
fn falls(entity: &Entity, mode: ModeId, var: VarId) -> Option<&Term> {
    let mut at = Some(mode);
    while let Some(id) = at {
        let mode = &entity.modes[id];
        if let Some(drive) = mode.drives.iter().find(|d| d.var == var) {
            return match &drive.by {
                DriveBy::Flow(term) if drive.degree == 2 => Some(term),
                _ => None,
            };
        }
        at = mode.parent;
    }
    let drive = entity.drives.iter().find(|d| d.var == var && d.degree == 2)?;
    if let DriveBy::Flow(term) = &drive.by { Some(term) } else { None }
}

/// At most two digits after the point.
fn short(x: f64) -> String {
    let text = format!("{x:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}
