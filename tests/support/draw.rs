//! What random programs are drawn from: a list of choices, so that a failing program shrinks. With all choices used up,
//! the first alternative is taken everywhere.

/// Draws from a list of choices.
pub struct Draw<'c>(std::slice::Iter<'c, u16>);

impl<'c> Draw<'c> {
    pub fn new(choices: &'c [u16]) -> Self {
        Draw(choices.iter())
    }

    /// A number below `count`.
    pub fn pick(&mut self, count: usize) -> usize {
        self.0.next().map_or(0, |c| usize::from(*c) % count.max(1))
    }

    /// True with a probability in percent.
    pub fn chance(&mut self, percent: usize) -> bool {
        self.0.next().is_some_and(|c| usize::from(*c) % 100 < percent)
    }

    /// One of some texts.
    pub fn one<'s>(&mut self, of: &[&'s str]) -> &'s str {
        of[self.pick(of.len())]
    }
}
