//! Measures of all rows of a long run, and selection of the rows to keep.

use super::finger_columns::FingerColumns;
use crate::measures::series::Stretch;
use crate::measures::strokes::{FeltStroke, StrokeMeasures};
use std::ops::Range;

/// Measures of all rows of a run whose rows were only partly kept.
#[derive(Debug, Clone, PartialEq)]
pub struct DecimatedRun {
    /// Number of rows of the whole run.
    pub rows: usize,
    /// Measures of every stroke, from all of its rows; only the maxima for strokes that were too long
    /// (`StrokeMeasures::of_extremes`).
    pub strokes: Vec<StrokeMeasures>,
    /// Estimated and true values of every stroke.
    pub felt: Vec<FeltStroke>,
    /// Numbers of the strokes that were too long to keep all rows until they were measured.
    pub too_long: Vec<u32>,
    /// Number of peaks of grasp force, as counted by the claim `four-peaks`.
    pub grasp_force_peaks: Option<usize>,
    /// Number of peaks of torque, as counted by the claim `four-peaks`.
    pub torque_peaks: Option<usize>,
    /// Force limits with the longest stretches above each of them.
    pub(crate) pressed: Vec<Pressed>,
}

impl DecimatedRun {
    /// Longest stretch of rows in which an element exceeds `limit` (N). `None` if no forces are known or this limit was
    /// not accumulated.
    pub fn longest_above(&self, limit: f64) -> Option<usize> {
        let mut pressed = self.pressed.iter();
        pressed.find(|p| p.limit == limit)?.longest()
    }
}

/// Stretches in which elements exceed a force limit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pressed {
    /// Force limit (N).
    limit: f64,
    /// Stretches of each element of each finger.
    elements: Vec<Vec<Stretch>>,
    /// For each finger: `true` if any element exceeded the limit in the last row.
    is_pressed: Vec<bool>,
}

impl Pressed {
    /// Accumulator for the force `limit` (N) and this number of fingers.
    pub fn new(limit: f64, fingers: usize) -> Self {
        Self {
            limit,
            elements: vec![Vec::new(); fingers],
            is_pressed: vec![false; fingers],
        }
    }

    /// Adds the next row.
    pub fn take_row(&mut self, fingers: &[FingerColumns], row: usize) {
        for (finger, columns) in fingers.iter().enumerate() {
            let forces = columns.forces[row].iter();
            let is_known = self.elements[finger].len() >= forces.len();
            // Fast path: no stretch starts, continues or ends.
            if is_known && !self.is_pressed[finger] && columns.largest_force[row] <= self.limit {
                continue;
            }
            self.take(finger, forces.map(|force| force.z));
        }
    }

    /// Adds the forces on the elements of `finger` at the next row (N).
    fn take(&mut self, finger: usize, forces: impl ExactSizeIterator<Item = f64> + Clone) {
        let elements = &mut self.elements[finger];
        if elements.len() < forces.len() {
            elements.resize(forces.len(), Stretch::default());
        }
        self.is_pressed[finger] = forces.clone().any(|force| force > self.limit);
        let mut rest = elements.iter_mut();
        for (force, element) in forces.zip(rest.by_ref()) {
            element.take(force > self.limit);
        }
        rest.for_each(|element| element.take(false));
    }

    /// Longest stretch of a single element (rows); `None` if no forces are known.
    pub fn longest(&self) -> Option<usize> {
        let elements = self.elements.iter().flatten();
        elements.map(Stretch::longest).max()
    }
}

/// A quantity as a function of the row.
pub(crate) type Quantity<'a> = dyn Fn(usize) -> f64 + 'a;

/// Indices of the rows to keep: rows without a `cell`, and for each run of rows in the same cell the first row, the
/// last row and the row with the maximum of each quantity, so that no peak is lost. NaN counts as maximum.
pub(crate) fn rows_that_stay<C: PartialEq>(
    count: usize,
    cell: impl Fn(usize) -> Option<C>,
    quantities: &[Box<Quantity<'_>>],
) -> Vec<usize> {
    let mut stay = Vec::new();
    let mut start = 0;
    while start < count {
        let own = cell(start);
        let others = |row: &usize| own.is_none() || cell(*row) != own;
        let end = (start + 1..count).find(others).unwrap_or(count);
        let begin = stay.len();
        stay.extend([start, end - 1]);
        if end - start > 2 {
            stay.extend(quantities.iter().map(|q| greatest(start..end, q)));
        }
        stay[begin..].sort_unstable();
        stay.dedup();
        start = end;
    }
    stay
}

/// First row with the maximum of a quantity.
fn greatest(rows: Range<usize>, quantity: &Quantity<'_>) -> usize {
    let value = |row: usize| match quantity(row) {
        value if value.is_nan() => f64::INFINITY,
        value => value,
    };
    let first = (rows.start, value(rows.start));
    let greatest = rows.fold(first, |greatest, row| {
        let value = value(row);
        if value > greatest.1 {
            (row, value)
        } else {
            greatest
        }
    });
    greatest.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_peaks_of_each_cell_are_kept() {
        let mut values = [0.0; 40];
        values[13] = 5.0;
        values[33] = f64::NAN;
        let cell = |row: usize| (!(10..12).contains(&row)).then_some(row / 20);
        let stay = rows_that_stay(40, cell, &[Box::new(|row| values[row])]);
        assert_eq!(stay, [0, 9, 10, 11, 12, 13, 19, 20, 33, 39]);
        let none: [usize; 0] = [];
        assert_eq!(rows_that_stay(0, |_| Some(0), &[]), none);
    }

    #[test]
    fn longest_stretch_is_of_a_single_element() {
        let mut pressed = Pressed::new(1.0, 2);
        assert_eq!(pressed.longest(), None);
        for forces in [[2.0, 0.0], [2.0, 2.0], [0.5, 2.0], [2.0, 2.0]] {
            pressed.take(0, forces.into_iter());
        }
        // An element without data counts as not pressed.
        pressed.take(0, [2.0].into_iter());
        pressed.take(0, [0.0, 2.0].into_iter());
        assert_eq!(pressed.longest(), Some(3));
    }
}
