//! Input scripts: `right*40 right+jump*12 -*10`. Steps are separated by white space; `A+B*N` holds A and B for N
//! steps, `-` is nothing, `steer=-0.5` sets an axis, `2:jump` is player 2's, `nature:hero.roll=3` fixes what is drawn.
//! `left right down up` stand for ∓1 of `horizontal` and `vertical`, unless the entity has buttons of these names.

use std::fmt::Write;

use crate::diagnostic::catalogue::run::BadInput;
use crate::diagnostic::{Diagnostics, similar};
use crate::ir::{AxisId, ButtonId, Entity, Id, PlayerId, Program, WorldId};
use crate::source::{FileId, Span};

use super::chance;
use super::input::{Input, PlayerInput};

/// Maximum number of steps of a script.
pub const MAX_STEPS: u64 = 100_000_000;

/// A number of steps with the same input.
#[derive(Debug, Clone, PartialEq)]
pub struct ScriptStep {
    /// The input of all players.
    pub input: Input,
    /// Number of steps.
    pub count: u32,
}

/// An input script.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Script {
    /// Its steps in order.
    pub steps: Vec<ScriptStep>,
}

impl Script {
    /// Number of steps of the world.
    pub fn len(&self) -> u64 {
        self.steps.iter().map(|s| u64::from(s.count)).sum()
    }

    /// Whether it has no steps.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Appends `count` steps of an input; equal neighbours become one.
    pub fn push(&mut self, input: &Input, count: u32) {
        match self.steps.last_mut() {
            Some(last) if last.input == *input && last.count.checked_add(count).is_some() => last.count += count,
            _ if count > 0 => self.steps.push(ScriptStep { input: input.clone(), count }),
            _ => {}
        }
    }

    /// The script cut to its first `steps` steps.
    #[must_use]
    pub fn first(&self, steps: u64) -> Script {
        let mut first = Script::default();
        let mut left = steps;
        for step in &self.steps {
            let count = u64::from(step.count).min(left) as u32;
            first.push(&step.input, count);
            left -= u64::from(count);
        }
        first
    }

    /// The input of each step of the world.
    pub fn inputs(&self) -> impl Iterator<Item = &Input> {
        self.steps.iter().flat_map(|s| std::iter::repeat_n(&s.input, s.count as usize))
    }

    /// The script as text for [`parse_script`].
    pub fn text(&self, program: &Program, world: WorldId) -> String {
        let mut out = String::new();
        for step in &self.steps {
            if !out.is_empty() {
                out.push(' ');
            }
            let names = names(program, world, &step.input);
            out.push_str(if names.is_empty() { "-" } else { "" });
            out.push_str(&names.join("+"));
            if step.count > 1 {
                // Writing to a string cannot fail.
                let _ = write!(out, "*{}", step.count);
            }
        }
        out
    }
}

/// The names of the inputs of one step, as written in scripts.
pub(super) fn names(program: &Program, id: WorldId, input: &Input) -> Vec<String> {
    let world = &program.worlds[id];
    let first = world.players.iter().map(|p| p.number).min();
    let mut names = Vec::new();
    for (of, player) in world.players.pairs() {
        let entity = &program.entities[world.slots[player.slot].entity];
        let given = input.of(of);
        let prefix = if Some(player.number) == first { String::new() } else { format!("{}:", player.number) };
        for (axis, name) in entity.axes.pairs() {
            let value = given.axes[axis.index()];
            if value != 0.0 {
                let word = DIRECTIONS
                    .iter()
                    .find(|(word, axis, v)| axis == name && *v == value && entity.button_named(word).is_none());
                names.push(match word {
                    Some((word, ..)) => format!("{prefix}{word}"),
                    None => format!("{prefix}{name}={value}"),
                });
            }
        }
        for (button, name) in entity.buttons.pairs() {
            if given.buttons >> button.index() & 1 == 1 {
                names.push(format!("{prefix}{name}"));
            }
        }
    }
    names.extend(chance::names(program, id, &input.1));
    names
}

/// The prefix of what nature draws.
const NATURE: &str = "nature:";

/// Words for the ends of the two usual axes.
const DIRECTIONS: [(&str, &str, f64); 4] =
    [("left", "horizontal", -1.0), ("right", "horizontal", 1.0), ("down", "vertical", -1.0), ("up", "vertical", 1.0)];

/// Parses a script for the players of a world. `file` is the location of `text` for diagnostics.
pub fn parse_script(program: &Program, world: WorldId, file: FileId, text: &str) -> (Script, Diagnostics) {
    parse_script_at(program, world, (file, 0), text)
}

