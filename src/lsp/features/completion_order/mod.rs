//! The order of completion items: what the place asks for first. In entities and behaviours, items are ordered by the
//! weights of their evidence; in worlds, by the usual order of statements and by use.

mod dimension;
mod evidence;
mod matches;
mod reading;
mod usual;
mod weights;

use std::collections::BTreeSet;

use crate::ordered::Ordered;
use crate::sema::checked::Entity;

use super::completion_items::{CompletionCollector, CompletionItem, CompletionKind};
use crate::lsp::text::cursor::{Block, CursorContext};

use dimension::Dimensions;
use evidence::{Candidate, Evidence};
use reading::{Reading, UNKNOWN};
use usual::UsualOrder;

/// The detail of a name that is used and not declared yet.
pub(super) const UNDECLARED: &str = "not declared yet";

/// The probability from which one of the first items is likely.
const LIKELY: f32 = 0.8;

/// The number of items that are seen at a glance.
const AT_A_GLANCE: usize = 3;

/// Sorts items: each gets its place as its rank. With them, whether one of the first is likely; where nothing is known
/// about that, it is taken to be.
pub(super) fn ordered(
    of: &CompletionCollector<'_>,
    cursor: &CursorContext<'_>,
    own: Option<&Entity>,
    items: Vec<CompletionItem>,
) -> (Vec<CompletionItem>, bool) {
    let (mut sorted, is_likely) = match text_of_entity(of, cursor) {
        Some(text) => by_evidence(text, &Dimensions { of, cursor, own }, items),
        None => {
            let order = UsualOrder::new(of, cursor);
            let mut keyed: Vec<_> = items.into_iter().map(|item| (order.key(&item), item)).collect();
            keyed.order_by(Ord::cmp);
            (keyed.into_iter().map(|(_, item)| item).collect::<Vec<_>>(), true)
        }
    };
    // Of a keyword and a function with one name the better is shown.
    let mut seen = BTreeSet::new();
    sorted.retain(|item| item.kind == CompletionKind::Snippet || seen.insert(item.label.clone()));
    for (place, item) in sorted.iter_mut().enumerate() {
        item.rank = u8::try_from(place).unwrap_or(u8::MAX);
    }
    (sorted, is_likely)
}

/// The items in an entity or a behaviour whose text up to the cursor is given, and whether one of the first is likely.
fn by_evidence(text: &str, dimensions: &Dimensions<'_>, items: Vec<CompletionItem>) -> (Vec<CompletionItem>, bool) {
    let evidence = Evidence::new(text, dimensions.wanted_dimension());
    let snippets: BTreeSet<String> =
        items.iter().filter(|item| item.kind == CompletionKind::Snippet).map(|item| word(item).to_string()).collect();
    let mut scored: Vec<(bool, bool, f32, usize, CompletionItem)> = Vec::new();
    for (place, item) in items.into_iter().enumerate() {
        // With a snippet, its keyword says nothing new: it comes after all others.
        let is_twin = item.kind == CompletionKind::Keyword && snippets.contains(&item.label);
        let mut score = 0.0;
        features(&evidence, dimensions, &item, &mut |name, value| score += weights::weight(name) * value);
        scored.push((item.is_import(), is_twin, score, place, item));
    }
    scored.order_by(|a, b| {
        (a.0, a.1).cmp(&(b.0, b.1)).then(b.2.total_cmp(&a.2)).then(a.4.rank.cmp(&b.4.rank)).then(a.3.cmp(&b.3))
    });
    let scores: Vec<f32> = scored.iter().filter(|of| !of.0 && !of.1).map(|of| of.2).collect();
    (scored.into_iter().map(|(.., item)| item).collect(), among_first(&scores) >= LIKELY)
}

/// The probability that one of the first items is wanted, given the scores of all from the highest to the lowest: the
/// weights are those of a logistic regression over the items of a list.
fn among_first(scores: &[f32]) -> f32 {
    let Some(most) = scores.first() else { return 0.0 };
    let likely = |scores: &[f32]| scores.iter().map(|score| (score - most).exp()).sum::<f32>();
    likely(&scores[..scores.len().min(AT_A_GLANCE)]) / likely(scores)
}

/// The names of items in an entity or a behaviour, and their features.
#[cfg(feature = "testing")]
pub(super) fn named_features(
    of: &CompletionCollector<'_>,
    cursor: &CursorContext<'_>,
    own: Option<&Entity>,
    items: &[CompletionItem],
) -> Vec<(String, Vec<(String, f32)>)> {
    let Some(text) = text_of_entity(of, cursor) else { return Vec::new() };
    let dimensions = Dimensions { of, cursor, own };
    let evidence = Evidence::new(text, dimensions.wanted_dimension());
    let named = items.iter().map(|item| {
        let mut all = Vec::new();
        features(&evidence, &dimensions, item, &mut |name, value| all.push((name.join(" "), value)));
        (item.label.clone(), all)
    });
    named.collect()
}

/// The text up to the cursor of the entity or behaviour around it.
fn text_of_entity<'c>(of: &'c CompletionCollector<'_>, cursor: &CursorContext<'_>) -> Option<&'c str> {
    let item = cursor.blocks.first().filter(|item| matches!(item.block, Block::Entity | Block::Behavior))?;
    of.code.get(item.start..cursor.word.start)
}

/// Tells the features of an item.
fn features(evidence: &Evidence<'_>, dimensions: &Dimensions<'_>, item: &CompletionItem, take: evidence::Take<'_>) {
    let class = class(&evidence.reading, item);
    let is_name = class.starts_with('#') || matches!(class, "x" | "y");
    let dimension = if is_name { dimensions.dimension(&item.label) } else { None };
    let label = if item.kind == CompletionKind::Snippet { word(item) } else { item.label.as_str() };
    evidence.features(&Candidate { label, class, dimension: dimension.as_deref() }, take);
}

/// The first word of an item.
fn word(item: &CompletionItem) -> &str {
    item.label.split(' ').next().unwrap_or_default()
}

/// The class of an item, as those of the words before it.
fn class<'i>(reading: &Reading<'_>, item: &'i CompletionItem) -> &'i str {
    match (item.kind, item.detail.as_str()) {
        (_, UNDECLARED) => UNKNOWN,
        (CompletionKind::Keyword | CompletionKind::Snippet, _) => word(item),
        (CompletionKind::Function, "goal" | "never") => "#goal",
        (CompletionKind::Function, _) | (CompletionKind::Value, "side") => &item.label,
        (CompletionKind::Value, "tag") => "#tag",
        (CompletionKind::Value, _) => "#value",
        (CompletionKind::Variable, _) if matches!(item.label.as_str(), "x" | "y") => &item.label,
        (CompletionKind::Variable, "condition") => "#condition",
        (CompletionKind::Variable, "ref") => "#ref",
        (CompletionKind::Variable, "continuous") => "#continuous",
        (CompletionKind::Variable, _) => reading.class(&item.label).unwrap_or("#int"),
        (CompletionKind::Constant, detail) if detail.ends_with("declares it") => "#known",
        (CompletionKind::Constant, _) => "#param",
        (CompletionKind::Mode, _) => "#mode",
        (CompletionKind::Input, "button") => "#button",
        (CompletionKind::Input, "axis") => "#axis",
        (CompletionKind::Input, "signal") => "#signal",
        (CompletionKind::Input, _) => "#chance",
        (CompletionKind::Group, _) => "#group",
        (CompletionKind::Entity, _) => "#entity",
        (CompletionKind::Instance, _) => "#touched",
        _ => "#other",
    }
}
