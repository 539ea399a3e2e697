//! What the elements of a fingertip feel, in the frame of its dome: each, as points of a cloud, and together.

use crate::model::{FingerModel, frame};
use crate::ros::{Header, PointCloud2, PointField, Wrench};
use feeler::sensor::layout::SensingElement;
use glam::DVec3;

/// The fields of a point that are numbers of 32 bits: where the element's tip is, m, and the force on it by what it
/// touches, N, both in the frame of the dome.
const NUMBERS: [&str; 6] = ["x", "y", "z", "fx", "fy", "fz"];
/// The fields that are 0 or 1: whether the element slips, and whether its force is known.
const FLAGS: [&str; 2] = ["slip", "valid"];
/// Bytes of a number, and of a point: a multiple of that, so that numbers are aligned.
const NUMBER: usize = 4;
const POINT: usize = 28;

/// The elements of a fingertip.
pub struct Elements {
    /// Each with its undeformed tip, m in the fingertip frame `T`.
    elements: Vec<(SensingElement, DVec3)>,
    /// The force on each by what it touches, N in `T`; not a number where it is not known.
    pub forces: Vec<DVec3>,
}

impl Elements {
    /// Those of a finger.
    pub fn of(model: &FingerModel) -> Self {
        Self::new(model.elements().collect())
    }

    /// These, each with its undeformed tip, m in `T`.
    pub fn new(elements: Vec<(SensingElement, DVec3)>) -> Self {
        Self {
            forces: vec![DVec3::ZERO; elements.len()],
            elements,
        }
    }

    /// The undeformed tips, m in `T`.
    pub fn tips(&self) -> impl Iterator<Item = DVec3> + '_ {
        self.elements.iter().map(|(_, tip)| *tip)
    }

    /// Takes the forces of a tactile frame, each in the frame of its element, N.
    pub fn take_forces(&mut self, forces: &[DVec3]) {
        let turned = self.elements.iter().zip(forces);
        let turned = turned.map(|((element, _), &force)| element.force_on_fingertip(force));
        self.forces.clear();
        self.forces.extend(turned);
    }

    /// What acts on the fingertip, by all elements whose force is known, about the dome's centre.
    pub fn wrench(&self) -> Wrench {
        let (mut sum, mut torque) = (DVec3::ZERO, DVec3::ZERO);
        let known = self.tips().zip(&self.forces);
        for (tip, force) in known.filter(|(_, force)| !force.is_nan()) {
            sum += *force;
            torque += tip.cross(*force);
        }
        Wrench {
            force: sum.into(),
            torque: torque.into(),
        }
    }

    /// Fills the points of `cloud`, of elements of which `slips` says whether they slip.
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

/// A cloud of the elements of `finger`, to be filled.
pub fn taxels(finger: usize, elements: &Elements) -> PointCloud2 {
    let field = |datatype| {
        move |(name, offset): (&&str, usize)| PointField {
            name: name.to_string(),
            offset: offset as u32,
            datatype,
            count: 1,
        }
    };
    let numbers = NUMBERS.iter().zip((0..).step_by(NUMBER));
    let flags = FLAGS.iter().zip(NUMBERS.len() * NUMBER..);
    let numbers = numbers.map(field(PointField::FLOAT32));
    PointCloud2 {
        header: Header::of(frame(finger, "dome")),
        height: 1,
        fields: numbers.chain(flags.map(field(PointField::UINT8))).collect(),
        point_step: POINT as u32,
        data: Vec::with_capacity(POINT * elements.elements.len()),
        // Forces that are not known are not numbers.
        is_dense: false,
        ..PointCloud2::default()
    }
}
