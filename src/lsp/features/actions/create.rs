//! Declarations of names that are missing, and imports of files that have them.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Component, Path};

use crate::diagnostic::suggestion::BlockKind;
use crate::diagnostic::{Code, Diagnostic, similar};
use crate::lsp::snapshot::Snapshot;
use crate::lsp::text::lexer::words;
use crate::lsp::view::View;
use crate::ordered::Ordered;
use crate::syntax::Rule;
use crate::syntax::occurrence::{NameKind, Role};

use super::blocks::Blocks;
use super::draft::Draft;

/// A draft with its title.
pub(super) type Titled = (String, Draft);

/// Maximum number of actions of one kind.
const MAX_SIMILAR: usize = 3;

/// The path by which one program imports another.
pub(in crate::lsp) fn relative(from: &Path, to: &Path) -> Option<String> {
    if from == to {
        return None;
    }
    let folder: Vec<Component<'_>> = from.parent()?.components().collect();
    let target: Vec<Component<'_>> = to.components().collect();
    let same = folder.iter().zip(&target).take_while(|(a, b)| a == b).count();
    let up = folder.iter().skip(same).map(|_| "..");
    let down = target.iter().skip(same).filter_map(|part| part.as_os_str().to_str());
    Some(up.chain(down).collect::<Vec<_>>().join("/"))
}

/// The insertion of an import into a text: after the last one, or at the beginning.
pub(in crate::lsp) fn import(code: &str, path: &str) -> (Range<usize>, String) {
    let statement = format!("import \"{path}\"");
    let mut at = None;
    let mut start = 0;
    for line in code.split_inclusive('\n') {
        if line.trim_start().starts_with("import ") {
            at = Some(start + line.trim_end().len());
        }
        start += line.len();
    }
    match at {
        Some(at) => (at..at, format!("\n{statement}")),
        // Comments at the beginning are about the file.
        None => {
            let comments = code.split_inclusive('\n').take_while(|line| line.trim_start().starts_with("//"));
            let is_doc = |line: &&str| line.trim_start().starts_with("///");
            let head: usize = comments.take_while(|line| !is_doc(line)).map(str::len).sum();
            let gap = if head > 0 { "\n" } else { "" };
            let below = if code.get(head..).is_some_and(|rest| rest.starts_with(['\n', '\r'])) { "\n" } else { "\n\n" };
            (head..head, format!("{gap}{statement}{below}"))
        }
    }
}

/// A declaration of a file of the workspace: its kind, its name, and the path by which a file imports it.
pub(in crate::lsp) fn importable(
    view: &View,
    snapshot: &Snapshot,
    path: &Path,
) -> BTreeSet<(NameKind, String, String)> {
    let mut out = BTreeSet::new();
    for (root, state) in view.programs.iter().filter(|(root, _)| snapshot.file(root).is_none()) {
        let other = &*state.current;
        let (Some(file), Some(relative)) = (other.file(root), relative(path, root)) else { continue };
        let declared = other.ide.occurrences.iter().filter(|o| {
            let is_item = matches!(o.kind, NameKind::Entity | NameKind::Behavior | NameKind::Constant);
            is_item && o.role == Role::Declared && o.at.file() == file
        });
        out.extend(declared.map(|o| (o.kind, other.name(o).to_string(), relative.clone())));
    }
    out
}

/// The actions that declare or import what a finding misses.
pub(super) fn created(view: &View, snapshot: &Snapshot, finding: &Diagnostic) -> Vec<Titled> {
    let Some(label) = &finding.primary else { return Vec::new() };
    let (file, at) = (label.span.file(), label.span.range());
    let path = snapshot.path(file).to_path_buf();
    let text = snapshot.text(file);
    let Some(blocks) = Blocks::of(text.code()) else { return Vec::new() };
    let creation = Creation { view, snapshot, path: &path, blocks: &blocks, at };
    match (finding.code, &finding.missing) {
        (Code::UnknownName, Some((kind, name))) => creation.named(kind, name),
        (Code::UncarriedTag, _) => creation.tag(),
        (Code::Unreadable, _) => creation.file(),
        (Code::Syntax, _) => creation.int_range().into_iter().collect(),
        _ => Vec::new(),
    }
}

/// The place where something is missing.
struct Creation<'a> {
    view: &'a View,
    snapshot: &'a Snapshot,
    path: &'a Path,
    blocks: &'a Blocks<'a>,
    at: Range<usize>,
}

