//! Arguments that set numbers of a program: `--set Hero.jump_speed=310`, and sweeps, `--set Hero.jump_speed=200..350/10`.

use clap::Args;

use crate::compile::NumberSetting;

/// Maximum number of values of one sweep.
const MAX_VALUES: usize = 10_000;

/// The numbers of a program that are set.
#[derive(Debug, Args)]
pub(in crate::cli) struct SetArgs {
    /// Sets the value of a `const`, or the default of a `param`, such as `Hero.jump_speed=310` or `gravity=-900`; can be
    /// given several times. A plain number has the unit that is written in the program.
    #[arg(long = "set", value_name = "NAME=NUMBER", value_parser = Setting::read, help_heading = "The program")]
    pub set: Vec<Setting>,
}

/// One number that is set.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::cli) struct Setting {
    /// `Hero.jump_speed`
    pub path: String,
    /// To what.
    pub value: SettingValue,
}

/// What a number is set to.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::cli) enum SettingValue {
    /// An expression of the language.
    One(String),
    /// Each of some numbers in turn.
    Sweep(Vec<String>),
}

impl Setting {
    /// `NAME=EXPRESSION` or `NAME=FIRST..LAST/STEP`
    fn read(text: &str) -> Result<Setting, String> {
        let form = || "a name and a number, such as `Hero.jump_speed=310` or `gravity=-900`".to_string();
        let (path, value) = text.split_once('=').ok_or_else(form)?;
        let (path, value) = (path.trim(), value.trim());
        if path.is_empty() || value.is_empty() {
            return Err(form());
        }
        let value = match value.contains("..") {
            true => SettingValue::Sweep(sweep(value)?),
            false => SettingValue::One(value.to_string()),
        };
        Ok(Setting { path: path.to_string(), value })
    }
}

/// The numbers of `FIRST..LAST/STEP`.
fn sweep(text: &str) -> Result<Vec<String>, String> {
    let form =
        || "a sweep is written `200..350/10`: the first number, the last one, and the step between two".to_string();
    let (range, step) = text.split_once('/').ok_or_else(form)?;
    let (first, last) = range.split_once("..").ok_or_else(form)?;
    let number = |text: &str| text.trim().parse::<f64>().ok().filter(|n| n.is_finite()).ok_or_else(form);
    // Without the noise of sums: as many digits as are written.
    let digits = [first, step].map(|text| text.trim().split_once('.').map_or(0, |(_, digits)| digits.len()));
    let digits = digits[0].max(digits[1]).min(12);
    let (first, last, step) = (number(first)?, number(last)?, number(step)?);
    if step <= 0.0 {
        return Err("the step of a sweep is above 0".to_string());
    }
    if last < first {
        return Err("the first number of a sweep is the smaller one".to_string());
    }
    // A last number that rounding misses counts.
    let count = ((last - first) / step + 1e-9).floor();
    if count >= MAX_VALUES as f64 {
        return Err(format!("a sweep has at most {MAX_VALUES} values"));
    }
    Ok((0..=count as usize).map(|at| format!("{:.digits$}", first + at as f64 * step)).collect())
}

impl SetArgs {
    /// The numbers that are set to one value.
    pub fn fixed(&self) -> Vec<NumberSetting<'_>> {
        let mut fixed = Vec::new();
        for setting in &self.set {
            if let SettingValue::One(value) = &setting.value {
                fixed.push(NumberSetting { path: &setting.path, value });
            }
        }
        fixed
    }

    /// The sweeps: names with their values.
    pub fn sweeps(&self) -> Vec<(&str, &[String])> {
        let mut sweeps = Vec::new();
        for setting in &self.set {
            if let SettingValue::Sweep(values) = &setting.value {
                sweeps.push((setting.path.as_str(), values.as_slice()));
            }
        }
        sweeps
    }

    /// The settings as they were written, for records.
    pub fn texts(&self) -> Vec<String> {
        self.fixed().iter().map(|NumberSetting { path, value }| format!("{path}={value}")).collect()
    }

    /// Why these settings are none for a command that runs a program once.
    pub fn refusal(&self) -> Option<String> {
        let (path, _) = *self.sweeps().first()?;
        Some(format!(
            "`--set {path}` is a sweep: `reach`, `sim`, `bounds` and `experiment` have these, other commands take one number"
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sweeps_have_both_ends_and_no_noise() {
        let of = |text: &str| Setting::read(text).map(|setting| setting.value);
        let sweep = |values: &[&str]| Ok(SettingValue::Sweep(values.iter().map(ToString::to_string).collect()));
        assert_eq!(of("A.b=200..230/10"), sweep(&["200", "210", "220", "230"]));
        assert_eq!(of("b=0..0.3/0.1"), sweep(&["0.0", "0.1", "0.2", "0.3"]));
        assert_eq!(of("b=-2..3/2"), sweep(&["-2", "0", "2"]));
        assert_eq!(of("b=5..5/1"), sweep(&["5"]));
        assert_eq!(of("b=-2 * 3"), Ok(SettingValue::One("-2 * 3".into())));
        for wrong in ["b", "b=", "=3", "b=1..2", "b=2..1/1", "b=1..2/0", "b=1..2/-1", "b=1..x/1", "b=0..1e9/1"] {
            assert!(Setting::read(wrong).is_err(), "{wrong}");
        }
    }
}
