//! The tables of `hypedc bounds`. Values that do not depend on modes are in one list; then, for each group, there is a
//! row per mode and a column per value that differs between its modes, joined over the other groups.

use std::collections::BTreeSet;
use std::io::{self, Write};

use crate::analysis::{Configuration, Interval, SlotSpace, Values};
use crate::ir::{DiscreteId, Domain, Entity, GroupId, Id, LeafId, SlotId, TimerId, VarId, World};

use crate::analysis::wording::{number, values as shown};
use crate::ask::{Dimensions, WorldBounds, dimensions};

/// Maximum width of a line, where it can be broken.
const WIDTH: usize = 110;

/// A number of an instance.
#[derive(Debug, Clone, Copy)]
enum Column {
    Var(VarId, u8),
    Discrete(DiscreteId),
    Timer(TimerId),
}

struct Slot<'a> {
    world: &'a World,
    entity: &'a Entity,
    space: &'a SlotSpace,
}

/// Slots with the same text, except for the positions of instances that never move.
struct SlotGroup {
    slots: Vec<SlotId>,
    /// The common text.
    shared: String,
    /// The full text, as long as it is the same for all.
    own: Option<String>,
}

/// Writes all slots, equal ones together, and the sum of their dimensions.
pub(in crate::cli) fn write_table(out: &mut impl Write, of: &WorldBounds<'_>) -> io::Result<()> {
    let mut all: Vec<SlotGroup> = Vec::new();
    for slot in of.space.slots.ids() {
        let s = Slot { world: of.world, entity: of.entity(slot), space: &of.space.slots[slot] };
        let (own, shared) = (s.text(true), s.text(false));
        let entity = |slot: SlotId| of.world.slots[slot].entity;
        let same =
            |a: &&mut SlotGroup| a.slots.first().is_some_and(|o| entity(*o) == entity(slot)) && a.shared == shared;
        match all.iter_mut().find(same) {
            Some(group) => {
                group.slots.push(slot);
                group.own.take_if(|text| *text != own);
            }
            None => all.push(SlotGroup { slots: vec![slot], shared, own: Some(own) }),
        }
    }
    for SlotGroup { slots, shared, own } in &all {
        let names: Vec<&str> = slots.iter().map(|s| of.world.slots[*s].name.as_str()).collect();
        let Some(&first) = slots.first() else { continue };
        let names = match names.as_slice() {
            [one, .., last] if names.len() > 3 => format!("{one} to {last}, {} of them", names.len()),
            _ => names.join(", "),
        };
        write!(out, "\n{names}: {}{}", of.entity(first).name, own.as_ref().unwrap_or(shared))?;
    }
    writeln!(out, "\ntotal: {}", dimensions_text(of.dimensions()))
}

fn dimensions_text(d: Dimensions) -> String {
    let vary = if d.varying == 1 { "varies" } else { "vary" };
    let (all, varying, rest) = (d.all, d.varying, d.in_one_combination);
    format!("{all} dimensions, of which {varying} {vary}, at most {rest} in one combination of modes")
}

