//! Forms of other languages, and declarations that leave out a part: operators, inheritance, `discrete` without its
//! values, `player` without its number.

use super::Rule;
use super::likely_fix::{Failure, LikelyFix, word};
use super::word::is_reserved;

/// The most likely fix of a form that the language writes differently.
pub(super) fn foreign(failed: &Failure<'_>) -> Option<LikelyFix> {
    discrete(failed)
        .or_else(|| clamp(failed))
        .or_else(|| tile_size(failed))
        .or_else(|| inheritance(failed))
        .or_else(|| player(failed))
        .or_else(|| place(failed))
        .or_else(|| point(failed))
        .or_else(|| question(failed))
        .or_else(|| look(failed))
        .or_else(|| tile(failed))
        .or_else(|| setting(failed))
        .or_else(|| own_name(failed))
        .or_else(|| another(failed))
        .or_else(|| remainder(failed))
        .or_else(|| power(failed))
        .or_else(|| choice(failed))
        .or_else(|| reserved(failed))
}

/// A word of the language where only a name can be.
fn reserved(failed: &Failure<'_>) -> Option<LikelyFix> {
    let is_name_expected = matches!(failed.expected, [only] if only == "a name");
    let found = failed.found;
    (is_name_expected && is_reserved(found))
        .then(|| LikelyFix::new(format!("`{found}` is a word of the language and never a name; `{found}_` can be one")))
}

/// Whether a text begins with a name.
fn begins_with_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

pub(super) fn begins_with_capital(text: &str) -> bool {
    text.starts_with(char::is_uppercase)
}

/// The words between the first word of a statement and the unexpected token.
fn after_first<'a>(failed: &Failure<'a>, first: &str) -> Option<&'a str> {
    if failed.first_word() != first {
        return None;
    }
    Some(failed.before().strip_prefix(first)?.trim())
}

/// A `discrete` variable without its values, or without a part of them.
fn discrete(failed: &Failure<'_>) -> Option<LikelyFix> {
    let declared = after_first(failed, "discrete").filter(|_| failed.rule == Rule::only_member)?;
    let (name, end) = (word(declared), failed.before().trim_end().len());
    // With nothing after it, any value fits.
    let is_range_expected = failed.expects("`..`");
    let value = match failed.rest().split_once('=') {
        _ if failed.found.is_empty() => Some("0"),
        Some((before, value)) if before.is_empty() || is_range_expected => Some(value),
        _ => None,
    };
    let value = value.map(|value| value.split("//").next().unwrap_or_default().trim());
    let domain = declared.strip_prefix(name).map_or("", |rest| rest.trim_start().trim_start_matches(':').trim());
    match value {
        Some("true" | "false") if failed.expects("`:`") => {
            let help = format!("a `discrete` variable names its values: `{name}: bool`");
            Some(LikelyFix::replacement(help, end..failed.at, ": bool "))
        }
        Some(value) if failed.expects("`:`") && !name.is_empty() => {
            let whole = whole_range(value);
            let help = format!("a `discrete` variable names its values: `{name}: {whole}`, `{name}: bool` or");
            Some(LikelyFix::new(format!("{help} `{name}: {{a, b}}`")))
        }
        Some(value) if domain == "int" || domain.starts_with("int ") && is_range_expected => {
            let whole = whole_range(value);
            Some(LikelyFix::new(format!("`int` needs a range, such as `{name}: {whole} = {value}`")))
        }
        Some(_) if failed.found.is_empty() && failed.expects("`=`") => {
            let first = match domain.strip_prefix('{') {
                Some(names) => word(names.trim_start()),
                None if domain == "bool" => "false",
                None => "0",
            };
            let example = format!("`{name}: {domain} = {first}`");
            Some(LikelyFix::new(format!("a `discrete` variable has a first value, such as {example}")))
        }
        _ if domain.is_empty() && failed.expected.iter().any(|expected| expected.starts_with("`int LOW")) => {
            foreign_domain(failed, name)
        }
        _ => None,
    }
}

