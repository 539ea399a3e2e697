//! Validates taxel layouts, which may come from handwritten files.

use super::common_mode::FEWEST;
use super::{Taxel, TaxelError, TaxelLayout, TaxelUnit};
use crate::check::Checker;
use crate::sensor::fingertip::layout::MAX_ELEMENTS;
use std::collections::HashSet;

/// Maximum number of columns of a table without a header.
const MAX_COLUMNS: usize = 8192;
/// Maximum number of characters in a name.
const MAX_NAME: usize = 100;
/// Maximum number of rows that are averaged for a zero.
const MAX_ZERO_ROWS: u32 = 100_000;
/// Valid range of counts per newton. Negative signs belong in `axes`.
const SCALE: (f64, f64) = (1e-6, 1e9);

impl TaxelLayout {
    /// Checks that every value of the layout is in its range.
    ///
    /// # Errors
    /// Returns [`TaxelError::Values`] with all values that are out of range.
    pub fn check(&self) -> Result<(), TaxelError> {
        let mut checker = Checker::default();
        self.check_all(&mut checker);
        checker.finish().map_err(TaxelError::Values)
    }

    fn check_all(&self, checker: &mut Checker) {
        check_name("name", &self.name, checker);
        let count = self.taxels.len();
        checker.require(
            "taxel",
            format!("{count} taxels"),
            (1..=MAX_ELEMENTS).contains(&count),
            &format!("1 to {MAX_ELEMENTS}"),
        );
        if let Some(rate) = self.rate {
            checker.between("rate", rate, 1e-3, 1e5);
        }
        self.check_axes(checker);
        self.check_columns(checker);
        self.check_drift(checker);
        self.check_rezero(checker);
        self.check_scales(checker);
        self.check_common_mode(checker);
        if let Some(serial) = &self.serial {
            serial.check(count, checker);
        }
        let rows = self.zero.rows;
        let expected = format!("0 to {MAX_ZERO_ROWS}");
        let good = rows <= MAX_ZERO_ROWS;
        checker.require("zero.rows", rows.to_string(), good, &expected);
        for (index, taxel) in self.taxels.iter().take(MAX_ELEMENTS).enumerate() {
            check_taxel(&format!("taxel[{index}]"), taxel, checker);
        }
        let given = self.taxels.iter().filter(|t| t.zero.is_some()).count();
        let good = given == 0 || given == count && rows == 0;
        checker.require(
            "taxel.zero",
            format!("set for {given} of {count} taxels, with zero.rows = {rows}"),
            good,
            "set for all taxels and zero.rows = 0, or for none",
        );
    }

    fn check_axes(&self, checker: &mut Checker) {
        let axes = [self.axes.x, self.axes.y, self.axes.z];
        let columns: HashSet<_> = axes.iter().map(|axis| axis.column()).collect();
        let expected = "each of the columns x, y, z once, with or without a minus";
        checker.require("axes", format!("{axes:?}"), columns.len() == 3, expected);
    }

    fn check_columns(&self, checker: &mut Checker) {
        let columns = &self.columns;
        let triple = [&columns.x, &columns.y, &columns.z];
        for (key, pattern) in ["columns.x", "columns.y", "columns.z"].iter().zip(triple) {
            check_name(key, pattern, checker);
            let named = pattern.matches("{n}").count() == 1;
            let prefixed = pattern.matches("{prefix}").count() <= 1;
            let expected = "a name with one {n} for the taxel's number, at most one {prefix}";
            checker.require(key, pattern.clone(), named && prefixed, expected);
        }
        let patterns: HashSet<_> = triple.into_iter().collect();
        let names = format!("{triple:?}");
        let expected = "three different names";
        checker.require("columns.x, y, z", names, patterns.len() == 3, expected);
        let prefix = &columns.prefix;
        let used = triple.iter().all(|pattern| pattern.contains("{prefix}"));
        checker.require(
            "columns.prefix",
            format!("{prefix:?}"),
            prefix.is_empty() || used && is_name(prefix),
            "a name without control characters, and {prefix} in x, y and z",
        );
        let first = columns.first;
        let expected = "0 to 1000000";
        checker.require(
            "columns.first",
            first.to_string(),
            first <= 1_000_000,
            expected,
        );
        if let Some(time) = &columns.time {
            check_name("columns.time.column", &time.column, checker);
        }
        if let Some(sequence) = &columns.sequence {
            check_name("columns.sequence", sequence, checker);
        }
        let delimiter = columns.delimiter;
        checker.require(
            "columns.delimiter",
            format!("{:?}", delimiter.unwrap_or_default()),
            delimiter.is_none_or(|delimiter| [',', ';', '\t', ' '].contains(&delimiter)),
            "a comma, a semicolon, a tab or a space",
        );
        if let Some(names) = &columns.without_header {
            let good = (1..=MAX_COLUMNS).contains(&names.len()) && names.iter().all(|n| is_name(n));
            let expected = format!("1 to {MAX_COLUMNS} names of at most {MAX_NAME} characters");
            let actual = format!("{} names", names.len());
            checker.require("columns.without_header", actual, good, &expected);
        }
    }

