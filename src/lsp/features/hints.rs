//! Inlay hints: dimensions of declarations, value ranges of variables, height and duration of jumps. Code lenses:
//! commands to simulate worlds and search for goals.

use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

use crate::ir::{EntityId, Id, IdVec, ModeId, ParamId, Place, VarId};
use crate::ordered::Ordered;
use crate::reach::query::Kind;
use crate::sema::checked::{Action, Checked, DriveBy, Edge, Entity, Term, TermKind};
use crate::sema::{ConstantContext, evaluate};
use crate::source::{FileId, Span};
use crate::syntax::ast::{Item, MapSource, Name, SpaceItem, World, WorldItem};

use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::document_text::Text;
use crate::lsp::values::format_values;
use crate::lsp::view::{ProgramState, View};

/// The content of a hint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::lsp) enum HintKind {
    /// The dimension of a parameter or variable.
    Dimension,
    /// The values that a variable can have.
    Bounds,
    /// The height and the duration of a jump.
    Jump,
}

/// A hint, shown at an offset.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(in crate::lsp) struct InlayHint {
    pub byte: usize,
    pub label: String,
    pub kind: HintKind,
}

/// The hints in a range of a file, in order, and the text to which their offsets refer; `None` if no program contains
/// the file.
pub(in crate::lsp) fn inlay_hints(
    view: &View,
    path: &Path,
    bytes: &Range<usize>,
) -> Option<(Arc<Text>, Vec<InlayHint>)> {
    let (state, file) = view.programs_with(path).find_map(|state| Some((state, state.current.file(path)?)))?;
    let snapshot = &*state.current;
    let (start, end) = (view.byte_in(snapshot, file, bytes.start), view.byte_in(snapshot, file, bytes.end));
    let mut hints = Hints { state, snapshot, file, found: Vec::new() };
    for (id, entity) in snapshot.ide.checked.entities.pairs() {
        hints.entity(&snapshot.ide.checked, id, entity);
    }
    hints.found.order_by(Ord::cmp);
    hints.found.dedup();
    hints.found.retain(|hint| start <= hint.byte && hint.byte <= end);
    Some((snapshot.text(file), hints.found))
}

/// A command, shown above a declaration.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct CodeLens {
    /// The range of the declared name.
    pub bytes: Range<usize>,
    pub command: LensCommand,
}

/// A command of `hypedc`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) enum LensCommand {
    /// `hypedc sim`; whether the world leaves its map open.
    Simulate { world: String, is_open: bool },
    /// `hypedc reach`
    Reach { world: String, kind: Kind, name: String, is_open: bool },
}

/// The lenses of the worlds, goals and `never`s of a text.
pub(in crate::lsp) fn code_lenses(text: &Text) -> Vec<CodeLens> {
    let mut out = Vec::new();
    for item in &text.tree().items {
        let Item::World(world) = item else { continue };
        let (name, is_open) = (world.name.text.to_string(), leaves_map_open(world));
        out.push(CodeLens {
            bytes: world.name.span.range(),
            command: LensCommand::Simulate { world: name.clone(), is_open },
        });
        out.extend(world.items.iter().filter_map(|item| {
            let (kind, question) = match item {
                WorldItem::Goal(question) => (Kind::Goal, question),
                WorldItem::Never(question) => (Kind::Never, question),
                _ => return None,
            };
            let (world, name) = (name.clone(), question.name.text.to_string());
            let command = LensCommand::Reach { world, kind, name, is_open };
            Some(CodeLens { bytes: question.name.span.range(), command })
        }));
    }
    out
}

/// Whether a world leaves a map to the command line.
fn leaves_map_open(world: &World) -> bool {
    let spaces = world.items.iter().filter_map(|item| if let WorldItem::Space(of) = item { Some(of) } else { None });
    spaces.flat_map(|space| &space.items).any(|item| match item {
        SpaceItem::Map(map) => {
            matches!(map.source, MapSource::Open(_) | MapSource::OpenLegend(_) | MapSource::OpenAll(_))
        }
        _ => false,
    })
}

/// Collects the hints of a file.
struct Hints<'a> {
    state: &'a ProgramState,
    snapshot: &'a Snapshot,
    file: FileId,
    found: Vec<InlayHint>,
}