/// The values of a `discrete` variable under the name that other languages have for them.
fn foreign_domain(failed: &Failure<'_>, name: &str) -> Option<LikelyFix> {
    let at = failed.at..failed.at + failed.found.len();
    match failed.found {
        "boolean" | "Bool" | "Boolean" => Some(LikelyFix::replacement("truth values are `bool`", at, "bool")),
        "integer" | "Int" | "number" | "uint" | "Integer" => {
            Some(LikelyFix::new(format!("whole numbers need a range, such as `{name}: int 0..9`")))
        }
        "float" | "double" | "real" | "Float" => {
            Some(LikelyFix::new(format!("numbers with a fraction are declared as `continuous {name} = 0`")))
        }
        found if found.starts_with(|c: char| c.is_ascii_digit() || c == '-') => {
            Some(LikelyFix::replacement("whole numbers of a range are written `int 0..9`", at.start..at.start, "int "))
        }
        _ => None,
    }
}

/// A range for a whole number: `int 0..9` if it is one of these.
fn whole_range(value: &str) -> String {
    let size = value.strip_prefix('-').unwrap_or(value);
    let is_whole = !size.is_empty() && size.bytes().all(|b| b.is_ascii_digit());
    let high = "9".repeat(if is_whole { size.len().min(9) } else { 1 });
    let low = if is_whole && size.len() < value.len() { format!("-{high}") } else { "0".to_string() };
    format!("int {low}..{high}")
}

/// A clamp with a strict comparison, or with its bound first.
fn clamp(failed: &Failure<'_>) -> Option<LikelyFix> {
    let target = after_first(failed, "clamp").filter(|_| failed.rule == Rule::only_member)?;
    if target.is_empty() {
        let help = "a clamp begins with the variable: `clamp x' in -50..50`, or `clamp x' >= -50`";
        return Some(LikelyFix::new(help));
    }
    let Some(sign) = Some(failed.found).filter(|found| [">", "<"].contains(found)) else {
        let is_bound = ["=", "-", "to", "from", "between", "within", ":", ""].contains(&failed.found)
            || failed.found.starts_with(|c: char| c.is_ascii_digit());
        let is_alone = is_bound && target.trim_end_matches('\'') == word(target);
        return is_alone.then(|| {
            LikelyFix::new(format!(
                "a clamp has two bounds, `clamp {target} in -50..50`, or one, `clamp {target} >= -50`"
            ))
        });
    };
    let help = format!("a bound is itself allowed: write `{sign}=`");
    Some(LikelyFix::replacement(help, failed.at..failed.at + 1, format!("{sign}=")))
}

/// `16x16` without blanks, or with another sign.
fn tile_size(failed: &Failure<'_>) -> Option<LikelyFix> {
    let is_size = match failed.rule {
        Rule::only_world_item => failed.first_word() == "tiles",
        Rule::only_space_item => failed.first_word() == "map" && failed.before().contains(" tile "),
        _ => false,
    };
    let width = failed.before().trim_end();
    if !is_size || !width.ends_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let rest = failed.rest();
    let height = rest.strip_prefix(['x', 'X', '×', '*', ','])?.trim_start();
    let (end, height) = (failed.slice.len() - height.len(), word(height));
    let is_number = !height.is_empty() && height.bytes().all(|b| b.is_ascii_digit());
    let width = width.get(width.rfind(|c: char| !c.is_ascii_digit()).map_or(0, |at| at + 1)..)?;
    let help = format!("width and height are apart: `{width} x {height}`");
    is_number.then(|| LikelyFix::replacement(help, failed.before().trim_end().len()..end, " x "))
}

