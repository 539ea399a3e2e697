//! Plausibility check of a tactile sensor against the effort (torque or force) of the drives, estimated from motor
//! currents.
//!
//! While a finger moves slowly, the effort of each joint's motor balances the forces on the fingertip: `effort = -J^T
//! f`, with the Jacobian `J` and the force `f` on the fingertip by the object. Both sides are averaged, because
//! currents are noisy. The tolerance is one and a half times the largest recent uncertainty of the effort plus
//! [`effort_share`](super::MonitorConfig::effort_share) of the larger side. If a joint exceeds it for
//! some time, the effort contradicts the tactile sensor. A motor that moves joints of several fingers balances the forces
//! on all of their fingertips, each times the motion of its joint per motion of the first one (virtual work).
//!
//! Weight, inertia and viscous friction of the finger, and the moment of the forces about the dome's centre, are
//! neglected.

use super::MonitorConfig;
use crate::control::stop_reason::StopReason;
use crate::hand::geometry::FingerGeometry;
use crate::hand::joint_vector::{JointVector, MAX_JOINTS};
use crate::hand::kinematics::jacobian;
use crate::hand::{JointEfforts, JointState};
use glam::DVec3;

/// Time constant of the averages (s).
const FILTER_TIME: f64 = 0.05;
/// Duration for which a joint must exceed its tolerance for a fault to be reported (s).
const MISMATCH_TIME: f64 = 0.1;
/// Fraction of its speed limit above which a joint is too fast for the comparison, because friction and inertia are
/// unknown.
const FAST: f64 = 0.3;
/// Factor on the uncertainty in the tolerance, because static friction may exceed the friction at calibration.
const UNCERTAINTY_FACTOR: f64 = 1.5;

/// Efforts of one finger's motors that balance the measured forces.
#[derive(Debug, Clone, Copy)]
pub struct ExpectedEfforts {
    /// Effort on each joint.
    pub efforts: JointVector,
    /// `true` for each joint whose motor also moves a joint of another finger.
    pub shared: [bool; MAX_JOINTS],
}

impl ExpectedEfforts {
    /// Efforts that balance the `force` on the fingertip by the object (N, in W), of motors that move this finger only.
    pub fn of(geometry: &FingerGeometry, joints: &JointState, force: DVec3) -> Self {
        let mut efforts = JointVector::zeros(geometry.joint_count());
        let jacobian = jacobian(geometry, joints.position);
        for (joint, column) in jacobian.columns().iter().enumerate() {
            efforts[joint] = -column.dot(force);
        }
        Self {
            efforts,
            shared: [false; MAX_JOINTS],
        }
    }

    /// Adds the `effort` that another finger requires of the motor of `joint`.
    pub fn add(&mut self, joint: usize, effort: f64) {
        self.efforts[joint] += effort;
        self.shared[joint] = true;
    }
}

/// Compares the efforts of one finger's drives with the forces that its fingertip measures.
#[derive(Debug, Clone)]
pub struct EffortMonitor {
    share: f64,
    /// Maximum time between two readings (s); after a longer gap, the comparison restarts.
    most_gap: f64,
    means: Option<Means>,
}

/// Low-pass filtered motor efforts and efforts that balance the measured forces, up to the time `stamp` (s).
#[derive(Debug, Clone, Copy)]
struct Means {
    stamp: f64,
    effort: JointVector,
    felt: JointVector,
    /// Largest recent uncertainty, which decays with the time constant of the averages.
    uncertainty: JointVector,
    /// Time at which each joint began to exceed its tolerance (s); NaN if it does not exceed it.
    since: JointVector,
}

impl EffortMonitor {
    /// Creates a monitor. A gap of more than `most_gap` (s) between two readings restarts the comparison.
    pub fn new(config: MonitorConfig, most_gap: f64) -> Self {
        Self {
            share: config.effort_share,
            most_gap,
            means: None,
        }
    }

    /// Returns `true` if `efforts` are known and compared.
    pub fn is_comparable(&self, efforts: &JointEfforts) -> bool {
        self.share != 0.0 && !efforts.effort.is_empty()
    }

    /// Discards all readings.
    pub fn reset(&mut self) {
        self.means = None;
    }

    /// Compares the `efforts` of `finger` with those that balance the measured forces, `felt`, at `stamp` (s). Does not
    /// allocate.
    ///
    /// # Errors
    /// If they have differed by more than the tolerance for too long.
    pub fn watch(
        &mut self,
        finger: usize,
        geometry: &FingerGeometry,
        stamp: f64,
        joints: &JointState,
        efforts: &JointEfforts,
        felt: ExpectedEfforts,
    ) -> Result<(), StopReason> {
        let limits = geometry.joint_speed_limit();
        let is_fast = |joint| joints.velocity[joint].abs() > FAST * limits[joint];
        if (0..geometry.joint_count()).any(is_fast) {
            self.reset();
            return Ok(());
        }
        let share = self.share;
        let means = self.average(stamp, efforts, felt.efforts);
        for joint in 0..geometry.joint_count() {
            let (effort, own) = (means.effort[joint], means.felt[joint]);
            let larger = effort.abs().max(own.abs());
            let tolerance = UNCERTAINTY_FACTOR * means.uncertainty[joint] + share * larger;
            // False for an unknown effort, which is NaN.
            let exceeds = (effort - own).abs() > tolerance;
            let since = &mut means.since[joint];
            *since = match exceeds {
                true if since.is_nan() => stamp,
                true => *since,
                false => f64::NAN,
            };
            if stamp - *since >= MISMATCH_TIME {
                return Err(StopReason::EffortMismatch {
                    finger,
                    joint,
                    effort,
                    felt: own,
                    tolerance,
                    unit: geometry.effort_unit(joint),
                    shared: felt.shared[joint],
                });
            }
        }
        Ok(())
    }

    /// Updates the averages with the readings at `stamp` (s).
    fn average(&mut self, stamp: f64, efforts: &JointEfforts, felt: JointVector) -> &mut Means {
        let most_gap = self.most_gap;
        let known = self.means.take();
        let known = known.filter(|means| (0.0..=most_gap).contains(&(stamp - means.stamp)));
        let means = known.map_or_else(
            || Means {
                stamp,
                effort: efforts.effort,
                felt,
                uncertainty: efforts.uncertainty,
                since: felt.map(|_| f64::NAN),
            },
            |before| {
                let keep = libm::exp(-(stamp - before.stamp) / FILTER_TIME);
                // A NaN does not persist.
                let mean = |old: f64, new: f64| match (keep * old + (1.0 - keep) * new).is_nan() {
                    true => new,
                    false => keep * old + (1.0 - keep) * new,
                };
                Means {
                    stamp,
                    effort: before.effort.zip_with(efforts.effort, mean),
                    felt: before.felt.zip_with(felt, mean),
                    uncertainty: (keep * before.uncertainty).max(efforts.uncertainty),
                    since: before.since,
                }
            },
        );
        self.means.insert(means)
    }
}
