//! Hovers: declaration, kind, dimension, documentation and value ranges of a name; descriptions of keywords and
//! findings.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::analysis::Values;
use crate::diagnostic::page::{Page, Part};
use crate::diagnostic::words::{KNOWN_NAMES, Meaning, SIGNATURES, Signature, meaning};
use crate::diagnostic::{Diagnostic, Diagnostics, Severity};
use crate::ir::EntityId;
use crate::sema::checked::{Checked, Condition, Entity, Type};
use crate::source::{FileId, Span};
use crate::syntax;
use crate::syntax::occurrence::{NameKind, Occurrence, Role};

use super::hover_more::{MapTile, hover_more};
use super::navigate::{ProgramPosition, last_known_positions, word_at};
use crate::lsp::location::{FileOffset, Location};
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::cursor::CursorContext;
use crate::lsp::text::words::statement_starts;
use crate::lsp::values::format_values;
use crate::lsp::view::View;

/// Maximum number of listed lines of worlds with a tag.
const MAX_TAGGED: usize = 5;
/// Maximum number of listed modes.
const MAX_MODES: usize = 12;

/// The hover at a position.
#[derive(Debug)]
pub(in crate::lsp) struct Hover {
    pub at: Location,
    pub markdown: String,
}

/// The hover of a name or keyword, and of the finding at a position; `of_tile` adds lines to that of a tile of a map.
pub(in crate::lsp) fn hover(view: &View, at: &FileOffset, of_tile: &dyn Fn(&MapTile) -> Vec<String>) -> Option<Hover> {
    let more = || hover_more(view, at, of_tile);
    let known = hover_name(view, at).or_else(more).or_else(|| hover_word(view, at));
    let parts: Vec<Hover> = known.into_iter().chain(hover_finding(view, at)).collect();
    let markdown = parts.iter().map(|part| part.markdown.as_str()).collect::<Vec<_>>().join("\n\n---\n\n");
    Some(Hover { markdown, ..parts.into_iter().next()? })
}

/// The hover of a name of the program.
fn hover_name(view: &View, at: &FileOffset) -> Option<Hover> {
    let positions = last_known_positions(view, at);
    let position = positions.iter().find(|position| !position.names.is_empty())?;
    let o = *position.names.first()?;
    let markdown = NameHover { position, snapshot: position.snapshot, o }.text();
    if std::ptr::eq(position.snapshot, &*position.state.current) {
        return Some(Hover { at: position.snapshot.location(o.at), markdown });
    }
    let text = Arc::clone(&view.documents.get(&at.path)?.text);
    let bytes = word_at(text.code(), at.byte)?;
    Some(Hover { at: Location { path: at.path.clone(), text, bytes }, markdown })
}

/// The hover of the finding at a position: the first paragraph of the page of its code. Errors take precedence.
fn hover_finding(view: &View, at: &FileOffset) -> Option<Hover> {
    let mut found: Option<(&Diagnostic, &Snapshot, Span)> = None;
    for state in view.programs_with(&at.path) {
        let snapshot = &*state.current;
        let Some(file) = snapshot.file(&at.path) else { continue };
        let byte = view.byte_in(snapshot, file, at.byte) as u32;
        let reported = snapshot.ide.compilation.diagnostics.iter();
        for finding in reported.chain(state.findings.iter().flat_map(Diagnostics::iter)) {
            let Some(span) = finding.primary.as_ref().map(|label| label.span) else { continue };
            let is_here = span.file() == file && span.start() <= byte && byte <= span.end();
            let is_first = found
                .is_none_or(|(other, ..)| other.severity == Severity::Warning && finding.severity == Severity::Error);
            if is_here && is_first {
                found = Some((finding, snapshot, span));
            }
        }
    }
    let (finding, snapshot, span) = found?;
    let page = Page::of(finding.code);
    let prose = page.parts.iter().find_map(|part| match part {
        Part::Prose(lines) => Some(lines.join(" ")),
        Part::Example(_) => None,
    });
    let code = finding.code.text();
    let prose = prose.unwrap_or_default();
    let markdown = format!("**{}**\n\n{prose} See `hypedc explain {code}`.", page.title);
    Some(Hover { at: snapshot.location(span), markdown })
}

