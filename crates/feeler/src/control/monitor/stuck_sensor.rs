//! Detects a camera that repeats the same image, from forces that do not change.

use crate::control::stop_reason::StopReason;
use crate::control::touch::TactileReading;
use glam::DVec3;

/// Counts consecutive tactile frames with new stamps but bit-identical forces. Camera noise changes every image and
/// thus the forces; a driver that repeats an image with new stamps does not.
///
/// Frames in which all forces are zero do not count, because a sensor may suppress forces below its resolution.
#[derive(Debug, Clone)]
pub struct StuckSensorDetector {
    /// Number of consecutive repetitions that counts as a fault; 0 disables the check.
    limit: u32,
    /// Sequence number of the latest frame.
    sequence: Option<u64>,
    /// Forces of the latest frame (N).
    forces: Vec<DVec3>,
    /// Number of consecutive repetitions so far.
    same: u32,
}

impl StuckSensorDetector {
    /// Creates a detector for a finger of `elements` elements that reports a fault after `limit` consecutive
    /// repetitions; 0 disables it.
    pub fn new(limit: u32, elements: usize) -> Self {
        Self {
            limit,
            sequence: None,
            forces: vec![DVec3::ZERO; elements],
            same: 0,
        }
    }

    /// Discards all previous frames.
    pub fn reset(&mut self) {
        (self.sequence, self.same) = (None, 0);
    }

    /// Checks the latest reading of `finger`, which must have the number of elements given to [`new`](Self::new).
    /// Does not allocate.
    ///
    /// # Errors
    /// If the number of consecutive repetitions has reached the limit.
    pub fn watch(&mut self, finger: usize, touch: &TactileReading) -> Result<(), StopReason> {
        let frame = &touch.frame;
        if self.limit == 0 || self.sequence == Some(frame.sequence) {
            return Ok(());
        }
        let is_first = self.sequence.replace(frame.sequence).is_none();
        if is_first || self.forces != frame.forces {
            self.same = 0;
            self.forces.copy_from_slice(&frame.forces);
            return Ok(());
        }
        let felt = self.forces.iter().any(|&force| force != DVec3::ZERO);
        self.same = if felt { self.same + 1 } else { 0 };
        if self.same < self.limit {
            return Ok(());
        }
        Err(StopReason::StuckSensorDetector {
            finger,
            frames: self.same,
        })
    }
}
