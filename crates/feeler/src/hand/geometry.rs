//! Geometry and joint limits of a finger.

use super::chain::{Chain, ChainConfig};
use super::description::FingerDescription;
use super::finger::{FingerConfig, FingerError, check};
use super::joint_vector::JointVector;
use super::three_joints::ThreeJoints;
use glam::{DMat3, DVec3};

/// Kinematics and joint limits of a finger: a checked [`FingerConfig`] or [`ChainConfig`], with precomputed transforms.
///
/// Positions and speeds of a joint are in rad and rad/s, or in m and m/s for the prismatic joint of a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct FingerGeometry {
    kinematics: Kinematics,
    joint_lower: JointVector,
    joint_upper: JointVector,
    joint_speed_limit: JointVector,
    joint_scale: JointVector,
}

/// Kinematics of a finger, by type.
#[derive(Debug, Clone, PartialEq)]
pub enum Kinematics {
    /// Three joints of the paper's reference finger, in closed form.
    ThreeJoints(ThreeJoints),
    /// One to seven joints of any arrangement.
    Chain(Box<Chain>),
}

/// Limits of a moving frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameLimits {
    /// Lower limit of the position (rad or m).
    pub lower: f64,
    /// Upper limit of the position (rad or m).
    pub upper: f64,
    /// Maximum speed (rad/s or m/s).
    pub speed: f64,
}

impl FingerGeometry {
    /// Builds the geometry of a finger with the three joints of the paper's reference finger.
    ///
    /// # Errors
    /// If a value is not finite or outside the range documented for its field.
    pub fn new(config: &FingerConfig) -> Result<Self, FingerError> {
        check(config)?;
        Ok(Self {
            kinematics: Kinematics::ThreeJoints(ThreeJoints::new(config)),
            joint_lower: config.joint_lower_deg.map(f64::to_radians).into(),
            joint_upper: config.joint_upper_deg.map(f64::to_radians).into(),
            joint_speed_limit: config.joint_speed_limit.into(),
            joint_scale: [1.0; 3].into(),
        })
    }

    /// Builds the geometry of a finger with one to seven joints.
    ///
    /// # Errors
    /// If a value is not finite or outside the range documented for its field, or if rows and joints do not refer to
    /// each other as documented.
    pub fn chain(config: &ChainConfig) -> Result<Self, FingerError> {
        let chain = Chain::new(config)?;
        let of_joints = |values| JointVector::first(values, chain.joint_count());
        Ok(Self {
            joint_lower: of_joints(chain.joint_lower()),
            joint_upper: of_joints(chain.joint_upper()),
            joint_speed_limit: of_joints(chain.joint_speed_limit()),
            joint_scale: of_joints(chain.is_prismatic().map(|slides| match slides {
                true => chain.reach(),
                false => 1.0,
            })),
            kinematics: Kinematics::Chain(Box::new(chain)),
        })
    }

    /// Builds the geometry of a finger from `description`.
    ///
    /// # Errors
    /// If [`new`](Self::new) or [`chain`](Self::chain) returns an error.
    pub fn of(description: &FingerDescription) -> Result<Self, FingerError> {
        match description {
            FingerDescription::ThreeJoints(config) => Self::new(config),
            FingerDescription::Chain(config) => Self::chain(config),
        }
    }

    /// Kinematics of the finger.
    #[inline(always)]
    pub fn kinematics(&self) -> &Kinematics {
        &self.kinematics
    }

    /// Number of joints.
    #[inline]
    pub fn joint_count(&self) -> usize {
        self.joint_lower.len()
    }

    /// Lower limits of the joint positions (rad or m).
    #[inline]
    pub fn joint_lower(&self) -> JointVector {
        self.joint_lower
    }

    /// Upper limits of the joint positions (rad or m).
    #[inline]
    pub fn joint_upper(&self) -> JointVector {
        self.joint_upper
    }

    /// Maximum joint speeds in either direction (rad/s or m/s).
    #[inline]
    pub fn joint_speed_limit(&self) -> JointVector {
        self.joint_speed_limit
    }

    /// `true` for each joint whose position is a displacement (m), `false` for an angle (rad).
    pub fn is_prismatic(&self) -> Vec<bool> {
        match &self.kinematics {
            Kinematics::ThreeJoints(_) => vec![false; self.joint_count()],
            Kinematics::Chain(chain) => chain.is_prismatic()[..chain.joint_count()].to_vec(),
        }
    }

