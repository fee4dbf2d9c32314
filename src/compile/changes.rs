//! What a compilation adds to a program or changes in it before it is checked: questions, and numbers that are set.

use std::path::Path;

use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::{Diagnostics, similar};
use crate::ir::{NeverId, Program, WorldId};
use crate::source::{Files, SourceMap, Span, on_one_line};
use crate::syntax::ast::{self, Name, Question};
use crate::syntax::occurrence::Occurrences;
use crate::syntax::{self, Number, Unshared};

/// Maximum number of names that a finding lists.
const MAX_LISTED: usize = 20;

/// A predicate that may never hold, in addition to those of the program.
#[derive(Debug, Clone, Copy)]
pub struct ExtraConstraint<'a> {
    /// The world; none: all of the file.
    pub world: Option<&'a str>,
    /// Its name.
    pub name: &'a str,
    /// Its text.
    pub predicate: &'a str,
    /// The name of its source in findings.
    pub origin: &'a str,
}

/// What a question asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Asked {
    /// A `goal`.
    Goal,
    /// A `never`.
    Never,
    /// A `goal` or a `never` of this name; another text is a `goal`.
    Either,
}

/// A question as a text: the name of a `goal` or a `never` of the world, or else a predicate, which is added to the
/// world under its [name](question_name).
#[derive(Debug, Clone, Copy)]
pub struct ExtraQuestion<'a> {
    /// What it asks for.
    pub asked: Asked,
    /// The world; none: all of the file.
    pub world: Option<&'a str>,
    /// The text.
    pub text: &'a str,
    /// The name of its source in findings.
    pub origin: &'a str,
}

/// A number that is set: the value of a `const`, or the default of a `param`.
#[derive(Debug, Clone, Copy)]
pub struct NumberSetting<'a> {
    /// `Hero.speed` of a parameter, `gravity` of a constant.
    pub path: &'a str,
    /// An expression. A plain number has the unit that is written in the program.
    pub value: &'a str,
}

/// What a compilation adds to a program or changes in it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Changes<'a> {
    /// Questions, in addition to those of the program and after them.
    pub questions: &'a [ExtraQuestion<'a>],
    /// One more `never`, the last one of its world.
    pub constraint: Option<ExtraConstraint<'a>>,
    /// Numbers that are set.
    pub numbers: &'a [NumberSetting<'a>],
}

/// The name under which a question is asked: a name as it is, a predicate on one line.
pub fn question_name(text: &str) -> String {
    on_one_line(text)
}

/// Whether a question must be a name, as it cannot be a predicate unless it is that of a condition.
pub fn is_name(text: &str) -> bool {
    syntax::is_name(text)
}

/// Adds the questions to the worlds of the root file.
pub(super) fn add_questions(
    changes: &Changes<'_>,
    trees: &mut [ast::File],
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
) {
    let Some(root) = trees.first_mut() else { return };
    for question in changes.questions {
        if root.worlds(question.world).any(|world| is_unknown(world, question)) {
            let (predicate, origin) = (question.text, question.origin);
            let name = question_name(predicate);
            let Some(added) = read(&name, predicate, origin, sources, diagnostics) else { continue };
            for world in root.worlds_mut(question.world).filter(|world| is_unknown(world, question)) {
                let added = added.clone().into();
                world.items.push(match question.asked {
                    Asked::Goal | Asked::Either => ast::WorldItem::Goal(added),
                    Asked::Never => ast::WorldItem::Never(added),
                });
            }
        }
    }
    if let Some(ExtraConstraint { world, name, predicate, origin }) = changes.constraint
        && let Some(never) = read(name, predicate, origin, sources, diagnostics)
    {
        root.worlds_mut(world).for_each(|world| world.items.push(ast::WorldItem::Never(never.clone().into())));
    }
}

/// Whether a world has no such question: its text is a predicate to add. A name that the world does not know is none,
/// unless it names a condition.
fn is_unknown(world: &ast::World, question: &ExtraQuestion<'_>) -> bool {
    let name = question_name(question.text);
    let is_named = |item: &ast::WorldItem| match (item, question.asked) {
        (ast::WorldItem::Goal(known), Asked::Goal | Asked::Either)
        | (ast::WorldItem::Never(known), Asked::Never | Asked::Either) => *known.name.text == *name,
        _ => false,
    };
    let is_condition = |item: &ast::WorldItem| match item {
        ast::WorldItem::Condition(known) => *known.name.text == *name,
        _ => false,
    };
    !world.items.iter().any(is_named) && (!is_name(&name) || world.items.iter().any(is_condition))
}

