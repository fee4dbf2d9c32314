//! The order of completion items: what the place asks for first. Statements come in their usual order, names by their
//! dimension and by whether they are still unused, operands by how often they begin a condition.

mod dimension;

use std::collections::{BTreeMap, BTreeSet};

use crate::sema::checked::Entity;

use dimension::hint;

use super::completion_items::{CompletionCollector, CompletionItem, CompletionKind};
use crate::lsp::text::cursor::{Block, CursorContext};
use crate::lsp::text::lexer::{Kind, tokens};
use crate::lsp::text::words::usual_order;

/// The position of an item: lower is better. First a class, then a place in it.
type Key = (usize, usize);

/// The detail of a name that is used and not declared yet.
pub(super) const UNDECLARED: &str = "not declared yet";

/// Words that begin a condition, the most frequent first.
const CONDITIONS: &[&str] =
    &["touching", "timer", "not", "in", "pressed", "y", "x", "entering", "held", "received", "near", "any", "lost"];

/// Functions in values, the most frequent first.
const VALUES: &[&str] = &["if", "min", "max", "clamp", "abs", "sin", "cos", "sign", "floor", "mod"];

/// Sorts items: each gets its place as its rank.
pub(super) fn ordered(
    of: &CompletionCollector<'_>,
    cursor: &CursorContext<'_>,
    own: Option<&Entity>,
    items: Vec<CompletionItem>,
) -> Vec<CompletionItem> {
    let order = Order::new(of, cursor, own);
    let mut keyed: Vec<(Key, CompletionItem)> = items.into_iter().map(|item| (order.key(&item), item)).collect();
    keyed.sort();
    // Of a keyword and a function with one name the better is shown.
    let mut seen = BTreeSet::new();
    keyed.retain(|(_, item)| item.kind == CompletionKind::Snippet || seen.insert(item.label.clone()));
    let rank = |(place, (_, mut item)): (usize, (Key, CompletionItem))| {
        item.rank = u8::try_from(place).unwrap_or(u8::MAX);
        item
    };
    keyed.into_iter().enumerate().map(rank).collect()
}

/// Where a name occurs before the cursor.
#[derive(Default)]
struct Uses {
    /// How often, without its declaration.
    count: usize,
    /// The index of the last occurrence among the words.
    last: usize,
    /// The index of the first one.
    first: usize,
    /// The words before its occurrences, and the two words before them.
    after: Vec<String>,
    after_both: Vec<String>,
}

struct Order<'a> {
    cursor: &'a CursorContext<'a>,
    own: Option<&'a Entity>,
    of: &'a CompletionCollector<'a>,
    uses: BTreeMap<String, Uses>,
    words: usize,
    /// The first word of the statement before, in the same block.
    statement_before: String,
    /// The first word of the guard before, in the same block.
    guard_before: String,
    /// Number of assignments in the same block.
    flows: usize,
    /// The dimension of what is written at the cursor.
    wanted: Option<String>,
}

/// Words before a name that is declared there.
const DECLARING: &[&str] =
    &["param", "button", "axis", "mode", "continuous", "discrete", "chance", "condition", "signal", "ref", "place"];

impl<'a> Order<'a> {
    fn new(of: &'a CompletionCollector<'a>, cursor: &'a CursorContext<'a>, own: Option<&'a Entity>) -> Self {
        let mut order = Order {
            cursor,
            own,
            of,
            uses: BTreeMap::new(),
            words: 0,
            statement_before: String::new(),
            guard_before: String::new(),
            flows: 0,
            wanted: None,
        };
        order.read(of.code.get(..cursor.word.start).unwrap_or_default());
        order.wanted = order.wanted_dimension();
        order
    }

