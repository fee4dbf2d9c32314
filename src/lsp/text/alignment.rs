//! A line diff that maps offsets between an older and a newer text. Results for the older text remain valid on lines
//! that an edit did not change.

use std::ops::Range;

/// Maximum number of lines that are searched for the next equal line.
const MAX_LOOKAHEAD: usize = 400;

/// The lines of two texts, and their differences.
pub(in crate::lsp) struct Alignment<'t> {
    old: Vec<&'t str>,
    new: Vec<&'t str>,
    /// The differing ranges of old and new lines, in order.
    hunks: Vec<(Range<usize>, Range<usize>)>,
}

impl<'t> Alignment<'t> {
    /// Compares a text and a newer one, both without a byte order mark.
    pub fn between(old: &'t str, new: &'t str) -> Self {
        let (old, new) = (lines(old), lines(new));
        let hunks = hunks(&old, &new);
        Alignment { old, new, hunks }
    }

    /// For each line of the older text, its index in the newer text, if it is unchanged.
    pub fn new_lines(&self) -> Vec<Option<usize>> {
        (0..self.old.len()).map(|line| self.new_line(line)).collect()
    }

    fn new_line(&self, old: usize) -> Option<usize> {
        map_line(&self.hunks, old, |(from, _)| from, |(_, to)| to).filter(|line| *line < self.new.len())
    }

    /// Maps an offset in the newer text to the older text. An offset in changed characters maps to their start.
    pub fn old_offset(&self, new: usize) -> Option<usize> {
        let (line, column) = line_and_column(&self.new, new)?;
        if let Some(line) = map_line(&self.hunks, line, |(_, to)| to, |(from, _)| from) {
            return Some(line_start(&self.old, line) + column);
        }
        let (from, to) = self.hunks.iter().find(|(_, to)| to.contains(&line))?;
        // If a hunk has as many new lines as old ones, they are compared one by one.
        let old_line = from.start + (line - to.start);
        let (old, new) = (self.old.get(old_line).filter(|_| from.len() == to.len())?, self.new.get(line)?);
        Some(line_start(&self.old, old_line) + old_column(old, new, column))
    }

    /// Maps a range in the older text to the newer text, if its line is unchanged.
    pub fn new_range(&self, old: Range<usize>) -> Option<Range<usize>> {
        let (line, column) = line_and_column(&self.old, old.start)?;
        let begin = line_start(&self.new, self.new_line(line)?) + column;
        Some(begin..begin + old.len())
    }
}

/// Maps a line from one side (`here`) to the other (`there`); `None` if it is in a hunk.
fn map_line<R>(
    hunks: &[R],
    line: usize,
    here: impl Fn(&R) -> &Range<usize>,
    there: impl Fn(&R) -> &Range<usize>,
) -> Option<usize> {
    let before = hunks.partition_point(|hunk| here(hunk).start <= line);
    match before.checked_sub(1).and_then(|last| hunks.get(last)) {
        Some(hunk) if here(hunk).contains(&line) => None,
        Some(hunk) => Some(line - here(hunk).end + there(hunk).end),
        None => Some(line),
    }
}

/// Maps a column of the new line to the old line, by their common prefix and suffix.
fn old_column(old: &str, new: &str, column: usize) -> usize {
    let prefix = old.chars().zip(new.chars()).take_while(|(a, b)| a == b).map(|(c, _)| c.len_utf8()).sum::<usize>();
    let rest = |line: &str| line.get(prefix..).unwrap_or_default().chars().rev().collect::<Vec<char>>();
    let suffix = rest(old).iter().zip(&rest(new)).take_while(|(a, b)| a == b).map(|(c, _)| c.len_utf8()).sum::<usize>();
    if column <= prefix {
        column
    } else if column >= new.len() - suffix {
        old.len() - (new.len() - column)
    } else {
        prefix
    }
}

/// Converts an offset to a line and a column in bytes.
fn line_and_column(lines: &[&str], byte: usize) -> Option<(usize, usize)> {
    let mut begin = 0;
    for (index, line) in lines.iter().enumerate() {
        if byte < begin + line.len() || index + 1 == lines.len() && byte == begin + line.len() {
            return Some((index, byte - begin));
        }
        begin += line.len();
    }
    None
}

/// The offset of the start of a line.
fn line_start(lines: &[&str], line: usize) -> usize {
    lines.iter().take(line).map(|line| line.len()).sum()
}

/// Splits a text into lines, with their terminators: LF, CRLF or CR. The last line has no terminator and may be empty.
fn lines(text: &str) -> Vec<&str> {
    let (mut out, mut begin) = (Vec::new(), 0);
    let bytes = text.as_bytes();
    for (at, byte) in bytes.iter().enumerate() {
        if *byte == b'\n' || *byte == b'\r' && bytes.get(at + 1) != Some(&b'\n') {
            out.extend(text.get(begin..=at));
            begin = at + 1;
        }
    }
    out.extend(text.get(begin..));
    out
}

