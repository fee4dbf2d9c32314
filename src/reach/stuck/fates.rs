//! What becomes of each state of a graph: whether it can still arrive, go on for ever without arriving, or only end.

use super::graph::successors;

/// The best that the inputs can still bring about from a state.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fate {
    /// Some inputs reach the goal.
    Arrives,
    /// No inputs do, and some go on for ever.
    Stuck,
    /// No inputs do, and all inputs end the run sooner or later, or leave no player.
    Doomed,
}

/// The fate of each state of a graph, given by the successors of each state, and by which are goals and which have no
/// player.
///
/// Two fixpoints: what arrives is the least set with the goals and each state that has a successor in it; of the rest,
/// what goes on for ever is the greatest set of states that lead to a player and have a successor in the set.
pub(super) fn fates(first: &[u32], next: &[u32], is_goal: &[bool], is_gone: &[bool]) -> Vec<Fate> {
    let states = is_goal.len() as u32;
    let before = reversed(first, next, states);
    let arrives = leading_to(&before, is_goal.to_vec());
    let has_players = leading_to(&before, is_gone.iter().map(|gone| !gone).collect());
    let fate = |arrives: &bool| if *arrives { Fate::Arrives } else { Fate::Stuck };
    let mut fates: Vec<Fate> = arrives.iter().map(fate).collect();
    let (before_first, before) = before;
    // For each of the rest, how many of its successors can go on. None of them arrives.
    let mut left: Vec<u32> = (0..states).map(|state| successors(first, next, state).len() as u32).collect();
    let ends = |state: &u32| left[*state as usize] == 0 || !has_players[*state as usize];
    let mut open: Vec<u32> = (0..states).filter(|state| fates[*state as usize] == Fate::Stuck && ends(state)).collect();
    open.iter().for_each(|state| fates[*state as usize] = Fate::Doomed);
    while let Some(state) = open.pop() {
        for &from in successors(&before_first, &before, state) {
            let at = from as usize;
            if fates[at] == Fate::Stuck {
                left[at] -= 1;
                if left[at] == 0 {
                    fates[at] = Fate::Doomed;
                    open.push(from);
                }
            }
        }
    }
    fates
}

/// The states that lead to one of some states, these included.
fn leading_to((before_first, before): &(Vec<u32>, Vec<u32>), mut leads: Vec<bool>) -> Vec<bool> {
    let mut open: Vec<u32> = (0u32..).zip(&leads).filter(|(_, leads)| **leads).map(|(state, _)| state).collect();
    while let Some(state) = open.pop() {
        for &from in successors(before_first, before, state) {
            if !std::mem::replace(&mut leads[from as usize], true) {
                open.push(from);
            }
        }
    }
    leads
}

/// The graph with all edges turned around, in the same form.
fn reversed(first: &[u32], next: &[u32], states: u32) -> (Vec<u32>, Vec<u32>) {
    let mut begins = vec![0u32; states as usize + 1];
    for &to in next {
        begins[to as usize + 1] += 1;
    }
    for at in 1..begins.len() {
        begins[at] += begins[at - 1];
    }
    let mut free = begins.clone();
    let mut before = vec![0; next.len()];
    for from in 0..states {
        for &to in successors(first, next, from) {
            before[free[to as usize] as usize] = from;
            free[to as usize] += 1;
        }
    }
    (begins, before)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fates in a graph by its lists of successors, a letter a state.
    fn letters(graph: &[&[u32]], goals: &[u32], gone: &[u32]) -> String {
        let mut first = vec![0];
        let mut next = Vec::new();
        for successors in graph {
            next.extend_from_slice(successors);
            first.push(next.len() as u32);
        }
        let among = |states: &[u32]| (0..graph.len() as u32).map(|state| states.contains(&state)).collect::<Vec<_>>();
        let letter = |fate: &Fate| match fate {
            Fate::Arrives => 'a',
            Fate::Stuck => 's',
            Fate::Doomed => 'd',
        };
        fates(&first, &next, &among(goals), &among(gone)).iter().map(letter).collect()
    }

    #[test]
    fn states_arrive_or_are_stuck_or_doomed() {
        // 0 leads to the goal 1, to a cycle 2-3 and to a dead end 4 that leads to 5 and ends there.
        assert_eq!(letters(&[&[1, 2, 4], &[], &[3], &[2], &[5], &[]], &[1], &[]), "aassdd");
        // What leads to a cycle as well as to an end is stuck; what stays where it is, too.
        assert_eq!(letters(&[&[1, 2], &[], &[2]], &[], &[]), "sds");
        assert_eq!(letters(&[&[0, 1], &[]], &[1], &[]), "aa");
        // In 1 no player is left for good; in 2 none is until 3.
        assert_eq!(letters(&[&[1], &[1]], &[], &[1]), "dd");
        assert_eq!(letters(&[&[1, 2], &[1], &[3], &[2]], &[], &[1, 2]), "sdss");
    }
}