/// The hover of a keyword or a function.
fn hover_word(view: &View, at: &FileOffset) -> Option<Hover> {
    let text = Arc::clone(&view.documents.get(&at.path)?.text);
    let code = text.code();
    let bytes = word_at(code, at.byte)?;
    let word = code.get(bytes.clone())?;
    let is_called = code.get(bytes.end..)?.trim_start_matches([' ', '\t']).starts_with('(');
    let ways = SIGNATURES.iter().filter(|s| is_called && s.name == word);
    let ways: Vec<String> = ways.map(Signature::line).collect();
    let shape = || matches!(word, "rect") && is_keyword_at(code, &bytes);
    let markdown = if ways.is_empty() || shape() {
        let keyword = meaning(word).filter(|_| is_keyword_at(code, &bytes));
        let Meaning { description, example, .. } = keyword.or_else(|| known_name_at(code, &bytes))?;
        format!("`{word}`: {description}\n\n```hyped\n{example}\n```")
    } else {
        ways.join("\n\n")
    };
    Some(Hover { at: Location { path: at.path.clone(), text, bytes }, markdown })
}

/// The name at a range, if every program has it.
fn known_name_at(code: &str, bytes: &std::ops::Range<usize>) -> Option<&'static Meaning> {
    let word = code.get(bytes.clone())?;
    let known = KNOWN_NAMES.iter().find(|known| known.word == word)?;
    // Only its coordinates are known.
    let fits = word != "start" || code.get(bytes.end..)?.starts_with('.');
    let is_name = |pair: pest::iterators::Pair<'_, syntax::Rule>| {
        pair.as_rule() == syntax::Rule::name && pair.as_span().start() == bytes.start && pair.as_str() == word
    };
    (fits && syntax::pairs(FileId(0), code)?.flatten().any(is_name)).then_some(known)
}

/// Whether the word at a range is a keyword there, and no name.
fn is_keyword_at(code: &str, bytes: &std::ops::Range<usize>) -> bool {
    let word = code.get(bytes.clone()).unwrap_or_default();
    if syntax::is_reserved(word) {
        return true;
    }
    if let Some(pairs) = syntax::pairs(FileId(0), code) {
        // Text inside a recovered syntax error is not classified.
        let mut here = pairs.flatten().filter(|p| p.as_span().start() <= bytes.start && bytes.end <= p.as_span().end());
        if !here.clone().any(|p| format!("{:?}", p.as_rule()).starts_with("bad_")) {
            return here.any(|p| p.as_str() == word && format!("{:?}", p.as_rule()).starts_with("word_"));
        }
    }
    let cursor = CursorContext::at(code, bytes.start);
    let goes_on = code.get(bytes.end..).unwrap_or_default().trim_start_matches([' ', '\t']);
    cursor.statement.is_empty()
        && statement_starts(cursor.block()).0.contains(&word)
        && !goes_on.starts_with(['=', ':', '\'', '.'])
}

/// The description of a kind of names.
pub(super) fn kind_label(kind: NameKind) -> &'static str {
    match kind {
        NameKind::Constant => "constant",
        NameKind::Entity => "entity",
        NameKind::Behavior => "behavior",
        NameKind::Argument => "parameter of a behavior",
        NameKind::World => "world",
        NameKind::Group => "group",
        NameKind::Mode => "mode",
        NameKind::Parameter => "parameter",
        NameKind::Variable => "continuous variable",
        NameKind::Discrete => "discrete variable",
        NameKind::Condition => "condition",
        NameKind::Signal => "signal",
        NameKind::SignalNumber => "number of a signal",
        NameKind::Value => "value of a discrete variable",
        NameKind::Reference => "reference",
        NameKind::Touched => "what is touched, or nearest",
        NameKind::Button => "button",
        NameKind::Axis => "axis",
        NameKind::Chance => "chance",
        NameKind::Tag => "tag",
        NameKind::Space => "space",
        NameKind::TileSet => "tile set",
        NameKind::Instance => "instance",
        NameKind::Goal => "goal",
        NameKind::Never => "never",
    }
}

