//! Compares the index with brute force, on points like those of game states: few distinct values, constant coordinates,
//! duplicates, common and rare modes, most points removed sooner or later.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, reason = "a test fails by panicking")]

use allocation_counter::measure;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use super::*;
use crate::ir::Extremes;

const PENALTY: f32 = 0.05;
/// Low thresholds, so that all structures are exercised.
const EARLY: Thresholds = Thresholds { scan: 20, partition: 6, tree: 10 };

/// How one coordinate is drawn.
#[derive(Debug, Clone, Copy)]
enum Values {
    /// Anything: a position.
    Any,
    /// One of a number of tenths, in which no sum of squares is exact: a counter.
    Tenths(u32),
    /// Mostly zero: a timer that seldom runs.
    Seldom,
    Fixed,
}

impl Values {
    fn draw(self, rng: &mut Pcg64) -> f32 {
        match self {
            Values::Any => rng.random_range(0.0..1.0),
            Values::Tenths(many) => rng.random_range(0..many) as f32 / 10.0,
            Values::Seldom => f32::from(u8::from(rng.random_bool(0.1))) * rng.random_range(0.0..1.0f32),
            Values::Fixed => 0.3,
        }
    }
}

/// An index together with a list of its points.
struct CheckedIndex {
    values: Vec<Values>,
    /// Number of values of each mode.
    modes: Vec<u32>,
    index: Index,
    points: Vec<(Vec<f32>, Vec<f32>)>,
    live: Vec<usize>,
    rng: Pcg64,
}

impl CheckedIndex {
    fn new(values: Vec<Values>, modes: Vec<u32>, thresholds: Thresholds, seed: u64) -> Self {
        let index = Index::with_thresholds(values.len(), modes.len(), PENALTY, thresholds);
        CheckedIndex { values, modes, index, points: Vec::new(), live: Vec::new(), rng: Pcg64::seed_from_u64(seed) }
    }

    fn draw(&mut self) -> (Vec<f32>, Vec<f32>) {
        let reals = self.values.iter().map(|values| values.draw(&mut self.rng)).collect();
        // Low values are common, high ones rare, as leaves are.
        let rng = &mut self.rng;
        let mut leaf = |many: u32| {
            let below = rng.random_range(1..=many);
            rng.random_range(0..below) as f32
        };
        (reals, self.modes.iter().map(|&many| leaf(many)).collect())
    }

    fn push(&mut self, (reals, modes): (Vec<f32>, Vec<f32>)) {
        self.index.push(&reals, &modes);
        self.live.push(self.points.len());
        self.points.push((reals, modes));
        assert_eq!(self.index.len(), self.points.len());
    }

    fn remove(&mut self, index: usize) {
        self.index.remove(index);
        self.live.retain(|&live| live != index);
    }

    fn brute(&self, (reals, modes): &(Vec<f32>, Vec<f32>), accept: impl Fn(usize) -> bool) -> Option<Neighbour> {
        let mut best: Option<Neighbour> = None;
        for &index in self.live.iter().filter(|&&index| accept(index)) {
            let (own_reals, own_modes) = &self.points[index];
            let mut distance = 0.0;
            for (a, b) in own_reals.iter().zip(reals) {
                distance += (a - b) * (a - b);
            }
            for (a, b) in own_modes.iter().zip(modes) {
                distance += if a == b { 0.0 } else { PENALTY };
            }
            if best.is_none_or(|best| distance < best.distance) {
                best = Some(Neighbour { index, distance });
            }
        }
        best
    }

    /// Checks a query, at a point or anywhere, for all points and for some of them. Returns the nearest.
    fn check(&mut self) -> Option<Neighbour> {
        let mut query = self.draw();
        if !self.points.is_empty() && self.rng.random_bool(0.3) {
            query = self.points[self.rng.random_range(0..self.points.len())].clone();
        } else if self.rng.random_bool(0.5) {
            query.0.iter_mut().for_each(|value| *value = self.rng.random_range(-0.5..1.5));
        }
        let found = self.index.nearest(&query.0, &query.1);
        assert_eq!(found, self.brute(&query, |_| true));
        let one_in = self.rng.random_range(1..30);
        let accept = |index: usize| (index * 7919).is_multiple_of(one_in);
        let live = &self.live;
        let asked = |index: usize| {
            assert!(live.contains(&index), "`accept` is not called for removed points");
            accept(index)
        };
        assert_eq!(self.index.nearest_where(&query.0, &query.1, asked), self.brute(&query, accept));
        found
    }
}

