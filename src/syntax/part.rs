//! The parts of blocks: the rule of each, its relevant inner pairs, and the names that a broken part may have declared.

use std::collections::BTreeSet;

use pest::iterators::Pair;

use super::Rule;
use super::ast::{Item, Member, Update, WorldItem};
use super::build::Builder;

/// The result of a part: `None` if it opens a block that does not end, else the built value and the end.
pub(super) type Part<T> = Option<(Option<T>, usize)>;

/// How the parts of a block are parsed: the rule, the fallback rule for a part whose block does not end, and the
/// builder.
pub(super) struct Parts<T> {
    pub next: Rule,
    pub plain: Rule,
    pub build: fn(&mut Builder<'_>, &Pair<'_, Rule>, usize) -> Part<T>,
}

/// The parts of files.
pub(super) const ITEMS: Parts<Item> =
    Parts { next: Rule::next_item, plain: Rule::plain_item, build: |b, pair, end| b.item(pair, end) };
/// The parts of entities, behaviours, groups and modes.
pub(super) const MEMBERS: Parts<Member> =
    Parts { next: Rule::next_member, plain: Rule::plain_member, build: |b, pair, end| b.part(pair, end) };
/// The parts of worlds.
pub(super) const WORLD_ITEMS: Parts<WorldItem> =
    Parts { next: Rule::next_world_item, plain: Rule::plain_world_item, build: |b, pair, end| b.world_part(pair, end) };
/// The parts of update blocks.
pub(super) const UPDATES: Parts<Update> = Parts {
    next: Rule::next_update,
    plain: Rule::next_update,
    build: |b, pair, end| {
        let update = if pair.as_rule() == Rule::bad_update {
            b.bad(Rule::only_update, pair);
            None
        } else {
            b.update(pair)
        };
        Some((update, end))
    },
};

/// The inner pairs without punctuation and keywords.
pub(super) fn parts<'i>(pair: &Pair<'i, Rule>) -> Vec<Pair<'i, Rule>> {
    each(pair).collect()
}

/// The same as an iterator, for lists that may be as long as a file.
pub(super) fn each<'i>(pair: &Pair<'i, Rule>) -> impl Iterator<Item = Pair<'i, Rule>> + use<'i> {
    pair.clone().into_inner().filter(|p| !is_punctuation(p.as_rule()))
}

fn is_punctuation(rule: Rule) -> bool {
    use Rule as R;
    matches!(
        rule,
        R::end
            | R::EOI
            | R::open_brace
            | R::close_brace
            | R::open_paren
            | R::close_paren
            | R::comma
            | R::colon
            | R::arrow
            | R::dot
            | R::range
            | R::caret
            | R::kw_import
            | R::kw_const
            | R::kw_entity
            | R::kw_world
            | R::kw_param
            | R::kw_continuous
            | R::kw_discrete
            | R::kw_button
            | R::kw_axis
            | R::kw_collider
            | R::kw_group
            | R::kw_mode
            | R::kw_when
            | R::kw_envelope
            | R::kw_as
            | R::kw_behavior
            | R::kw_ref
            | R::kw_clamp
            | R::kw_invariant
            | R::kw_use
            | R::kw_spawn
            | R::kw_destroy
            | R::word_follow
            | R::word_links
            | R::word_decay
            | R::word_limit
            | R::word_link
            | R::word_vglc
            | R::word_level
            | R::word_tiled
            | R::word_ldtk
            | R::word_legend
            | R::word_tile
            | R::word_from
            | R::word_int
            | R::word_always
            | R::word_initial
            | R::word_bounce
            | R::word_by
            | R::word_directions
            | R::word_attack
            | R::word_sustain
            | R::word_for
            | R::word_release
            | R::word_while
            | R::word_accel
            | R::word_over
            | R::word_to
            | R::word_step
            | R::word_collide
            | R::word_with
            | R::word_tiles
            | R::dash
            | R::word_slope
            | R::word_breakable
            | R::word_restore
            | R::word_after
            | R::word_x
            | R::word_space
            | R::word_player
            | R::word_goal
            | R::word_condition
            | R::word_signal
            | R::word_send
            | R::word_chance
            | R::word_look
            | R::word_never
            | R::word_map
            | R::word_place
            | R::word_at
            | R::word_rect
            | R::word_bounds
            | R::word_wrap
            | R::word_any
            | R::word_all
            | R::word_touching
            | R::word_nearest
            | R::word_within
            | R::word_test
            | R::word_inputs
            | R::word_seed
            | R::word_expect
            | R::word_without
    )
}

