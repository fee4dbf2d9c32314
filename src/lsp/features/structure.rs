//! Document symbols, folding ranges and selection ranges: features that need only the syntax tree of one text.
//! Statements with syntax errors are skipped.

use std::ops::Range;

use crate::ordered::Ordered;
use crate::source::{FileId, Span};
use crate::syntax::ast::{Domain, Edge, Item, Kinds, MapSource, Member, SpaceItem, Tile, TileSpawn, Update, WorldItem};
use crate::syntax::occurrence::NameKind;
use crate::syntax::{self, ast};

use crate::lsp::text::document_text::{Encoding, Text};
use crate::lsp::text::lexer::{Kind, tokens};

/// Maximum number of characters of a guard in the outline.
const MAX_DETAIL: usize = 60;

/// The file id of the text, which is parsed alone.
const FILE: FileId = FileId(0);

/// The kind of an entry of the outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::lsp) enum SymbolKind {
    /// A declaration, or a `use` of a behaviour.
    Name(NameKind),
    /// An imported file, or a map.
    File,
    /// A collider, or a rectangle of a space.
    Shape,
    /// An edge to a mode, or a link to a space.
    Edge,
    /// A `spawn`.
    Spawn,
    /// A character or a name of a level.
    Tile,
    /// A `player`.
    Player,
    /// A `limit`.
    Limit,
    /// A `test`.
    Test,
}

/// An entry of the outline.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Symbol {
    pub name: String,
    pub detail: Option<String>,
    pub kind: SymbolKind,
    pub whole: Range<usize>,
    /// The range of the name, inside `whole`.
    pub name_at: Range<usize>,
    pub children: Vec<Symbol>,
}

/// The outline of a text.
pub(in crate::lsp) fn document_symbols(text: &Text) -> Vec<Symbol> {
    let code = text.code();
    let outline = Outline { code };
    text.tree().items.iter().map(|item| outline.item(item)).collect()
}

/// Selection ranges: for each offset, the nested ranges that contain it, outermost first.
pub(in crate::lsp) fn selection_ranges(text: &Text, bytes: &[usize]) -> Vec<Vec<Range<usize>>> {
    let mut spans: Vec<(usize, usize)> = Vec::new();
    for pair in syntax::pairs(FILE, text.code()).into_iter().flat_map(pest::iterators::Pairs::flatten) {
        let inside = pair.as_str().trim_end().len();
        spans.push((pair.as_span().start(), pair.as_span().start() + inside));
    }
    // If the text does not parse, there are at least tokens.
    spans.extend(tokens(text.code()).map(|t| (t.at.start, t.at.end)));
    spans.push((0, text.code().len()));
    let around = |byte: &usize| {
        let mut around: Vec<(usize, usize)> =
            spans.iter().copied().filter(|(start, end)| start <= byte && byte <= end).collect();
        around.order_by_key(|(start, end)| (std::cmp::Reverse(end - start), *start));
        around.dedup();
        let mut out: Vec<Range<usize>> = Vec::new();
        for (start, end) in around {
            // Skip a range that is not nested: two tokens can meet at the cursor.
            if out.last().is_none_or(|last| last.start <= start && end <= last.end) {
                out.push(start..end);
            }
        }
        out
    };
    bytes.iter().map(around).collect()
}

/// The kind of a fold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::lsp) enum FoldKind {
    /// A block in braces, or the rows of a map.
    Block,
    Comments,
    Imports,
}

/// A range of lines that can be folded.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(in crate::lsp) struct Fold {
    pub first_line: u32,
    pub last_line: u32,
    pub kind: FoldKind,
}