/// The header of a class.
fn inheritance(failed: &Failure<'_>) -> Option<LikelyFix> {
    let name = after_first(failed, "entity").filter(|_| failed.rule == Rule::only_item)?;
    let rest = failed.rest();
    if name.is_empty() || name.contains(char::is_whitespace) || !failed.expects("`{`") {
        return None;
    }
    let is_word = ["extends", "inherits", "implements", "is", "like", "of", "from"].contains(&failed.found);
    let inside = rest.strip_prefix([':', '(', '<']).map(str::trim_start);
    if is_word || inside.is_some_and(begins_with_capital) {
        return Some(LikelyFix::new(
            "entities do not inherit: what several of them share is a `behavior`, which each takes with `use`",
        ));
    }
    let is_list = rest.starts_with('(');
    is_list.then(|| LikelyFix::new("an entity declares its parameters inside of its block: `param speed = 60`"))
}

/// A player without its number, or without a colon.
fn player(failed: &Failure<'_>) -> Option<LikelyFix> {
    let number = after_first(failed, "player").filter(|_| failed.rule == Rule::only_world_item)?;
    let is_number = number.bytes().all(|b| b.is_ascii_digit());
    let rest = failed.rest();
    // `player one: hero`
    let named = rest.strip_prefix(word(rest)).map(str::trim_start).filter(|_| number.is_empty());
    let named = named.filter(|rest| rest.starts_with([':', '='])).unwrap_or(rest);
    let after_sign = named.strip_prefix([':', '=']).map(str::trim_start);
    let instance = word(after_sign.unwrap_or(rest));
    if !is_number || !begins_with_name(instance) {
        return None;
    }
    let number = if number.is_empty() { "1" } else { number };
    let help = format!("players have numbers: `player {number}: {instance}`");
    let end = failed.slice.len() - after_sign.unwrap_or(rest).len();
    Some(LikelyFix::replacement(help, "player".len()..end, format!(" {number}: ")))
}

/// An instance without its name.
fn place(failed: &Failure<'_>) -> Option<LikelyFix> {
    let written = after_first(failed, "place").filter(|_| failed.rule == Rule::only_space_item)?;
    if written.is_empty() || !failed.expects("`:`") {
        return None;
    }
    let found = failed.found;
    if !begins_with_capital(written) && begins_with_capital(found) {
        let help = format!("a colon is between the name and its entity: `place {written}: {found}`");
        return Some(LikelyFix::replacement(help, failed.before().trim_end().len()..failed.at, ": "));
    }
    let (name, entity) = match begins_with_capital(written) {
        true if begins_with_name(found) && found != "at" => (found.to_string(), written.to_string()),
        true => (with_first(written, |c| c.to_lowercase().collect()), written.to_string()),
        false => (written.to_string(), with_first(written, |c| c.to_uppercase().collect())),
    };
    let at = failed.rest().find('(').and_then(|at| failed.rest().get(at..));
    let point = at.and_then(|at| at.get(..=at.find(')')?)).filter(|point| point.len() <= 20).unwrap_or("(0, 0)");
    Some(LikelyFix::new(format!("an instance has a name of its own: `place {name}: {entity} at {point}`")))
}

/// A position without parentheses.
fn point(failed: &Failure<'_>) -> Option<LikelyFix> {
    let is_place = failed.rule == Rule::only_space_item && failed.first_word() == "place";
    if is_place && failed.expects("`at`") {
        let help = "a position follows `at`: `place hero: Hero at (0, 0)`";
        let is_missing = failed.rest().starts_with('(');
        let text = if failed.before().ends_with(' ') { "at " } else { " at " };
        return Some(match is_missing {
            true => LikelyFix::replacement(help, failed.at..failed.at, text),
            false => LikelyFix::new(help),
        });
    }
    if !is_place || !failed.before().trim_end().ends_with(" at") {
        return None;
    }
    let rest = failed.rest();
    let end = rest.find(['{', '\n', '/']).unwrap_or(rest.len());
    let (x, y) = rest.get(..end)?.split_once(',')?;
    let text = format!("({}, {})", x.trim(), y.trim());
    let end = failed.at + x.len() + 1 + y.trim_end().len();
    Some(LikelyFix::replacement(format!("a point is in parentheses: `{text}`"), failed.at..end, text))
}