    /// Reads the words before the cursor: of the item around it.
    fn read(&mut self, before: &str) {
        let start = self.cursor.blocks.first().map_or(0, |block| block.start);
        let text = before.get(start..).unwrap_or_default();
        let (mut before_last, mut last_word) = ("", "");
        let mut at_start = true;
        let mut is_list = false;
        // Of each open block: the first word of the last statement, that of the last guard, the number of assignments.
        let mut open: Vec<(&str, &str, usize)> = vec![("", "", 0)];
        for token in tokens(text) {
            let word = token.text(text);
            match token.kind {
                Kind::Newline => {
                    (at_start, is_list) = (true, false);
                    continue;
                }
                Kind::Comment => continue,
                Kind::Symbol if word == "{" => {
                    open.push(("", "", 0));
                    at_start = true;
                }
                Kind::Symbol if word == "}" => {
                    open.pop();
                    at_start = true;
                }
                Kind::Symbol if word == ";" => at_start = true,
                Kind::Word => {
                    if let Some((first, guard, _)) = open.last_mut() {
                        if at_start {
                            *first = word;
                        } else if last_word == "when" && *first == "when" {
                            *guard = word;
                        }
                    }
                    is_list |= at_start && matches!(word, "button" | "axis");
                    at_start = false;
                    self.words += 1;
                    let declares = DECLARING.contains(&last_word) || is_list;
                    let uses = self.uses.entry(word.to_string()).or_default();
                    if uses.first == 0 {
                        uses.first = self.words;
                    }
                    uses.count += usize::from(!declares);
                    uses.last = self.words;
                    uses.after.push(last_word.to_string());
                    uses.after_both.push(format!("{before_last} {last_word}"));
                }
                _ => {
                    if word == "="
                        && let Some((first, _, flows)) = open.last_mut()
                    {
                        *flows += usize::from(!DECLARING.contains(first));
                    }
                    at_start = false;
                }
            }
            (before_last, last_word) = (last_word, word);
        }
        let (first, guard, flows) = open.last().copied().unwrap_or_default();
        (self.statement_before, self.guard_before, self.flows) = (first.to_string(), guard.to_string(), flows);
    }

    fn is_unused(&self, name: &str) -> bool {
        self.uses.get(name).is_none_or(|uses| uses.count == 0)
    }

    /// Unused names in the order of their declaration, then the others, the last used first.
    fn by_use(&self, name: &str) -> usize {
        match self.uses.get(name) {
            Some(uses) if uses.count == 0 => uses.first,
            Some(uses) => 10_000 + self.words.saturating_sub(uses.last),
            None => 30_000,
        }
    }

    /// The names that were used last first.
    fn by_recency(&self, name: &str) -> usize {
        self.uses.get(name).map_or(30_000, |uses| self.words.saturating_sub(uses.last))
    }

    fn key(&self, item: &CompletionItem) -> Key {
        let label = item.label.as_str();
        let first = self.cursor.statement.first().copied().unwrap_or_default();
        let last = self.cursor.previous(1);
        if item.is_import() {
            return (6_000, 0);
        }
        if item.detail == UNDECLARED {
            return (5_000, self.by_recency(label));
        }
        if let Some(call) = self.cursor.calls.last() {
            match call.name {
                "pressed" | "held" | "released" => return (0, self.by_use(label)),
                "touching" => return self.touching(item, call.argument),
                _ => {}
            }
        }
        if self.cursor.statement.is_empty() {
            return self.statement(item);
        }
        match last {
            "->" => return self.target(label),
            "mode" => return (0, self.uses.get(label).map_or(0, |uses| uses.first)),
            "." => return (0, self.by_recency(label)),
            "in" if first != "clamp" => {
                let is_other = self.cursor.enclosing(Block::Mode).is_none_or(|block| block.name != label);
                return (usize::from(!is_other), self.by_recency(label));
            }
            _ => {}
        }
        if matches!(first, "collide" | "collider" | "kinematic" | "rect" | "look") && item.kind == CompletionKind::Value
        {
            return self.tag(label, first);
        }
        let fixed: &[&str] = match last {
            "clamp" => &["y", "x"],
            "envelope" | "(" if first == "envelope" => &["x", "y"],
            "," if first == "envelope" && !self.cursor.statement.contains(&"by") => &["y", "x"],
            ":" if matches!(first, "collider" | "kinematic") => &["rect"],
            "attack" | "decay" | "release" => &["accel", "instant", "over", "hold"],
            _ => &[],
        };
        if first == "envelope" && item.detail == "axis" {
            return (0, self.by_use(label));
        }
        if let Some(at) = fixed.iter().position(|known| *known == label) {
            return (0, at);
        }
        if matches!(item.kind, CompletionKind::Value | CompletionKind::Property) {
            return (0, self.given(item));
        }
        if self.is_condition() { self.condition(item) } else { self.value(item) }
    }

    /// The order in which items were collected.
    fn given(&self, item: &CompletionItem) -> usize {
        self.of.list.iter().position(|other| other == item).unwrap_or(usize::MAX)
    }