/// The entities of which a name is a member; several if it is declared in a behaviour.
pub(super) fn owners<'c>(
    checked: &'c Checked,
    snapshot: &Snapshot,
    o: &Occurrence,
    name: &str,
) -> Vec<(EntityId, &'c Entity)> {
    let is_it = |span: Span| snapshot.ide.compilation.sources.trace(span).0 == o.declared;
    let owns = |e: &Entity| match o.kind {
        NameKind::Parameter => e.params.iter().any(|p| is_it(p.name.span)),
        NameKind::Variable => e.vars.iter().any(|v| v.name.text == name && is_it(v.name.span)),
        NameKind::Discrete => e.discretes.iter().any(|d| is_it(d.name.span)),
        NameKind::Condition => e.conditions.iter().any(|c| is_it(c.name.span)),
        NameKind::Signal => e.signals.iter().any(|s| is_it(s.name.span)),
        NameKind::SignalNumber => e.signals.iter().filter_map(|s| s.number.as_ref()).any(|n| is_it(n.name.span)),
        NameKind::Reference => e.refs.iter().any(|r| is_it(r.name.span)),
        NameKind::Button => e.buttons.iter().any(|b| is_it(b.span)),
        NameKind::Axis => e.axes.iter().any(|a| is_it(a.span)),
        NameKind::Chance => e.chances.iter().any(|c| is_it(c.name.span)),
        NameKind::Mode => e.modes.iter().any(|m| is_it(m.name.span)),
        NameKind::Group => e.groups.iter().filter_map(|g| g.name.as_ref()).any(|n| is_it(n.span)),
        _ => false,
    };
    checked.entities.pairs().filter(|(_, e)| owns(e)).map(|(id, e)| (id, &**e)).collect()
}

/// Builds the hover of a name.
struct NameHover<'a> {
    position: &'a ProgramPosition<'a>,
    snapshot: &'a Snapshot,
    o: Occurrence,
}