/// A goal or a `never` without its name, or without a colon.
fn question(failed: &Failure<'_>) -> Option<LikelyFix> {
    let kind = failed.first_word();
    let name = after_first(failed, kind).filter(|_| failed.rule == Rule::only_world_item)?;
    if !["goal", "never"].contains(&kind) {
        return None;
    }
    let rest = failed.rest();
    let is_assigned = failed.found == "=" && !failed.before().contains(':');
    if is_assigned || (failed.expects("`:`") && !name.is_empty() && begins_with_name(rest)) {
        let sign = usize::from(is_assigned);
        let range = failed.before().trim_end().len()..failed.at + sign;
        let help = format!("a colon is between the name and the predicate: `{kind} {name}: …`");
        return Some(LikelyFix::replacement(help, range, if sign > 0 { ":" } else { ": " }));
    }
    let is_named = !name.is_empty() && !failed.expects("`:`");
    (!is_named).then(|| LikelyFix::new(format!("a `{kind}` has a name: `{kind} NAME: PREDICATE`")))
}

/// The name of a colour, or a look of tags without a colon.
fn look(failed: &Failure<'_>) -> Option<LikelyFix> {
    if failed.first_word() != "look" {
        return None;
    }
    let rest = failed.rest();
    let is_named = failed.rule == Rule::only_member && failed.before().trim() == "look" && begins_with_name(rest);
    if is_named {
        return Some(LikelyFix::new("a look is a colour, `look #e04030`, or a picture, `look \"hero.png\"`"));
    }
    let is_joined = failed.rule == Rule::only_world_item && failed.expects("`:`") && rest.starts_with(['#', '"']);
    is_joined.then(|| {
        let range = failed.before().trim_end().len()..failed.at;
        LikelyFix::replacement("a colon is between the tags and their look: `look coin: #ffd040`", range, ": ")
    })
}

/// A tile's character without its quotes, or two tiles on one line.
fn tile(failed: &Failure<'_>) -> Option<LikelyFix> {
    if !matches!(failed.rule, Rule::only_tile | Rule::only_kind) {
        return None;
    }
    let rest = failed.rest();
    if failed.at > 0 {
        let before = failed.before().trim_end();
        let last = before.trim_end_matches(',').trim_end();
        let is_next =
            rest.starts_with('\'') && (last.len() < before.len() || failed.expects("the end of the statement"));
        let help = "tiles are on lines of their own, or separated by `;`";
        return is_next.then(|| LikelyFix::replacement(help, last.len()..failed.at, "; "));
    }
    let (character, end) = match rest.strip_prefix('"') {
        Some(quoted) => (quoted.chars().next()?, 2),
        None => (rest.chars().next()?, 0),
    };
    let end = end + character.len_utf8();
    let is_alone = rest.get(end..)?.trim_start().starts_with([':', '=']);
    if !is_alone || rest.starts_with('\'') {
        return None;
    }
    let help = format!("a tile's character is in single quotes: `'{character}'`");
    Some(LikelyFix::replacement(help, 0..end, format!("'{character}'")))
}

/// A setting of an instance with another sign.
fn setting(failed: &Failure<'_>) -> Option<LikelyFix> {
    let is_sign = failed.expects("`=`") && [":", ":="].contains(&failed.found);
    (failed.rule == Rule::only_setting && is_sign).then(|| {
        let gap = if failed.before().ends_with(' ') { "=" } else { " =" };
        LikelyFix::replacement("a setting is written `x = 1`", failed.at..failed.at + failed.found.len(), gap)
    })
}

