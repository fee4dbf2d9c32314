//! The result of `hypedc reach --skill` as text for people.

use crate::reach::Conclusion;
use crate::tabular::{Cell, Column, Table};

use super::super::explore::listed;
use super::super::text::{counted, with_luck};
use super::result::{AnswerResult, LayerResult, SkillResult, TopsResult};
use crate::cli::args::ReachArgs;

/// The answer of a layer in a few words.
fn answer(layer: &LayerResult, answer: &AnswerResult) -> String {
    let words = answer.verdict.words();
    match (answer.verdict, answer.seconds_of_play) {
        (Conclusion::Reached | Conclusion::Violated, _) if answer.of != layer.name => format!("as {}", answer.of),
        (_, Some(seconds)) => format!("{words} in {seconds:.2} s{}", with_luck(answer.luck.as_ref())),
        _ => words.to_string(),
    }
}

/// Floors in words: `x 112 to 160 at y 80`.
fn floors(tops: &[TopsResult], has_rooms: bool, is_whole: bool) -> String {
    let place = |TopsResult { space, tops }: &TopsResult| {
        let room = if has_rooms { format!(" in `{space}`") } else { String::new() };
        format!("x {} to {} at y {}{room}", tops.left, tops.right, tops.y)
    };
    listed(tops.iter().map(place).collect(), is_whole)
}

/// The result as text.
pub(super) fn result_text(result: &SkillResult, args: &ReachArgs) -> String {
    let SkillResult { file, world, settings, layers, .. } = result;
    let set: String = settings.set.iter().map(|set| format!(", {set}")).collect();
    let without = settings.without.as_ref().map(|without| format!(", without {without}")).unwrap_or_default();
    let mut out = format!("{file}, world {world}, seed {}{set}{without}: who gets where\n", settings.seed);
    let mut columns = vec![
        Column::left("", "players"),
        Column::right("", "places"),
        Column::right("", "new"),
        Column::right("", "floors"),
        Column::right("", "new"),
    ];
    let questions = layers.first().map_or(&[][..], |layer| &layer.answers);
    columns.extend(
        questions.iter().map(|question| Column::left("", format!("{} {}", question.kind.name(), question.goal))),
    );
    let width = columns.len();
    let mut table = Table::new(columns);
    for layer in layers {
        let numbers = [layer.places, layer.new_places_count, layer.tops_stood_on, layer.new_tops_count];
        let mut cells: Vec<Cell> = vec![layer.name.as_str().into()];
        cells.extend(numbers.map(|number| Cell::from(number.to_string())));
        cells.extend(layer.answers.iter().map(|found| Cell::from(answer(layer, found))));
        cells.resize_with(width, Cell::empty);
        table.push(cells);
    }
    for line in table.text().lines() {
        out.push_str(&format!("  {line}\n"));
    }
    let is_quiet = args.quiet;
    let has_rooms = result.nobody.iter().chain(layers.iter().flat_map(|layer| &layer.new_tops));
    let mut spaces: Vec<&str> = has_rooms.map(|tops| tops.space.as_str()).collect();
    spaces.sort_unstable();
    spaces.dedup();
    let has_rooms = spaces.len() > 1 || layers.iter().map(|layer| layer.new_rooms.len()).sum::<usize>() > 1;
    if !is_quiet {
        for layer in layers.iter().skip(1) {
            let mut new: Vec<String> = layer.new_rooms.iter().map(|room| format!("room `{room}`")).collect();
            if !layer.new_tops.is_empty() {
                new.push(format!("floors {}", floors(&layer.new_tops, has_rooms, args.verbose)));
            }
            if !new.is_empty() {
                let with = if layer.without.is_some() { "" } else { "with " };
                out.push_str(&format!("  new {with}{}: {}\n", layer.name, new.join(", ")));
            }
        }
        if !result.nobody.is_empty() {
            let nobody = floors(&result.nobody, has_rooms, args.verbose);
            out.push_str(&format!("  nobody stood on floors {nobody}\n"));
        }
    }
    if let Some(path) = &args.svg {
        out.push_str(&format!("  drawn   {}\n", path.display()));
    }
    out.extend(result.refuted.as_ref().map(|why| format!("{why}\n")));
    if is_quiet {
        return out;
    }
    let nodes: u64 = layers.iter().map(|layer| layer.nodes).sum();
    out.push_str(&format!(
        "  search  {} to explore, {:.3} s; `--nodes N` and `--seconds S` give more\n",
        counted(nodes, "node"),
        result.seconds
    ));
    if result.stopped {
        out.push_str("  stopped: layers are missing, and the last one is not whole\n");
    }
    out.push_str(&format!(
        "  places of {} px; `new` are those of no layer above; what was not found in a layer may still be reachable\n",
        result.place
    ));
    out
}