/// Reads a predicate as a question.
fn read(
    name: &str,
    predicate: &str,
    origin: &str,
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
) -> Option<Question> {
    let file = sources.add(Path::new(origin), predicate);
    let (read, found) = syntax::parse_predicate(file, predicate);
    diagnostics.append(found);
    let name = Name { text: name.into(), span: Span::new(file, 0, predicate.len()) };
    read.map(|predicate| Question { name, predicate })
}

/// The `never`s that were added to a world as questions from a source: they are no rules of it.
pub fn added_nevers(program: &Program, sources: &SourceMap, world: WorldId, origin: &str) -> Vec<NeverId> {
    let is_added = |span: Span| sources.holds(span) && sources.file(span.file()).path == Path::new(origin);
    let nevers = program.spans.worlds[world].nevers.pairs();
    nevers.filter(|(_, span)| is_added(**span)).map(|(id, _)| id).collect()
}

/// A number of a program as it is written.
#[derive(Debug, Clone, PartialEq)]
pub struct WrittenNumber {
    /// Its value in the unit in which it is written; none if it is not a literal.
    pub literal: Option<f64>,
    /// The unit that is written after it, with the space before it.
    pub unit: String,
}

/// The number of a program with a path: `Hero.speed` of a parameter, `gravity` of a constant.
///
/// That there is none.
pub fn written_number(root: &Path, files: &dyn Files, path: &str) -> Result<WrittenNumber, NoQuestion> {
    let mut sources = SourceMap::new();
    let (mut trees, _) = syntax::load(root, (files, &Unshared), &mut sources);
    // What is wrong with behaviours is a finding of the program.
    let _ = syntax::expand(&mut trees, &mut sources, &mut Occurrences::default());
    let known: Vec<Number> = trees.iter().flat_map(syntax::numbers).collect();
    let number = known.iter().find(|number| number.path() == path).ok_or_else(|| unknown(path, &known))?;
    let unit = if number.literal.is_some() { syntax::unit_of(sources.slice(number.span)) } else { "" };
    Ok(WrittenNumber { literal: number.literal, unit: unit.to_string() })
}

/// Sets numbers of the trees, in which behaviours are expanded.
pub(super) fn set_numbers(
    changes: &Changes<'_>,
    trees: &mut [ast::File],
    sources: &mut SourceMap,
    diagnostics: &mut Diagnostics,
) {
    if changes.numbers.is_empty() {
        return;
    }
    let known: Vec<Number> = trees.iter().flat_map(syntax::numbers).collect();
    for &NumberSetting { path, value } in changes.numbers {
        let Some(number) = known.iter().find(|number| number.path() == path) else {
            diagnostics.report(unknown(path, &known));
            continue;
        };
        let is_plain = value.trim().parse::<f64>().is_ok() && number.literal.is_some();
        let unit = if is_plain { syntax::unit_of(sources.slice(number.span)) } else { "" };
        let text = format!("{}{unit}", value.trim());
        let file = sources.add(Path::new(&format!("--set {path}")), text.as_str());
        let (expression, found) = syntax::parse_predicate(file, &text);
        diagnostics.append(found);
        if let Some(expression) = expression {
            trees.iter_mut().for_each(|tree| {
                syntax::set_number(tree, path, &expression);
            });
        }
    }
}

fn unknown(path: &str, known: &[Number]) -> NoQuestion {
    let paths: Vec<String> = known.iter().map(Number::path).collect();
    // The entity may be left out.
    let last = path.rsplit('.').next();
    let with_entity = known.iter().find(|number| Some(&*number.name) == last).map(Number::path);
    let near = with_entity.or_else(|| similar(path, paths.iter().map(String::as_str)));
    let mut list: Vec<String> = paths.iter().take(MAX_LISTED).map(|path| format!("`{path}`")).collect();
    if paths.len() > MAX_LISTED {
        list.push(format!("{} more", paths.len() - MAX_LISTED));
    }
    let help = match list.is_empty() {
        true => "the program has no `param` and no `const`".to_string(),
        false => format!("there is {}", list.join(", ")),
    };
    NoQuestion { why: format!("no `param` or `const` `{path}`"), near, help: Some(help) }
}
