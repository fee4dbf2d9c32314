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

/// The minimum. Of 0 and -0 it is the first one, where `f64::min` leaves the choice to the machine: `atan2` tells them
/// apart.
#[inline]
fn least(a: f64, b: f64) -> f64 {
    if b < a || a.is_nan() { b } else { a }
}

/// The maximum; of 0 and -0 the first one.
#[inline]
fn greatest(a: f64, b: f64) -> f64 {
    if b > a || a.is_nan() { b } else { a }
}

/// A function of up to three numbers, `if` excepted.
pub fn call(function: Function, [a, b, c]: [f64; 3]) -> f64 {
    match function {
        Function::Min => least(a, b),
        Function::Max => greatest(a, b),
        Function::Abs => a.abs(),
        Function::Sign if a == 0.0 => 0.0,
        Function::Sign => a.signum(),
        // The upper bound wins where the bounds are crossed, as in min(max(x, low), high).
        Function::Clamp => least(greatest(a, b), c),
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
