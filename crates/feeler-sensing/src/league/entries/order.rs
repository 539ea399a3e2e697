//! Order and identifiers under which a program receives recordings.

use crate::league::data::{DataSet, Fold, Piece};
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

/// Order in which recordings are sent to a program, and their identifiers. The original names and order may reveal
/// labels, so both are random, with a seed that depends only on the data.
pub struct Order {
    pub train: Vec<Piece>,
    /// Indices of the test pieces in the fold, in the order in which they are sent.
    pub test: Vec<usize>,
    /// Identifier of each recording.
    pub recordings: Vec<usize>,
    /// Identifier of each group.
    pub groups: Vec<usize>,
}

impl Order {
    /// Draws the order of a fold. Pieces of the same recording stay in order of time.
    pub fn of(set: &DataSet, fold: &Fold) -> Self {
        let mut random = Pcg64::seed_from_u64(set.recordings.len() as u64);
        let mut drawn = |count: usize| {
            let mut drawn: Vec<_> = (0..count).collect();
            drawn.shuffle(&mut random);
            drawn
        };
        let recordings = drawn(set.recordings.len());
        let groups = drawn(set.groups.len());
        let mut train = fold.train.clone();
        let mut test: Vec<_> = (0..fold.test.len()).collect();
        let place = |piece: &Piece| (recordings[piece.recording], piece.rows.start);
        train.sort_by_key(place);
        test.sort_by_key(|&index| place(&fold.test[index]));
        Self {
            train,
            test,
            recordings,
            groups,
        }
    }
}
