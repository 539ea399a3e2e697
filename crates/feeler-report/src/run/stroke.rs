//! Splits rows into strokes.

use feeler_record::Phase;
use std::ops::Range;

/// One stroke from touch to release, as ranges of rows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stroke {
    /// Number of the stroke, from 1.
    pub index: u32,
    /// All rows of the stroke.
    pub rows: Range<usize>,
    /// Rows of its MOVE phase; empty if it has none.
    pub moving: Range<usize>,
    /// `true` if the recording continues after MOVE, so that MOVE is complete, and all rows of the stroke were kept.
    pub whole: bool,
}

/// Splits rows into strokes. A stroke is a run of rows with the same number above 0, excluding rows after the end of
/// the task. Its MOVE is its longest run of MOVE rows.
pub(crate) fn split_strokes(numbers: &[u32], phases: &[Phase]) -> Vec<Stroke> {
    let number = |row: usize| match phases[row].is_final() {
        true => 0,
        false => numbers[row],
    };
    runs(numbers.len(), number)
        .filter(|(index, _)| *index > 0)
        .map(|(index, rows)| {
            let moving = runs(rows.len(), |row| phases[rows.start + row] == Phase::Move)
                .filter(|(moving, _)| *moving)
                .map(|(_, run)| rows.start + run.start..rows.start + run.end)
                .max_by_key(ExactSizeIterator::len)
                .unwrap_or(rows.start..rows.start);
            let next = phases.get(moving.end);
            let whole = next.is_some_and(|&phase| phase != Phase::Stopped);
            Stroke {
                index,
                rows,
                moving,
                whole,
            }
        })
        .collect()
}

/// Runs of equal keys in `0..length`.
fn runs<K: PartialEq + Copy>(
    length: usize,
    key: impl Fn(usize) -> K,
) -> impl Iterator<Item = (K, Range<usize>)> {
    let mut start = 0;
    std::iter::from_fn(move || {
        let first = (start < length).then(|| key(start))?;
        let end = (start..length).find(|&i| key(i) != first).unwrap_or(length);
        let run = start..end;
        start = end;
        Some((first, run))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use Phase::{Done, Move, Release, Return, Search, Stopped};

    #[test]
    fn strokes_are_runs_of_equal_numbers_until_the_task_ends() {
        let numbers = [0, 1, 1, 1, 1, 1, 2, 2, 2, 2];
        let phases = [
            Search, Search, Move, Move, Release, Return, Search, Move, Return, Done,
        ];
        let strokes = split_strokes(&numbers, &phases);
        assert_eq!(strokes.len(), 2);
        assert_eq!(
            (strokes[0].rows.clone(), strokes[0].moving.clone()),
            (1..6, 2..4)
        );
        assert_eq!(
            (strokes[1].rows.clone(), strokes[1].moving.clone()),
            (6..9, 7..8)
        );
        assert!(strokes.iter().all(|s| s.whole));
    }

    #[test]
    fn stroke_with_truncated_move_is_not_whole() {
        assert!(!split_strokes(&[1, 1, 1], &[Search, Move, Move])[0].whole);
        assert!(!split_strokes(&[1, 1, 1], &[Search, Move, Stopped])[0].whole);
        let without_move = &split_strokes(&[1, 1], &[Search, Search])[0];
        assert!(without_move.moving.is_empty());
    }
}
