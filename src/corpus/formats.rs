//! Rows as CSV (RFC 4180), and as a table for people.

use crate::json::{self, Layout};
use crate::reach::Conclusion;
use crate::tabular::{Cell, Column, Table, csv};

use super::row::Row;

/// The columns of the CSV, one line a row; the fields are those of [`Row`], and what depends on the machine comes last.
pub const CSV_HEADER: [&str; 56] = [
    "row",
    "level",
    "kind",
    "goal",
    "verdict",
    "is_expected",
    "steps",
    "nodes",
    "places",
    "mode_combinations",
    "places_with_modes",
    "place",
    "inputs",
    "proven_by",
    "reasons",
    "error",
    "states",
    "least_steps",
    "is_shortest",
    "reads_between",
    "answered_by",
    "trees",
    "extensions",
    "failures",
    "simulated_steps",
    "exhausted_hold",
    "exhausted_states",
    "violations",
    "end",
    "is_withdrawn",
    "inputs_left_out",
    "fault",
    "refuted",
    "file",
    "world",
    "level_sha256",
    "program_sha256",
    "hypedc",
    "seed",
    "planner",
    "bounds",
    "metric",
    "hold",
    "restart",
    "settings",
    "nodes_limit",
    "nearest_part",
    "nearest_distance",
    "nearest_unit",
    "nearest_column",
    "success",
    "success_low",
    "success_high",
    "seconds",
    "cpu_seconds",
    "analysis_seconds",
];

/// A row as a line of CSV under [`CSV_HEADER`], without the line's end. A missing value is an empty cell; `violations`
/// holds the names of each `never`, `settings` all of them as JSON.
pub fn csv_line(row: &Row) -> String {
    fn number<T: ToString>(number: Option<T>) -> String {
        number.map_or(String::new(), |n| n.to_string())
    }
    let text = |text: &Option<String>| text.clone().unwrap_or_default();
    let (a, c, s, t) = (&row.answer, &row.answer.coverage, &row.settings, &row.timing);
    let violations: Vec<&str> = a.violations.iter().map(|v| v.never.as_str()).collect();
    let proof = a.proven_by.map(|method| method.name().to_string());
    let missing = a.why_not.as_ref().and_then(|why| why.missing());
    let nearest = a.why_not.as_ref().and_then(|why| why.nearest.as_ref());
    let cells: [String; CSV_HEADER.len()] = [
        row.row.to_string(),
        text(&row.level),
        a.kind.name().to_string(),
        a.goal.clone(),
        a.verdict.name().to_string(),
        a.is_expected.to_string(),
        number(a.steps),
        a.nodes.to_string(),
        c.places.to_string(),
        c.mode_combinations.to_string(),
        c.places_with_modes.to_string(),
        c.place.to_string(),
        text(&a.inputs),
        proof.unwrap_or_default(),
        a.reasons.join("; "),
        text(&row.error),
        number(a.states),
        number(a.least_steps),
        number(a.is_shortest),
        a.reads_between.to_string(),
        text(&a.answered_by),
        a.trees.to_string(),
        a.extensions.to_string(),
        a.failures.to_string(),
        a.simulated_steps.to_string(),
        number(a.exhausted.map(|e| e.hold)),
        number(a.exhausted.map(|e| e.states)),
        violations.join(" "),
        a.end.name().to_string(),
        a.is_withdrawn.to_string(),
        a.inputs_left_out.to_string(),
        text(&row.fault),
        text(&row.refuted),
        row.file.clone(),
        row.world.clone(),
        text(&row.level_sha256),
        text(&row.program_sha256),
        s.hypedc.clone(),
        s.seed.to_string(),
        s.planner.clone(),
        s.bounds.clone(),
        s.metric.clone(),
        s.hold.map_or(String::new(), |(low, high)| format!("{low}..{high}")),
        text(&s.restart),
        json::text(s, Layout::Compact).unwrap_or_default(),
        number(s.nodes_limit),
        missing.map_or(String::new(), |part| part.text.clone()),
        number(missing.and_then(|part| part.distance)),
        missing.map_or(String::new(), |part| part.unit.clone()),
        number(nearest.and_then(|nearest| nearest.at.column)),
        number(a.robust.as_ref().map(|robust| robust.success.success)),
        number(a.robust.as_ref().map(|robust| robust.success.success_95[0])),
        number(a.robust.as_ref().map(|robust| robust.success.success_95[1])),
        format!("{:.6}", t.seconds),
        t.cpu_seconds.map_or(String::new(), |seconds| format!("{seconds:.6}")),
        format!("{:.6}", t.analysis_seconds),
    ];
    csv::line(cells)
}

