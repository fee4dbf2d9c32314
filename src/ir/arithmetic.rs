//! Operators and functions on numbers: the shared arithmetic of constant folding, the simulator and the analysis.

use super::{Arithmetic, CompareOp, Function};

/// The arithmetic of the simulator; division by zero gives no finite number.
pub fn arithmetic(op: Arithmetic, a: f64, b: f64) -> f64 {
    match op {
        Arithmetic::Add => a + b,
        Arithmetic::Subtract => a - b,
        Arithmetic::Multiply => a * b,
        Arithmetic::Divide => a / b,
    }
}

/// A comparison.
#[inline]
pub fn compare(op: CompareOp, a: f64, b: f64) -> bool {
    match op {
        CompareOp::Equal => a == b,
        CompareOp::Unequal => a != b,
        CompareOp::Less => a < b,
        CompareOp::AtMost => a <= b,
        CompareOp::Greater => a > b,
        CompareOp::AtLeast => a >= b,
    }
}

/// `a` less the whole multiple of `b` below it: from 0 to before `b`, whatever the sign of `a`.
fn modulo(a: f64, b: f64) -> f64 {
    // Exact, with the sign of `a`.
    let rest = a % b;
    if rest == 0.0 {
        return 0.0;
    }
    if (rest < 0.0) == (b < 0.0) {
        return rest;
    }
    let wrapped = rest + b;
    // A tiny rest is lost in the sum.
    if wrapped == b { 0.0 } else { wrapped }
}

/// The smaller and the larger of two numbers, chosen by comparison: of 0 and -0 the first one, where `f64::min` leaves
/// the choice to the machine and `atan2` tells them apart. A number comes before what is none.
pub trait Extremes: Copy {
    /// The minimum.
    fn least(self, other: Self) -> Self;
    /// The maximum.
    fn greatest(self, other: Self) -> Self;
}

macro_rules! extremes {
    ($($float:ty),*) => {$(
        impl Extremes for $float {
            #[inline]
            fn least(self, other: Self) -> Self {
                if other < self || self.is_nan() { other } else { self }
            }

            #[inline]
            fn greatest(self, other: Self) -> Self {
                if other > self || self.is_nan() { other } else { self }
            }
        }
    )*};
}

extremes!(f64, f32);

/// A function of up to three numbers, `if` excepted.
pub fn call(function: Function, [a, b, c]: [f64; 3]) -> f64 {
    match function {
        Function::Min => a.least(b),
        Function::Max => a.greatest(b),
        Function::Abs => a.abs(),
        Function::Sign if a == 0.0 => 0.0,
        Function::Sign => a.signum(),
        // The upper bound wins where the bounds are crossed, as in min(max(x, low), high).
        Function::Clamp => a.greatest(b).least(c),
        Function::Floor => a.floor(),
        Function::Ceil => a.ceil(),
        Function::Round => a.round(),
        Function::Sqrt => a.sqrt(),
        // The standard library's last bits differ between platforms.
        Function::Sin => libm::sin(a),
        Function::Cos => libm::cos(a),
        Function::Atan2 => libm::atan2(a, b),
        Function::Mod => modulo(a, b),
        Function::If => {
            if a != 0.0 {
                b
            } else {
                c
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_two_zeros_the_first_one_is_both_extremes() {
        let bits = |pair: [f64; 2]| pair.map(f64::to_bits);
        for (a, b) in [(0.0, -0.0), (-0.0, 0.0)] {
            assert_eq!(bits([a.least(b), a.greatest(b)]), bits([a, a]));
            assert_eq!(bits([Function::Min, Function::Max].map(|f| call(f, [a, b, 0.0]))), bits([a, a]));
        }
        assert_eq!([1.0.least(2.0), 2.0.least(1.0), 1.0.greatest(2.0), 2.0.greatest(1.0)], [1.0, 1.0, 2.0, 2.0]);
        assert_eq!(
            [f64::NAN.least(1.0), 1.0.least(f64::NAN), f64::NAN.greatest(1.0), 1.0.greatest(f64::NAN)],
            [1.0; 4]
        );
        assert_eq!([f32::NAN.least(1.0), (-1.0f32).greatest(1.0)], [1.0; 2]);
    }
}
