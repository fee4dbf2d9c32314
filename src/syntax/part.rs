//! The parts that blocks are made of: by which rule each is read, what of a pair is of interest, and what a part that fits
//! no rule would have declared.

use std::collections::BTreeSet;

use pest::iterators::Pair;

use super::Rule;
use super::ast::{Item, Member, Update, WorldItem};
use super::build::Builder;

/// What came of a part of a block: nothing if it opens a block that does not end, else what was built of it and where it
/// ends.
pub(super) type Part<T> = Option<(Option<T>, usize)>;

/// How the parts of a block are read: by which rule, by which one if what a part opens does not end, and what is built.
pub(super) struct Parts<T> {
    pub next: Rule,
    pub plain: Rule,
    pub build: fn(&mut Builder<'_>, &Pair<'_, Rule>, usize) -> Part<T>,
}

/// How what is in a file is read.
pub(super) const ITEMS: Parts<Item> =
    Parts { next: Rule::next_item, plain: Rule::plain_item, build: |b, pair, end| b.item(pair, end) };
/// How what is in entities, behaviours, groups and modes is read.
pub(super) const MEMBERS: Parts<Member> =
    Parts { next: Rule::next_member, plain: Rule::plain_member, build: |b, pair, end| b.part(pair, end) };
/// How what is in worlds is read.
pub(super) const WORLD_ITEMS: Parts<WorldItem> =
    Parts { next: Rule::next_world_item, plain: Rule::plain_world_item, build: |b, pair, end| b.world_part(pair, end) };
/// How updates are read.
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

/// The inner pairs without punctuation and introducing words.
pub(super) fn parts<'i>(pair: &Pair<'i, Rule>) -> Vec<Pair<'i, Rule>> {
    each(pair).collect()
}

/// The same one by one, for lists that may be as long as a file.
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
            | R::word_initial
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
            | R::word_x
            | R::word_space
            | R::word_player
            | R::word_goal
            | R::word_never
            | R::word_map
            | R::word_place
            | R::word_at
            | R::word_rect
            | R::word_bounds
            | R::word_any
            | R::word_touching
    )
}

/// Notes the names that a broken declaration would have introduced: the words after a declaring word, or after a first word
/// that opens nothing and may be a slip.
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
    ];
    const OTHER: &[&str] = &["when", "envelope", "import", "step", "collide", "player", "kinematic", "initial", "use"];
    let mut declaring = false;
    let is_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut first = true;
    for token in slice.split(|c: char| !is_word(c) && c != ',').filter(|t| !t.is_empty()) {
        let list_goes_on = token.ends_with(',');
        for word in token.split(',').filter(|w| !w.is_empty()) {
            let slip = first && !OTHER.contains(&word) && !DECLARING.contains(&word);
            let declares = DECLARING.contains(&word) || slip;
            // `speed 100`, its `param` forgotten, declares its first word.
            if slip || (declaring && !declares) {
                names.insert(word.to_string());
            }
            declaring = declares || (declaring && list_goes_on);
            first = false;
        }
    }
}