    /// Statements in their usual order, after the one before.
    fn statement(&self, item: &CompletionItem) -> Key {
        let block = self.cursor.block();
        let word = item.label.split(' ').next().unwrap_or_default();
        let order = usual_order(block);
        let place = |word: &str| order.iter().position(|known| *known == word);
        let is_name =
            matches!(item.kind, CompletionKind::Variable | CompletionKind::Constant | CompletionKind::Property);
        if block == Some(Block::Updates) {
            let guard = self.cursor.blocks.last().map_or(0, |block| block.start);
            let in_guard = self.of.code.get(guard..self.cursor.word.start).is_some_and(|text| is_word_of(text, word));
            return match is_name {
                true if in_guard && self.uses.contains_key(word) => (0, self.by_recency(word)),
                true if self.assigned(word) > 0 => (1, self.by_recency(word)),
                // Without a target something happens to the instance.
                false if word == "destroy" && !self.has_target() => (2, 0),
                true => (3, if word == "y" { 0 } else { 1 + self.by_recency(word) }),
                false => (4, self.given(item)),
            };
        }
        if is_name {
            // `mode falling { y'' = gravity }`
            let begins = block == Some(Block::Mode) && self.statement_before.is_empty() && self.cursor.word.is_empty();
            return (if begins && word == "y" { 0 } else { 5 }, self.by_recency(word));
        }
        // A snippet comes before its keyword.
        let is_snippet = usize::from(item.kind != CompletionKind::Snippet);
        let (Some(at), from) = (place(word), place(&self.statement_before).unwrap_or(0)) else {
            return (40, self.given(item));
        };
        let class = if word == "else" && self.statement_before != "when" { 3 } else { 0 };
        // What comes before the last statement in the usual order is less likely.
        let is_rare = matches!(
            word,
            "look"
                | "ref"
                | "continuous"
                | "chance"
                | "signal"
                | "kinematic"
                | "invariant"
                | "use"
                | "envelope"
                | "follow"
                | "spawn"
        );
        let distance = if at >= from { at - from } else { order.len() + at };
        let distance = distance + if is_rare && self.statement_before != word { order.len() } else { 0 };
        (class, distance * 2 + is_snippet)
    }

    /// Whether the edge around leads to a mode.
    fn has_target(&self) -> bool {
        let start = self.cursor.blocks.last().map_or(0, |block| block.start);
        self.of.code.get(start..self.cursor.word.start).is_some_and(|text| text.contains("->"))
    }

    /// How often a name was assigned on edges.
    fn assigned(&self, name: &str) -> usize {
        self.uses.get(name).map_or(0, |uses| uses.after.iter().filter(|word| *word == "{").count())
    }

    /// The target of an edge: modes that no edge leads to, then the others; the mode itself last.
    fn target(&self, label: &str) -> Key {
        let name = label.rsplit('.').next().unwrap_or(label);
        let own = self.cursor.enclosing(Block::Mode).map_or("", |block| block.name);
        let is_target = self.uses.get(name).is_some_and(|uses| uses.after.iter().any(|word| word == "->"));
        let outer = self.cursor.blocks.iter().any(|block| block.block == Block::Mode && block.name == name);
        match () {
            () if name == own || name == "always" => (3, 0),
            () if outer => (2, 0),
            () if !is_target => (0, self.by_recency(name)),
            () => (1, self.by_recency(name)),
        }
    }

    fn own_tags(&self) -> Vec<&str> {
        let own = self.own.into_iter().flat_map(|e| e.colliders.iter().flat_map(|c| c.tags.iter()));
        let names =
            own.filter_map(|tag| self.of.checked().find_map(|checked| checked.tags.get(*tag)).map(|name| &*name.text));
        names.collect()
    }

    fn touching(&self, item: &CompletionItem, argument: usize) -> Key {
        let label = item.label.as_str();
        let is_side = item.detail == "side";
        let own = self.own_tags().iter().position(|tag| *tag == label);
        let is_declared = self.uses.get(label).is_some_and(|uses| uses.after.iter().any(|w| w == "collider"));
        match (argument, own) {
            _ if is_side => (if argument == 2 { 0 } else { 3 }, side(label)),
            (0, Some(own)) => match self.uses.get(label).filter(|uses| uses.after.iter().any(|word| word == "(")) {
                Some(uses) => (0, self.words.saturating_sub(uses.last)),
                None => (1, own),
            },
            (0, None) => (1 + usize::from(!is_declared), self.by_recency(label)),
            (_, Some(_)) => (2, self.by_recency(label)),
            (_, None) if is_declared => (2, self.by_recency(label)),
            (_, None) => (1, self.by_recency(label)),
        }
    }

