//! Where the places of one text are in a later one, told from the lines that both have: what is known of a text holds on
//! for those parts of it that an edit left alone.

use std::ops::Range;

/// So many lines are looked ahead for the place where two texts go on alike.
const REACH: usize = 400;

/// Which lines of two texts are the same.
pub(in crate::lsp) struct Alignment<'t> {
    old: Vec<&'t str>,
    new: Vec<&'t str>,
    /// What differs, in order.
    runs: Vec<(Range<usize>, Range<usize>)>,
}

impl<'t> Alignment<'t> {
    /// Of a text and a later one, as the compiler sees them.
    pub fn between(old: &'t str, new: &'t str) -> Self {
        let (old, new) = (lines(old), lines(new));
        let runs = runs(&old, &new);
        Alignment { old, new, runs }
    }

    /// Of each line of the older text, the line of the later one that it is, if nothing changed in it.
    pub fn lines(&self) -> Vec<Option<usize>> {
        (0..self.old.len()).map(|line| self.line(line)).collect()
    }

    fn line(&self, old: usize) -> Option<usize> {
        shifted(&self.runs, old, |(from, _)| from, |(_, to)| to).filter(|line| *line < self.new.len())
    }

    /// The byte of the older text that a byte of the later one was. Where letters were changed it is where they begin.
    pub fn before(&self, new: usize) -> Option<usize> {
        let (line, column) = place(&self.new, new)?;
        if let Some(line) = shifted(&self.runs, line, |(_, to)| to, |(from, _)| from) {
            return Some(start(&self.old, line) + column);
        }
        let (from, to) = self.runs.iter().find(|(_, to)| to.contains(&line))?;
        // Lines that were changed in their place are compared one by one.
        let was = from.start + (line - to.start);
        let (old, new) = (self.old.get(was).filter(|_| from.len() == to.len())?, self.new.get(line)?);
        Some(start(&self.old, was) + column_before(old, new, column))
    }

    /// The bytes of the later text that some bytes of the older one are, if nothing changed in their line.
    pub fn after(&self, old: Range<usize>) -> Option<Range<usize>> {
        let (line, column) = place(&self.old, old.start)?;
        let begin = start(&self.new, self.line(line)?) + column;
        Some(begin..begin + old.len())
    }
}

/// The line on the other side of one that is the same on both.
fn shifted<R>(
    runs: &[R],
    line: usize,
    here: impl Fn(&R) -> &Range<usize>,
    there: impl Fn(&R) -> &Range<usize>,
) -> Option<usize> {
    let before = runs.partition_point(|run| here(run).start <= line);
    match before.checked_sub(1).and_then(|last| runs.get(last)) {
        Some(run) if here(run).contains(&line) => None,
        Some(run) => Some(line - here(run).end + there(run).end),
        None => Some(line),
    }
}

/// The column of an older line that a column of the later one was.
fn column_before(old: &str, new: &str, column: usize) -> usize {
    let ahead = old.chars().zip(new.chars()).take_while(|(a, b)| a == b).map(|(c, _)| c.len_utf8()).sum::<usize>();
    let rest = |line: &str| line.get(ahead..).unwrap_or_default().chars().rev().collect::<Vec<char>>();
    let behind = rest(old).iter().zip(&rest(new)).take_while(|(a, b)| a == b).map(|(c, _)| c.len_utf8()).sum::<usize>();
    if column <= ahead {
        column
    } else if column >= new.len() - behind {
        old.len() - (new.len() - column)
    } else {
        ahead
    }
}

/// The line of a byte, and its column in bytes.
fn place(lines: &[&str], byte: usize) -> Option<(usize, usize)> {
    let mut begin = 0;
    for (index, line) in lines.iter().enumerate() {
        if byte < begin + line.len() || index + 1 == lines.len() && byte == begin + line.len() {
            return Some((index, byte - begin));
        }
        begin += line.len();
    }
    None
}

/// The first byte of a line.
fn start(lines: &[&str], line: usize) -> usize {
    lines.iter().take(line).map(|line| line.len()).sum()
}

/// The lines of a text with their ends: LF, CRLF or CR. The last one has none, and may be empty.
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

/// What differs between two lists of lines: lines of the first, and the lines of the second in their place. They go on
/// alike at the nearest line that both have and that is not blank.
pub(in crate::lsp) fn runs(old: &[&str], new: &[&str]) -> Vec<(Range<usize>, Range<usize>)> {
    let (mut a, mut b) = (0, 0);
    let mut out = Vec::new();
    while a < old.len() || b < new.len() {
        if old.get(a) == new.get(b) {
            (a, b) = (a + 1, b + 1);
            continue;
        }
        // The nearest place where both go on alike.
        let reach = old.len() - a + new.len() - b;
        let same = |i: usize, j: usize| match (old.get(i), new.get(j)) {
            (Some(x), Some(y)) => x == y && !x.trim().is_empty(),
            (None, None) => true,
            _ => false,
        };
        let meets = (1..=reach.min(REACH)).find_map(|sum| {
            let mut ways = (0..=sum).map(|i| (a + i, b + sum - i));
            ways.find(|(i, j)| *i <= old.len() && *j <= new.len() && same(*i, *j))
        });
        let (mut i, mut j) = meets.unwrap_or((old.len(), new.len()));
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
        let at = Alignment::between(OLD, new).before(new.find(word).unwrap_or_default());
        at.and_then(|at| OLD.get(at..)).and_then(|rest| rest.split_whitespace().next())
    }

    #[test]
    fn lines_that_stay_are_found_again() {
        let new = "zero\none\r\n\nplace a: Slime at b\nthree\nfour";
        let alignment = Alignment::between(OLD, new);
        assert_eq!(alignment.lines(), [Some(1), None, Some(2), Some(3), Some(4), None]);
        assert_eq!(before(new, "three"), Some("three"));
        let at = OLD.find("Slime").unwrap_or_default();
        assert_eq!(alignment.after(at..at + 5).and_then(|bytes| new.get(bytes)), Some("Slime"));
        assert_eq!(alignment.after(5..8), None, "the line is gone");
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
                alignment.lines().into_iter().enumerate().filter_map(|(a, b)| Some((a, b?))).collect();
            proptest::prop_assert!(kept.is_sorted_by(|(a, b), (c, d)| a < c && b < d));
            for (a, b) in kept {
                let line = alignment.old[a];
                proptest::prop_assert_eq!(line, alignment.new[b]);
                let (from, to) = (start(&alignment.old, a), start(&alignment.new, b));
                for column in 0..line.len() {
                    proptest::prop_assert_eq!(alignment.before(to + column), Some(from + column));
                    proptest::prop_assert_eq!(alignment.after(from + column..from + line.len()), Some(to + column..to + line.len()));
                }
            }
            // A place that there is is led to one that there is.
            for byte in 0..=new.len() {
                proptest::prop_assert!(alignment.before(byte).is_none_or(|at| at <= old.len()));
            }
        }
    }

    #[test]
    fn texts_without_a_common_line_have_no_common_places() {
        let alignment = Alignment::between("a\nb", "c");
        assert_eq!((alignment.line(1), alignment.before(0), alignment.after(0..1)), (None, None, None));
        assert_eq!(Alignment::between("", "").before(0), Some(0));
    }
}
