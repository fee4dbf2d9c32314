//! "Did you mean": the nearest name by edit distance.

/// How many names are compared.
const MAX_CANDIDATES: usize = 1_000;

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
    candidates
        .into_iter()
        // Among thousands of names nobody looks for a slip of the hand.
        .take(MAX_CANDIDATES)
        .filter(move |c| *c != name && c.chars().count().abs_diff(length) <= limit)
        .map(move |c| (distance(name, c), c))
        .filter(move |&(d, _)| d <= limit)
}

/// Optimal string alignment distance, in characters, case folded.
fn distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.to_lowercase().chars().collect();
    let b: Vec<char> = b.to_lowercase().chars().collect();
    if a.len().abs_diff(b.len()) > 4 {
        return usize::MAX;
    }
    let mut rows = vec![vec![0usize; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            rows[i][j] = if i == 0 {
                j
            } else if j == 0 {
                i
            } else {
                let cost = usize::from(a[i - 1] != b[j - 1]);
                let mut best = (rows[i - 1][j] + 1).min(rows[i][j - 1] + 1).min(rows[i - 1][j - 1] + cost);
                if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    best = best.min(rows[i - 2][j - 2] + 1);
                }
                best
            };
        }
    }
    rows[a.len()][b.len()]
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