/// The rows as a table: a line each, followed by the reason for an unexpected verdict.
pub fn table(rows: &[&Row]) -> String {
    let mut columns = vec![Column::left("", "level")];
    let has_goals = rows.windows(2).any(|pair| pair[0].key().question() != pair[1].key().question());
    if has_goals {
        columns.push(Column::left("", "goal"));
    }
    columns.extend([
        Column::left("", "verdict"),
        Column::right("", "steps"),
        Column::right("", "nodes"),
        Column::right("", "places"),
        Column::right("", "seconds"),
    ]);
    let has_success = rows.iter().any(|row| row.answer.robust.is_some());
    if has_success {
        columns.push(Column::right("", "success"));
    }
    columns.push(Column::left("", ""));
    let mut table = Table::new(columns);
    for row in rows {
        let answer = &row.answer;
        let mut cells: Vec<Cell> = vec![row.key().level_name().into()];
        if has_goals {
            cells.push(answer.goal.as_str().into());
        }
        let is_searched = answer.nodes > 0;
        let searched = |number: f64| is_searched.then_some(number);
        let whole = |number: f64| format!("{number:.0}");
        cells.extend([
            answer.verdict.words().into(),
            Cell::of(answer.steps.map(|n| n as f64), whole),
            Cell::of(searched(answer.nodes as f64), whole),
            Cell::of(searched(answer.coverage.places as f64), whole),
            Cell::of(searched(row.timing.seconds), |s| format!("{s:.3}")),
        ]);
        if has_success {
            let success = answer.robust.as_ref().map(|robust| robust.success.success);
            cells.push(Cell::of(success, |share| format!("{:.1} %", 100.0 * share)));
        }
        cells.push(row.reason().into());
        table.push(cells);
    }
    table.text()
}

/// The number of rows by verdict, in one line without its end: `3 questions: 2 reached, 1 error`.
pub fn summary(rows: &[&Row]) -> String {
    let counts = Conclusion::ALL.map(|verdict| (verdict, rows.iter().filter(|r| r.answer.verdict == verdict).count()));
    let parts = counts.into_iter().filter(|(_, count)| *count > 0).map(|(v, count)| format!("{count} {}", v.words()));
    let mut levels: Vec<&Option<String>> = rows.iter().map(|r| &r.level).collect();
    levels.dedup();
    let (questions, levels) = (counted(rows.len(), "question"), counted(levels.len(), "level"));
    let all = if questions.split(' ').next() == levels.split(' ').next() {
        levels
    } else {
        format!("{questions} about {levels}")
    };
    match parts.collect::<Vec<_>>() {
        parts if parts.is_empty() => all,
        parts => format!("{all}: {}", parts.join(", ")),
    }
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::corpus::row::tests::row;
    use crate::reach::query::{Answer, Counterexample, ExhaustedHold, Kind};

    fn rows() -> Vec<Row> {
        let mut missed = row("levels/long name.txt");
        missed.answer = Answer {
            verdict: Conclusion::NotFound,
            is_expected: false,
            steps: None,
            inputs: None,
            nodes: 200_000,
            exhausted: Some(ExhaustedHold { hold: 10, states: 40 }),
            ..missed.answer
        };
        let failed = Row {
            answer: Answer::failed(Kind::Goal, "out".into()),
            error: Some("levels/b.txt:2:1: error[E0501]: a row has 2 tiles, others have 3\nmore".into()),
            ..row("levels/b.txt")
        };
        let mut broken = row("levels/a, or so.txt");
        broken.answer.violations =
            vec![Counterexample { never: "fell".into(), steps: 3, inputs: "-*3".into(), luck: None }];
        vec![broken, missed, failed]
    }

    #[test]
    fn every_cell_has_a_column() {
        for row in rows() {
            let cells = csv::cells(&csv_line(&row));
            assert_eq!(cells.len(), CSV_HEADER.len());
            let cell = |name: &str| &cells[CSV_HEADER.iter().position(|c| *c == name).unwrap()];
            assert_eq!(*cell("level"), row.level.clone().unwrap());
            assert_eq!(cell("verdict"), row.answer.verdict.name());
            assert_eq!(*cell("error"), row.error.clone().unwrap_or_default());
            assert_eq!(cell("analysis_seconds"), "0.500000");
            assert_eq!(serde_json::from_str::<crate::corpus::Settings>(cell("settings")).unwrap(), row.settings);
        }
    }

    #[test]
    fn the_table_says_why_not() {
        let rows = rows();
        let rows: Vec<&Row> = rows.iter().collect();
        let expected = "\
level                 verdict    steps   nodes  places  seconds
levels/a, or so.txt   reached      120      31      12    0.250
levels/long name.txt  not found      -  200000      12    0.250  not among 200000 nodes
levels/b.txt          error          -       -       -        -  levels/b.txt:2:1: error[E0501]: a row has 2 tiles, others have 3
";
        assert_eq!(table(&rows), expected);
        assert_eq!(summary(&rows), "3 levels: 1 reached, 1 not found, 1 error");
        let mut other = rows[2].clone();
        other.answer.goal = "key".into();
        let rows = [rows[0], rows[1], rows[2], &other];
        assert_eq!(summary(&rows), "4 questions about 3 levels: 1 reached, 1 not found, 2 error");
        assert!(table(&rows).starts_with("level                 goal  verdict"));
        assert_eq!(summary(&[]), "0 levels");
    }
}