    fn check_drift(&self, checker: &mut Checker) {
        let Some(drift) = &self.drift else { return };
        let sizes = [("untouched", drift.untouched), ("most", drift.most)];
        checker.all_positive("drift", &sizes);
        checker.between("drift.time_constant", drift.time_constant, 1e-2, 1e6);
        checker.between("drift.settle", drift.settle, 0.0, 1e6);
    }

    fn check_rezero(&self, checker: &mut Checker) {
        let Some(rule) = &self.rezero else { return };
        checker.between("rezero.after", rule.after, 1e-2, 1e6);
        let sizes = [("untouched", rule.untouched), ("still", rule.still)];
        checker.all_positive("rezero", &sizes);
    }

    fn check_scales(&self, checker: &mut Checker) {
        if let Some(scale) = self.counts_per_newton {
            check_scale("counts_per_newton", scale, checker);
        }
        let known = self.taxels.iter().filter(|t| self.scale(t).is_some());
        let (known, count) = (known.count(), self.taxels.len());
        let (good, expected) = match self.unit {
            TaxelUnit::Newton => (known == 0, "set for none, since columns are in newtons"),
            TaxelUnit::Counts => (known == 0 || known == count, "set for all taxels or none"),
        };
        let actual = format!("set for {known} of {count} taxels");
        checker.require("counts_per_newton", actual, good, expected);
    }
}

/// Cosine of the maximum angle between normals that count as parallel.
const PARALLEL: f64 = 0.999;

impl TaxelLayout {
    /// Checks that common-mode rejection is possible: a uniform field must have the same effect on all taxels.
    fn check_common_mode(&self, checker: &mut Checker) {
        if !self.common_mode {
            return;
        }
        let count = self.taxels.len();
        let normals = || self.elements().map(|(element, _)| element.normal());
        let first = normals().next().unwrap_or_default();
        let parallel = normals().all(|normal| normal.dot(first) > PARALLEL);
        let kind = match parallel {
            true => "of the same normal",
            false => "of different normals",
        };
        checker.require(
            "common_mode",
            format!("true with {count} taxels {kind}"),
            parallel && count >= FEWEST,
            &format!("false, or at least {FEWEST} taxels, all with the same normal"),
        );
    }
}

fn check_taxel(key: &str, taxel: &Taxel, checker: &mut Checker) {
    checker.vector(&format!("{key}.place"), taxel.place);
    checker.vector(&format!("{key}.normal"), taxel.normal);
    checker.direction(&format!("{key}.normal"), taxel.normal);
    let turn = &format!("{key}.turn_deg");
    checker.between(turn, taxel.turn_deg, -360.0, 360.0);
    if let Some(scale) = taxel.counts_per_newton {
        check_scale(&format!("{key}.counts_per_newton"), scale, checker);
    }
    let zero = taxel.zero.unwrap_or_default();
    let good = zero.iter().all(|z| z.is_finite() && z.abs() <= 1e9);
    let expected = "three numbers from -1e9 to 1e9";
    checker.require(&format!("{key}.zero"), format!("{zero:?}"), good, expected);
}

fn check_scale(key: &str, scale: [f64; 3], checker: &mut Checker) {
    for (axis, counts) in ["x", "y", "z"].iter().zip(scale) {
        checker.between(&format!("{key}, {axis}"), counts, SCALE.0, SCALE.1);
    }
}

fn check_name(key: &str, name: &str, checker: &mut Checker) {
    let expected = format!("1 to {MAX_NAME} characters without control characters");
    let shown: String = name.chars().take(MAX_NAME).collect();
    checker.require(key, format!("{shown:?}"), is_name(name), &expected);
}

fn is_name(name: &str) -> bool {
    (1..=MAX_NAME).contains(&name.chars().count()) && !name.chars().any(char::is_control)
}