impl Hints<'_> {
    fn add(&mut self, at: Span, kind: HintKind, label: String) {
        // Declarations in behaviours have no hints: each use can have other values.
        if at.file() == self.file {
            self.found.push(InlayHint { byte: at.range().end, label, kind });
        }
    }

    fn entity(&mut self, checked: &Checked, id: EntityId, entity: &Entity) {
        for (param, p) in entity.params.pairs().filter(|(_, p)| p.dimension.is_none()) {
            if let Some(dimension) = checked.dimensions.params.get(&(id, param)).filter(|d| *d != "1") {
                self.add(p.name.span, HintKind::Dimension, format!(": {dimension}"));
            }
        }
        for (var, v) in entity.vars.pairs().filter(|(_, v)| v.dimension.is_none() && v.name.span != entity.name.span) {
            if let Some(dimension) = checked.dimensions.vars.get(&(id, var)).filter(|d| *d != "1") {
                self.add(v.name.span, HintKind::Dimension, format!(": {dimension}"));
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

    /// The range of a variable over all modes, unless it is the declared one.
    fn bounds(&mut self, entity: &Entity, name: &Name, declared: Option<(i32, i32)>) {
        let Some(ranges) = &self.state.ranges else { return };
        let known = ranges.get(&entity.name.text, &name.text);
        let all = known.iter().filter_map(|m| m.values.first()).filter_map(crate::analysis::Values::hull);
        let Some(hull) = all.reduce(crate::analysis::Interval::or) else { return };
        let is_informative =
            declared.is_none_or(|(low, high)| (f64::from(low), f64::from(high)) != (hull.low, hull.high));
        if is_informative && (hull.low.is_finite() || hull.high.is_finite()) {
            self.add(self.line_end(name.span), HintKind::Bounds, format!("is {}", format_values(&hull.into())));
        }
    }

    /// The end of the line of a span, before a comment.
    fn line_end(&self, at: Span) -> Span {
        let text = self.snapshot.ide.compilation.sources.file(at.file()).text();
        let rest = text.get(at.range().end..).unwrap_or_default();
        let line = rest.split(['\n', '\r', ';', '}']).next().unwrap_or_default();
        let line = line.split("//").next().unwrap_or_default().trim_end();
        let end = at.range().end + line.len();
        Span::new(at.file(), end, end)
    }

    /// Adds height and duration of a jump: an edge that sets an upward velocity and enters a mode with a downward
    /// acceleration.
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
            let Some(leaf) = entered_leaf(entity, edge.target.unwrap_or(edge.source)) else { continue };
            let Some(pull) = acceleration(entity, leaf, height).and_then(&value).filter(|v| *v < 0.0) else { continue };
            let (rise, time) = (speed * speed / (-2.0 * pull), speed / -pull);
            let mut label = format!("up to {} px in {} s", format_number(rise), format_number(time));
            if ends_by_contact(entity, leaf) {
                label = format!("{label}, {} s in the air", format_number(2.0 * time));
            }
            self.add(update.span, HintKind::Jump, label);
        }
    }
}

/// The default values of parameters; NaN where the value is not constant.
fn parameters(entity: &Entity) -> IdVec<ParamId, f64> {
    let mut params: IdVec<ParamId, f64> = IdVec::new();
    for param in entity.params.iter() {
        let context = ConstantContext { params: Some(&params), step: None };
        let value = evaluate(&param.default, context).unwrap_or(f64::NAN);
        params.push(value);
    }
    params
}

/// The leaf that is entered with a mode; `None` if it depends on a guard.
fn entered_leaf(entity: &Entity, mode: ModeId) -> Option<ModeId> {
    let mut at = mode;
    loop {
        let inside = &entity.modes[at].children;
        if inside.iter().any(|child| entity.modes[*child].initial_when.is_some()) {
            return None;
        }
        let Some(default) = entity.default_mode(inside) else { return Some(at) };
        at = default;
    }
}

/// Whether all edges of a mode and its outer modes require a contact.
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

/// Whether a guard implies a contact.
fn needs_contact(guard: &Term) -> bool {
    match &guard.kind {
        TermKind::Touching(_) => true,
        TermKind::And(sides) => sides.iter().any(needs_contact),
        TermKind::Or(sides) => sides.iter().all(needs_contact),
        _ => false,
    }
}

/// The acceleration of a variable in a mode, if the innermost flow of the variable gives one.
fn acceleration(entity: &Entity, mode: ModeId, var: VarId) -> Option<&Term> {
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

/// Formats a number with at most two decimals.
fn format_number(x: f64) -> String {
    let text = format!("{x:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_string()
}
