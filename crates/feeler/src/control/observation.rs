//! Observations of one finger as flat arrays of numbers, for learned policies and Gymnasium environments.
//!
//! Velocities and directions are in the fingertip frame `T`, so that one policy works for fingers that face each other.
//! Forces are in the element frame `E_i`, as measured.

use super::plan::Plan;
use super::sense::FingerReadings;
use crate::hand::{JointVector, MAX_JOINTS};
use glam::DVec3;
use std::ops::Range;

/// Number of entries other than the elements' forces and the joints' positions and velocities.
const OTHERS: usize = 15;

/// Error of writing an observation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ObservationError {
    /// The finger has a different number of elements than the observation.
    #[error("expected a finger of {expected} elements, got forces on {actual}")]
    ElementCount {
        /// Number of elements of the observation.
        expected: usize,
        /// Number of elements of the finger.
        actual: usize,
    },
    /// The finger has more joints than the observation.
    #[error("expected a finger of {expected} joints, got {actual}")]
    JointCount {
        /// Number of joints of the observation.
        expected: usize,
        /// Number of joints of the finger.
        actual: usize,
    },
    /// The buffer has a different length than the observation.
    #[error("expected a buffer for {expected} numbers, got {actual}")]
    Length {
        /// Length of the observation.
        expected: usize,
        /// Length of the buffer.
        actual: usize,
    },
}

/// Layout of the observation of one finger as an array of numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ObservationLayout {
    /// Number of elements of the finger.
    pub elements: usize,
    /// Number of joints of the finger, at most [`MAX_JOINTS`].
    pub joints: usize,
}

/// A part of an observation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ObservationPart {
    /// Name of the part.
    pub name: &'static str,
    /// Unit and frame of the part.
    pub unit: &'static str,
    /// Indices of the part within the observation.
    pub range: Range<usize>,
}

impl ObservationLayout {
    /// Number of values in the observation.
    #[expect(clippy::len_without_is_empty, reason = "no observation is empty")]
    pub fn len(&self) -> usize {
        3 * self.elements + 2 * self.joint_count() + OTHERS
    }

    fn joint_count(&self) -> usize {
        self.joints.min(MAX_JOINTS)
    }

    /// Parts of the observation, in order. For a prismatic joint, the position is in m and the velocity in m/s.
    pub fn parts(&self) -> [ObservationPart; 12] {
        let mut end = 0;
        [
            // F_x, F_y, F_z of each element in turn.
            ("forces", "N, in E_i", 3 * self.elements),
            ("touch", "0 or 1", 1),
            ("slip", "0 or 1", 1),
            ("over", "0 or 1", 1),
            ("grasp_force", "N", 1),
            ("joint_angles", "rad", self.joint_count()),
            ("joint_velocities", "rad/s", self.joint_count()),
            ("last_action", "m/s, in T", 3),
            ("planned_velocity", "m/s, in T", 3),
            ("towards_object", "unit vector, in T", 3),
            ("reflex", "0 or 1", 1),
            ("keep_grasp", "0 or 1", 1),
        ]
        .map(|(name, unit, length)| {
            let start = end;
            end += length;
            ObservationPart {
                name,
                unit,
                range: start..end,
            }
        })
    }

    /// Index range of the part called `name`; `None` if there is no such part.
    pub fn range(&self, name: &str) -> Option<Range<usize>> {
        let mut parts = self.parts().into_iter();
        parts.find_map(|part| (part.name == name).then_some(part.range))
    }

    /// Writes the observation of a finger with the given `plan` and readings. `last_action` is the last requested
    /// fingertip velocity (m/s, in W). Does not allocate.
    ///
    /// # Errors
    /// If the number of elements differs, if the finger has more joints (missing ones are 0), or if the length of
    /// `observation` differs from [`len`](Self::len).
    pub fn write(
        &self,
        plan: &Plan,
        sense: &FingerReadings<'_>,
        last_action: DVec3,
        observation: &mut [f32],
    ) -> Result<(), ObservationError> {
        let (flags, forces) = (sense.flags(), &sense.touch.frame.forces);
        if forces.len() != self.elements {
            return Err(ObservationError::ElementCount {
                expected: self.elements,
                actual: forces.len(),
            });
        }
        if observation.len() != self.len() {
            return Err(ObservationError::Length {
                expected: self.len(),
                actual: observation.len(),
            });
        }
        let to_fingertip = sense.pose.rotation.transpose();
        let (felt, rest) = observation.split_at_mut(3 * self.elements);
        let (felt, _) = felt.as_chunks_mut();
        for (numbers, force) in felt.iter_mut().zip(forces) {
            *numbers = [force.x as f32, force.y as f32, force.z as f32];
        }
        let up = |flag: bool| f32::from(u8::from(flag));
        let vector = |v: DVec3| v.as_vec3().to_array();
        let beside: [&[f32]; 8] = [
            &[up(flags.touch), up(flags.slip), up(flags.over)],
            &[flags.grasp_force as f32],
            &self.observed_joints(sense.joints.position)?[..self.joint_count()],
            &self.observed_joints(sense.joints.velocity)?[..self.joint_count()],
            &vector(to_fingertip * last_action),
            &vector(to_fingertip * plan.velocity),
            &vector(to_fingertip * plan.towards_object),
            &[up(plan.reflex), up(plan.keep_grasp)],
        ];
        let mut rest = rest;
        for part in beside {
            let (own, others) = rest.split_at_mut(part.len());
            own.copy_from_slice(part);
            rest = others;
        }
        Ok(())
    }

