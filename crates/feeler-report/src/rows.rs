//! Rows of several values each, in one piece of memory.

use std::ops::Index;

/// Rows of values, one after the other; they need not be equally long.
#[derive(Debug, Clone, PartialEq)]
pub struct Rows<T> {
    values: Vec<T>,
    /// Where each row ends among the values.
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

    /// Makes room for more values.
    pub fn reserve(&mut self, rows: usize, values: usize) {
        self.values.reserve(values);
        self.ends.reserve(rows);
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// A row, if there is one of this number.
    pub fn get(&self, row: usize) -> Option<&[T]> {
        let end = *self.ends.get(row)?;
        self.values.get(self.start(row)..end)
    }

    /// The newest row.
    pub fn last(&self) -> Option<&[T]> {
        self.get(self.len().checked_sub(1)?)
    }

    /// Keeps these rows only, which are in their order.
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
    fn rows_are_what_was_pushed() {
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
    fn what_is_kept_is_as_it_was() {
        let of: [&[u8]; 5] = [&[1, 2], &[3], &[], &[4, 5, 6], &[7]];
        for kept in [&[][..], &[0, 1, 2, 3, 4], &[0, 3], &[2, 3, 4], &[1, 4]] {
            let mut all = rows(&of);
            all.keep(kept);
            let expected: Vec<_> = kept.iter().map(|&row| of[row]).collect();
            assert_eq!(all, rows(&expected));
        }
    }
}
