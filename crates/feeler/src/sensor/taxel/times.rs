//! Checks that rows follow each other in regular intervals.

use super::TableProblem;

/// Minimum number of intervals for detecting jumps.
const KNOWN: u32 = 5;
/// Ratio of an interval to the typical interval above which it is a jump.
const JUMP: f64 = 5.0;
/// Weight of a new interval in the average that gives the typical interval.
const RATE: f64 = 0.1;

/// Time of the latest row and typical interval between rows, s.
#[derive(Debug, Clone, Copy, Default)]
pub struct Times {
    newest: Option<f64>,
    usual: f64,
    known: u32,
}

impl Times {
    /// Time of the latest row; 0 before the first.
    pub fn newest(&self) -> f64 {
        self.newest.unwrap_or(0.0)
    }

    /// Starts a new sequence, whose first time is arbitrary.
    pub fn restart(&mut self) {
        self.newest = None;
    }

    /// Adds the time of the next row (s). Returns the problem with it, if any.
    pub fn take(&mut self, time: f64) -> Option<TableProblem> {
        let interval = time - self.newest.replace(time)?;
        if interval < 0.0 {
            return Some(TableProblem::TimeBack);
        }
        if interval == 0.0 {
            return Some(TableProblem::TimeRepeated);
        }
        if self.known < KNOWN {
            self.usual += (interval - self.usual) / f64::from(self.known + 1);
            self.known += 1;
            return None;
        }
        // Jumps count, too, so that a changed rate soon becomes the usual one.
        let longest = JUMP * self.usual;
        self.usual += RATE * (interval.min(longest) - self.usual);
        (interval > longest).then_some(TableProblem::TimeJump)
    }
}