/// Collects the names that a broken declaration may have declared: the words after a declaring keyword, or after a
/// first word that may be a misspelt keyword.
pub(super) fn note_declared(slice: &str, names: &mut BTreeSet<String>) {
    const DECLARING: &[&str] = &[
        "param",
        "continuous",
        "discrete",
        "ref",
        "button",
        "axis",
        "collider",
        "group",
        "mode",
        "entity",
        "behavior",
        "world",
        "const",
        "space",
        "tiles",
        "place",
        "goal",
        "never",
        "map",
        "condition",
        "signal",
        "chance",
    ];
    const OTHER: &[&str] = &[
        "when",
        "else",
        "envelope",
        "import",
        "step",
        "collide",
        "player",
        "kinematic",
        "initial",
        "use",
        "look",
        "test",
        "inputs",
        "expect",
        "reachable",
        "unreachable",
        "unfound",
    ];
    let mut declaring = false;
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut first = true;
    let is_place = slice.starts_with("place ");
    for token in slice.split(|c: char| !is_word(c) && c != ',').filter(|t| !t.is_empty()) {
        let list_goes_on = token.ends_with(',');
        for word in token.split(',').filter(|w| !w.is_empty()) {
            let may_be_typo = first && !OTHER.contains(&word) && !DECLARING.contains(&word);
            let declares = DECLARING.contains(&word) || may_be_typo;
            // `speed 100` without `param` declares its first word.
            if may_be_typo || (declaring && !declares) {
                names.insert(word.to_string());
            }
            // `place Slime at …` leaves out the name, which is usually that of the entity.
            if is_place && declaring && word.starts_with(char::is_uppercase) {
                names.insert(word.to_lowercase());
            }
            declaring = declares || (declaring && list_goes_on);
            first = false;
        }
    }
}

/// What stands for any character of a map among poisoned names.
pub(crate) const ANY_SYMBOL: &str = "'";

/// A character of a map as a poisoned name.
pub(crate) fn symbol_name(symbol: char) -> String {
    format!("'{symbol}'")
}

/// Collects what a broken tile may have declared: its character, or any one if there is none, and tags and instances.
pub(super) fn note_tile(slice: &str, names: &mut BTreeSet<String>) {
    let slice = slice.trim_start();
    let (first, rest) = match slice.strip_prefix(['\'', '"']) {
        Some(inner) => inner.split_once(['\'', '"']).or_else(|| inner.split_once(':')),
        None => slice.split_once(':'),
    }
    .unwrap_or(("", slice));
    let is_symbol = |c: &char| !c.is_whitespace();
    match first.chars().any(|c| is_symbol(&c)) {
        true => names.extend(first.chars().filter(is_symbol).map(symbol_name)),
        // A blank between quotes is a character, too.
        false => drop(names.insert(ANY_SYMBOL.to_string())),
    }
    // Another tile in the same statement.
    let characters: Vec<char> = rest.chars().collect();
    let quoted = characters.windows(3).filter(|three| three[0] == '\'' && three[2] == '\'');
    names.extend(quoted.map(|three| symbol_name(three[1])));
    let words = rest.split(|c: char| !c.is_alphanumeric() && c != '_').filter(|word| !word.is_empty());
    names.extend(words.map(str::to_string));
}
