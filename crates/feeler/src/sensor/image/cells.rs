//! Spatial index of points in a grid of square cells.

use glam::DVec2;

/// Average number of points per cell.
const POINTS_PER_CELL: f64 = 2.0;

/// Points sorted into a grid of square cells.
#[derive(Debug, Clone)]
pub(crate) struct Cells<'a> {
    points: &'a [DVec2],
    low: DVec2,
    /// Side length of a cell, in the unit of the points.
    side: f64,
    columns: usize,
    rows: usize,
    /// Index in `order` at which each cell starts, and the end of the last one.
    starts: Vec<usize>,
    /// Indices of the points, sorted by cell.
    order: Vec<usize>,
}

impl<'a> Cells<'a> {
    /// Builds the index. All `points` must be finite.
    pub fn new(points: &'a [DVec2]) -> Self {
        let low = points
            .iter()
            .fold(DVec2::INFINITY, |low, point| low.min(*point));
        let high = points
            .iter()
            .fold(DVec2::NEG_INFINITY, |high, point| high.max(*point));
        let extent = (high - low).max(DVec2::ZERO);
        let share = POINTS_PER_CELL / points.len().max(1) as f64;
        // Points on a line get cells along that line.
        let side = (extent.x * extent.y * share).sqrt();
        let side = side.max(extent.max_element() * share).max(1e-9);
        let mut cells = Self {
            points,
            low,
            side,
            columns: (extent.x / side) as usize + 1,
            rows: (extent.y / side) as usize + 1,
            starts: Vec::new(),
            order: vec![0; points.len()],
        };
        cells.sort();
        cells
    }

    /// Sorts the points into the cells by filling `starts` and `order`.
    fn sort(&mut self) {
        let mut starts = vec![0; self.columns * self.rows + 1];
        let cells: Vec<usize> = self.points.iter().map(|point| self.cell(*point)).collect();
        for &cell in &cells {
            starts[cell + 1] += 1;
        }
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        for (index, &cell) in cells.iter().enumerate() {
            self.order[next[cell]] = index;
            next[cell] += 1;
        }
        self.starts = starts;
    }

    /// Column and row of the cell nearest to the point `place`.
    fn column_and_row(&self, place: DVec2) -> (usize, usize) {
        // Casts to usize saturate at 0.
        let cell = (place - self.low) / self.side;
        let (column, row) = (cell.x as usize, cell.y as usize);
        (column.min(self.columns - 1), row.min(self.rows - 1))
    }

    fn cell(&self, place: DVec2) -> usize {
        let (column, row) = self.column_and_row(place);
        row * self.columns + column
    }

    /// Indices of the points in the cells from `first` to `last` (column, row), both inclusive.
    fn in_block(
        &self,
        first: (usize, usize),
        last: (usize, usize),
    ) -> impl Iterator<Item = usize> + '_ {
        (first.1..=last.1).flat_map(move |row| {
            let row = row * self.columns;
            let span = self.starts[row + first.0]..self.starts[row + last.0 + 1];
            self.order[span].iter().copied()
        })
    }

    /// Indices of the points within `radius` of the point `place`, in unspecified order.
    pub fn within(&self, place: DVec2, radius: f64) -> impl Iterator<Item = usize> + '_ {
        let first = self.column_and_row(place - radius);
        let last = self.column_and_row(place + radius);
        let near =
            move |&index: &usize| self.points[index].distance_squared(place) <= radius * radius;
        self.in_block(first, last).filter(near)
    }

    /// Replaces the contents of `nearest` with the squared distances and indices of the `count` points nearest to
    /// `place`, sorted by distance and, for equal distances, by index.
    pub fn nearest(&self, place: DVec2, count: usize, nearest: &mut Vec<(f64, usize)>) {
        let (column, row) = self.column_and_row(place);
        let mut reach = (count as f64 / POINTS_PER_CELL).sqrt() as usize / 2;
        loop {
            nearest.clear();
            let first = (column.saturating_sub(reach), row.saturating_sub(reach));
            let last = (
                (column + reach).min(self.columns - 1),
                (row + reach).min(self.rows - 1),
            );
            let distance = |index: usize| (self.points[index].distance_squared(place), index);
            nearest.extend(self.in_block(first, last).map(distance));
            let sure = self.distance_out_of(first, last, place);
            let closer = nearest.iter().filter(|(d, _)| *d < sure * sure).count();
            if closer >= count || sure == f64::INFINITY {
                break;
            }
            reach = 2 * reach + 1;
        }
        let by_distance =
            |a: &(f64, usize), b: &(f64, usize)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        if count > 0 && nearest.len() > count {
            nearest.select_nth_unstable_by(count - 1, by_distance);
        }
        nearest.truncate(count);
        nearest.sort_unstable_by(by_distance);
    }

    /// Lower bound of the distance from `place` to points outside the cells from `first` to `last`; infinite if these
    /// are all cells.
    fn distance_out_of(&self, first: (usize, usize), last: (usize, usize), place: DVec2) -> f64 {
        let offset = place - self.low;
        let below = |first: usize, offset: f64| match first {
            0 => f64::INFINITY,
            first => offset - first as f64 * self.side,
        };
        let above = |last: usize, count: usize, offset: f64| match last + 1 == count {
            true => f64::INFINITY,
            false => (last + 1) as f64 * self.side - offset,
        };
        let columns = below(first.0, offset.x).min(above(last.0, self.columns, offset.x));
        let rows = below(first.1, offset.y).min(above(last.1, self.rows, offset.y));
        columns.min(rows).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point() -> impl Strategy<Value = DVec2> {
        // Includes integers, so that points coincide, lie on lines and have equal distances.
        let number = prop_oneof![-50.0..50.0_f64, (-5..5_i32).prop_map(f64::from)];
        (number.clone(), number).prop_map(DVec2::from)
    }

    proptest! {
        #[test]
        fn results_equal_an_exhaustive_search(
            points in proptest::collection::vec(point(), 0..60), place in point(), count in 0..20_usize, radius in 0.0..30.0_f64
        ) {
            let cells = Cells::new(&points);
            let mut all: Vec<_> = points.iter().map(|p| p.distance_squared(place)).zip(0..).collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let mut nearest = vec![(1.0, 7)];
            cells.nearest(place, count, &mut nearest);
            prop_assert_eq!(&nearest[..], &all[..count.min(all.len())]);
            let mut within: Vec<usize> = cells.within(place, radius).collect();
            within.sort_unstable();
            let mut expected: Vec<usize> = all.iter().filter(|p| p.0 <= radius * radius).map(|p| p.1).collect();
            expected.sort_unstable();
            prop_assert_eq!(within, expected);
        }
    }
}