    /// Tags in `collide` lines and colliders: before `with` those of colliders, after it those that are asked for.
    fn tag(&self, label: &str, first: &str) -> Key {
        let code = self.of.code.get(..self.cursor.word.start).unwrap_or_default();
        let is_after_with = self.cursor.statement.contains(&"with");
        let lines = code.lines().filter(|line| line.trim_start().starts_with("collide"));
        let is_paired = lines.filter(|line| line.split("with").nth(1).is_some_and(|rest| is_word_of(rest, label)));
        let pairs = is_paired.count();
        let of_collider = |line: &str| {
            let line = line.trim_start();
            let line = line.strip_prefix("kinematic ").unwrap_or(line);
            line.starts_with("collider") && is_word_of(line.split(':').next().unwrap_or(line), label)
        };
        let is_of_collider = code.lines().any(of_collider);
        let last = code.rmatch_indices(label).next().map_or(usize::MAX, |(at, _)| code.len() - at);
        let first_at = code.find(label).unwrap_or(usize::MAX);
        match (first, is_after_with) {
            ("collide", true) => (pairs.min(1) + usize::from(is_of_collider), first_at),
            ("collide", false) => (usize::from(!is_of_collider), last),
            ("rect", _) => (usize::from(is_of_collider), first_at),
            _ => (0, last),
        }
    }

    /// Whether a condition is written at the cursor, and an operand of it begins.
    fn is_condition(&self) -> bool {
        let last = self.cursor.previous(1);
        let first = self.cursor.statement.first().copied().unwrap_or_default();
        let in_if = self.cursor.calls.last().is_some_and(|call| call.name == "if" && call.argument == 0);
        matches!(last, "when" | "and" | "or" | "not" | "invariant" | "while")
            || first == "condition" && last == "="
            || matches!(first, "goal" | "never") && last == ":"
            || matches!(last, "expect" | "reachable" | "unreachable")
            || in_if && last == "("
    }

    fn condition(&self, item: &CompletionItem) -> Key {
        let label = item.label.as_str();
        let in_world = self.cursor.enclosing(Block::World).is_some();
        if in_world {
            return match item.kind {
                CompletionKind::Instance => (0, self.by_recency(label)),
                CompletionKind::Variable | CompletionKind::Function if item.detail == "condition" => (1, 0),
                CompletionKind::Function => (if matches!(item.detail.as_str(), "goal" | "never") { 0 } else { 2 }, 0),
                _ => (3, self.given(item)),
            };
        }
        let last = self.cursor.previous(1);
        (1_000 - self.points(item, last).clamp(0, 999) as usize, self.by_use(label))
    }

    /// How likely an item begins an operand of a condition in an entity: what the entity has, what it asked before, and
    /// how often a word does.
    fn points(&self, item: &CompletionItem, last: &str) -> i32 {
        let label = item.label.as_str();
        let own = self.own;
        let has_buttons = own.is_some_and(|e| !e.buttons.is_empty());
        let unused_button = own.is_some_and(|e| e.buttons.iter().any(|b| self.is_unused(&b.text)));
        let has_tags = !self.own_tags().is_empty() || self.uses.contains_key("collider");
        let groups = own.map_or(0, |e| e.groups.len());
        let is_collider = matches!(self.cursor.statement.first(), Some(&"collider" | &"kinematic"));
        let is_edge = self.cursor.statement.len() == 1 && last == "when";
        let usual = match label {
            _ if item.detail == "condition" => {
                if self.is_unused(label) {
                    350
                } else {
                    120
                }
            }
            "touching" if has_tags => 300,
            "timer" => 200,
            "not" => 150,
            "pressed" if has_buttons => {
                if unused_button {
                    250
                } else {
                    150
                }
            }
            "in" => {
                if groups > 1 {
                    130
                } else {
                    100
                }
            }
            "y" | "x" => {
                if label == "y" {
                    100
                } else {
                    80
                }
            }
            "held" if has_buttons => 80,
            "entering" if groups > 1 => 60,
            "received" if own.is_some_and(|e| !e.signals.is_empty()) => 80,
            "touching" | "pressed" | "held" | "released" | "entering" | "exiting" | "received" => 0,
            _ if item.detail == "axis" => 110,
            _ if matches!(item.kind, CompletionKind::Variable | CompletionKind::Input) => 60,
            "near" | "any" | "lost" => 40,
            _ => 10,
        };
        let here = match (last, label) {
            _ if is_collider && matches!(label, "in" | "not") => 300,
            ("not", "not" | "timer" | "true" | "false" | "pressed") => -400,
            ("not", "held") if has_buttons => 180,
            ("and", "not") => 150,
            ("and", "touching") => -150,
            ("or", _) if self.asked_before(label) => 300,
            _ if is_edge && self.follows(label, unused_button) => 150,
            _ => 0,
        };
        let times = self.uses.get(label).map_or(0, |uses| uses.after.iter().filter(|word| *word == last).count());
        usual + here + 100 * times.min(4) as i32
    }

