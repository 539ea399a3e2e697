//! Conversion between tactile readings and messages.

use super::message::{MessageHeader, NO_ELEMENT, TactileUpdate};
use feeler::control::TactileReading;
use feeler::sensor::forces::NO_FORCE;
use feeler_record::wire::Vector3;
use glam::DVec3;

impl TactileUpdate {
    /// Creates the message for the reading `touch` of `finger`. Elements with a shear rate above `slip_threshold` (N/s)
    /// are marked as slipping. Elements without a valid force are marked as invalid, with a force of 0 N, not NaN.
    pub fn of_touch(
        header: MessageHeader,
        finger: usize,
        touch: &TactileReading,
        slip_threshold: f64,
    ) -> Self {
        let (frame, flags) = (&touch.frame, touch.flags);
        let sent = |force: &DVec3| match force.is_nan() {
            true => Vector3::from(DVec3::ZERO),
            false => Vector3::from(*force),
        };
        let slips = touch.shear_rate.iter().map(|&rate| rate > slip_threshold);
        Self {
            header,
            finger: finger as u32,
            frame: frame.sequence,
            touch: flags.touch,
            slip: flags.slip,
            over: flags.over,
            largest_element: flags.largest_element.map_or(NO_ELEMENT, |e| e as u32),
            grasp_force: flags.grasp_force,
            forces: frame.forces.iter().map(sent).collect(),
            shear_rate: touch.shear_rate.clone(),
            slip_mask: mask(slips),
            invalid_mask: mask(frame.forces.iter().map(|force| force.is_nan())),
        }
    }

    /// Returns the force on each element (N), or [`NO_FORCE`] for elements marked as invalid.
    pub fn valid_forces(&self) -> impl Iterator<Item = DVec3> {
        let forces = self.forces.iter().enumerate();
        forces.map(|(element, &force)| {
            let byte = self.invalid_mask.get(element / 8);
            match byte.is_some_and(|byte| byte >> (element % 8) & 1 == 1) {
                true => NO_FORCE,
                false => force.into(),
            }
        })
    }
}

/// Packs the elements' flags into bytes: bit `i % 8` of byte `i / 8` is element `i`.
fn mask(elements: impl ExactSizeIterator<Item = bool>) -> Vec<u8> {
    let mut mask = vec![0; elements.len().div_ceil(8)];
    for (element, is_set) in elements.enumerate() {
        mask[element / 8] |= u8::from(is_set) << (element % 8);
    }
    mask
}
