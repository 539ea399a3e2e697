//! How long a finger that follows an outline felt nothing.

use feeler_record::{Phase, Recording, Tactile};
use glam::DVec3;

/// Stamps within a nanosecond are one time, s.
const SAME: f64 = 1e-9;

/// Goes through the tactile frames of the first finger, part by part.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Contact {
    /// Up to which time frames were taken, s.
    until: Option<f64>,
    /// Frames within MOVE.
    frames: usize,
    /// Frames without touch, up to the last one that was taken.
    current: usize,
    longest: usize,
}

impl Contact {
    /// Takes the frames up to `until`, s, that were not taken before.
    pub fn take(&mut self, recording: &Recording, until: f64) {
        let Some(finger) = recording.fingers.first() else {
            return;
        };
        let threshold = recording.facts.touch_force_threshold;
        let is_new = |frame: &&Tactile| {
            self.until.is_none_or(|before| frame.stamp > before + SAME)
                && frame.stamp <= until + SAME
        };
        let (mut frames, mut current, mut longest) = (0, self.current, self.longest);
        for frame in finger.tactile.iter().filter(is_new) {
            let steps = (recording.task).partition_point(|task| task.stamp <= frame.stamp + SAME);
            let step = steps.checked_sub(1).map(|step| &recording.task[step]);
            if step.is_none_or(|task| task.phase != Phase::Move) {
                continue;
            }
            let mut forces = frame.forces.iter().map(|&force| DVec3::from(force));
            let touches = forces.any(|force| force.length() > threshold);
            frames += 1;
            current = if touches { 0 } else { current + 1 };
            longest = longest.max(current);
        }
        self.frames += frames;
        (self.current, self.longest) = (current, longest);
        self.until = Some(until);
    }

    /// The longest stretch without touch, in frames; none without frames within MOVE.
    pub fn longest_loss(&self) -> Option<usize> {
        (self.frames > 0).then_some(self.longest)
    }
}
