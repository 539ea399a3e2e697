//! What a run that is too long to keep all of its rows measures of all of them, and which rows it keeps.

use super::cap::FeltStroke;
use super::run_data::RunData;
use super::series::Stretch;
use super::strokes::StrokeMeasures;
use std::ops::Range;

/// What was measured of every row of a run, most of which were let go of.
#[derive(Debug, Clone, PartialEq)]
pub struct Thinned {
    /// Rows of the whole run.
    pub rows: usize,
    /// The measures of every stroke, each from all of its rows; of a stroke that was too long to keep them, only what is
    /// largest in it (`StrokeMeasures::of_extremes`).
    pub strokes: Vec<StrokeMeasures>,
    /// The strokes as they were felt.
    pub felt: Vec<FeltStroke>,
    /// Numbers of the strokes that were too long to keep all of their rows until they were measured.
    pub too_long: Vec<u32>,
    /// Peaks of grasp force, as the claim `four-peaks` counts them.
    pub grasp_force_peaks: Option<usize>,
    /// Peaks of torque, as the same claim counts them.
    pub torque_peaks: Option<usize>,
    /// Forces (N), and for how many rows in a row an element was pressed harder than each.
    pub(crate) pressed: Vec<Pressed>,
}

impl Thinned {
    /// Rows in the longest stretch of an element pressed harder than `limit`, N; none where no forces are known, or
    /// nobody asked for this limit while the rows were there.
    pub fn longest_above(&self, limit: f64) -> Option<usize> {
        let mut pressed = self.pressed.iter();
        pressed.find(|p| p.limit == limit)?.longest()
    }
}

/// For how long elements are pressed harder than a limit.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Pressed {
    /// N.
    limit: f64,
    /// Of each element of each finger.
    elements: Vec<Vec<Stretch>>,
    /// Whether any element of each finger was pressed harder in the last row.
    is_pressed: Vec<bool>,
}

impl Pressed {
    /// Harder than `limit`, N, of this many fingers.
    pub fn new(limit: f64, fingers: usize) -> Self {
        Self {
            limit,
            elements: vec![Vec::new(); fingers],
            is_pressed: vec![false; fingers],
        }
    }

    /// Takes the next row.
    pub fn take_row(&mut self, data: &RunData, row: usize) {
        for (finger, columns) in data.fingers.iter().enumerate() {
            let forces = columns.forces[row].iter();
            let is_known = self.elements[finger].len() >= forces.len();
            // Mostly none is pressed, nor was: no stretch begins, goes on or ends.
            if is_known && !self.is_pressed[finger] && columns.largest_force[row] <= self.limit {
                continue;
            }
            self.take(finger, forces.map(|force| force.z));
        }
    }

    /// Takes the forces (N) on the elements of `finger` at the next row.
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

    /// Rows in the longest stretch of one element; none where no forces are known.
    pub fn longest(&self) -> Option<usize> {
        let elements = self.elements.iter().flatten();
        elements.map(Stretch::longest).max()
    }
}

/// A quantity by row.
pub(crate) type Quantity<'a> = dyn Fn(usize) -> f64 + 'a;

/// Which of so many rows stay: those that are in no `cell`; and of each run of rows in the same one the first, the last
/// and, of each of `quantities`, where it is greatest, so that no peak is lost. What is no number is the greatest.
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

/// Where a quantity is greatest, first.
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
    fn of_each_cell_the_ends_and_the_peaks_stay() {
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
    fn the_longest_press_is_that_of_one_element() {
        let mut pressed = Pressed::new(1.0, 2);
        assert_eq!(pressed.longest(), None);
        for forces in [[2.0, 0.0], [2.0, 2.0], [0.5, 2.0], [2.0, 2.0]] {
            pressed.take(0, forces.into_iter());
        }
        // An element of which nothing is heard is not pressed.
        pressed.take(0, [2.0].into_iter());
        pressed.take(0, [0.0, 2.0].into_iter());
        assert_eq!(pressed.longest(), Some(3));
    }
}
