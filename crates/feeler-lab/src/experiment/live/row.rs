//! Writes one row of a live page in the order of its columns, without the time.

use feeler::control::FingerFlags;
use feeler::hand::{FingerGeometry, JointVector};
use feeler::math::quaternion_z;
use feeler::sensor::contact::Contact;
use feeler_report::page_data::{contact_values, flag_bits};
use glam::{DQuat, DVec3};
use std::iter;

/// Writes the numbers of a row into preallocated memory. Numbers beyond its capacity are omitted.
pub struct Row<'a>(&'a mut Vec<f32>);

/// Values of one finger in a row.
pub struct FingerRow<'a, F> {
    /// Geometry of the finger.
    pub geometry: &'a FingerGeometry,
    /// Joint positions (rad or m).
    pub joints: JointVector,
    /// Number of elements of the fingertip.
    pub elements: usize,
    /// Force at each element, in the element's frame (N).
    pub forces: F,
    /// TOUCH, SLIP, OVER, largest element and grasp force.
    pub flags: &'a FingerFlags,
    /// `true` if the finger truly slips; `false` if the ground truth is unknown.
    pub slips: bool,
    /// Rate of change of each element's tangential force (N/s).
    pub shear_rates: &'a [f64],
    /// Contact with an object, or `None` if no element touches.
    pub contact: Option<Contact>,
}

impl<'a> Row<'a> {
    /// Starts a row in `numbers`, whose content is discarded.
    pub fn begin(numbers: &'a mut Vec<f32>) -> Self {
        numbers.clear();
        Self(numbers)
    }

    /// Appends a number.
    pub fn push(&mut self, number: f64) {
        if self.0.len() < self.0.capacity() {
            self.0.push(number as f32);
        }
    }

    fn extend(&mut self, numbers: impl IntoIterator<Item = f64>) {
        numbers.into_iter().for_each(|number| self.push(number));
    }

    /// Appends the columns of the next finger.
    pub fn finger(&mut self, finger: FingerRow<'_, impl Iterator<Item = DVec3>>) {
        let FingerRow { flags, .. } = finger;
        self.extend(finger.geometry.frame_positions(finger.joints));
        let forces = finger.forces.chain(iter::repeat(DVec3::NAN));
        self.extend(forces.take(finger.elements).flat_map(|f| f.to_array()));
        let bits = flag_bits([flags.touch, flags.slip, flags.over, finger.slips]);
        self.push(f64::from(bits));
        self.push(flags.grasp_force);
        let largest = flags
            .largest_element
            .map(|element| finger.shear_rates.get(element));
        self.push(largest.flatten().copied().unwrap_or_default());
        self.extend(contact_values(finger.contact));
    }

    /// Appends the pose of the cap: its centre in `W` (m) and its angle (rad).
    pub fn cap(&mut self, centre: DVec3, angle: f64) {
        self.pose(centre, quaternion_z(angle));
        self.push(angle);
    }

    /// Appends the pose of a frame in its parent.
    pub fn pose(&mut self, position: DVec3, rotation: DQuat) {
        self.extend(position.to_array());
        self.extend(rotation.to_array());
    }
}
