//! Alignment of pieces with the line above or below. What the author aligned stays aligned; all other runs of blanks
//! become one.
//!
//! Two pieces in neighbouring lines are linked if the author put them in the same column and at least one of them after
//! more than one blank. Linked pieces get the leftmost column that fits all of them. A value without a sign may be
//! aligned with one that has a sign: then it leaves room for it.

use crate::ordered::Ordered;

use super::lines::{Line, Lines, Piece, Slot};

/// Maximum number of iterations until the columns are stable.
const ROUNDS: usize = 8;

/// Sets the padding of all pieces.
pub(super) fn align(lines: &mut Lines<'_>) {
    if !lines.pieces.iter().any(|p| p.blanks.is_some_and(|b| b > 1)) {
        return;
    }
    for _ in 0..ROUNDS {
        let padding = padding(lines);
        if !apply_padding(lines, &padding) {
            return;
        }
    }
    let nothing = vec![0; lines.pieces.len()];
    apply_padding(lines, &nothing);
}

/// The padding of each piece.
fn padding(lines: &Lines<'_>) -> Vec<usize> {
    let neighbours = neighbours(&lines.lines);
    let signless = signless(lines, &neighbours);
    let column = |piece: usize| lines.pieces[piece].column - usize::from(signless[piece]);
    // The alignment group of each linked piece.
    let mut groups: Vec<Option<usize>> = vec![None; lines.pieces.len()];
    let mut members: Vec<Vec<(usize, usize)>> = Vec::new();
    for &(above, below) in &neighbours {
        let same_block = lines.lines[above].block.is_some() && lines.lines[above].block == lines.lines[below].block;
        let mut uppers = inner(&lines.lines[above]).peekable();
        for lower in inner(&lines.lines[below]) {
            while uppers.next_if(|&u| column(u) < column(lower)).is_some() {}
            let Some(&upper) = uppers.peek() else { break };
            let (a, b) = (&lines.pieces[upper], &lines.pieces[lower]);
            let wide = |p: usize| signless[p] || lines.pieces[p].blanks.is_some_and(|b| b > 1);
            let alike = match (a.slot, b.slot) {
                (Slot::Comment, slot) | (slot, Slot::Comment) => slot == Slot::Comment && a.slot == b.slot,
                (Slot::Mark(_), _) | (_, Slot::Mark(_)) => same_block && a.slot == b.slot,
                _ => same_block,
            };
            if column(upper) != column(lower) || !alike || !can_move(a) || !can_move(b) || !(wide(upper) || wide(lower))
            {
                continue;
            }
            let group = *groups[upper].get_or_insert_with(|| {
                members.push(vec![(above, upper)]);
                members.len() - 1
            });
            groups[lower] = Some(group);
            members[group].push((below, lower));
        }
    }
    // From left to right: the column of a piece depends on those before it.
    members.order_by_key(|group| group.first().map_or(0, |&(_, piece)| column(piece)));
    let mut padding = vec![0; lines.pieces.len()];
    // For each line its next piece, and the column where the last one ends.
    let mut filled: Vec<(usize, usize)> = lines.lines.iter().map(|l| (l.pieces.start, l.indent)).collect();
    for group in &members {
        let mut target = 0;
        for &(line, piece) in group {
            let (next, end) = &mut filled[line];
            while *next < piece {
                *end += width(&lines.pieces[*next], *next == lines.lines[line].pieces.start) + padding[*next];
                *next += 1;
            }
            target = target.max(*end);
        }
        for &(line, piece) in group {
            padding[piece] = target - filled[line].1 + usize::from(signless[piece]);
        }
    }
    padding
}

/// Number of columns of a piece without padding.
fn width(piece: &Piece<'_>, first: bool) -> usize {
    piece.width + usize::from(piece.space && !first)
}

fn can_move(piece: &Piece<'_>) -> bool {
    piece.space && piece.blanks.is_some()
}

/// The pieces of a line except the first.
fn inner(line: &Line) -> std::ops::Range<usize> {
    (line.pieces.start + 1).min(line.pieces.end)..line.pieces.end
}

/// Pairs of consecutive lines with nothing but comments between them, in the source and in the layout.
fn neighbours(lines: &[Line]) -> Vec<(usize, usize)> {
    let mut pairs = Vec::new();
    let mut above: Option<usize> = None;
    let mut between = 0;
    for (index, line) in lines.iter().enumerate() {
        if line.blank {
            above = None;
        }
        if line.comment {
            between += 1;
            continue;
        }
        if let Some(above) = above
            && line.source.0 == lines[above].source.1 + 1 + between
        {
            pairs.push((above, index));
        }
        (above, between) = (Some(index), 0);
    }
    pairs
}

/// The values without a sign that leave room for one, because a value below or above has it.
fn signless(lines: &Lines<'_>, neighbours: &[(usize, usize)]) -> Vec<bool> {
    let mut found = vec![false; lines.pieces.len()];
    let mut look = |line: usize, beside: usize| {
        for piece in inner(&lines.lines[line]) {
            let this = &lines.pieces[piece];
            if this.slot != Slot::Value || !can_move(this) || this.blanks.is_some_and(|b| b < 2) {
                continue;
            }
            let start = lines.lines[beside].pieces.start;
            let others = &lines.pieces[lines.lines[beside].pieces.clone()];
            let at = others.partition_point(|p| p.column + 1 < this.column);
            let near = others[at..].iter().enumerate().take_while(|(_, p)| p.column <= this.column);
            let leaves_room = near.into_iter().any(|(i, p)| match p.slot {
                Slot::Sign => p.space && p.column + 1 == this.column,
                _ => p.column == this.column && found[start + at + i],
            });
            if leaves_room {
                found[piece] = true;
            }
        }
    };
    for &(above, below) in neighbours {
        look(below, above);
    }
    for &(above, below) in neighbours.iter().rev() {
        look(above, below);
    }
    found
}

/// Applies the padding to the pieces' columns. Returns whether that changed anything.
fn apply_padding(lines: &mut Lines<'_>, padding: &[usize]) -> bool {
    let mut changed = false;
    let mut number = 0;
    for line in &mut lines.lines {
        number += usize::from(line.blank);
        line.source = (number, number);
        number += 1;
        let mut column = line.indent;
        for (index, piece) in line.pieces.clone().enumerate() {
            let before = if index == 0 { 0 } else { usize::from(lines.pieces[piece].space) + padding[piece] };
            let at = &mut lines.pieces[piece];
            column += before;
            let blanks = (index > 0).then_some(before);
            changed |= (at.column, at.blanks, at.pad) != (column, blanks, padding[piece]);
            (at.column, at.blanks, at.pad) = (column, blanks, padding[piece]);
            column += at.width;
        }
    }
    changed
}
