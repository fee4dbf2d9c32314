//! Fits the weights of the order of completions: logistic regression over the items that are shown at each position,
//! with the wanted one as the outcome, by stochastic gradient descent with steps as in J. Duchi, E. Hazan, Y. Singer,
//! *Adaptive Subgradient Methods for Online Learning and Stochastic Optimization* (2011); small weights become 0.

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

use hypedc::lsp::service::{Request, Service};

use super::positions::{entities, is_wanted, positions, typed_until};
use super::{Memory, PATH, language};

/// What a large weight costs, and what any weight costs.
const SQUARED_COST: f32 = 0.3 / 50.0;
const COST: f32 = 0.01;
const STEP: f32 = 0.2;
const ROUNDS: usize = 12;
/// How much a position of an example counts: sessions are written to be typed, examples are edited for long.
const EXAMPLE: f32 = 0.5;
/// The number of positions at which a feature must be seen.
const SEEN: usize = 10;
/// Weights are written in parts of this many.
const UNIT: f32 = 20.0;

/// A position with the features of the items that are shown.
struct Example {
    items: Vec<Vec<(usize, f32)>>,
    wanted: Vec<bool>,
    /// The number of its file.
    file: usize,
    /// Whether it is of a text that was written as a session.
    is_session: bool,
}

impl Example {
    fn scores(&self, weights: &[f32]) -> Vec<f32> {
        self.items.iter().map(|item| item.iter().map(|(feature, value)| weights[*feature] * value).sum()).collect()
    }

    /// The place of the wanted item, from 0.
    fn place(&self, weights: &[f32]) -> Option<usize> {
        let scores = self.scores(weights);
        let before = |at: usize| (0..scores.len()).filter(|o| (scores[*o], at) > (scores[at], *o)).count();
        (0..scores.len()).filter(|at| self.wanted[*at]).map(before).min()
    }
}

/// The texts: all examples, entity by entity, and the sessions as a whole; with the numbers of their files.
fn texts() -> Vec<(usize, bool, String)> {
    let mut out = Vec::new();
    let mut file = 0;
    for (folder, is_session) in [("examples", false), ("tests/lsp/tuning", true)] {
        for path in crate::support::files(folder, "hyped") {
            let text = std::fs::read_to_string(&path).unwrap();
            file += 1;
            if is_session {
                out.push((file, is_session, text));
                continue;
            }
            let constants: Vec<&str> = text.lines().filter(|line| line.starts_with("const ")).collect();
            let large = entities(&text).into_iter().filter(|entity| (20..140).contains(&entity.lines().count()));
            out.extend(large.map(|entity| (file, is_session, format!("{}\n{entity}", constants.join("\n")))));
        }
    }
    out
}

/// The positions of all texts, and the names of the features.
fn examples() -> (Vec<Example>, Vec<String>) {
    let language = language();
    let (mut examples, mut names) = (Vec::new(), Vec::new());
    let mut numbers: HashMap<String, usize> = HashMap::new();
    for (file, is_session, text) in texts() {
        let mut service = Service::new(Arc::new(Memory::default()));
        for position in positions(&text, &language).0 {
            let so_far = &text[..position.cursor()];
            service.answer(Request::Document { path: PATH.into(), text: typed_until(&text, position.cursor()) });
            let typed = position.typed.to_lowercase();
            let shown = service.evidence(PATH, so_far.encode_utf16().count()).into_iter();
            let shown = shown.filter(|(label, _)| label.to_lowercase().starts_with(&typed));
            // A keyword and its snippet are one item.
            let mut seen = BTreeSet::new();
            let shown: Vec<_> =
                shown.filter(|(label, _)| seen.insert(label.trim_end_matches(" …").to_string())).collect();
            let wanted = shown.iter().map(|(label, _)| is_wanted(label, &position)).collect();
            let mut number = |name: String| {
                *numbers.entry(name).or_insert_with_key(|name| {
                    names.push(name.clone());
                    names.len() - 1
                })
            };
            let items = shown
                .into_iter()
                .map(|(_, features)| features.into_iter().map(|(name, value)| (number(name), value)).collect())
                .collect();
            examples.push(Example { items, wanted, file, is_session });
        }
    }
    (examples, names)
}