/// The hunks of a diff: ranges of old lines, and the ranges of new lines that replace them. A hunk ends at the nearest
/// line that both lists contain and that is not blank.
pub(in crate::lsp) fn hunks(old: &[&str], new: &[&str]) -> Vec<(Range<usize>, Range<usize>)> {
    let (mut a, mut b) = (0, 0);
    let mut out = Vec::new();
    while a < old.len() || b < new.len() {
        if old.get(a) == new.get(b) {
            (a, b) = (a + 1, b + 1);
            continue;
        }
        // The nearest equal lines: the smallest number of skipped lines on both sides.
        let remaining = old.len() - a + new.len() - b;
        let same = |i: usize, j: usize| match (old.get(i), new.get(j)) {
            (Some(x), Some(y)) => x == y && !x.trim().is_empty(),
            (None, None) => true,
            _ => false,
        };
        let next_match = (1..=remaining.min(MAX_LOOKAHEAD)).find_map(|sum| {
            let mut candidates = (0..=sum).map(|i| (a + i, b + sum - i));
            candidates.find(|(i, j)| *i <= old.len() && *j <= new.len() && same(*i, *j))
        });
        let (mut i, mut j) = next_match.unwrap_or((old.len(), new.len()));
        while i > a && j > b && old.get(i - 1) == new.get(j - 1) {
            (i, j) = (i - 1, j - 1);
        }
        out.push((a..i, b..j));
        (a, b) = (i, j);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    const OLD: &str = "one\r\ntwo\n\nplace a: Slime at b\nthree\n";

    fn before(new: &str, word: &str) -> Option<&'static str> {
        let at = Alignment::between(OLD, new).old_offset(new.find(word).unwrap_or_default());
        at.and_then(|at| OLD.get(at..)).and_then(|rest| rest.split_whitespace().next())
    }

    #[test]
    fn lines_that_stay_are_found_again() {
        let new = "zero\none\r\n\nplace a: Slime at b\nthree\nfour";
        let alignment = Alignment::between(OLD, new);
        assert_eq!(alignment.new_lines(), [Some(1), None, Some(2), Some(3), Some(4), None]);
        assert_eq!(before(new, "three"), Some("three"));
        let at = OLD.find("Slime").unwrap_or_default();
        assert_eq!(alignment.new_range(at..at + 5).and_then(|bytes| new.get(bytes)), Some("Slime"));
        assert_eq!(alignment.new_range(5..8), None, "the line is gone");
    }

    #[test]
    fn what_was_changed_in_a_line_is_where_it_was() {
        let new = "one\r\ntwo\n\nplace é: Ooze at b\nthree\n";
        assert_eq!([before(new, "place"), before(new, "at b")], [Some("place"), Some("at")]);
        assert_eq!(before("one\r\ntwo\n\nplace a: Ooze at b\nthree\n", "Ooze"), Some("Slime"));
    }

    proptest::proptest! {
        #[test]
        fn lines_go_to_equal_ones_in_order_and_their_bytes_with_them(
            old in "([ab]{0,2}(\n|\r\n|\r)){0,8}[ab]?", new in "([ab]{0,2}(\n|\r\n|\r)){0,8}[ab]?",
        ) {
            let alignment = Alignment::between(&old, &new);
            let kept: Vec<(usize, usize)> =
                alignment.new_lines().into_iter().enumerate().filter_map(|(a, b)| Some((a, b?))).collect();
            proptest::prop_assert!(kept.is_sorted_by(|(a, b), (c, d)| a < c && b < d));
            for (a, b) in kept {
                let line = alignment.old[a];
                proptest::prop_assert_eq!(line, alignment.new[b]);
                let (from, to) = (line_start(&alignment.old, a), line_start(&alignment.new, b));
                for column in 0..line.len() {
                    proptest::prop_assert_eq!(alignment.old_offset(to + column), Some(from + column));
                    let rest = alignment.new_range(from + column..from + line.len());
                    proptest::prop_assert_eq!(rest, Some(to + column..to + line.len()));
                }
            }
            // Valid offsets map to valid offsets.
            for byte in 0..=new.len() {
                proptest::prop_assert!(alignment.old_offset(byte).is_none_or(|at| at <= old.len()));
            }
        }
    }

    #[test]
    fn texts_without_a_common_line_have_no_common_places() {
        let alignment = Alignment::between("a\nb", "c");
        assert_eq!((alignment.new_line(1), alignment.old_offset(0), alignment.new_range(0..1)), (None, None, None));
        assert_eq!(Alignment::between("", "").old_offset(0), Some(0));
    }
}
