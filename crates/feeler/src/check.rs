//! Collects the values of a configuration that are out of their ranges.
//!
//! Each config struct has a method `check` that says what its values must be, next to the struct. All problems are
//! collected, each with its key as in an experiment file. Numbers that are not finite are never in range.
//!
//! ```
//! use feeler::check::Checker;
//! use feeler::sensor::drift::DriftConfig;
//!
//! let drift = DriftConfig { gain_rate: 2.0, ..DriftConfig::default() };
//! let mut checker = Checker::default();
//! drift.check("sensor.drift", &mut checker);
//! let problems = checker.problems();
//! assert_eq!(problems[0].to_string(), "sensor.drift.gain_rate = 2: expected 0 to 1");
//! ```

use std::fmt;

/// Largest number that is accepted where nothing else limits a value: far beyond what a rig could
/// have, and far below where arithmetic overflows.
pub const MAX: f64 = 1e9;

/// More characters than a number needs.
const LONG: usize = 20;

/// A value that is out of its range.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The value's key in the experiment file.
    pub field: String,
    /// The value.
    pub value: String,
    /// What it must be.
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

/// What a value must be.
#[derive(Debug, Clone, PartialEq)]
pub struct Requirement {
    /// The value's key in the experiment file.
    pub field: String,
    /// What it must be, in words.
    pub expected: String,
    /// The least and the greatest that a number can be, where that is all.
    pub range: Option<[f64; 2]>,
}

/// Collects problems. A `field` is a key as in an experiment file.
#[derive(Debug, Clone, Default)]
pub struct Checker {
    problems: Vec<Problem>,
    requirements: Vec<Requirement>,
}

impl Checker {
    /// What was found, in the order of the checks.
    pub fn problems(self) -> Vec<Problem> {
        self.problems
    }

    /// All that was required, in the order of the checks.
    pub fn requirements(self) -> Vec<Requirement> {
        self.requirements
    }

    /// A value is good, or else it is not what was `expected`.
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

    /// More than 0, at most [`MAX`].
    pub fn positive(&mut self, field: &str, value: f64) {
        let good = value > 0.0 && value <= MAX;
        let expected = format!("more than 0, at most {MAX:e}");
        self.require_in(Some([0.0, MAX]), field, value.to_string(), good, &expected);
    }

    /// Each of these fields of the table `key` is more than 0, at most [`MAX`].
    pub fn all_positive(&mut self, key: &str, fields: &[(&str, f64)]) {
        for (field, value) in fields {
            self.positive(&format!("{key}.{field}"), *value);
        }
    }

    /// From 0 to [`MAX`].
    pub fn not_negative(&mut self, field: &str, value: f64) {
        self.between(field, value, 0.0, MAX);
    }

    /// From `low` to `high`.
    pub fn between(&mut self, field: &str, value: f64, low: f64, high: f64) {
        let good = (low..=high).contains(&value);
        let expected = format!("{} to {}", number(low), number(high));
        self.require_in(Some([low, high]), field, value.to_string(), good, &expected);
    }

    /// A field of the table `key` is more than `other` = `least` of the same table, at most [`MAX`].
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

    /// A place or a vector: three numbers from -10 to 10.
    pub fn vector(&mut self, field: &str, value: [f64; 3]) {
        let good = value.iter().all(|c| c.is_finite() && c.abs() <= 10.0);
        self.require(
            field,
            format!("{value:?}"),
            good,
            "three numbers from -10 to 10",
        );
    }

    /// A vector with a direction.
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

/// A number of hundreds of digits as a reader would write it; all else as it is.
fn compact(value: String) -> String {
    match value.parse::<f64>() {
        Ok(value_of) if value.len() > LONG => number(value_of),
        _ => value,
    }
}

/// A bound as a reader would write it: neither a long row of digits nor `1e0`.
fn number(bound: f64) -> String {
    if bound == 0.0 || (1e-3..1e6).contains(&bound.abs()) {
        bound.to_string()
    } else {
        format!("{bound:e}")
    }
}