/// The folds of blocks, maps, and sequences of comments or imports that span several lines.
pub(in crate::lsp) fn folding_ranges(text: &Text) -> Vec<Fold> {
    let code = text.code();
    let line = |byte: usize| text.position(byte, Encoding::Utf8).line;
    let fold = |first_line: u32, last_line: u32, kind: FoldKind| Fold { first_line, last_line, kind };
    let (mut out, mut open): (Vec<Fold>, Vec<u32>) = (Vec::new(), Vec::new());
    // The first and the last line of the current sequence of comments, and of imports.
    let mut runs: [Option<(u32, u32)>; 2] = [None, None];
    let kinds = [FoldKind::Comments, FoldKind::Imports];
    let mut is_first = true;
    for token in tokens(code) {
        let at = line(token.at.start);
        let run = match (token.kind, token.text(code)) {
            (Kind::Comment, _) if is_first => Some(0),
            (Kind::Word, "import") if is_first => Some(1),
            _ => None,
        };
        if let Some(kind) = run {
            match &mut runs[kind] {
                Some((_, last)) if *last + 1 == at => *last = at,
                other => {
                    let ended = other.replace((at, at)).filter(|(first, last)| first < last);
                    out.extend(ended.map(|(first, last)| fold(first, last, kinds[kind])));
                }
            }
        }
        is_first = token.kind == Kind::Newline;
        match token.text(code) {
            "{" => open.push(at),
            "}" => {
                if let Some(start) = open.pop().filter(|start| *start + 1 < at) {
                    // The closing brace stays visible.
                    out.push(fold(start, at - 1, FoldKind::Block));
                }
            }
            _ if token.kind == Kind::Text => {
                let end = line(token.at.end);
                if end > at + 1 {
                    out.push(fold(at, end - 1, FoldKind::Block));
                }
            }
            _ => {}
        }
    }
    for (run, kind) in runs.into_iter().zip(kinds) {
        let ended = run.filter(|(first, last)| first < last);
        out.extend(ended.map(|(first, last)| fold(first, last, kind)));
    }
    out.order_by_key(|f| (f.first_line, f.last_line));
    out
}

/// Builds the outline of a text.
struct Outline<'a> {
    code: &'a str,
}

