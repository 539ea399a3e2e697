//! Cross-validation folds of contiguous blocks of time with guard intervals.

/// A cross-validation fold.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fold {
    /// Rows that are predicted.
    pub held: Vec<usize>,
    /// Rows excluded from training: `held` and the rows close to them in time, which are too similar.
    pub hidden: Vec<usize>,
}

impl Fold {
    /// Rows used for training, out of `rows` rows.
    pub fn train(&self, rows: usize) -> Vec<usize> {
        let mut hidden = vec![false; rows];
        for &row in &self.hidden {
            hidden[row] = true;
        }
        (0..rows).filter(|&row| !hidden[row]).collect()
    }
}

/// Splits each recording into `count` contiguous blocks; fold k holds out the k-th block of each recording. A guard
/// interval of a tenth of a block on each side is excluded from training. `recording_of` contains the recording of each
/// row; rows are in chronological order.
pub(super) fn blocks(recording_of: &[usize], count: usize) -> Vec<Fold> {
    let mut folds = vec![
        Fold {
            held: Vec::new(),
            hidden: Vec::new(),
        };
        count
    ];
    for rows in by_recording(recording_of) {
        let bound = |block: usize| block * rows.len() / count;
        for (block, fold) in folds.iter_mut().enumerate() {
            let (start, end) = (bound(block), bound(block + 1));
            if start == end {
                continue;
            }
            let guard = (end - start) / 10;
            let around = start.saturating_sub(guard)..(end + guard).min(rows.len());
            fold.held.extend(&rows[start..end]);
            fold.hidden.extend(&rows[around]);
        }
    }
    folds.retain(|fold| !fold.held.is_empty());
    folds
}

/// Rows of each recording, in chronological order.
pub(super) fn by_recording(recording_of: &[usize]) -> Vec<Vec<usize>> {
    let count = recording_of.iter().max().map_or(0, |&last| last + 1);
    let mut recordings = vec![Vec::new(); count];
    for (row, &recording) in recording_of.iter().enumerate() {
        recordings[recording].push(row);
    }
    recordings.retain(|rows| !rows.is_empty());
    recordings
}

/// Folds that hold out whole recordings; if there are more than `most` recordings, several per fold. Empty if there is
/// only one recording.
pub(super) fn recordings(recording_of: &[usize], most: usize) -> Vec<Fold> {
    let recordings = by_recording(recording_of);
    if recordings.len() < 2 {
        return Vec::new();
    }
    let mut folds = vec![Vec::new(); recordings.len().min(most)];
    let count = folds.len();
    for (index, rows) in recordings.into_iter().enumerate() {
        folds[index % count].extend(rows);
    }
    let fold = |held: Vec<usize>| Fold {
        hidden: held.clone(),
        held,
    };
    folds.into_iter().map(fold).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Every row is held out once, and no temporal neighbour of a held-out row is used for training.
        #[test]
        fn neighbours_are_not_used_for_training(lengths in proptest::collection::vec(1..60_usize, 1..5), count in 2..9_usize) {
            let recording_of: Vec<usize> = lengths.iter().enumerate()
                .flat_map(|(recording, &length)| vec![recording; length]).collect();
            let mut times = vec![0; recording_of.len()];
            for fold in blocks(&recording_of, count) {
                let train = fold.train(recording_of.len());
                for &row in &fold.held {
                    times[row] += 1;
                    let own = recording_of.iter().filter(|&&other| other == recording_of[row]).count();
                    let guard = own / count / 10;
                    for near in row.saturating_sub(guard)..=row + guard {
                        let same = recording_of.get(near) == Some(&recording_of[row]);
                        prop_assert!(!(same && train.contains(&near)), "{near} is used to predict {row}");
                    }
                }
            }
            prop_assert!(times.iter().all(|&times| times == 1));
        }
    }
}
