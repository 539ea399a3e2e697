//! Whether new pictures of a finger go on saying the same.

use super::stop_reason::StopReason;
use super::touch::FingerTouch;
use glam::DVec3;

/// Counts new tactile frames with the same forces, to the bit. A camera's noise changes every picture, and with it the
/// forces; a driver that repeats a picture under new stamps does not.
///
/// Frames without any force do not count: a sensor may leave out forces that are too small for it.
#[derive(Debug, Clone)]
pub struct FrozenForces {
    /// So many frames like the one before are too many; 0 for none.
    limit: u32,
    /// Sequence number of the newest frame.
    sequence: Option<u64>,
    /// Its forces, N.
    forces: Vec<DVec3>,
    /// Frames before it that were the same.
    same: u32,
}

impl FrozenForces {
    /// For a finger of `elements` elements, of whose frames `limit` in a row may not be like the one before; 0 for any
    /// number.
    pub fn new(limit: u32, elements: usize) -> Self {
        Self {
            limit,
            sequence: None,
            forces: vec![DVec3::ZERO; elements],
            same: 0,
        }
    }

    /// Forgets what was.
    pub fn reset(&mut self) {
        (self.sequence, self.same) = (None, 0);
    }

    /// Looks at what `finger` felt, which is of as many elements. Does not allocate.
    ///
    /// # Errors
    /// When as many new frames as the limit were the same.
    pub fn watch(&mut self, finger: usize, touch: &FingerTouch) -> Result<(), StopReason> {
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
        Err(StopReason::FrozenForces {
            finger,
            frames: self.same,
        })
    }
}