impl Outline<'_> {
    fn symbol(
        &self,
        name: &ast::Name,
        kind: SymbolKind,
        whole: Span,
        detail: Option<&str>,
        children: Vec<Symbol>,
    ) -> Symbol {
        // The protocol forbids empty names; a name can still be missing.
        let name_text = if name.text.is_empty() { "?" } else { &name.text };
        self.symbol_at(name_text, name.span, kind, whole, detail, children)
    }

    /// An entry whose name differs from the text at its range.
    fn symbol_at(
        &self,
        name: &str,
        at: Span,
        kind: SymbolKind,
        whole: Span,
        detail: Option<&str>,
        children: Vec<Symbol>,
    ) -> Symbol {
        let whole = if whole.contains(at) { whole } else { at };
        let detail = detail.map(str::to_string);
        Symbol { name: name.into(), detail, kind, whole: whole.range(), name_at: at.range(), children }
    }

    fn item(&self, item: &Item) -> Symbol {
        match item {
            Item::Import(i) => self.symbol(&i.path, SymbolKind::File, i.path.span, Some("import"), Vec::new()),
            Item::Constant(c) => self.symbol(
                &c.name,
                SymbolKind::Name(NameKind::Constant),
                c.name.span.to(c.value.span),
                Some("const"),
                Vec::new(),
            ),
            Item::Entity(e) => self.symbol(
                &e.name,
                SymbolKind::Name(NameKind::Entity),
                e.span,
                Some("entity"),
                self.members(&e.members),
            ),
            Item::Behavior(b) => {
                let leaf =
                    |p| self.symbol(p, SymbolKind::Name(NameKind::Argument), p.span, Some("parameter"), Vec::new());
                let inside = b.parameters.iter().map(leaf).chain(self.members(&b.members)).collect();
                self.symbol(&b.name, SymbolKind::Name(NameKind::Behavior), b.span, Some("behavior"), inside)
            }
            Item::World(w) => {
                let inside = w.items.iter().filter_map(|i| self.world_item(i)).collect();
                self.symbol(&w.name, SymbolKind::Name(NameKind::World), w.span, Some("world"), inside)
            }
        }
    }

    fn members(&self, members: &[Member]) -> Vec<Symbol> {
        let mut out = Vec::new();
        for member in members {
            let leaf = |name: &ast::Name, kind, to: Span, detail| {
                self.symbol(name, kind, name.span.to(to), Some(detail), Vec::new())
            };
            match member {
                Member::Parameter(p) => {
                    out.push(leaf(&p.name, SymbolKind::Name(NameKind::Parameter), p.value.span, "param"))
                }
                Member::Continuous(c) => {
                    let end = c.initial.as_ref().map_or(c.name.span, |e| e.span);
                    out.push(leaf(&c.name, SymbolKind::Name(NameKind::Variable), end, "continuous"));
                }
                Member::Discrete(d) => {
                    let value = |n| self.symbol(n, SymbolKind::Name(NameKind::Value), n.span, None, Vec::new());
                    let values =
                        if let Domain::Set(names) = &d.domain { names.iter().map(value).collect() } else { Vec::new() };
                    let whole = d.name.span.to(d.initial.span);
                    out.push(self.symbol(
                        &d.name,
                        SymbolKind::Name(NameKind::Discrete),
                        whole,
                        Some("discrete"),
                        values,
                    ));
                }
                Member::Reference(r) => {
                    out.push(leaf(&r.name, SymbolKind::Name(NameKind::Reference), r.entity.span, "ref"))
                }
                Member::Condition(c) => out.push(self.condition(c)),
                Member::Signals(list) => {
                    let kind = SymbolKind::Name(NameKind::Signal);
                    out.extend(list.0.iter().map(|s| self.symbol(&s.name, kind, s.span, Some("signal"), Vec::new())));
                }
                Member::Buttons(list) => {
                    out.extend(list.0.iter().map(|n| leaf(n, SymbolKind::Name(NameKind::Button), n.span, "button")));
                }
                Member::Axes(list) => {
                    out.extend(list.0.iter().map(|n| leaf(n, SymbolKind::Name(NameKind::Axis), n.span, "axis")));
                }
                Member::Chance(c) => {
                    out.push(leaf(&c.name, SymbolKind::Name(NameKind::Chance), c.high.span, "chance"));
                }
                Member::Collider(c) => {
                    if let Some(first) = c.tags.first() {
                        let name = comma_separated(&c.tags);
                        let detail = Some(if c.kinematic { "kinematic collider" } else { "collider" });
                        out.push(self.symbol_at(&name, first.span, SymbolKind::Shape, c.span, detail, Vec::new()));
                    }
                }
                Member::Group(g) => {
                    let inside = self.members(&g.members);
                    out.push(self.symbol(&g.name, SymbolKind::Name(NameKind::Group), g.span, Some("group"), inside));
                }
                Member::Mode(m) => {
                    let inside = self.members(&m.members);
                    out.push(self.symbol(&m.name, SymbolKind::Name(NameKind::Mode), m.span, Some("mode"), inside));
                }
                Member::Use(u) => {
                    out.push(self.symbol(
                        &u.behavior,
                        SymbolKind::Name(NameKind::Behavior),
                        u.span,
                        Some("use"),
                        Vec::new(),
                    ));
                }
                Member::Edge(edge) => {
                    let Edge { guard, target: Some(target), span, .. } = &**edge else { continue };
                    let guard = self.slice(guard.span);
                    let name = format!("-> {}", self.slice(target.span()));
                    out.push(self.symbol_at(&name, target.span(), SymbolKind::Edge, *span, Some(&guard), Vec::new()));
                }
                Member::Entry(update) => {
                    let Update::Spawn(s) = &**update else { continue };
                    out.push(self.symbol(&s.entity, SymbolKind::Spawn, s.span, Some("spawn"), Vec::new()));
                }
                _ => {}
            }
        }
        out
    }

    fn condition(&self, c: &ast::Condition) -> Symbol {
        let kind = SymbolKind::Name(NameKind::Condition);
        self.symbol(&c.name, kind, c.name.span.to(c.value.span), Some("condition"), Vec::new())
    }

    fn world_item(&self, item: &WorldItem) -> Option<Symbol> {
        Some(match item {
            WorldItem::Tiles(t) => {
                self.symbol(&t.name, SymbolKind::Name(NameKind::TileSet), t.span, Some("tiles"), self.tiles(&t.tiles))
            }
            WorldItem::Space(s) => {
                let inside = s.items.iter().filter_map(|i| self.space_item(i)).collect();
                self.symbol(&s.name, SymbolKind::Name(NameKind::Space), s.span, Some("space"), inside)
            }
            WorldItem::Condition(c) => self.condition(c),
            WorldItem::Goal(q) | WorldItem::Never(q) => {
                let is_goal = matches!(item, WorldItem::Goal(_));
                let (kind, detail) = if is_goal { (NameKind::Goal, "goal") } else { (NameKind::Never, "never") };
                let whole = q.name.span.to(q.predicate.span);
                self.symbol(&q.name, SymbolKind::Name(kind), whole, Some(detail), Vec::new())
            }
            WorldItem::Player(p) => self.symbol(&p.instance, SymbolKind::Player, p.span, Some("player"), Vec::new()),
            WorldItem::Limit(l) => {
                let detail = format!("limit {}", self.slice(l.count.span));
                self.symbol(&l.entity, SymbolKind::Limit, l.span, Some(&detail), Vec::new())
            }
            WorldItem::Test(t) => self.symbol(&t.name, SymbolKind::Test, t.span, Some("test"), Vec::new()),
            WorldItem::Step(_) | WorldItem::Collide(_) | WorldItem::Look(_) => return None,
        })
    }

    fn space_item(&self, item: &SpaceItem) -> Option<Symbol> {
        Some(match item {
            SpaceItem::Place(p) => {
                self.symbol(&p.name, SymbolKind::Name(NameKind::Instance), p.span, Some(&*p.entity.text), Vec::new())
            }
            SpaceItem::Link(l) => {
                let name = format!("-> {}", l.space.text);
                self.symbol_at(&name, l.space.span, SymbolKind::Edge, l.span, Some("link"), Vec::new())
            }
            SpaceItem::Solid(s) => {
                let first = s.tags.first()?.span;
                let whole = first.to(s.rectangle.span);
                self.symbol_at(&comma_separated(&s.tags), first, SymbolKind::Shape, whole, Some("rect"), Vec::new())
            }
            SpaceItem::Map(map) => {
                let none = Kinds::default();
                let (name, tiles, kinds) = match &map.source {
                    MapSource::Inline(name, _) | MapSource::Text(_, name) | MapSource::Open(name) => {
                        (Some(name), &[][..], &none)
                    }
                    MapSource::Vglc(path, legend) => (Some(path), legend.tiles.as_slice(), &none),
                    MapSource::OpenLegend(legend) => (Some(&legend.path), legend.tiles.as_slice(), &none),
                    MapSource::Tiled(path, kinds) | MapSource::Ldtk(path, _, kinds) => {
                        (Some(path), kinds.tiles.as_slice(), kinds)
                    }
                    MapSource::OpenAll(kinds) => (None, kinds.tiles.as_slice(), kinds),
                };
                let named = kinds.kinds.iter().map(|k| {
                    let detail = tile_detail(&k.tags, k.spawn.as_ref());
                    let inside = self.instance(k.spawn.as_ref());
                    let whole = k.spawn.as_ref().map_or(k.name.span, |spawn| k.name.span.to(spawn.whole));
                    self.symbol(&k.name, SymbolKind::Tile, whole, Some(&detail), inside)
                });
                let inside: Vec<Symbol> = self.tiles(tiles).into_iter().chain(named).collect();
                let (text, at) = name.map_or(("level", map.span), |name| (&*name.text, name.span));
                self.symbol_at(text, at, SymbolKind::File, map.span, Some("map"), inside)
            }
            SpaceItem::Bounds(_) | SpaceItem::Wrap(_) => return None,
        })
    }

    /// The entries of a tile set.
    fn tiles(&self, tiles: &[Tile]) -> Vec<Symbol> {
        let tile = |t: &Tile| {
            let detail = tile_detail(&t.tags, t.spawn.as_ref());
            let name = format!("'{}'", t.symbol);
            let inside = self.instance(t.spawn.as_ref());
            let last = t.tags.last().map(|tag| tag.span).or(t.spawn.as_ref().map(|s| s.whole));
            let whole = t.symbol_span.to(last.unwrap_or(t.symbol_span));
            self.symbol_at(&name, t.symbol_span, SymbolKind::Tile, whole, Some(&detail), inside)
        };
        tiles.iter().map(tile).collect()
    }

    /// The instance that a tile names.
    fn instance(&self, spawn: Option<&TileSpawn>) -> Vec<Symbol> {
        let named = spawn.and_then(|s| Some((s.name.as_ref()?, &*s.entity.text)));
        named
            .map(|(n, entity)| self.symbol(n, SymbolKind::Name(NameKind::Instance), n.span, Some(entity), Vec::new()))
            .into_iter()
            .collect()
    }

    /// The text of a span as one line, shortened.
    fn slice(&self, at: Span) -> String {
        let written = self.code.get(at.range()).unwrap_or_default();
        let words: Vec<&str> = written.split_whitespace().collect();
        let line = words.join(" ");
        match line.char_indices().nth(MAX_DETAIL) {
            Some((end, _)) => format!("{}…", line.get(..end).unwrap_or_default()),
            None => line,
        }
    }
}

/// Joins names by commas.
fn comma_separated(names: &[ast::Name]) -> String {
    names.iter().map(|n| &*n.text).collect::<Vec<_>>().join(", ")
}

/// The meaning of a character or a name of a level.
fn tile_detail(tags: &[ast::Name], spawn: Option<&TileSpawn>) -> String {
    spawn.map_or_else(
        || if tags.is_empty() { "empty".into() } else { comma_separated(tags) },
        |s| format!("spawn {}", s.entity.text),
    )
}
