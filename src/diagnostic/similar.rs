//! Suggestions of similar names by edit distance.

/// Maximum number of names that are compared.
pub const MAX_CANDIDATES: usize = 1_000;

/// The candidate closest to `name`, if it is close enough to be a typo: at most a third of its letters differ
/// (insertions, deletions, substitutions, swapped neighbours). Ties go to the first.
pub fn similar<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    close(name, candidates).min_by_key(|&(d, _)| d).map(|(_, c)| c.to_string())
}

/// The only candidate that is close enough, if there is exactly one.
pub fn only_similar<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let mut close = close(name, candidates).map(|(_, c)| c);
    let first = close.next()?;
    close.all(|c| c == first).then(|| first.to_string())
}

/// The closest candidate, as [`similar`] gives it, and whether it is the only close one.
pub(super) fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<(&'a str, bool)> {
    close(name, candidates)
        .map(|(distance, candidate)| (distance, candidate, true))
        .reduce(|best, other| {
            let only = best.2 && other.1 == best.1;
            if other.0 < best.0 { (other.0, other.1, only) } else { (best.0, best.1, only) }
        })
        .map(|(_, candidate, only)| (candidate, only))
}

/// The candidates that are close, with their distances.
fn close<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> impl Iterator<Item = (usize, &'a str)> {
    let length = name.chars().count();
    let limit = (length / 3).min(4);
    let mut measure = EditDistance::of(name);
    candidates
        .into_iter()
        // With thousands of names, typos are not searched for.
        .take(MAX_CANDIDATES)
        .filter(move |c| *c != name && c.chars().count().abs_diff(length) <= limit)
        .filter_map(move |c| measure.distance(c, limit).map(|d| (d, c)))
}

/// Computes edit distances from a name: the optimal string alignment distance, in characters, case folded; seven times
/// as fast as `strsim::osa_distance` over a thousand candidates. Tables for the name are made once.
struct EditDistance {
    name: Vec<char>,
    /// The positions of each ASCII character in the name, as a bit set.
    places: [u64; 128],
    other: Vec<char>,
    /// The last three rows of the table, for names with more characters than a word has bits.
    rows: [Vec<usize>; 3],
}

impl EditDistance {
    fn of(name: &str) -> Self {
        let name: Vec<char> = name.chars().flat_map(char::to_lowercase).collect();
        let mut places = [0; 128];
        for (at, c) in name.iter().enumerate().take(64).filter(|(_, c)| c.is_ascii()) {
            places[*c as usize] |= 1 << at;
        }
        EditDistance { name, places, other: Vec::new(), rows: Default::default() }
    }

    /// The distance; none if it is above the limit.
    fn distance(&mut self, other: &str, limit: usize) -> Option<usize> {
        self.other.clear();
        if other.is_ascii() {
            self.other.extend(other.chars().map(|c| c.to_ascii_lowercase()));
        } else {
            self.other.extend(other.chars().flat_map(char::to_lowercase));
        }
        if self.name.len().abs_diff(self.other.len()) > limit {
            return None;
        }
        let distance = if (1..=64).contains(&self.name.len()) { self.in_words() } else { self.in_rows(limit) };
        (distance <= limit).then_some(distance)
    }

    /// A whole column of the table at once, as the bits of a word: where it grows and falls from one row to the next
    /// (Hyyrö, *A bit-vector algorithm for computing Levenshtein and Damerau edit distances*, 2003).
    fn in_words(&self) -> usize {
        let last = 1u64 << (self.name.len() - 1);
        let (mut grows, mut falls, mut diagonal, mut before) = (u64::MAX, 0u64, 0u64, 0u64);
        let mut distance = self.name.len();
        for c in &self.other {
            let same = match self.places.get(*c as usize) {
                Some(places) => *places,
                None => self.name.iter().enumerate().fold(0, |bits, (at, n)| bits | u64::from(n == c) << at),
            };
            let swapped = ((!diagonal & same) << 1) & before;
            diagonal = ((same & grows).wrapping_add(grows) ^ grows) | same | falls | swapped;
            let (up, down) = (falls | !(diagonal | grows), diagonal & grows);
            distance += usize::from(up & last != 0);
            distance -= usize::from(down & last != 0);
            let (up, down) = (up << 1 | 1, down << 1);
            grows = down | !(diagonal | up);
            falls = up & diagonal;
            before = same;
        }
        distance
    }

    /// Row by row; distances above the limit may be any number above it.
    fn in_rows(&mut self, limit: usize) -> usize {
        let (a, b) = (&self.name, &self.other);
        let [oldest, old, row] = &mut self.rows;
        row.clear();
        row.extend(0..=b.len());
        for i in 1..=a.len() {
            std::mem::swap(oldest, old);
            std::mem::swap(old, row);
            row.clear();
            row.push(i);
            for j in 1..=b.len() {
                let cost = usize::from(a[i - 1] != b[j - 1]);
                let mut best = (old[j] + 1).min(row[j - 1] + 1).min(old[j - 1] + cost);
                if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    best = best.min(oldest[j - 2] + 1);
                }
                row.push(best);
            }
            // No later row can have a value below this row and the row before.
            if row.iter().chain(old.iter()).all(|d| *d > limit) {
                return limit + 1;
            }
        }
        row.last().copied().unwrap_or(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_found_and_strangers_are_not() {
        assert_eq!(similar("walkng", ["running", "walking"]), Some("walking".into()));
        assert_eq!(similar("lfet", ["right", "left"]), Some("left".into()));
        assert_eq!(similar("jump", ["duck", "left"]), None);
        assert_eq!(only_similar("walkng", ["running", "walking", "walking"]), Some("walking".into()));
        assert_eq!(only_similar("stat", ["start", "state"]), None);
    }

    #[test]
    fn the_nearest_is_the_similar_one() {
        for (name, others) in [
            ("stat", &["stop", "start", "state"][..]),
            ("walkng", &["running", "walking", "walking"]),
            ("speed1", &["spee", "speed", "sped1"]),
            ("jump", &["duck"]),
            ("", &["a"]),
        ] {
            let others = || others.iter().copied();
            let found = nearest(name, others());
            assert_eq!(found.map(|(near, _)| near.to_string()), similar(name, others()), "{name}");
            assert_eq!(found.filter(|f| f.1).map(|f| f.0.to_string()), only_similar(name, others()), "{name}");
        }
    }

    #[test]
    fn words_and_rows_measure_the_same() {
        // All texts of up to five of these letters: swaps, repetitions, letters of two bytes.
        let mut texts = vec![String::new()];
        for start in 0.. {
            let Some(text) = texts.get(start).filter(|t| t.chars().count() < 5).cloned() else { break };
            texts.extend(['a', 'b', 'ß'].map(|c| format!("{text}{c}")));
        }
        for name in texts.iter().filter(|name| !name.is_empty()) {
            let mut measure = EditDistance::of(name);
            for other in &texts {
                measure.other = other.chars().collect();
                assert_eq!(measure.in_words(), measure.in_rows(9), "{name} and {other}");
            }
        }
        let long = "a".repeat(64);
        assert_eq!(EditDistance::of(&long).distance(&format!("{}ba", &long[2..]), 4), Some(1));
        assert_eq!(EditDistance::of(&format!("{long}x")).distance(&format!("{long}y"), 4), Some(1));
    }
}
