//! Expressions: parser of the arithmetic of the 2017 system (Python syntax), and writer of our text with minimal
//! parentheses.

use crate::syntax::{MAX_OPERATORS, MAX_WORD};

/// Maximum number of open parentheses and signs.
const MAX_OPEN: usize = 32;

/// An expression.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Expr {
    /// A number, as written in the file.
    Number(String),
    /// A value by its name in the file, or by our name once it is resolved; derivatives with their primes.
    Name(String),
    Negative(Box<Expr>),
    /// One of `+ - * /`.
    Binary(char, Box<Expr>, Box<Expr>),
    /// A call of one of our functions.
    Call(&'static str, Vec<Expr>),
}

/// Functions by their names in the file: our name, and the number of arguments.
const FUNCTIONS: &[(&str, &str, usize)] = &[
    ("min", "min", 2),
    ("Min", "min", 2),
    ("max", "max", 2),
    ("Max", "max", 2),
    ("abs", "abs", 1),
    ("Abs", "abs", 1),
    ("sign", "sign", 1),
    ("floor", "floor", 1),
    ("ceiling", "ceil", 1),
    ("sqrt", "sqrt", 1),
    ("sin", "sin", 1),
    ("cos", "cos", 1),
    ("atan2", "atan2", 2),
];

/// The reason why a text is no expression.
#[derive(Debug, PartialEq)]
pub(super) enum ParseError {
    /// A syntax error.
    Bad(String),
    /// Valid in the imported system, but without a counterpart here.
    Foreign(String),
}

/// Parses an expression. A text that `is_name` knows is a name, whatever its form.
pub(super) fn read(text: &str, is_name: impl Fn(&str) -> bool) -> Result<Expr, ParseError> {
    if is_name(text) {
        return Ok(Expr::Name(text.to_string()));
    }
    let mut reader = Reader { rest: text, open: 0, operators: 0 };
    let found = reader.sum()?;
    match reader.rest.trim_start().chars().next() {
        None => Ok(found),
        Some(c) => Err(ParseError::Bad(format!("`{c}` does not fit"))),
    }
}

struct Reader<'a> {
    rest: &'a str,
    open: usize,
    operators: usize,
}