    /// Converts a joint quantity of a finger for the observation; values of missing joints are 0.
    fn observed_joints(&self, joints: JointVector) -> Result<[f32; MAX_JOINTS], ObservationError> {
        let (expected, actual) = (self.joint_count(), joints.len());
        let error = ObservationError::JointCount { expected, actual };
        let numbers = joints.to_array().filter(|_| actual <= expected);
        Ok(numbers.ok_or(error)?.map(|number| number as f32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::flags::FingerFlags;
    use crate::control::sense::FingertipPose;
    use crate::control::touch::TactileReading;
    use crate::hand::JointState;
    use crate::sensor::fingertip::layout::{ElementLayout, LayoutConfig, RingConfig};
    use glam::DMat3;

    fn layout() -> ElementLayout {
        ElementLayout::new(&LayoutConfig {
            dome_radius: 0.018,
            rings: vec![RingConfig {
                elements: 2,
                polar_angle_deg: 45.0,
            }],
            grid: None,
        })
    }

    /// The finger is rotated by a quarter turn about z: its `x` is W's `y`, its `y` is W's `-x`.
    #[test]
    fn numbers_are_in_their_parts_and_vectors_in_the_fingertip_frame() {
        let layout = layout();
        let mut touch = TactileReading::none(2);
        touch.frame.forces = vec![DVec3::new(0.1, 0.2, 0.3), DVec3::new(-0.4, 0.5, -0.6)];
        touch.flags = FingerFlags {
            touch: true,
            over: true,
            grasp_force: 0.3,
            ..FingerFlags::default()
        };
        let sense = FingerReadings {
            pose: FingertipPose {
                rotation: DMat3::from_cols(DVec3::Y, -DVec3::X, DVec3::Z),
                ..FingertipPose::default()
            },
            joints: JointState {
                position: [1.0, 2.0, 3.0].into(),
                velocity: [4.0, 5.0, 6.0].into(),
            },
            touch: &touch,
            layout: &layout,
        };
        let plan = Plan {
            velocity: 7.0 * DVec3::Y,
            towards_object: DVec3::X,
            reflex: false,
            keep_grasp: true,
        };
        let observed = ObservationLayout {
            elements: 2,
            joints: 3,
        };
        let mut numbers = vec![f32::NAN; observed.len()];
        let last = DVec3::new(8.0, 9.0, 10.0);
        observed
            .write(&plan, &sense, last, &mut numbers)
            .expect("the buffer fits");
        let expected: [&[f32]; 12] = [
            &[0.1, 0.2, 0.3, -0.4, 0.5, -0.6],
            &[1.0],
            &[0.0],
            &[1.0],
            &[0.3],
            &[1.0, 2.0, 3.0],
            &[4.0, 5.0, 6.0],
            &[9.0, -8.0, 10.0],
            &[7.0, 0.0, 0.0],
            &[0.0, -1.0, 0.0],
            &[0.0],
            &[1.0],
        ];
        for (part, expected) in observed.parts().into_iter().zip(expected) {
            assert_eq!(&numbers[part.range.clone()], expected, "{}", part.name);
            assert_eq!(observed.range(part.name), Some(part.range));
        }
        assert_eq!(numbers, expected.concat());
        let mut short = vec![0.0; observed.len() - 1];
        let error = observed.write(&plan, &sense, last, &mut short);
        let (expected, actual) = (27, 26);
        assert_eq!(error, Err(ObservationError::Length { expected, actual }));
        let other = ObservationLayout {
            elements: 3,
            ..observed
        };
        let error = other.write(&plan, &sense, last, &mut short);
        let (expected, actual) = (3, 2);
        assert_eq!(
            error,
            Err(ObservationError::ElementCount { expected, actual })
        );
    }

    #[test]
    fn each_joint_has_a_number() {
        let layout = layout();
        let touch = TactileReading::none(2);
        for joints in 1..=MAX_JOINTS {
            let numbers: Vec<_> = (1..=joints).map(|joint| joint as f64).collect();
            let position = JointVector::from_slice(&numbers).expect("few joints");
            let sense = FingerReadings {
                pose: FingertipPose::default(),
                joints: JointState {
                    position,
                    velocity: -position,
                },
                touch: &touch,
                layout: &layout,
            };
            let observed = ObservationLayout {
                elements: 2,
                joints,
            };
            assert_eq!(observed.len(), 21 + 2 * joints);
            let mut numbers = vec![f32::NAN; observed.len()];
            let write = |observed: &ObservationLayout, numbers: &mut [f32]| {
                observed.write(&Plan::default(), &sense, DVec3::ZERO, numbers)
            };
            write(&observed, &mut numbers).expect("the buffer fits");
            assert!(numbers.iter().all(|number| number.is_finite()));
            let range = observed.range("joint_angles").expect("a part");
            assert!(numbers[range].iter().map(|&n| f64::from(n)).eq(position));
            let range = observed.range("joint_velocities").expect("a part");
            assert!(numbers[range].iter().map(|&n| f64::from(n)).eq(-position));
            let fewer = ObservationLayout {
                elements: 2,
                joints: joints - 1,
            };
            let error = write(&fewer, &mut numbers[2..]);
            let (expected, actual) = (joints - 1, joints);
            let count = ObservationError::JointCount { expected, actual };
            assert_eq!(error, Err(count));
        }
    }
}
