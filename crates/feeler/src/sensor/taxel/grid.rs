//! Regular grid of taxels.

use super::{Taxel, TaxelError};
use crate::check::{Checker, Problem};
use crate::sensor::fingertip::layout::MAX_ELEMENTS;
use serde::Deserialize;

/// Table `[grid]` of a layout file: a regular grid of taxels, numbered row by row. Its middle is the origin of `T`;
/// columns are along y and rows along -z, so that the grid has the arrangement of the matrix of readings when viewed
/// from outside.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Grid {
    /// Number of rows.
    rows: usize,
    /// Number of columns.
    columns: usize,
    /// Distance between two neighbours, m.
    pitch: f64,
}

impl Grid {
    /// Extracts the grid from the text of a layout. Returns it with the remaining text, or `None` if the text contains
    /// no grid.
    ///
    /// # Errors
    /// If the text is not TOML, or if values of the grid are out of range.
    pub fn of(text: &str) -> Result<Option<(Self, toml::Table)>, TaxelError> {
        let mut table: toml::Table = toml::from_str(text)?;
        let Some(grid) = table.remove("grid") else {
            return Ok(None);
        };
        let grid: Self = grid.try_into()?;
        grid.check(table.contains_key("taxel"))
            .map_err(TaxelError::Values)?;
        Ok(Some((grid, table)))
    }

    /// Checks the grid of a layout. `is_listed` is `true` if the layout also lists taxels.
    fn check(&self, is_listed: bool) -> Result<(), Vec<Problem>> {
        let mut checker = Checker::default();
        let (rows, columns) = (self.rows, self.columns);
        let count = rows.saturating_mul(columns);
        checker.require(
            "grid",
            format!("{rows} rows of {columns} columns"),
            (1..=MAX_ELEMENTS).contains(&count),
            &format!("1 to {MAX_ELEMENTS} taxels"),
        );
        checker.between("grid.pitch", self.pitch, 1e-6, 1.0);
        let expected = "either taxels or a grid";
        checker.require("taxel", "a list and a grid".into(), !is_listed, expected);
        checker.finish()
    }

    /// Taxels of the grid, row by row.
    pub fn taxels(&self) -> Vec<Taxel> {
        let middle = |count: usize| (count as f64 - 1.0) / 2.0;
        let (row_middle, column_middle) = (middle(self.rows), middle(self.columns));
        let rows = 0..self.rows;
        let places = rows.flat_map(|row| (0..self.columns).map(move |column| (row, column)));
        let taxels = places.map(|(row, column)| {
            let y = (column as f64 - column_middle) * self.pitch;
            let z = (row_middle - row as f64) * self.pitch;
            Taxel::at([0.0, y, z])
        });
        taxels.collect()
    }
}
