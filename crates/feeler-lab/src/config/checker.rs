//! Collects the values of an experiment that are out of their ranges.

use std::fmt;

/// Largest number that is accepted where nothing else limits a value: far beyond what a rig could
/// have, and far below where arithmetic overflows.
pub(super) const MAX: f64 = 1e9;

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

/// Collects problems.
#[derive(Default)]
pub(super) struct Checker {
    /// What was found so far.
    pub(super) problems: Vec<Problem>,
}

impl Checker {
    pub(super) fn require(&mut self, field: &str, value: String, good: bool, expected: &str) {
        if !good {
            self.problems.push(Problem {
                field: field.to_string(),
                value: compact(value),
                expected: expected.to_string(),
            });
        }
    }

    pub(super) fn positive(&mut self, field: &str, value: f64) {
        let good = value > 0.0 && value <= MAX;
        let expected = format!("more than 0, at most {MAX:e}");
        self.require(field, value.to_string(), good, &expected);
    }

    pub(super) fn not_negative(&mut self, field: &str, value: f64) {
        self.between(field, value, 0.0, MAX);
    }

    pub(super) fn between(&mut self, field: &str, value: f64, low: f64, high: f64) {
        let good = (low..=high).contains(&value);
        self.require(
            field,
            value.to_string(),
            good,
            &format!("{} to {}", number(low), number(high)),
        );
    }

    pub(super) fn vector(&mut self, field: &str, value: [f64; 3]) {
        let good = value.iter().all(|c| c.is_finite() && c.abs() <= 10.0);
        self.require(
            field,
            format!("{value:?}"),
            good,
            "three numbers from -10 to 10",
        );
    }

    pub(super) fn direction(&mut self, field: &str, value: [f64; 3]) {
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