/// As [`parse_script`], for a text that begins at a byte of its file.
pub fn parse_script_at(
    program: &Program,
    world: WorldId,
    (file, base): (FileId, usize),
    text: &str,
) -> (Script, Diagnostics) {
    let mut parser = Parser { program, world, file, base, text, diagnostics: Diagnostics::new() };
    let mut script = Script::default();
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| !c.is_whitespace()) {
        let from = text.len() - rest.len() + start;
        let length = text[from..].find(char::is_whitespace).unwrap_or(text.len() - from);
        rest = &text[from + length..];
        if let Some((input, count)) = parser.step(from, from + length) {
            script.push(&input, count);
        }
    }
    if script.len() > MAX_STEPS {
        parser.report(
            0,
            text.len(),
            format!("the script lasts {} steps, at most {MAX_STEPS} are run", script.len()),
            None,
        );
    }
    (script, parser.diagnostics)
}

struct Parser<'a> {
    program: &'a Program,
    world: WorldId,
    file: FileId,
    /// Where the text begins in its file.
    base: usize,
    text: &'a str,
    diagnostics: Diagnostics,
}

/// The input that a name in a script sets.
enum Target {
    Button(ButtonId),
    Axis(AxisId, Option<f64>),
}

impl Parser<'_> {
    fn report(&mut self, from: usize, to: usize, why: String, help: Option<String>) {
        let at = Span::new(self.file, self.base + from, self.base + to);
        self.diagnostics.report(BadInput { at, why, help });
    }

    fn step(&mut self, from: usize, to: usize) -> Option<(Input, u32)> {
        let token = &self.text[from..to];
        let (body, count) = match token.rsplit_once('*') {
            Some((body, digits)) => match digits.parse::<u32>() {
                Ok(count) => (body, count),
                Err(_) => {
                    let at = to - digits.len();
                    let why = format!("`{digits}` is no number of steps");
                    self.report(at, to, why, Some("write `right*40` for 40 steps".into()));
                    return None;
                }
            },
            None => (token, 1),
        };
        let mut input = Input::nothing(self.program.worlds[self.world].players.len());
        if body == "-" {
            return Some((input, count));
        }
        let mut at = from;
        let mut fits = true;
        for part in body.split('+') {
            fits &= self.part(part, at, &mut input).is_some();
            at += part.len() + 1;
        }
        // Opposite directions cancel: they were added up.
        for player in &mut input.0 {
            for axis in &mut player.axes {
                *axis = axis.clamp(-1.0, 1.0);
            }
        }
        fits.then_some((input, count))
    }

    fn part(&mut self, part: &str, from: usize, input: &mut Input) -> Option<()> {
        let to = from + part.len();
        let world = &self.program.worlds[self.world];
        if let Some(drawn) = part.strip_prefix(NATURE) {
            return self.nature(drawn, from + NATURE.len(), input);
        }
        let (player, name) = match part.split_once(':') {
            Some((number, name)) => {
                let found = number.parse().ok().and_then(|n: u32| world.players.find(|p| p.number == n));
                if found.is_none() {
                    self.report(from, to, format!("no player `{number}` in `{}`", world.name), None);
                }
                (found?, name)
            }
            None => {
                let first = world.players.ids().min_by_key(|&p| world.players[p].number);
                if first.is_none() {
                    let help = Some("add `player 1: INSTANCE` to the world".into());
                    self.report(from, to, format!("`{}` has no player", world.name), help);
                }
                (first?, part)
            }
        };
        let (name, value) = match name.split_once('=') {
            Some((name, value)) => match value.parse::<f64>() {
                Ok(value) if (-1.0..=1.0).contains(&value) => (name, Some(value)),
                _ => {
                    let at = to - value.len();
                    self.report(at, to, format!("`{value}` is no value of an axis"), Some("-1 to 1".into()));
                    return None;
                }
            },
            None => (name, None),
        };
        if name.is_empty() {
            let help = "there is a name on both sides of `+`: `right+jump`".to_string();
            self.report(
                from.min(self.text.len().saturating_sub(1)),
                to.max(from + 1),
                "an input is missing".into(),
                Some(help),
            );
            return None;
        }
        match self.target(player, name, from, to)? {
            Target::Button(button) if value.is_none() => {
                self.player(input, player)?.buttons |= 1 << button.index();
            }
            Target::Axis(axis, direction) if value.is_some() != direction.is_some() => {
                self.player(input, player)?.axes[axis.index()] += value.or(direction).unwrap_or(0.0);
            }
            Target::Button(_) => {
                let why = format!("`{name}` is a button and takes no value");
                self.report(from, to, why, None);
                return None;
            }
            Target::Axis(_, Some(end)) => {
                let why = format!("`{name}` is a direction and takes no value");
                let axis = DIRECTIONS.iter().find(|(word, ..)| *word == name).map_or("", |(_, axis, _)| axis);
                self.report(from, to, why, Some(format!("write `{name}`, or `{axis}={}`", end / 2.0)));
                return None;
            }
            Target::Axis(..) => {
                let why = format!("`{name}` is an axis and needs one value");
                self.report(from, to, why, Some(format!("write `{name}=-1`, or any value to 1")));
                return None;
            }
        }
        Some(())
    }

    /// What nature draws: `hero.roll=3`, or `roll=3` if only one instance has that chance.
    fn nature(&mut self, part: &str, from: usize, input: &mut Input) -> Option<()> {
        let (world, to) = (&self.program.worlds[self.world], from + part.len());
        let Some((name, number)) = part.split_once('=') else {
            let help = Some(format!("write `{NATURE}{part}=1`"));
            self.report(from, to.max(from + 1), "what nature draws is a chance and its value".into(), help);
            return None;
        };
        let found = chance::named(self.program, world, name);
        let full = |slot| format!("{NATURE}{}.{name}={number}", &world.slots[slot].name);
        let (id, draw) = match found.as_slice() {
            [only] => *only,
            [] => {
                let all = chance::draws(self.program, world);
                let name_of = |draw: &chance::Draw| {
                    let slot = &world.slots[draw.slot];
                    format!("{}.{}", slot.name, self.program.entities[slot.entity].chances[draw.chance].name)
                };
                let known: Vec<String> = all.iter().map(name_of).collect();
                let near =
                    similar(name, known.iter().map(String::as_str)).map(|near| format!("did you mean `{near}`?"));
                let help = near.or_else(|| known.first().map(|first| format!("there is `{first}`")));
                let help = help.or_else(|| Some("no instance of this world has a `chance`".into()));
                self.report(from, from + name.len().max(1), format!("no chance `{name}` in `{}`", world.name), help);
                return None;
            }
            [(_, first), ..] => {
                let why = format!("{} instances have a chance `{name}`", found.len());
                self.report(from, from + name.len(), why, Some(format!("write `{}`", full(first.slot))));
                return None;
            }
        };
        let (low, high) = draw.range;
        match number.parse::<i32>() {
            Ok(value) if (low..=high).contains(&value) => input.1.set(id, Some(value)),
            _ => {
                let why = format!("`{number}` is nothing that `{name}` can be");
                self.report(to - number.len(), to.max(from + 1), why, Some(format!("{low} to {high}")));
                return None;
            }
        }
        Some(())
    }

    fn player<'i>(&self, input: &'i mut Input, player: PlayerId) -> Option<&'i mut PlayerInput> {
        input.0.get_mut(player.index())
    }

    fn target(&mut self, player: PlayerId, name: &str, from: usize, to: usize) -> Option<Target> {
        let world = &self.program.worlds[self.world];
        let entity: &Entity = &self.program.entities[world.slots[world.players[player].slot].entity];
        if let Some(button) = entity.button_named(name) {
            return Some(Target::Button(button));
        }
        if let Some(axis) = entity.axis_named(name) {
            return Some(Target::Axis(axis, None));
        }
        if let Some((_, axis, value)) = DIRECTIONS.iter().find(|(word, ..)| *word == name)
            && let Some(axis) = entity.axis_named(axis)
        {
            return Some(Target::Axis(axis, Some(*value)));
        }
        let words = DIRECTIONS.iter().filter(|(_, axis, _)| entity.axis_named(axis).is_some()).map(|(word, ..)| *word);
        let known: Vec<&str> = entity.buttons.iter().map(String::as_str).chain(words).collect();
        let axes = || entity.axes.iter().map(String::as_str);
        let near = similar(name, known.iter().copied().chain(axes()));
        let why = format!("`{}` reads no button or axis `{name}`", entity.name);
        let all = known.iter().map(|known| format!("`{known}`")).chain(axes().map(|axis| format!("`{axis}=0.5`")));
        let all: Vec<String> = all.collect();
        let all = (!all.is_empty()).then(|| format!("it reads {}", all.join(", ")));
        let help = match (near, all) {
            (Some(near), Some(all)) => Some(format!("did you mean `{near}`? {all}")),
            (_, all) => all.or_else(|| Some("it declares no `button` and no `axis`".into())),
        };
        self.report(from, to, why, help);
        None
    }
}
