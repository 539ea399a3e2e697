//! Whether the time goes on as it should.

use super::Trouble;

/// Intervals that are looked at before any is called a jump.
const KNOWN: u32 = 5;
/// How much longer than usual an interval must be to be called a jump.
const JUMP: f64 = 5.0;
/// Part of the way to the newest interval that the usual one goes.
const RATE: f64 = 0.1;

/// The times of rows, s.
#[derive(Debug, Clone, Copy, Default)]
pub struct Times {
    newest: Option<f64>,
    usual: f64,
    known: u32,
}

impl Times {
    /// The newest time; 0 before the first.
    pub fn newest(&self) -> f64 {
        self.newest.unwrap_or(0.0)
    }

    /// Begins a sequence, whose time may be any.
    pub fn restart(&mut self) {
        self.newest = None;
    }

    /// Takes the time of the next row; what is odd about it.
    pub fn take(&mut self, time: f64) -> Option<Trouble> {
        let interval = time - self.newest.replace(time)?;
        if interval < 0.0 {
            return Some(Trouble::TimeBack);
        }
        if interval == 0.0 {
            return Some(Trouble::TimeRepeated);
        }
        if self.known < KNOWN {
            self.usual += (interval - self.usual) / f64::from(self.known + 1);
            self.known += 1;
            return None;
        }
        // One that is far longer moves it, too: a rate that has changed is soon the usual one.
        let longest = JUMP * self.usual;
        self.usual += RATE * (interval.min(longest) - self.usual);
        (interval > longest).then_some(Trouble::TimeJump)
    }
}