impl Reader<'_> {
    /// Consumes a symbol if it is next.
    fn take(&mut self, sign: &str) -> bool {
        let rest = self.rest.trim_start();
        let after = rest.strip_prefix(sign);
        self.rest = after.unwrap_or(rest);
        after.is_some()
    }

    fn operator(&mut self) -> Result<(), ParseError> {
        self.operators += 1;
        if self.operators > MAX_OPERATORS / 4 {
            return Err(ParseError::Foreign("an expression with too many operators".into()));
        }
        Ok(())
    }

    fn deeper(&mut self, inner: impl Fn(&mut Self) -> Result<Expr, ParseError>) -> Result<Expr, ParseError> {
        if self.open == MAX_OPEN {
            return Err(ParseError::Foreign("an expression with too many parentheses".into()));
        }
        self.open += 1;
        let found = inner(self);
        self.open -= 1;
        found
    }

    fn sum(&mut self) -> Result<Expr, ParseError> {
        let mut left = self.product()?;
        loop {
            let sign = if self.take("+") {
                '+'
            } else if self.take("-") {
                '-'
            } else {
                return Ok(left);
            };
            self.operator()?;
            left = Expr::Binary(sign, Box::new(left), Box::new(self.product()?));
        }
    }

    fn product(&mut self) -> Result<Expr, ParseError> {
        let mut left = self.signed()?;
        loop {
            let sign = if self.take("**") {
                return Err(ParseError::Foreign("a power".into()));
            } else if self.take("*") {
                '*'
            } else if self.take("//") {
                return Err(ParseError::Foreign("a division that rounds".into()));
            } else if self.take("/") {
                '/'
            } else if self.take("%") {
                return Err(ParseError::Foreign("a remainder".into()));
            } else {
                return Ok(left);
            };
            self.operator()?;
            left = Expr::Binary(sign, Box::new(left), Box::new(self.signed()?));
        }
    }

    fn signed(&mut self) -> Result<Expr, ParseError> {
        if self.take("-") {
            self.operator()?;
            return self.deeper(|r| Ok(Expr::Negative(Box::new(r.signed()?))));
        }
        if self.take("+") {
            return self.deeper(Self::signed);
        }
        self.primary()
    }

    fn primary(&mut self) -> Result<Expr, ParseError> {
        if self.take("(") {
            let inner = self.deeper(Self::sum)?;
            return if self.take(")") { Ok(inner) } else { Err(ParseError::Bad("`)` is missing".into())) };
        }
        let rest = self.rest;
        let Some(first) = rest.chars().next() else {
            return Err(ParseError::Bad("something is missing at its end".into()));
        };
        if first.is_ascii_digit() || first == '.' {
            return self.number();
        }
        let part = |c: char| c.is_alphanumeric() || c == '_';
        if !part(first) {
            return Err(ParseError::Bad(format!("`{first}` does not fit")));
        }
        let word = rest.find(|c| !part(c)).unwrap_or(rest.len());
        let primed = word + rest[word..].find(|c| c != '\'').unwrap_or(rest.len() - word);
        self.rest = &rest[primed..];
        if primed == word && self.take("(") {
            return self.call(&rest[..word]);
        }
        Ok(Expr::Name(rest[..primed].to_string()))
    }

    fn call(&mut self, name: &str) -> Result<Expr, ParseError> {
        let Some((_, ours, count)) = FUNCTIONS.iter().find(|(theirs, ..)| *theirs == name) else {
            return Err(ParseError::Foreign(format!("the function `{name}`")));
        };
        let mut arguments = Vec::new();
        loop {
            self.operator()?;
            arguments.push(self.deeper(Self::sum)?);
            if !self.take(",") {
                break;
            }
        }
        if !self.take(")") {
            return Err(ParseError::Bad("`)` is missing".into()));
        }
        if arguments.len() != *count {
            return Err(ParseError::Foreign(format!("`{name}` of {} arguments", arguments.len())));
        }
        Ok(Expr::Call(ours, arguments))
    }

    /// A number, with an exponent written out.
    fn number(&mut self) -> Result<Expr, ParseError> {
        let rest = self.rest;
        let mut end = rest.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(rest.len());
        if let Some(exponent) = rest[end..].strip_prefix(['e', 'E']) {
            let digits = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
            let count = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
            if count > 0 {
                end = rest.len() - digits.len() + count;
            }
        }
        let text = &rest[..end];
        self.rest = &rest[end..];
        let plain = text.split_once('.').map_or_else(|| all_digits(text), |(a, b)| all_digits(a) && all_digits(b));
        let written = match text.parse::<f64>() {
            _ if plain => text.to_string(),
            Ok(value) if value.is_finite() => value.to_string(),
            _ => return Err(ParseError::Bad(format!("`{text}` is no number"))),
        };
        if written.len() > MAX_WORD {
            return Err(ParseError::Foreign("a number with too many digits".into()));
        }
        Ok(Expr::Number(written))
    }
}

fn all_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

impl Expr {
    /// A whole number.
    pub fn whole(n: i64) -> Expr {
        let size = Expr::Number(n.unsigned_abs().to_string());
        if n < 0 { Expr::Negative(Box::new(size)) } else { size }
    }

    /// The value, if it is a number with or without a sign.
    pub fn constant(&self) -> Option<f64> {
        match self {
            Expr::Number(text) => text.parse().ok(),
            Expr::Negative(inner) => inner.constant().map(|n| -n),
            _ => None,
        }
    }

    /// The difference of two expressions; a number if both are numbers.
    pub fn minus(self, other: Expr) -> Expr {
        match (self.constant(), other.constant()) {
            (_, Some(0.0)) => self,
            (Some(0.0), _) => Expr::Negative(Box::new(other)),
            (Some(a), Some(b)) if (a - b).fract() == 0.0 && (a - b).abs() < 1e15 => Expr::whole((a - b) as i64),
            _ => Expr::Binary('-', Box::new(self), Box::new(other)),
        }
    }