    /// Unit of the position of `joint`: `rad`, or `m` if it is prismatic.
    pub fn joint_unit(&self, joint: usize) -> &'static str {
        match self.slides(joint) {
            false => "rad",
            true => "m",
        }
    }

    /// Unit of the effort on `joint`: `N m`, or `N` if it is prismatic.
    pub fn effort_unit(&self, joint: usize) -> &'static str {
        match self.slides(joint) {
            false => "N m",
            true => "N",
        }
    }

    /// Returns `true` if `joint` is prismatic. Does not allocate.
    fn slides(&self, joint: usize) -> bool {
        match &self.kinematics {
            Kinematics::ThreeJoints(_) => false,
            Kinematics::Chain(chain) => chain.is_prismatic().get(joint) == Some(&true),
        }
    }

    /// Scale of each joint for tolerances: change of its position that corresponds to 1 rad. 1 rad, or the reach (m)
    /// for a prismatic joint.
    #[inline]
    pub fn joint_scale(&self) -> JointVector {
        self.joint_scale
    }

    /// Upper bound of the distance from the first joint to the fingertip (m).
    pub fn reach(&self) -> f64 {
        match &self.kinematics {
            Kinematics::ThreeJoints(finger) => finger.links().iter().sum(),
            Kinematics::Chain(chain) => chain.reach(),
        }
    }

    /// Upper bounds of the speed of any point within `radius` (m) of the fingertip, per unit speed of each joint (m/rad
    /// or m/m).
    pub fn lever_arms(&self, radius: f64) -> JointVector {
        match &self.kinematics {
            Kinematics::ThreeJoints(finger) => {
                let [l2, l3, l4] = finger.links();
                let last = l4 + radius;
                [l2 + l3 + last, l3 + last, last].into()
            }
            Kinematics::Chain(chain) => chain.lever_arms(radius),
        }
    }

    /// Number of moving frames. It is at least the number of joints, because several coupled frames may follow the same
    /// joint.
    pub fn frame_count(&self) -> usize {
        match &self.kinematics {
            Kinematics::ThreeJoints(_) => self.joint_count(),
            Kinematics::Chain(chain) => chain.frame_count(),
        }
    }

    /// Positions of the moving frames (rad or m) at the joint positions `joints`, from the base to the fingertip.
    pub fn frame_positions(&self, joints: JointVector) -> impl Iterator<Item = f64> + '_ {
        let joints = joints.padded(self.joint_count());
        (0..self.frame_count()).map(move |index| match &self.kinematics {
            Kinematics::ThreeJoints(_) => joints[index],
            Kinematics::Chain(chain) => chain.frame_position(index, joints.as_slice()),
        })
    }

    /// Limits of the moving frames, from the base to the fingertip.
    pub fn frame_limits(&self) -> Vec<FrameLimits> {
        let lower: Vec<_> = self.frame_positions(self.joint_lower).collect();
        let upper = self.frame_positions(self.joint_upper);
        let speeds = self.frame_velocities(self.joint_speed_limit);
        let limits = lower.into_iter().zip(upper).zip(speeds);
        let limits = limits.map(|((one, other), speed)| FrameLimits {
            lower: one.min(other),
            upper: one.max(other),
            speed: speed.abs(),
        });
        limits.collect()
    }

    /// Velocities of the moving frames (rad/s or m/s) at the joint velocities `velocities`.
    pub fn frame_velocities(&self, velocities: JointVector) -> impl Iterator<Item = f64> + '_ {
        (0..self.frame_count()).map(move |index| match &self.kinematics {
            Kinematics::ThreeJoints(_) => velocities[index],
            Kinematics::Chain(chain) => chain.frame_velocity(index, &velocities),
        })
    }

    /// Endpoints in `W` (m) of the links to draw, from the base to the fingertip, at the joint positions `joints` (rad
    /// or m). `tip` is the fingertip pose at `joints`.
    pub fn skeleton(&self, joints: JointVector, tip: (DVec3, DMat3)) -> Vec<DVec3> {
        match &self.kinematics {
            Kinematics::ThreeJoints(finger) => finger.skeleton(joints[0], tip).into(),
            Kinematics::Chain(chain) => chain.skeleton(joints.as_slice()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_in_radians() {
        let geometry = FingerGeometry::new(&FingerConfig {
            base_position: [-0.144, 0.0, 0.06],
            phi1_deg: 0.0,
            phi2_deg: 0.0,
            links: [0.025, 0.05, 0.055],
            joint_lower_deg: [-45.0, -30.0, -120.0],
            joint_upper_deg: [45.0, 120.0, -10.0],
            joint_speed_limit: [3.0; 3],
        });
        let geometry = geometry.unwrap();
        assert_eq!(geometry.joint_lower()[0], -std::f64::consts::FRAC_PI_4);
        assert_eq!(geometry.joint_upper()[0], std::f64::consts::FRAC_PI_4);
    }
}
