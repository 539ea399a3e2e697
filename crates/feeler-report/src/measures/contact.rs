//! Longest loss of contact while a finger traces an outline.

use super::series::Stretch;
use feeler_record::{Phase, Recording, SAME_TIME, Tactile};
use glam::DVec3;

/// Accumulates the tactile frames of the first finger, part by part.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Contact {
    /// Time up to which frames have been processed (s).
    until: Option<f64>,
    /// Number of frames within MOVE.
    frames: usize,
    /// Stretches of frames without touch.
    lost: Stretch,
}

impl Contact {
    /// Processes the frames up to `until` (s) that have not been processed yet.
    pub fn take(&mut self, recording: &Recording, until: f64) {
        let Some(finger) = recording.fingers.first() else {
            return;
        };
        let threshold = recording.facts.touch_force_threshold;
        let is_new = |frame: &&Tactile| {
            self.until
                .is_none_or(|before| frame.stamp > before + SAME_TIME)
                && frame.stamp <= until + SAME_TIME
        };
        let (mut frames, mut lost) = (0, self.lost);
        for frame in finger.tactile.iter().filter(is_new) {
            let steps =
                (recording.task).partition_point(|task| task.stamp <= frame.stamp + SAME_TIME);
            let step = steps.checked_sub(1).map(|step| &recording.task[step]);
            if step.is_none_or(|task| task.phase != Phase::Move) {
                continue;
            }
            let mut forces = frame.forces.iter().map(|&force| DVec3::from(force));
            let touches = forces.any(|force| force.length() > threshold);
            frames += 1;
            lost.take(!touches);
        }
        self.frames += frames;
        self.lost = lost;
        self.until = Some(until);
    }

    /// Longest stretch without touch, in frames; `None` if there are no frames within MOVE.
    pub fn longest_loss(&self) -> Option<usize> {
        (self.frames > 0).then_some(self.lost.longest())
    }
}