fn fit(examples: &[&Example], features: usize) -> Vec<f32> {
    let (mut weights, mut squares) = (vec![0f32; features], vec![1e-6f32; features]);
    let mut seen = vec![0; features];
    for example in examples {
        let all: BTreeSet<usize> = example.items.iter().flatten().map(|(feature, _)| *feature).collect();
        all.into_iter().for_each(|feature| seen[feature] += 1);
    }
    let mut order: Vec<usize> = (0..examples.len()).collect();
    let mut random = 12345u64;
    for _ in 0..ROUNDS {
        for at in (1..order.len()).rev() {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            order.swap(at, (random >> 33) as usize % (at + 1));
        }
        for at in &order {
            let example = examples[*at];
            if example.items.len() < 2 || !example.wanted.contains(&true) {
                continue;
            }
            let scores = example.scores(&weights);
            let most = scores.iter().copied().max_by(f32::total_cmp).unwrap();
            let counts = if example.is_session { 1.0 } else { EXAMPLE };
            let likely: Vec<f32> = scores.iter().map(|score| (score - most).exp()).collect();
            let all: f32 = likely.iter().sum();
            let right: f32 = likely.iter().zip(&example.wanted).filter(|(_, wanted)| **wanted).map(|(p, _)| p).sum();
            for ((item, wanted), likely) in example.items.iter().zip(&example.wanted).zip(&likely) {
                let slope = likely / all - if *wanted { likely / right } else { 0.0 };
                if slope.abs() < 1e-4 {
                    continue;
                }
                for (feature, value) in item.iter().filter(|(feature, _)| seen[*feature] >= SEEN) {
                    let weight = &mut weights[*feature];
                    let slope = counts * slope * value + SQUARED_COST * *weight;
                    squares[*feature] += slope * slope;
                    let step = STEP / squares[*feature].sqrt();
                    *weight -= step * slope;
                    let cut = step * COST;
                    *weight = if weight.abs() > cut { *weight - cut.copysign(*weight) } else { 0.0 };
                }
            }
        }
    }
    weights
}

/// The hash by which the library finds a weight (FNV-1a).
fn hash(name: &str) -> u32 {
    name.bytes().fold(0x811c_9dc5, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}

/// Prints what part of the positions of files is right that the weights were not fitted to, then writes the weights
/// that are fitted to all files.
#[test]
#[ignore = "fits the weights of completions and writes them"]
fn fits_the_weights() {
    let (examples, names) = examples();
    let mut right: BTreeMap<bool, [usize; 3]> = BTreeMap::new();
    for fold in 0..6 {
        let others: Vec<&Example> = examples.iter().filter(|example| example.file % 6 != fold).collect();
        let weights = fit(&others, names.len());
        for example in examples.iter().filter(|example| example.file % 6 == fold) {
            let place = example.place(&weights);
            let count = right.entry(example.is_session).or_default();
            count[0] += 1;
            count[1] += usize::from(place == Some(0));
            count[2] += usize::from(place.is_some_and(|place| place < 3));
        }
    }
    for (is_session, [all, first, among_three]) in right {
        let percent = |part: usize| part as f64 * 100.0 / all as f64;
        let kind = if is_session { "sessions" } else { "examples" };
        println!("{kind}: {all} positions, {:.1} % first, {:.1} % in three", percent(first), percent(among_three));
    }
    let weights = fit(&examples.iter().collect::<Vec<_>>(), names.len());
    let mut lines: BTreeMap<u32, String> = BTreeMap::new();
    for (name, weight) in names.iter().zip(weights) {
        let weight = (weight * UNIT).round().clamp(-127.0, 127.0);
        if weight.abs() > 1.0 {
            lines.insert(hash(name), format!("{weight}\t{name}\n"));
        }
    }
    let text: String = lines.into_values().collect();
    println!("{} weights of {} features", text.lines().count(), names.len());
    std::fs::write("src/lsp/features/completion_order/weights.txt", text).unwrap();
}
