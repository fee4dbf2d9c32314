//! `hypedc graph`: statecharts of a program's entities, on standard output.

use std::io::{self, Write};

use crate::compile::{Changes, LevelFile};
use crate::diagnostic::catalogue::run::NoQuestion;
use crate::diagnostic::similar;
use crate::graph::{Chart, chart, dot, mermaid, svg};
use crate::ir::EntityId;

use super::Exit;
use super::args::{GraphArgs, GraphFormat};
use super::report::{Loaded, load_changed, plain_error, show_fact};

pub(super) fn run(args: &GraphArgs) -> io::Result<Exit> {
    if let Some(why) = args.numbers.refusal() {
        plain_error(&why)?;
        return Ok(Exit::Refused);
    }
    let numbers = args.numbers.fixed();
    let changes = Changes { numbers: &numbers, ..Changes::default() };
    let Some(loaded) = load_changed(&args.file, LevelFile::default(), &changes)? else {
        return Ok(Exit::Refused);
    };
    let Some(entities) = choose(&loaded, args)? else {
        return Ok(Exit::Refused);
    };
    let charts: Vec<Chart> = entities.into_iter().map(|id| chart(&loaded.program, &loaded.sources, id)).collect();
    let text = match args.format {
        GraphFormat::Dot => dot(&charts),
        GraphFormat::Mermaid => mermaid(&charts),
        GraphFormat::Svg => svg(&charts),
    };
    write!(io::stdout(), "{text}")?;
    Ok(Exit::Yes)
}

/// The requested entities, or all; reports why if there are none.
fn choose(loaded: &Loaded, args: &GraphArgs) -> io::Result<Option<Vec<EntityId>>> {
    let entities = &loaded.program.entities;
    let file = args.file.display();
    let names: Vec<&str> = entities.iter().map(|e| &*e.name).collect();
    let mut chosen = Vec::new();
    for name in &args.entity {
        let Some(id) = loaded.program.entity_named(name) else {
            let list: Vec<String> = names.iter().map(|n| format!("`{n}`")).collect();
            let fact = NoQuestion {
                why: format!("no entity `{name}` in `{file}`"),
                near: similar(name, names.iter().copied()),
                help: (!list.is_empty()).then(|| format!("there is {}", list.join(", "))),
            };
            show_fact(&loaded.sources, fact)?;
            return Ok(None);
        };
        chosen.push(id);
    }
    if names.is_empty() {
        let fact = NoQuestion { why: format!("`{file}` has no entity"), near: None, help: None };
        show_fact(&loaded.sources, fact)?;
        return Ok(None);
    }
    Ok(Some(if chosen.is_empty() { entities.ids().collect() } else { chosen }))
}
