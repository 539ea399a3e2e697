//! Tactile frames that a sensor measured between two control steps.

use crate::sensor::forces::reading::TactileFrame;
use glam::DVec3;

/// Maximum number of frames in a buffer; older ones are dropped.
const MOST_FRAMES: usize = 64;

/// Buffer of tactile frames measured between two control steps, oldest first, at most 64. The memory of removed frames
/// is reused.
#[derive(Debug, Clone, Default)]
pub struct FrameBuffer {
    frames: Vec<TactileFrame>,
    len: usize,
}

impl FrameBuffer {
    /// Removes all frames without freeing memory.
    pub fn clear(&mut self) {
        self.len = 0;
    }

    /// Appends a frame. Drops the oldest one if the buffer is full. Allocates only until the buffer has once had this
    /// length.
    pub fn push(&mut self, sequence: u64, stamp: f64, forces: impl Iterator<Item = DVec3>) {
        if self.len == MOST_FRAMES {
            self.frames.rotate_left(1);
            self.len -= 1;
        }
        if self.len == self.frames.len() {
            self.frames.push(TactileFrame::unloaded(0));
        }
        if let Some(frame) = self.frames.get_mut(self.len) {
            (frame.sequence, frame.stamp) = (sequence, stamp);
            frame.forces.clear();
            frame.forces.extend(forces);
            self.len += 1;
        }
    }

    /// All frames, oldest first.
    pub fn as_slice(&self) -> &[TactileFrame] {
        self.frames.get(..self.len).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_latest_frames_are_kept_in_order() {
        let mut buffer = FrameBuffer::default();
        for round in 1..=2 {
            buffer.clear();
            assert!(buffer.as_slice().is_empty());
            for number in 0..70 {
                let forces = [DVec3::splat(number as f64); 3];
                buffer.push(number, 0.01 * number as f64, forces.into_iter().take(round));
            }
            let numbers = buffer.as_slice().iter().map(|frame| frame.sequence);
            assert!(numbers.eq(6..70));
            let last = buffer.as_slice().last().expect("a frame");
            assert_eq!(last.forces, vec![DVec3::splat(69.0); round]);
        }
    }
}
