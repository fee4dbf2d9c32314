//! A table in plain text, its columns aligned, some of them under a common heading.

use std::borrow::Cow;

use super::csv;

/// Number of blanks between two columns.
const GAP: usize = 2;

/// A column's heading.
#[derive(Debug, Clone)]
pub struct Column {
    /// The common heading above it and its neighbours with the same; empty for none.
    group: &'static str,
    name: Cow<'static, str>,
    is_right: bool,
}

impl Column {
    /// A left-aligned column, for words.
    pub fn left(group: &'static str, name: impl Into<Cow<'static, str>>) -> Self {
        Column { group, name: name.into(), is_right: false }
    }

    /// A right-aligned column, for numbers.
    pub fn right(group: &'static str, name: impl Into<Cow<'static, str>>) -> Self {
        Column { group, name: name.into(), is_right: true }
    }
}

/// The cell of a row in a column.
#[derive(Debug, Clone)]
pub struct Cell(String);

impl Cell {
    /// An empty cell: not applicable.
    pub const fn empty() -> Self {
        Cell(String::new())
    }

    /// A number, or a dash where there is none.
    pub fn of(number: Option<f64>, text: fn(f64) -> String) -> Self {
        Cell(number.map_or("-".to_string(), text))
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Cell(text.to_string())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Cell(text)
    }
}

/// A table.
pub struct Table {
    columns: Vec<Column>,
    rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new(columns: Vec<Column>) -> Self {
        Table { columns, rows: Vec::new() }
    }

    /// Adds a row, a cell for each column.
    pub fn push(&mut self, cells: Vec<Cell>) {
        self.rows.push(cells);
    }

    /// The table, headings first, no blanks at the ends of lines.
    pub fn text(&self) -> String {
        let names: Vec<Cell> = self.columns.iter().map(|c| c.name.as_ref().into()).collect();
        let mut widths = self.widths(&names);
        let mut above = String::new();
        let mut at = 0;
        for part in self.columns.chunk_by(|a, b| a.group == b.group) {
            let (group, last) = (part[0].group, at + part.len() - 1);
            let width = |widths: &[usize]| widths[at..=last].iter().sum::<usize>() + GAP * (part.len() - 1);
            // A heading that is wider than its columns widens the first of them.
            widths[at] += group.chars().count().saturating_sub(width(&widths));
            let is_right = part.iter().all(|c| c.is_right);
            above.push_str(&padded(group, width(&widths), is_right));
            above.push_str(&" ".repeat(GAP));
            at = last + 1;
        }
        let mut out = String::new();
        if !above.trim().is_empty() {
            out.push_str(above.trim_end());
            out.push('\n');
        }
        for row in std::iter::once(&names).chain(&self.rows) {
            let cells = row.iter().zip(&self.columns).zip(&widths);
            let cells: Vec<String> = cells.map(|((cell, c), width)| padded(&cell.0, *width, c.is_right)).collect();
            out.push_str(cells.join(&" ".repeat(GAP)).trim_end());
            out.push('\n');
        }
        out
    }

    /// The table as comma-separated values, headings first; common headings are left out.
    pub fn csv(&self) -> String {
        let names = csv::line(self.columns.iter().map(|column| &column.name));
        let rows = self.rows.iter().map(|row| csv::line(row.iter().map(|cell| &cell.0)));
        std::iter::once(names).chain(rows).map(|line| line + "\n").collect()
    }

    fn widths(&self, names: &[Cell]) -> Vec<usize> {
        let rows = || self.rows.iter().map(Vec::as_slice).chain([names]);
        let width = |at: usize| rows().filter_map(|r| r.get(at)).map(|c| c.0.chars().count()).max().unwrap_or(0);
        (0..self.columns.len()).map(width).collect()
    }
}

fn padded(text: &str, width: usize, is_right: bool) -> String {
    if is_right { format!("{text:>width$}") } else { format!("{text:<width$}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_under_their_headings() {
        let mut table = Table::new(vec![
            Column::left("", "who"),
            Column::right("a long heading", "a"),
            Column::right("a long heading", "b"),
        ]);
        table.push(vec!["rrt".into(), Cell::of(Some(12.0), |x| x.to_string()), Cell::of(None, |x| x.to_string())]);
        table.push(vec!["exhaustive".into(), "3".into(), Cell::empty()]);
        let expected = "            a long heading\n\
                        who                   a  b\n\
                        rrt                  12  -\n\
                        exhaustive            3\n";
        assert_eq!(table.text(), expected);
        assert_eq!(table.csv(), "who,a,b\nrrt,12,-\nexhaustive,3,\n");
    }
}