impl NameHover<'_> {
    fn text(&self) -> String {
        let name = self.snapshot.name(&self.o);
        let checked = &self.snapshot.ide.checked;
        let owners = owners(checked, self.snapshot, &self.o, name);
        let mut parts = Vec::new();
        let is_own = self.snapshot.ide.compilation.sources.slice(self.o.declared) == name;
        if is_own && self.o.kind != NameKind::Tag {
            let declaration = self.condition().unwrap_or_else(|| self.snapshot.line(self.o.declared));
            parts.push(format!("```hyped\n{declaration}\n```"));
        }
        let mut what = kind_label(self.o.kind).to_string();
        let names: Vec<String> = owners.iter().take(3).map(|(_, e)| format!("`{}`", e.name.text)).collect();
        if !names.is_empty() {
            what = format!("{what} of {}", names.join(", "));
        }
        if let Some(entity) = Some(name).filter(|_| self.o.kind == NameKind::Instance).and_then(|n| self.instance(n)) {
            what = format!("{what} of `{entity}`");
        }
        let dimension = owners.first().and_then(|(id, e)| self.dimension(checked, *id, e, name));
        if let Some(dimension) = dimension.or_else(|| self.last_dimension(owners.first()?.1, name)) {
            what = format!("{what}, {dimension}");
        }
        parts.push(if is_own && self.o.kind != NameKind::Tag { what } else { format!("`{name}`: {what}") });
        if is_own && self.o.kind != NameKind::Argument {
            parts.extend(self.snapshot.doc(self.o.declared));
        }
        match self.o.kind {
            NameKind::Mode => parts.extend(owners.first().map(|(_, e)| self.transitions(e))),
            NameKind::Tag => parts.push(self.tagged(name)),
            NameKind::Variable | NameKind::Discrete => {
                parts.extend(owners.iter().take(3).filter_map(|(_, e)| self.ranges(e, name)));
            }
            _ => {}
        }
        parts.retain(|part| !part.is_empty());
        parts.join("\n\n")
    }

    /// The declaration of a condition, which may take several lines.
    fn condition(&self) -> Option<String> {
        let (checked, sources) = (&self.snapshot.ide.checked, &self.snapshot.ide.compilation.sources);
        let all = checked.entities.iter().flat_map(|e| &e.conditions);
        let mut all = all.chain(checked.worlds.iter().flat_map(|w| &w.conditions));
        let is_it = |c: &&Condition| sources.trace(c.name.span).0 == self.o.declared;
        let value = all.find(is_it).filter(|_| self.o.kind == NameKind::Condition)?.value.span;
        let lines = sources.slice(self.o.declared.to(sources.trace(value).0)).lines();
        Some(format!("condition {}", lines.map(str::trim).collect::<Vec<_>>().join("\n    ")))
    }

    /// Number of primes after the name, at most 2.
    fn degree(&self) -> usize {
        let text = self.snapshot.text(self.o.at.file());
        let after = text.code().get(self.o.at.range().end..).unwrap_or_default();
        after.bytes().take_while(|b| *b == b'\'').count().min(2)
    }

    /// The dimension in the last snapshot without errors: it may depend on code that does not compile now.
    fn last_dimension(&self, entity: &Entity, name: &str) -> Option<String> {
        let good = self.position.state.last_good.as_deref().filter(|_| !self.position.state.current.is_error_free())?;
        let mut entities = good.ide.checked.entities.pairs();
        let (id, entity) = entities.find(|(_, e)| e.name.text == entity.name.text)?;
        self.dimension(&good.ide.checked, id, entity, name)
    }

    fn dimension(&self, checked: &Checked, id: EntityId, entity: &Entity, name: &str) -> Option<String> {
        let known = &checked.dimensions;
        match self.o.kind {
            NameKind::Parameter => {
                let param = entity.params.find(|p| p.name.text == name)?;
                known.params.get(&(id, param)).cloned()
            }
            NameKind::Variable => {
                let var = entity.vars.find(|v| v.name.text == name)?;
                let base = if name == "x" || name == "y" { "px" } else { known.vars.get(&(id, var))? };
                Some(per_second(base, self.degree()))
            }
            NameKind::Discrete => {
                let discrete = &entity.discretes[entity.discretes.find(|d| d.name.text == name)?];
                Some(match &discrete.ty {
                    Type::Bool => "true or false".into(),
                    Type::Set(_) => discrete.values.join(", "),
                    _ => format!("{}..{}", discrete.range.0, discrete.range.1),
                })
            }
            NameKind::Axis => Some("-1 to 1".into()),
            NameKind::Chance => {
                let (low, high) = entity.chances.iter().find(|c| c.name.text == name)?.range;
                Some(format!("{low}..{high}, drawn anew in each step"))
            }
            _ => None,
        }
    }

    /// The values of a variable in each mode.
    fn ranges(&self, entity: &Entity, name: &str) -> Option<String> {
        let known = self.position.state.ranges.as_ref()?.get(&entity.name.text, name);
        let degree = if self.o.kind == NameKind::Variable { self.degree() } else { 0 };
        let discrete = entity.discretes.iter().find(|d| d.name.text == name);
        let (ty, declared) = (discrete.map(|d| d.ty), discrete.map(|d| d.range));
        let shown = |values: &Values| match ty {
            Some(Type::Set(_)) => {
                let may = discrete
                    .iter()
                    .flat_map(|d| d.values.iter())
                    .enumerate()
                    .filter(|(at, _)| values.contains(*at as f64));
                may.map(|(_, name)| name.clone()).collect::<Vec<_>>().join(" or ")
            }
            Some(Type::Bool) => {
                let may = [(0.0, "false"), (1.0, "true")].into_iter().filter(|(at, _)| values.contains(*at));
                may.map(|(_, name)| name).collect::<Vec<_>>().join(" or ")
            }
            _ => format_values(values),
        };
        let rows: Vec<(&str, String)> =
            known.iter().filter_map(|m| Some((m.mode.as_str(), shown(m.values.get(degree)?)))).collect();
        let first = rows.first()?;
        let written = format!("{name}{}", "'".repeat(degree));
        if rows.iter().all(|(_, values)| *values == first.1) {
            let is_uninformative = first.1 == "any"
                || matches!(ty, Some(Type::Set(_) | Type::Bool)) && first.1.contains(" or ")
                || declared.is_some_and(|(low, high)| first.1 == format!("{low}..{high}"));
            return Some(format!("`{written}` is {}", first.1)).filter(|_| !is_uninformative);
        }
        let lines = rows.iter().take(MAX_MODES).map(|(mode, values)| format!("| `{mode}` | {values} |"));
        let more = rows.len().saturating_sub(MAX_MODES);
        let more = if more > 0 { format!("\n\n… and {more} more modes") } else { String::new() };
        Some(format!("| in | `{written}` is |\n|---|---|\n{}{more}", lines.collect::<Vec<_>>().join("\n")))
    }

    /// The modes with edges to and from a mode.
    fn transitions(&self, entity: &Entity) -> String {
        let sources = &self.snapshot.ide.compilation.sources;
        let is_it = |span: Span| sources.trace(span).0 == self.o.declared;
        let Some(mode) = entity.modes.find(|m| is_it(m.name.span)) else { return String::new() };
        let list = |modes: Vec<String>| {
            let mut once: Vec<String> = Vec::new();
            for mode in modes {
                if !once.contains(&mode) {
                    once.push(mode);
                }
            }
            once.join(", ")
        };
        let path = |id| format!("`{}`", entity.modes[id].path.join("."));
        let into = entity.edges.iter().filter(|e| e.target == Some(mode)).map(|e| path(e.source)).collect();
        let out = entity.edges.iter().filter(|e| e.source == mode).filter_map(|e| e.target).map(path).collect();
        let line = |word: &str, modes: String| (!modes.is_empty()).then(|| format!("{word} {modes}"));
        let lines = [line("from", list(into)), line("to", list(out))];
        lines.into_iter().flatten().collect::<Vec<_>>().join("  \n")
    }

    /// The colliders and world geometry with a tag.
    fn tagged(&self, name: &str) -> String {
        let checked = &self.snapshot.ide.checked;
        let Some(tag) = checked.tags.find(|t| t.text == name) else { return String::new() };
        let entities = checked.entities.iter().filter(|e| e.colliders.iter().any(|c| c.tags.contains(&tag)));
        let entities: Vec<String> = entities.map(|e| format!("`{}`", e.name.text)).collect();
        let colliders = (!entities.is_empty()).then(|| format!("colliders of {}", entities.join(", ")));
        // Tiles and rectangles with a tag are declared in worlds.
        let in_worlds = |at: Span| checked.worlds.iter().any(|w| w.span.contains(at));
        let all = self.snapshot.occurrences_of(&BTreeSet::from([self.snapshot.key(&self.o)]));
        let here = all.filter(|o| o.role == Role::Declared && in_worlds(o.at)).take(MAX_TAGGED);
        let lines = here.map(|o| format!("`{}`", self.snapshot.line(o.at)));
        colliders.into_iter().chain(lines).collect::<Vec<_>>().join("  \n")
    }

    fn instance(&self, name: &str) -> Option<String> {
        let checked = &self.snapshot.ide.checked;
        let instance = checked.worlds.iter().flat_map(|w| w.instances.iter()).find(|i| i.name.text == name)?;
        Some(checked.entities.get(instance.entity)?.name.text.to_string())
    }
}

/// The dimension of a derivative.
pub(super) fn per_second(base: &str, degree: usize) -> String {
    match (base, degree) {
        (base, 0) => base.into(),
        ("1", 1) => "1/s".into(),
        ("1", _) => "1/s^2".into(),
        (base, _) if base.contains('/') => format!("({base})/s{}", if degree == 2 { "^2" } else { "" }),
        (base, 1) => format!("{base}/s"),
        (base, _) => format!("{base}/s^2"),
    }
}
