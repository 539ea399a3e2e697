//! Forces on the elements of a fingertip in the dome's frame: as a point cloud, and summed to a wrench.

use crate::messages::model::{FingerModel, frame};
use crate::ros::{Header, PointCloud2, Wrench, fields};
use feeler::sensor::fingertip::SensingElement;
use glam::DVec3;

/// The 32-bit number fields of a point: position of the element's tip (m) and force on the element (N), both in the
/// dome's frame.
const NUMBERS: [&str; 6] = ["x", "y", "z", "fx", "fy", "fz"];
/// The fields that are 0 or 1: whether the element slips, and whether its force is known.
const FLAGS: [&str; 2] = ["slip", "valid"];
/// Size of a number in bytes.
const NUMBER: usize = 4;
/// Size of a point in bytes: a multiple of the size of a number, so that numbers are aligned.
const POINT: usize = 28;

/// The elements of a fingertip.
pub struct Elements {
    /// Each element with its undeformed tip in the fingertip frame `T` (m).
    elements: Vec<(SensingElement, DVec3)>,
    /// Force on each element in `T` (N), or NaN if not known.
    pub forces: Vec<DVec3>,
}

impl Elements {
    /// Creates the elements of a finger.
    pub fn of(model: &FingerModel) -> Self {
        Self::new(model.elements().collect())
    }

    /// Creates the elements from pairs of an element and its undeformed tip in `T` (m).
    pub fn new(elements: Vec<(SensingElement, DVec3)>) -> Self {
        Self {
            forces: vec![DVec3::ZERO; elements.len()],
            elements,
        }
    }

    /// The undeformed tips in `T` (m).
    pub fn tips(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.elements.iter().map(|(_, tip)| *tip)
    }

    /// Sets the forces from a tactile frame, given in each element's frame (N).
    pub fn take_forces(&mut self, forces: &[DVec3]) {
        let turned = self.elements.iter().zip(forces);
        let turned = turned.map(|((element, _), &force)| element.force_on_fingertip(force));
        self.forces.clear();
        self.forces.extend(turned);
    }

    /// Wrench on the fingertip about the dome's centre: the sum over all elements whose force is known.
    pub fn wrench(&self) -> Wrench {
        let all = self.tips().zip(self.forces.iter().copied());
        Wrench::of(all.filter(|(_, force)| !force.is_nan()))
    }

    /// Fills the points of `cloud`. `slips` returns whether an element slips.
    pub fn fill(&self, cloud: &mut PointCloud2, slips: impl Fn(usize) -> bool) {
        cloud.data.clear();
        for (element, (tip, force)) in self.tips().zip(&self.forces).enumerate() {
            let numbers = tip.to_array().into_iter().chain(force.to_array());
            for number in numbers {
                cloud.data.extend((number as f32).to_le_bytes());
            }
            let flags = [slips(element), !force.is_nan()];
            cloud.data.extend(flags.map(u8::from));
            cloud
                .data
                .extend([0; POINT - NUMBERS.len() * NUMBER - FLAGS.len()]);
        }
        cloud.width = self.forces.len() as u32;
        cloud.row_step = cloud.data.len() as u32;
    }
}

/// Creates an empty point cloud for the elements of `finger`.
pub fn taxels(finger: usize, elements: &Elements) -> PointCloud2 {
    PointCloud2 {
        header: Header::of(frame(finger, "dome")),
        height: 1,
        fields: fields(&NUMBERS, &FLAGS),
        point_step: POINT as u32,
        data: Vec::with_capacity(POINT * elements.elements.len()),
        // Unknown forces are NaN.
        is_dense: false,
        ..PointCloud2::default()
    }
}