impl Creation<'_> {
    fn written(&self) -> &str {
        self.blocks.code.get(self.at.clone()).unwrap_or_default()
    }

    fn add(&self, to: BlockKind, statement: String) -> Option<Titled> {
        let (at, new) = self.blocks.insertion(to, &self.at, &statement)?;
        Some(self.titled(format!("declare `{}`", head(&statement)), at, new))
    }

    fn titled(&self, title: String, at: Range<usize>, new: String) -> Titled {
        let mut draft = Draft::default();
        draft.edit(self.path, at, new);
        (title, draft)
    }

    /// Before the item around.
    fn item(&self, statement: String) -> Option<Titled> {
        let item = self.blocks.innermost(&self.at, &[Rule::entity, Rule::behavior, Rule::world, Rule::constant])?;
        let lines = self.blocks.lines(&item.bytes)?;
        let title = format!("declare `{}`", head(&statement));
        Some(self.titled(title, lines.start..lines.start, format!("{statement}\n\n")))
    }

    fn constant(&self, name: &str) -> Option<Titled> {
        let statement = format!("const {name} = 1");
        let title = format!("declare `{statement}`");
        let constants = self.blocks.inside(&(0..self.at.start)).filter(|node| node.rule == Rule::constant);
        if let Some(last) = constants.last() {
            let end = last.bytes.end;
            return Some(self.titled(title, end..end, format!("\n{statement}")));
        }
        self.item(statement)
    }

    /// Beside the mode around, in the group of an edge.
    fn mode(&self, name: &str) -> Option<Titled> {
        let own = self.blocks.innermost(&self.at, &[Rule::mode, Rule::always])?;
        let indent = self.blocks.indent(own.bytes.start);
        let end = own.bytes.end;
        let rest = self.blocks.code.get(end..)?;
        let line = end + rest.find(['\n', '}']).unwrap_or(rest.len());
        let new = format!("\n{indent}mode {name} {{ }}");
        Some(self.titled(format!("declare `mode {name}`"), line..line, new))
    }

    fn named(&self, kind: &str, name: &str) -> Vec<Titled> {
        let mut out: Vec<Option<Titled>> = Vec::new();
        let has = |part: &str| kind.split([' ', ',']).any(|word| word == part);
        let in_entity = self.blocks.innermost(&self.at, &[Rule::entity, Rule::behavior]).is_some();
        out.extend(self.imports(kind, name).into_iter().map(Some));
        match kind {
            "mode" => out.push(self.mode(name.split('.').next_back().unwrap_or(name))),
            "button" => out.push(self.add(BlockKind::Entity, format!("button {name}"))),
            "axis" => {
                out.push(self.add(BlockKind::Entity, format!("axis {name}")));
                out.push(self.add(BlockKind::Entity, format!("button {name}")));
            }
            "signal" => out.push(self.add(BlockKind::Entity, format!("signal {name}"))),
            "behavior" => out.push(self.item(format!("behavior {name} {{ }}"))),
            "tile set" => {
                let world = format!("tiles {name} 16 x 16 {{\n    '.': empty\n    '#': wall\n}}");
                out.push(self.add(BlockKind::World, world));
            }
            "space" => out.push(self.add(BlockKind::World, format!("space {name} {{ }}"))),
            _ if has("entity") => out.push(self.item(format!("entity {name} {{ }}"))),
            _ if has("instance") => out.extend(self.instances(name)),
            _ if in_entity && (has("variable") || has("parameter") || has("constant")) => {
                let bare = name.trim_end_matches('\'');
                if !kind.starts_with("continuous") {
                    out.push(self.add(BlockKind::Entity, format!("param {bare} = 1")));
                }
                out.push(self.add(BlockKind::Entity, format!("continuous {bare} = 0")));
                out.push(self.add(BlockKind::Entity, format!("discrete {bare}: int 0..9 = 0")));
                out.push(self.add(BlockKind::Entity, format!("discrete {bare}: bool = false")));
                if !kind.starts_with("continuous") {
                    out.push(self.constant(bare));
                    out.push(self.add(BlockKind::Entity, format!("axis {bare}")));
                }
            }
            _ if has("constant") => out.push(self.constant(name)),
            _ => {}
        }
        out.into_iter().flatten().collect()
    }

    /// An instance of an entity in the first space of the world: of the entity with a similar name, or of the first ones.
    fn instances(&self, name: &str) -> Vec<Option<Titled>> {
        let Some(world) = self.blocks.innermost(&self.at, &[Rule::world]) else { return Vec::new() };
        let Some(space) = self.blocks.inside(&world.bytes).find(|node| node.rule == Rule::space) else {
            return Vec::new();
        };
        let entities = &self.snapshot.ide.checked.entities;
        let mut names: Vec<&str> = entities.iter().map(|e| &*e.name.text).collect();
        names.order_by_key(|entity| !entity.eq_ignore_ascii_case(name));
        if names.first().is_some_and(|first| first.eq_ignore_ascii_case(name)) {
            names.truncate(1);
        }
        let place = |entity: &str| {
            let statement = format!("place {name}: {entity} at (0, 0)");
            let (at, new) = self.blocks.insertion_in(space, &statement)?;
            Some(self.titled(format!("add `{statement}`"), at, new))
        };
        names.into_iter().take(MAX_SIMILAR).map(place).collect()
    }

    /// Something with a tag in the first space, and the line that lets it block the entity that asks for it.
    fn tag(&self) -> Vec<Titled> {
        let tag = self.written();
        let checked = &self.snapshot.ide.checked;
        let own = self.blocks.innermost(&self.at, &[Rule::entity]);
        let name = own.and_then(|own| self.blocks.inside(&own.bytes).find(|node| node.rule == Rule::name));
        let name = name.and_then(|name| self.blocks.code.get(name.bytes.clone()));
        let entity = name.and_then(|name| checked.entities.iter().find(|e| &*e.name.text == name));
        let mut own = entity.into_iter().flat_map(|e| e.colliders.iter().flat_map(|c| c.tags.iter()));
        let own = own.next().and_then(|tag| checked.tags.get(*tag)).map(|tag| tag.text.to_string());
        let world = self.blocks.inside(&(0..self.blocks.code.len())).find(|node| node.rule == Rule::world);
        let (Some(own), Some(world)) = (own, world) else { return Vec::new() };
        let Some(space) = self.blocks.inside(&world.bytes).find(|node| node.rule == Rule::space) else {
            return Vec::new();
        };
        let mut draft = Draft::default();
        let rect = format!("rect {tag} (0, -16, 320, 16)");
        let Some((at, new)) = self.blocks.insertion_in(space, &rect) else { return Vec::new() };
        draft.edit(self.path, at, new);
        let asked = self.blocks.code.get(world.bytes.clone()).unwrap_or_default();
        let collides = asked.lines().map(str::trim).filter(|line| line.starts_with("collide "));
        let is_word = |line: &str, word: &str| words(line).any(|w| w == word);
        let mut title = format!("add `{rect}`");
        if !collides.into_iter().any(|line| is_word(line, tag) && is_word(line, &own)) {
            let line = format!("collide {own} with {tag}: block");
            let Some((at, new)) = self.blocks.insertion_in(world, &line) else { return Vec::new() };
            draft.edit(self.path, at, new);
            title = format!("{title} and `{line}`");
        }
        vec![(title, draft)]
    }

    /// Imports of files that declare a name.
    fn imports(&self, kind: &str, name: &str) -> Vec<Titled> {
        let fits = |known: NameKind| match known {
            NameKind::Entity => kind.contains("entity"),
            NameKind::Behavior => kind == "behavior",
            NameKind::Constant => kind.contains("constant"),
            _ => false,
        };
        let known = importable(self.view, self.snapshot, self.path);
        let named = known.iter().filter(|(known, of, _)| of == name && fits(*known)).take(MAX_SIMILAR);
        let action = |(_, _, path): &(NameKind, String, String)| {
            let (at, new) = import(self.blocks.code, path);
            self.titled(format!("import `{path}`"), at, new)
        };
        named.map(action).collect()
    }

    /// A range for `int` without one.
    fn int_range(&self) -> Option<Titled> {
        let before = self.blocks.code.get(..self.at.start)?.trim_end();
        let rest = before.strip_suffix("int").filter(|rest| rest.trim_end().ends_with(':'))?;
        let at = rest.len()..before.len();
        Some(self.titled("write `int 0..9`".into(), at, "int 0..9".into()))
    }

    /// Another file in place of one that an import does not find.
    fn file(&self) -> Vec<Titled> {
        let Some(import) = self.blocks.innermost(&self.at, &[Rule::import]) else { return Vec::new() };
        let written = self.written().trim_matches('"');
        let others: Vec<String> = self.view.programs.keys().filter_map(|other| relative(self.path, other)).collect();
        let name = |path: &str| path.rsplit('/').next().unwrap_or(path).to_string();
        let near = others
            .iter()
            .filter(|other| similar(&name(written), [name(other).as_str()]).is_some() || name(other) == name(written));
        let mut out: Vec<Titled> = near
            .take(MAX_SIMILAR)
            .map(|other| self.titled(format!("import `{other}`"), self.at.clone(), format!("\"{other}\"")))
            .collect();
        if let Some(lines) = self.blocks.lines(&import.bytes) {
            out.push(self.titled("remove the import".into(), lines, String::new()));
        }
        out
    }
}

/// The first line of a statement, without the brace at its end.
fn head(statement: &str) -> &str {
    let line = statement.lines().next().unwrap_or_default();
    line.split(" {").next().unwrap_or(line)
}
