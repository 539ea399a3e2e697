//! Rows of varying length in contiguous memory.

use std::ops::Index;

/// Rows of varying length, stored contiguously.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows<T> {
    values: Vec<T>,
    /// End index of each row in `values`.
    ends: Vec<usize>,
}

impl<T> Default for Rows<T> {
    fn default() -> Self {
        let (values, ends) = (Vec::new(), Vec::new());
        Self { values, ends }
    }
}

impl<T: Copy> Rows<T> {
    /// Appends a row.
    pub fn push(&mut self, row: impl IntoIterator<Item = T>) {
        self.values.extend(row);
        self.ends.push(self.values.len());
    }

    /// Reserves capacity for additional rows and values.
    pub fn reserve(&mut self, rows: usize, values: usize) {
        self.values.reserve(values);
        self.ends.reserve(rows);
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// `true` if there are no rows.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// Row with this index, or `None` if out of range.
    pub fn get(&self, row: usize) -> Option<&[T]> {
        let end = *self.ends.get(row)?;
        self.values.get(self.start(row)..end)
    }

    /// Last row.
    pub fn last(&self) -> Option<&[T]> {
        self.get(self.len().checked_sub(1)?)
    }

    /// Retains only the rows with these ascending indices.
    pub fn keep(&mut self, rows: &[usize]) {
        let mut length = 0;
        for (place, &row) in rows.iter().enumerate() {
            let own = self.start(row)..self.ends[row];
            let end = length + own.len();
            self.values.copy_within(own, length);
            (self.ends[place], length) = (end, end);
        }
        self.ends.truncate(rows.len());
        self.values.truncate(length);
    }

    fn start(&self, row: usize) -> usize {
        row.checked_sub(1).map_or(0, |before| self.ends[before])
    }
}

impl<T: Copy, R: IntoIterator<Item = T>> FromIterator<R> for Rows<T> {
    fn from_iter<I: IntoIterator<Item = R>>(rows: I) -> Self {
        let mut all = Self::default();
        rows.into_iter().for_each(|row| all.push(row));
        all
    }
}

impl<T: Copy> Index<usize> for Rows<T> {
    type Output = [T];

    fn index(&self, row: usize) -> &[T] {
        &self.values[self.start(row)..self.ends[row]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(of: &[&[u8]]) -> Rows<u8> {
        of.iter().map(|row| row.iter().copied()).collect()
    }

    #[test]
    fn rows_equal_the_pushed_values() {
        let rows = rows(&[&[1, 2], &[], &[3]]);
        assert_eq!((rows.len(), rows.is_empty()), (3, false));
        assert_eq!(
            (&rows[0], &rows[1], &rows[2]),
            (&[1, 2][..], &[][..], &[3][..])
        );
        assert_eq!((rows.last(), rows.get(3)), (Some(&[3][..]), None));
        assert_eq!(Rows::<u8>::default().last(), None);
    }

    #[test]
    fn kept_rows_are_unchanged() {
        let of: [&[u8]; 5] = [&[1, 2], &[3], &[], &[4, 5, 6], &[7]];
        for kept in [&[][..], &[0, 1, 2, 3, 4], &[0, 3], &[2, 3, 4], &[1, 4]] {
            let mut all = rows(&of);
            all.keep(kept);
            let expected: Vec<_> = kept.iter().map(|&row| of[row]).collect();
            assert_eq!(all, rows(&expected));
        }
    }
}