/// A name with another first letter.
pub(super) fn with_first(name: &str, change: impl Fn(char) -> String) -> String {
    let mut letters = name.chars();
    letters.next().map(change).into_iter().chain(letters.map(String::from)).collect()
}

/// `self.x` or `this.x` for `x`.
fn own_name(failed: &Failure<'_>) -> Option<LikelyFix> {
    for own in ["self", "this"] {
        let start = match failed.found {
            "." => failed.before().strip_suffix(own).map(str::len),
            found if found == own => Some(failed.at),
            _ => None,
        };
        let Some(start) = start else { continue };
        let before = failed.slice.get(..start)?;
        let name = failed.slice.get(start..)?.strip_prefix(own)?.strip_prefix('.').map(word)?;
        if !begins_with_name(name) || before.ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == '.') {
            continue;
        }
        let help = format!("an entity's own names stand alone: `{name}`");
        return Some(LikelyFix::replacement(help, start..start + own.len() + 1, ""));
    }
    None
}

/// An update or a flow of another instance's variable.
fn another(failed: &Failure<'_>) -> Option<LikelyFix> {
    let of = failed.before().trim();
    let is_statement = matches!(failed.rule, Rule::only_update | Rule::only_member) && of == failed.first_word();
    if !is_statement || failed.found != "." || of.is_empty() {
        return None;
    }
    let path = failed.rest().strip_prefix('.')?;
    let name = word(path);
    let sign = path.get(name.len()..)?.trim_start_matches('\'').trim_start();
    let is_set = [":=", "=", "+=", "-=", "*=", "/=", "++", "--"].iter().any(|sets| sign.starts_with(sets));
    (is_set && begins_with_name(name)).then(|| {
        LikelyFix::new(format!(
            "an entity sets only its own variables: `{name}` is set by an edge in the entity of `{of}`"
        ))
    })
}

/// Whether a character is part of a number, a variable or a path.
fn is_part(c: char) -> bool {
    c.is_alphanumeric() || matches!(c, '_' | '\'' | '.')
}

/// The start of the operand that ends a text: a number, a name, a call, an expression in parentheses.
fn operand_before(text: &str) -> Option<usize> {
    let name = |text: &str| text.trim_end_matches(is_part).len();
    let text = text.trim_end();
    if !text.ends_with(')') {
        let start = name(text);
        return (start < text.len()).then_some(start);
    }
    let mut depth = 0;
    for (at, c) in text.char_indices().rev() {
        match c {
            ')' => depth += 1,
            '(' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some(name(text.get(..at)?));
        }
    }
    None
}

/// The operand that begins a text, as it is written.
fn operand_after(text: &str) -> Option<&str> {
    let sign = usize::from(text.starts_with('-'));
    let mut end = text.get(sign..)?.find(|c: char| !is_part(c)).map_or(text.len(), |at| at + sign);
    if text.get(end..)?.starts_with('(') {
        let mut depth = 0;
        let closes = |(_, c): &(usize, char)| {
            depth += match c {
                '(' => 1,
                ')' => -1,
                _ => 0,
            };
            depth == 0
        };
        end += text.get(end..)?.char_indices().find(closes)?.0 + 1;
    }
    text.get(..end).filter(|operand| operand.len() > sign)
}

/// Whether an operand belongs to a product or has a sign of its own, so that it is not all of the left side.
fn is_bound(before: &str) -> bool {
    let before = before.trim_end();
    let is_sign = before.strip_suffix('-').is_some_and(|rest| {
        let rest = rest.trim_end();
        rest.is_empty() || !rest.ends_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | '\'' | ')'))
    });
    is_sign || before.ends_with(['*', '/', '%', '^'])
}

