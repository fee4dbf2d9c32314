//! Exponents of dimensions: fractions, added and multiplied as long as they can be represented exactly.

/// A fraction in lowest terms with a positive denominator.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Ratio(pub i64, pub i64);

impl Ratio {
    pub const ZERO: Ratio = Ratio(0, 1);
    pub const ONE: Ratio = Ratio(1, 1);

    pub fn new(n: i64, d: i64) -> Ratio {
        let (mut a, mut b) = (n.unsigned_abs(), d.unsigned_abs());
        while b != 0 {
            (a, b) = (b, a % b);
        }
        let g = (a.max(1) as i64) * d.signum();
        Ratio(n / g, d / g)
    }

    /// `None` if it cannot be represented exactly.
    pub fn plus(self, o: Ratio) -> Option<Ratio> {
        let sum = self.0.checked_mul(o.1)?.checked_add(o.0.checked_mul(self.1)?)?;
        Ratio::checked(sum, self.1.checked_mul(o.1)?)
    }

    /// `None` if it cannot be represented exactly.
    pub fn times(self, o: Ratio) -> Option<Ratio> {
        Ratio::checked(self.0.checked_mul(o.0)?, self.1.checked_mul(o.1)?)
    }

    /// Both numbers of a ratio can be negated without overflow.
    fn checked(n: i64, d: i64) -> Option<Ratio> {
        (n != i64::MIN && d != i64::MIN).then(|| Ratio::new(n, d))
    }
}
