//! "Did you mean": the nearest name by edit distance.

/// How many names are compared.
pub const MAX_CANDIDATES: usize = 1_000;

/// The candidate closest to `name`, if one is close enough to be a slip of the hand: at most a third of its
/// letters differ (insertions, deletions, substitutions, swapped neighbours). Ties go to the first.
pub fn similar<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    close(name, candidates).min_by_key(|&(d, _)| d).map(|(_, c)| c.to_string())
}

/// The only candidate that is as close as that, if there is just one.
pub fn only_similar<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let mut close = close(name, candidates).map(|(_, c)| c);
    let first = close.next()?;
    close.all(|c| c == first).then(|| first.to_string())
}

/// The candidates that are close, with their distances.
fn close<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> impl Iterator<Item = (usize, &'a str)> {
    let length = name.chars().count();
    let limit = (length / 3).min(4);
    let mut measure =
        Measure { name: name.to_lowercase().chars().collect(), other: Vec::new(), rows: Default::default() };
    candidates
        .into_iter()
        // Among thousands of names nobody looks for a slip of the hand.
        .take(MAX_CANDIDATES)
        .filter(move |c| *c != name && c.chars().count().abs_diff(length) <= limit)
        .filter_map(move |c| measure.distance(c, limit).map(|d| (d, c)))
}

/// Measures how far others are from a name; what it needs is made once.
struct Measure {
    name: Vec<char>,
    other: Vec<char>,
    /// The last three rows of the table.
    rows: [Vec<usize>; 3],
}

impl Measure {
    /// Optimal string alignment distance, in characters, case folded; none if it is above the limit.
    fn distance(&mut self, other: &str, limit: usize) -> Option<usize> {
        self.other.clear();
        self.other.extend(other.chars().flat_map(char::to_lowercase));
        let (a, b) = (&self.name, &self.other);
        if a.len().abs_diff(b.len()) > limit {
            return None;
        }
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
            // No later row can come below what this one and the one before have.
            if row.iter().chain(old.iter()).all(|d| *d > limit) {
                return None;
            }
        }
        row.last().copied().filter(|d| *d <= limit)
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
}