/// `a % b` or `a mod b`.
fn remainder(failed: &Failure<'_>) -> Option<LikelyFix> {
    let sign = Some(failed.found).filter(|found| ["%", "mod", "rem"].contains(found))?;
    if !failed.expects("an operator") {
        return None;
    }
    let rest = failed.rest().get(sign.len()..)?;
    let gap = rest.len() - rest.trim_start().len();
    let start = operand_before(failed.before());
    let both = start.zip(operand_after(rest.trim_start()));
    let Some((start, right)) = both.filter(|(start, _)| !is_bound(failed.slice.get(..*start).unwrap_or_default()))
    else {
        return Some(LikelyFix::new("the remainder is written `mod(a, b)`"));
    };
    let text = format!("mod({}, {right})", failed.before().get(start..)?.trim_end());
    let end = failed.at + sign.len() + gap + right.len();
    Some(LikelyFix::replacement(format!("the remainder is written `{text}`"), start..end, text))
}

/// What there is instead of powers.
pub(crate) const NO_POWER: &str = "there is no power: `a * a` is the square of `a`, `sqrt(a)` its root";

/// `a ^ 2` or `a ** 2`.
fn power(failed: &Failure<'_>) -> Option<LikelyFix> {
    let is_caret = failed.found == "^" && failed.expects("an operator");
    let is_stars = failed.found == "*" && failed.before().ends_with('*');
    if !is_caret && !is_stars {
        return None;
    }
    let before = if is_stars { failed.before().get(..failed.at - 1)? } else { failed.before() };
    let rest = failed.rest().get(1..)?;
    let gap = rest.len() - rest.trim_start().len();
    let start = operand_before(before);
    let (start, left) = (start?, before.get(start?..)?.trim_end());
    let exponent = operand_after(rest.trim_start()).unwrap_or_default();
    let end = failed.at + 1 + gap + exponent.len();
    let is_last = !failed.slice.get(end..)?.trim_start().starts_with(['^', '*']);
    let text = match exponent {
        _ if !is_last => return Some(LikelyFix::new(NO_POWER)),
        "2" => format!("{left} * {left}"),
        "3" => format!("{left} * {left} * {left}"),
        "0.5" => format!("sqrt({})", left.strip_prefix('(').and_then(|l| l.strip_suffix(')')).unwrap_or(left)),
        _ => return Some(LikelyFix::new(NO_POWER)),
    };
    let is_divisor = before.get(..start)?.trim_end().ends_with('/');
    let text = if is_divisor && exponent != "0.5" { format!("({text})") } else { text };
    Some(LikelyFix::replacement(format!("there is no power: write `{text}`"), start..end, text))
}

/// `c ? a : b`
fn choice(failed: &Failure<'_>) -> Option<LikelyFix> {
    if failed.found != "?" || !failed.expects("an operator") {
        return None;
    }
    let general = || Some(LikelyFix::new("a choice is written `if(condition, a, b)`"));
    let sets = [":=", " = "].iter().filter_map(|sign| failed.before().find(sign).map(|at| at + sign.len())).min();
    let is_whole = matches!(failed.rule, Rule::only_update | Rule::only_member | Rule::only_item)
        && !["when", "invariant", "collider"].contains(&failed.first_word());
    let Some(start) = sets.filter(|_| is_whole) else { return general() };
    let rest = failed.rest().get(1..)?;
    let rest = rest.split("//").next().unwrap_or_default().trim_end();
    let (Some((a, b)), Some(condition)) = (rest.split_once(':'), failed.before().get(start..)) else {
        return general();
    };
    let parts = [condition, a, b].map(str::trim);
    let is_balanced = |part: &str| part.matches('(').count() == part.matches(')').count();
    if parts.iter().any(|part| part.is_empty() || part.contains(['?', ':', '{']) || !is_balanced(part)) {
        return general();
    }
    let text = format!("if({})", parts.join(", "));
    let end = failed.at + 1 + rest.len();
    let start = start + condition.len() - condition.trim_start().len();
    Some(LikelyFix::replacement(format!("a choice is written `{text}`"), start..end, text))
}
