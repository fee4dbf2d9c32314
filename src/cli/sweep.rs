//! Sweeps: one or two numbers of a program that take each of some values in turn. Commands compile and ask for each point
//! of the grid, and show a table.

use std::io::{self, Write};
use std::path::Path;

use crate::compile::NumberSetting;
use crate::tabular::{Cell, Column, Table};

use super::Exit;
use super::args::SetArgs;
use super::report::{plain_error, written};

/// Maximum number of sweeps of a command, and of points of the grid.
const MAX_AXES: usize = 2;
const MAX_POINTS: usize = 10_000;

/// The grid of one or two sweeps.
pub(super) struct Sweep<'a> {
    /// The numbers with their values; the second varies fastest.
    pub axes: Vec<(&'a str, &'a [String])>,
}

/// Runs a command over the grid of its arguments; none if they have no sweep.
pub(super) fn swept(args: &SetArgs, run: impl FnOnce(&Sweep<'_>) -> io::Result<Exit>) -> io::Result<Option<Exit>> {
    match Sweep::new(args) {
        Ok(sweep) => sweep.map(|sweep| run(&sweep)).transpose(),
        Err(why) => {
            plain_error(&why)?;
            Ok(Some(Exit::Refused))
        }
    }
}

/// Shows the table of a sweep, and writes it as CSV if that is asked for.
pub(super) fn show(head: &str, table: Option<&Table>, csv: Option<&Path>) -> io::Result<Exit> {
    let (text, lines) = table.map_or_else(Default::default, |table| (table.text(), table.csv()));
    if let Some(path) = csv
        && !written(path, &lines)?
    {
        return Ok(Exit::Refused);
    }
    let saved = csv.map_or(String::new(), |path| format!("table   {}\n", path.display()));
    write!(io::stdout(), "{head}{text}{saved}")?;
    Ok(Exit::Yes)
}

/// Refuses `--csv` where nothing is swept.
pub(super) fn refuses_csv(csv: Option<&Path>, instead: &str) -> io::Result<bool> {
    if csv.is_some() {
        plain_error(&format!("`--csv` writes the table of a sweep, `--set NAME=FIRST..LAST/STEP`; {instead}"))?;
    }
    Ok(csv.is_some())
}

impl<'a> Sweep<'a> {
    /// The grid of the arguments; none if they have no sweep.
    ///
    /// Why it is too large.
    fn new(args: &'a SetArgs) -> Result<Option<Self>, String> {
        let axes = args.sweeps();
        if axes.len() > MAX_AXES {
            return Err(format!("at most {MAX_AXES} numbers can be swept at a time, not {}", axes.len()));
        }
        let sweep = Sweep { axes };
        match sweep.points() {
            points if points > MAX_POINTS => {
                Err(format!("these sweeps have {points} points together, at most {MAX_POINTS} are possible"))
            }
            _ => Ok((!sweep.axes.is_empty()).then_some(sweep)),
        }
    }

    /// The number of points.
    pub fn points(&self) -> usize {
        self.axes.iter().map(|(_, values)| values.len()).product()
    }

    /// The values at a point.
    pub fn values(&self, point: usize) -> Vec<&'a str> {
        let mut rest = point;
        let mut values: Vec<&'a str> = Vec::new();
        for (_, all) in self.axes.iter().rev() {
            let count = all.len().max(1);
            values.extend(all.get(rest % count).map(String::as_str));
            rest /= count;
        }
        values.reverse();
        values
    }

    /// The numbers that are set at a point.
    pub fn numbers(&self, point: usize) -> Vec<NumberSetting<'a>> {
        let names = self.axes.iter().map(|(path, _)| *path);
        names.zip(self.values(point)).map(|(path, value)| NumberSetting { path, value }).collect()
    }

    /// What is swept: `Hero.jump_speed 200 to 350`.
    pub fn text(&self) -> String {
        let axis = |(path, values): &(&str, &[String])| match values {
            [first, .., last] => format!("{path} {first} to {last}"),
            values => format!("{path} {}", values.concat()),
        };
        self.axes.iter().map(axis).collect::<Vec<_>>().join(", ")
    }

    /// The columns of the values in a table.
    pub fn columns(&self) -> Vec<Column> {
        self.axes.iter().map(|(path, _)| Column::right("", path.to_string())).collect()
    }

    /// The cells of a point in these columns.
    pub fn cells(&self, point: usize) -> Vec<Cell> {
        self.values(point).into_iter().map(Cell::from).collect()
    }
}