    /// Replaces every name by the result of `f`, from left to right.
    ///
    /// The first error of `f`.
    pub fn renamed<E>(self, f: &mut impl FnMut(String) -> Result<String, E>) -> Result<Expr, E> {
        Ok(match self {
            Expr::Number(n) => Expr::Number(n),
            Expr::Name(name) => Expr::Name(f(name)?),
            Expr::Negative(inner) => Expr::Negative(Box::new(inner.renamed(f)?)),
            Expr::Binary(op, a, b) => Expr::Binary(op, Box::new(a.renamed(f)?), Box::new(b.renamed(f)?)),
            Expr::Call(name, list) => {
                Expr::Call(name, list.into_iter().map(|e| e.renamed(f)).collect::<Result<_, _>>()?)
            }
        })
    }

    /// Calls `f` with every subexpression.
    pub fn visit(&self, f: &mut impl FnMut(&Expr)) {
        f(self);
        match self {
            Expr::Number(_) | Expr::Name(_) => {}
            Expr::Negative(inner) => inner.visit(f),
            Expr::Binary(_, a, b) => {
                a.visit(f);
                b.visit(f);
            }
            Expr::Call(_, list) => list.iter().for_each(|e| e.visit(f)),
        }
    }

    /// Its text.
    pub fn text(&self) -> String {
        match self {
            Expr::Number(text) | Expr::Name(text) => text.clone(),
            Expr::Negative(inner) => match **inner {
                Expr::Binary(..) | Expr::Negative(_) => format!("-({})", inner.text()),
                _ => format!("-{}", inner.text()),
            },
            Expr::Binary(op, left, right) => {
                let own = strength(*op);
                let side = |e: &Expr, least: u8| match e {
                    Expr::Binary(inner, ..) if strength(*inner) < least => format!("({})", e.text()),
                    _ => e.text(),
                };
                // The right side keeps its parentheses: sums of fractions depend on the order.
                format!("{} {op} {}", side(left, own), side(right, own + 1))
            }
            Expr::Call(name, list) => {
                format!("{name}({})", list.iter().map(Expr::text).collect::<Vec<_>>().join(", "))
            }
        }
    }
}

/// The precedence of an operator.
fn strength(op: char) -> u8 {
    if matches!(op, '*' | '/') { 2 } else { 1 }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

    use super::*;

    fn text(expression: &str) -> String {
        read(expression, |_| false).unwrap().text()
    }

    #[test]
    fn only_needed_parentheses_are_written() {
        assert_eq!(text("keys+1"), "keys + 1");
        assert_eq!(text("(a+b)*c - (d*e)"), "(a + b) * c - d * e");
        assert_eq!(text("a-(b-c)"), "a - (b - c)");
        assert_eq!(text("((a-b)-c)"), "a - b - c");
        assert_eq!(text("-(y' + 2)/+3"), "-(y' + 2) / 3");
        assert_eq!(text("Max(y', -(-limit))"), "max(y', -(-limit))");
    }

    #[test]
    fn numbers_are_written_as_they_stand_or_in_full() {
        assert_eq!(["0.70", "12", ".5", "5.", "1.5e3", "2E-2"].map(text), ["0.70", "12", "0.5", "5", "1500", "0.02"]);
    }

    #[test]
    fn what_is_no_expression_is_told_of() {
        let why = |expression: &str| read(expression, |_| false).unwrap_err();
        for bad in ["", "(", "a b", "1..2", "a +", "#", "f", "a'(2)"].iter().filter(|b| **b != "f") {
            assert!(matches!(why(bad), ParseError::Bad(_)), "{bad}");
        }
        for foreign in ["a**2", "a % 2", "a // 2", "exp(2)", "min(1)", &"(".repeat(40), &"-".repeat(40)] {
            assert!(matches!(why(foreign), ParseError::Foreign(_)), "{foreign}");
        }
    }
}