    /// Whether the condition asks with this word already.
    fn asked_before(&self, label: &str) -> bool {
        self.cursor.statement.iter().rev().skip(1).find(|word| CONDITIONS.contains(*word)) == Some(&label)
    }

    /// Whether a word begins the guard that most often follows those before it in the mode.
    fn follows(&self, label: &str, unused_button: bool) -> bool {
        let has_buttons = self.own.is_some_and(|e| !e.buttons.is_empty());
        let is_first = !self.uses.contains_key("->");
        let likely = match (self.guard_before.as_str(), self.flows) {
            ("", _) if is_first && unused_button => "pressed",
            ("", 2..) => "timer",
            ("not" | "entering", _) if has_buttons => "pressed",
            ("pressed", _) => "not",
            _ => "touching",
        };
        let has_tags = !self.own_tags().is_empty();
        label == likely && (likely != "touching" || has_tags)
    }

    fn value(&self, item: &CompletionItem) -> Key {
        let label = item.label.as_str();
        let is_name = matches!(
            item.kind,
            CompletionKind::Variable | CompletionKind::Constant | CompletionKind::Input | CompletionKind::Instance
        );
        if is_name {
            let dimension = self.dimension(label);
            let (wanted, hint) = (self.wanted.as_deref(), hint(label));
            let class = match (wanted, dimension.as_deref().or(hint)) {
                (Some(wanted), Some(known)) if wanted == known => 0,
                (Some("px"), Some(_)) if matches!(label, "x" | "y") => 0,
                (_, None) if self.is_unused(label) => 1,
                (None, _) => 1,
                (Some(_), None) => 2,
                (Some(_), Some("1")) => 3,
                (Some(_), Some(_)) => 30,
            };
            // A variable is rarely its own value.
            let is_assigned = self.cursor.statement.first() == Some(&label);
            let is_known = item.detail.ends_with("unless the program declares it");
            let is_angle = self.cursor.calls.last().is_some_and(|call| matches!(call.name, "sin" | "cos"));
            let class = match () {
                () if is_known => 20,
                () if item.detail == "axis" && self.cursor.previous(1) == "*" => 0,
                () if is_angle && item.kind != CompletionKind::Variable => class + 2,
                () => class + 3 * usize::from(is_assigned),
            };
            // What was written in such a place before.
            let place = format!("{} {}", self.cursor.previous(2), self.cursor.previous(1));
            let again = self.uses.get(label).is_some_and(|uses| uses.after_both.contains(&place));
            return (class, if again && class < 3 { 0 } else { self.by_use(label) });
        }
        let place = VALUES.iter().position(|word| *word == label).unwrap_or(VALUES.len());
        let wanted = self.wanted.as_deref();
        match item.kind {
            CompletionKind::Function if wanted == Some("1") && matches!(label, "min" | "max") => (1, place),
            CompletionKind::Function => (10, place),
            CompletionKind::Keyword => (11, self.given(item)),
            _ => (8, self.given(item)),
        }
    }
}

/// The sides, the most asked for first.
fn side(label: &str) -> usize {
    ["below", "left", "right", "above"].iter().position(|known| *known == label).unwrap_or(4)
}

/// Whether a text has a word.
fn is_word_of(text: &str, word: &str) -> bool {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|other| other == word)
}