impl Slot<'_> {
    /// Everything after the name; with or without the position of an instance that never moves.
    fn text(&self, place: bool) -> String {
        if self.space.is_given_up {
            let why = self.space.why.map_or(String::new(), |why| format!(" ({})", why.reason()));
            return format!("\n  too large to analyse{why}: anything is possible\n");
        }
        if self.space.configurations.is_empty() {
            return ", never present\n".to_string();
        }
        let spaces: BTreeSet<_> = self.space.configurations.iter().flat_map(|c| c.spaces.iter().copied()).collect();
        let spaces: Vec<&str> = spaces.iter().map(|s| self.world.spaces[*s].name.as_str()).collect();
        let within = if self.world.spaces.len() > 1 { format!(" in {}", spaces.join(", ")) } else { String::new() };
        let absent = if self.space.can_be_absent { ", can be absent" } else { "" };
        let mut out = format!("{within}{absent}\n  {}\n", dimensions_text(dimensions(self.entity, self.space)));
        let groups: Vec<GroupId> = self.entity.groups.ids().filter(|g| self.leaves(*g).len() > 1).collect();
        let columns = self.columns();
        let differs = |column: &Column, group: GroupId| {
            let mut cells = self.leaves(group).into_iter().map(|leaf| self.cell(*column, Some((group, leaf))));
            let first = cells.next();
            cells.any(|c| Some(c) != first)
        };
        let steady = columns.iter().filter(|c| !groups.iter().any(|g| differs(c, *g)));
        let steady: Vec<String> = steady.map(|c| self.relation(*c, place)).collect();
        out.push_str(&wrapped("  always  ", &steady));
        if self.space.configurations.iter().any(|c| c.leaves.len() > 1) {
            let count = self.space.configurations.len();
            let noun = if count == 1 { "combination" } else { "combinations" };
            out.push_str(&format!("  {count} {noun} of modes\n"));
        }
        for group in groups {
            let own: Vec<Column> = columns.iter().copied().filter(|c| differs(c, group)).collect();
            self.write_group(&mut out, group, &own);
        }
        out
    }

    fn columns(&self) -> Vec<Column> {
        let vars = self.entity.vars.ids().flat_map(|var| [0, 1, 2].map(|degree| Column::Var(var, degree)));
        let discretes = self.entity.discretes.ids().map(Column::Discrete);
        vars.chain(discretes).chain(self.entity.timers.ids().map(Column::Timer)).collect()
    }

    /// The leaves of a group that can be active.
    fn leaves(&self, group: GroupId) -> BTreeSet<LeafId> {
        self.space.configurations.iter().filter_map(|c| c.leaves.get(group.index())).copied().collect()
    }

    /// The values of a column while a leaf is active, or overall.
    fn values(&self, column: Column, of: Option<(GroupId, LeafId)>) -> Values {
        let fits = |c: &&Configuration| of.is_none_or(|(g, leaf)| c.leaves.get(g.index()) == Some(&leaf));
        let found = self.space.configurations.iter().filter(fits).flat_map(|c| match column {
            Column::Var(var, degree) => c.vars[var][usize::from(degree)].intervals().to_vec(),
            Column::Discrete(id) => c.discretes[id].intervals().to_vec(),
            Column::Timer(id) => vec![c.timers[id]],
        });
        Values::any(found)
    }

    fn cell(&self, column: Column, of: Option<(GroupId, LeafId)>) -> String {
        let values = self.values(column, of);
        match column {
            Column::Var(..) => shown(&values),
            Column::Discrete(id) => self.discrete(id, &values),
            Column::Timer(_) => self.time(&values),
        }
    }

    /// The values of a discrete variable by name; consecutive whole numbers as an interval.
    fn discrete(&self, id: DiscreteId, values: &Values) -> String {
        let discrete = &self.entity.discretes[id];
        let name = |i: i64| match &discrete.domain {
            Domain::Int => i.to_string(),
            Domain::Bool => if i == 0 { "false" } else { "true" }.to_string(),
            Domain::Set(names) => {
                usize::try_from(i).ok().and_then(|i| names.get(i)).cloned().unwrap_or_else(|| i.to_string())
            }
        };
        let whole = |i: &Interval| i.high - i.low < 8.0;
        if matches!(discrete.domain, Domain::Int) || !values.intervals().iter().all(whole) {
            let joined = values.hull().filter(|h| {
                let count: f64 = values.intervals().iter().map(|i| i.high - i.low + 1.0).sum();
                count > 2.0 && count == h.high - h.low + 1.0
            });
            return shown(&joined.map_or_else(|| *values, Values::from));
        }
        let names: Vec<String> =
            values.intervals().iter().flat_map(|i| i.low as i64..=i.high as i64).map(name).collect();
        if let [only] = names.as_slice() { format!("= {only}") } else { format!("{{{}}}", names.join(", ")) }
    }

    /// A timer's count in steps and in seconds.
    fn time(&self, values: &Values) -> String {
        let seconds = |steps: f64| number(steps * self.world.step.seconds());
        match values.hull() {
            Some(h) if h.is_point() && h.low == 0.0 => "= 0".to_string(),
            Some(h) if h.high.is_finite() && h.high < f64::from(u32::MAX) => {
                format!("{} ({} s)", shown(values), seconds(h.high))
            }
            Some(h) => format!(">= {}", number(h.low)),
            None => shown(values),
        }
    }

    fn name(&self, column: Column) -> String {
        match column {
            Column::Var(var, degree) => self.entity.variable_text(var, degree),
            Column::Discrete(id) => self.entity.discretes[id].name.clone(),
            Column::Timer(id) => {
                let path = &self.entity.modes[self.entity.timers[id].mode].path;
                format!("timer({path})")
            }
        }
    }

    /// Positions are lengths; the units of other variables are not known here.
    fn unit(column: Column) -> &'static str {
        match column {
            Column::Var(var, degree) if var.is_position() => {
                [" [px]", " [px/s]", " [px/s²]"][usize::from(degree.min(2))]
            }
            Column::Timer(_) => " [steps]",
            _ => "",
        }
    }

    fn relation(&self, column: Column, place: bool) -> String {
        let is_position = matches!(column, Column::Var(var, 0) if var.is_position());
        if is_position && !place && self.values(column, None).constant().is_some() {
            return format!("{} as placed", self.name(column));
        }
        let cell = self.cell(column, None);
        if cell == "= 0" {
            // Zero needs no unit.
            return format!("{} = 0", self.name(column));
        }
        let is = if cell.starts_with(['[', '{']) { "in " } else { "" };
        format!("{}{} {is}{cell}", self.name(column), Self::unit(column))
    }

    fn write_group(&self, out: &mut String, group: GroupId, columns: &[Column]) {
        let leaves: Vec<LeafId> = self.leaves(group).into_iter().collect();
        let prefix = self.entity.groups[group].name.as_ref().map_or(String::new(), |name| format!("{name}."));
        let path = |leaf: &LeafId| {
            let path = &self.entity.modes[self.entity.leaves[*leaf].mode].path;
            path.strip_prefix(&prefix).unwrap_or(path).to_string()
        };
        let head = self.entity.groups[group].name.clone().unwrap_or_else(|| "mode".to_string());
        if columns.is_empty() {
            let names: Vec<String> = leaves.iter().map(path).collect();
            out.push_str(&wrapped(&format!("  {head}  "), &names));
            return;
        }
        let first: Vec<String> = std::iter::once(head).chain(leaves.iter().map(path)).collect();
        let mut rest: Vec<Vec<String>> = Vec::new();
        for column in columns {
            let title = format!("{}{}", self.name(*column), Self::unit(*column));
            let cells = leaves.iter().map(|leaf| self.cell(*column, Some((group, *leaf))));
            rest.push(std::iter::once(title).chain(cells).collect());
        }
        let width = |column: &Vec<String>| column.iter().map(|c| c.chars().count()).max().unwrap_or(0);
        let mut rest = rest.as_slice();
        // Columns that do not fit go below.
        while !rest.is_empty() {
            let mut taken = 0;
            let mut used = 2 + width(&first);
            while let Some(column) = rest.get(taken) {
                used += 2 + width(column);
                if used > WIDTH && taken > 0 {
                    break;
                }
                taken += 1;
            }
            let (now, later) = rest.split_at(taken);
            for row in 0..first.len() {
                let cells = std::iter::once(&first).chain(now).map(|c| format!("{:1$}", c[row], width(c)));
                let line = cells.collect::<Vec<_>>().join("  ");
                out.push_str(&format!("  {}\n", line.trim_end()));
            }
            rest = later;
        }
    }
}

/// A list with a heading, with line breaks.
fn wrapped(head: &str, items: &[String]) -> String {
    if items.is_empty() {
        return String::new();
    }
    let mut out = head.to_string();
    let mut used = head.chars().count();
    for (index, item) in items.iter().enumerate() {
        let comma = if index + 1 < items.len() { "," } else { "" };
        let length = item.chars().count() + comma.len();
        if index > 0 && used + 1 + length > WIDTH {
            out.push('\n');
            out.push_str(&" ".repeat(head.chars().count()));
            used = head.chars().count();
        } else if index > 0 {
            out.push(' ');
            used += 1;
        }
        out.push_str(item);
        out.push_str(comma);
        used += length;
    }
    out.push('\n');
    out
}