fn values() -> impl Strategy<Value = Vec<Values>> {
    let one =
        prop_oneof![Just(Values::Any), (2..12u32).prop_map(Values::Tenths), Just(Values::Seldom), Just(Values::Fixed)];
    prop_oneof![
        // Few values, so that points coincide; then dimensions with and without trees.
        2 => prop::collection::vec((2..4u32).prop_map(Values::Tenths), 0..4),
        4 => prop::collection::vec(one.clone(), 0..14),
        1 => prop::collection::vec(one, 14..30),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn agrees_with_brute_force(
        values in values(),
        modes in prop::collection::vec(1..5u32, 0..4),
        seed: u64,
        turns in 1..700usize,
        removed in 0.0..1.0f64,
    ) {
        let mut checked = CheckedIndex::new(values, modes, EARLY, seed);
        for turn in 0..turns {
            let point = checked.draw();
            checked.push(point);
            if checked.rng.random_bool(0.02) {
                // The same point over and over.
                let point = checked.draw();
                (0..30).for_each(|_| checked.push(point.clone()));
            }
            if turn % 5 == 0 {
                let nearest = checked.check();
                // Planners use up the nearest point.
                if let Some(nearest) = nearest && checked.rng.random_bool(removed) {
                    checked.remove(nearest.index);
                }
            }
            if checked.rng.random_bool(removed / 2.0) {
                let victim = checked.rng.random_range(0..checked.points.len());
                checked.remove(victim);
            }
        }
        while !checked.live.is_empty() {
            checked.check();
            for _ in 0..20.min(checked.live.len()) {
                let victim = checked.live[checked.rng.random_range(0..checked.live.len())];
                checked.remove(victim);
            }
        }
        prop_assert_eq!(checked.check(), None);
        checked.index.clear();
        checked.points.clear();
        prop_assert!(checked.index.is_empty());
        let point = checked.draw();
        checked.push(point);
        checked.check();
    }
}

/// Twenty thousand points with the production thresholds.
fn many(values: Vec<Values>, modes: Vec<u32>) {
    let mut checked = CheckedIndex::new(values, modes, THRESHOLDS, 1);
    for turn in 0..20_000 {
        let point = checked.draw();
        checked.push(point);
        if turn % 100 == 0
            && let Some(nearest) = checked.check()
        {
            checked.remove(nearest.index);
        }
    }
    // A hole in the middle: the nearest points are all removed.
    let query = checked.points[10_000].clone();
    let mut near = checked.live.clone();
    let distance = |index: &usize| {
        let pairs = checked.points[*index].0.iter().zip(&query.0);
        pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f32>()
    };
    near.sort_by(|a, b| distance(a).total_cmp(&distance(b)));
    for index in near.into_iter().take(5_000) {
        checked.index.remove(index);
        checked.live.retain(|&live| live != index);
        if index % 50 == 0 {
            assert_eq!(checked.index.nearest(&query.0, &query.1), checked.brute(&query, |_| true));
            checked.check();
        }
    }
}

#[test]
fn many_points_of_few_coordinates() {
    many(vec![Values::Any, Values::Any, Values::Tenths(8), Values::Fixed], vec![2]);
}

#[test]
fn many_points_of_some_coordinates_and_common_modes() {
    let values =
        [Values::Any, Values::Tenths(11), Values::Seldom, Values::Any, Values::Any, Values::Any, Values::Fixed];
    many(values.to_vec(), vec![3, 2, 2]);
}

#[test]
fn many_points_of_many_coordinates_and_rare_modes() {
    let mut values = vec![Values::Any; 3];
    values.extend([Values::Tenths(5), Values::Seldom, Values::Seldom].repeat(6));
    many(values, vec![4, 4, 4, 4, 4]);
}

#[test]
fn twelve_coordinates() {
    many([Values::Any, Values::Tenths(4), Values::Seldom].repeat(4), Vec::new());
}

#[test]
fn the_same_point_over_and_over() {
    let mut checked = CheckedIndex::new(vec![Values::Any; 3], vec![2], THRESHOLDS, 1);
    let (one, other) = (checked.draw(), checked.draw());
    for _ in 0..3_000 {
        checked.push(one.clone());
        checked.push(other.clone());
    }
    while let Some(nearest) = checked.check() {
        checked.remove(nearest.index);
        // Removes most points in blocks, to finish soon.
        let more: Vec<usize> = checked.live.iter().copied().skip(10).take(20).collect();
        more.into_iter().for_each(|index| checked.index.remove(index));
        let points = &checked.index;
        checked.live.retain(|&index| !matches!(points.locations[index], Location::Removed));
    }
}

/// Squares that underflow or nearly overflow.
#[test]
fn distances_of_any_size() {
    for scale in [1e-24, 1e-22, 1e-20, 1e-3, 1e9] {
        let mut rng = Pcg64::seed_from_u64(1);
        let mut checked = CheckedIndex::new(vec![Values::Any; 4], Vec::new(), EARLY, 1);
        for _ in 0..500 {
            let mut draw = || (0..4).map(|_| rng.random_range(0.0..scale)).collect::<Vec<f32>>();
            let (mut point, query) = (draw(), draw());
            point[3] = scale / 2.0;
            checked.push((point, Vec::new()));
            assert_eq!(checked.index.nearest(&query, &[]), checked.brute(&(query, Vec::new()), |_| true));
        }
    }
}

#[test]
fn removed_points_go() {
    let mut index = Index::new(2, 1, PENALTY);
    for i in 0..100_000 {
        index.push(&[i as f32, 0.0], &[0.0]);
        if i >= 10 {
            index.remove(i - 10);
            index.remove(i - 10);
        }
    }
    let kept: usize = index.partitions.iter().map(|partition| partition.points().len()).sum();
    assert!(kept + index.rest.len() < 3_000, "{kept} slots for ten points");
    index.remove(100_000);
    assert_eq!(index.nearest(&[0.0, 0.0], &[1.0]).unwrap().index, 99_990);
}

#[test]
fn a_query_takes_no_memory() {
    let mut checked = CheckedIndex::new(vec![Values::Any; 4], vec![2, 2], THRESHOLDS, 1);
    for _ in 0..20_000 {
        let point = checked.draw();
        checked.push(point);
    }
    assert!(checked.index.partitions.len() > 1);
    for _ in 0..100 {
        let (reals, modes) = checked.draw();
        let counted = measure(|| {
            checked.index.nearest(&reals, &modes);
            checked.index.nearest_where(&reals, &modes, |_| true);
        });
        assert_eq!((counted.count_total, counted.bytes_total), (0, 0));
    }
}

#[test]
fn of_two_ways_around_the_shorter_counts() {
    let around = |points: &[[f32; 2]], query: [f32; 2]| {
        let mut index = Index::new(2, 0, 0.0).around(vec![
            Around { coordinate: 0, middle: 5.0, size: 10.0 },
            Around { coordinate: 1, middle: 50.0, size: 100.0 },
        ]);
        points.iter().for_each(|point| index.push(point, &[]));
        let brute = |point: &[f32; 2]| {
            let way = |a: f32, b: f32, size: f32| [a - b, a - b + size, a - b - size].map(f32::abs);
            let least = |ways: [f32; 3]| ways.into_iter().fold(f32::INFINITY, f32::least);
            let (x, y) = (least(way(point[0], query[0], 10.0)), least(way(point[1], query[1], 100.0)));
            x * x + y * y
        };
        let found = index.nearest(&query, &[]).unwrap();
        let least = points.iter().map(brute).fold(f32::INFINITY, f32::least);
        assert!((found.distance - least).abs() < 1e-3, "{query:?}: {found:?}, {least}");
        found.index
    };
    let points = [[1.0, 50.0], [5.0, 50.0], [9.0, 50.0], [9.5, 1.0]];
    assert_eq!(around(&points, [9.9, 50.0]), 2);
    assert_eq!(around(&points, [0.1, 99.0]), 3);
    assert_eq!(around(&points[..2], [9.9, 50.0]), 0);
    for x in 0..40 {
        for y in 0..40 {
            around(&points, [x as f32 * 0.25, y as f32 * 2.5]);
        }
    }
}
