//! Collects the out-of-range values of a configuration.
//!
//! Each config struct has a `check` method that checks the range of every field. The checker collects all problems,
//! each with the key of the value in the experiment file. Non-finite numbers are always out of range.
//!
//! ```
//! use feeler::check::Checker;
//! use feeler::sensor::forces::DriftConfig;
//!
//! let drift = DriftConfig { gain_rate: 2.0, ..DriftConfig::default() };
//! let mut checker = Checker::default();
//! drift.check("sensor.drift", &mut checker);
//! let problems = checker.problems();
//! assert_eq!(problems[0].to_string(), "sensor.drift.gain_rate = 2: expected 0 to 1");
//! ```

use std::fmt;

/// Upper bound of values without another bound. It is far larger than any quantity of a real rig, and far below the
/// point where arithmetic overflows.
pub const MAX: f64 = 1e9;

/// Number of characters above which a number is printed in exponent notation.
const LONG: usize = 20;

/// A value that is outside its range.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// Key of the value in the experiment file.
    pub field: String,
    /// The rejected value.
    pub value: String,
    /// Description of the valid values.
    pub expected: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            field,
            value,
            expected,
        } = self;
        write!(f, "{field} = {value}: expected {expected}")
    }
}

/// Joins problems with semicolons, for messages.
pub fn joined(problems: &[Problem]) -> String {
    let problems: Vec<_> = problems.iter().map(Problem::to_string).collect();
    problems.join("; ")
}

/// A constraint on one value of the configuration.
#[derive(Debug, Clone, PartialEq)]
pub struct Requirement {
    /// Key of the value in the experiment file.
    pub field: String,
    /// Description of the valid values.
    pub expected: String,
    /// Minimum and maximum; `None` if the constraint is not a simple range.
    pub range: Option<[f64; 2]>,
}

/// Checks values and collects the problems. Each `field` is a key of the experiment file.
#[derive(Debug, Clone, Default)]
pub struct Checker {
    problems: Vec<Problem>,
    requirements: Vec<Requirement>,
}

impl Checker {
    /// Returns the problems found, in the order of the checks.
    pub fn problems(self) -> Vec<Problem> {
        self.problems
    }

    /// Returns the problems found as an error, if any.
    ///
    /// # Errors
    /// If a value is out of its range.
    pub fn finish(self) -> Result<(), Vec<Problem>> {
        match self.problems.is_empty() {
            true => Ok(()),
            false => Err(self.problems),
        }
    }

    /// Returns all constraints that were checked, in the order of the checks.
    pub fn requirements(self) -> Vec<Requirement> {
        self.requirements
    }

    /// Checks that `good` is `true`; otherwise reports `value` as a problem, with `expected` as the description of the
    /// valid values.
    pub fn require(&mut self, field: &str, value: String, good: bool, expected: &str) {
        self.require_in(None, field, value, good, expected);
    }

    fn require_in(
        &mut self,
        range: Option<[f64; 2]>,
        field: &str,
        value: String,
        good: bool,
        expected: &str,
    ) {
        self.requirements.push(Requirement {
            field: field.to_string(),
            expected: expected.to_string(),
            range,
        });
        if !good {
            self.problems.push(Problem {
                field: field.to_string(),
                value: compact(value),
                expected: expected.to_string(),
            });
        }
    }

    /// Checks that a value is above 0 and at most [`MAX`].
    pub fn positive(&mut self, field: &str, value: f64) {
        let good = value > 0.0 && value <= MAX;
        let expected = format!("more than 0, at most {MAX:e}");
        self.require_in(Some([0.0, MAX]), field, value.to_string(), good, &expected);
    }

    /// Checks that each of `fields` in the table `key` is above 0 and at most [`MAX`].
    pub fn all_positive(&mut self, key: &str, fields: &[(&str, f64)]) {
        for (field, value) in fields {
            self.positive(&format!("{key}.{field}"), *value);
        }
    }

    /// Checks that a value is from 0 to [`MAX`].
    pub fn not_negative(&mut self, field: &str, value: f64) {
        self.between(field, value, 0.0, MAX);
    }

    /// Checks that a value is from `low` to `high`.
    pub fn between(&mut self, field: &str, value: f64, low: f64, high: f64) {
        let good = (low..=high).contains(&value);
        let expected = format!("{} to {}", number(low), number(high));
        self.require_in(Some([low, high]), field, value.to_string(), good, &expected);
    }

    /// Checks that a field of the table `key` is above `least`, the value of the field `other` of the same table, and
    /// at most [`MAX`].
    pub fn more_than(
        &mut self,
        key: &str,
        (field, value): (&str, f64),
        (other, least): (&str, f64),
    ) {
        self.require(
            &format!("{key}.{field}"),
            value.to_string(),
            value > least && value <= MAX,
            &format!("more than {key}.{other} = {least}, at most {MAX:e}"),
        );
    }

    /// Checks that the three components of a point or vector are from -10 to 10.
    pub fn vector(&mut self, field: &str, value: [f64; 3]) {
        let good = value.iter().all(|c| c.is_finite() && c.abs() <= 10.0);
        self.require(
            field,
            format!("{value:?}"),
            good,
            "three numbers from -10 to 10",
        );
    }

    /// Checks that a vector is not zero.
    pub fn direction(&mut self, field: &str, value: [f64; 3]) {
        let length = value.iter().map(|c| c * c).sum::<f64>().sqrt();
        let good = (1e-6..=MAX).contains(&length);
        self.require(
            field,
            format!("{value:?}"),
            good,
            "a direction: a vector that is not zero",
        );
    }
}

/// Formats a number with many digits in exponent notation; returns other values unchanged.
fn compact(value: String) -> String {
    match value.parse::<f64>() {
        Ok(value_of) if value.len() > LONG => number(value_of),
        _ => value,
    }
}

/// Formats a bound, in exponent notation if it is very large or very small.
fn number(bound: f64) -> String {
    if bound == 0.0 || (1e-3..1e6).contains(&bound.abs()) {
        bound.to_string()
    } else {
        format!("{bound:e}")
    }
}
