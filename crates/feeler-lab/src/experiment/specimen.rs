//! Whether there is something to touch where a task expects its specimen.

use crate::config::ExperimentConfig;
use feeler::control::task::TaskConfig;
use feeler::control::task::friction_scan::FrictionScanConfig;
use feeler::hand::finger::FingerGeometry;
use feeler::hand::inverse_kinematics::{KinematicsError, inverse_kinematics};
use feeler_sim::world::World;
use glam::DVec3;

/// A dome is said to touch from this far off, m.
const TOUCHING: f64 = 1e-4;
/// Most steps on the way to the specimen; a finger that passes very close to something for long is believed to touch.
const MAX_STEPS: usize = 10_000;

/// Why the finger cannot press on the specimen.
#[derive(Debug, thiserror::Error)]
pub enum SpecimenError {
    /// There is nothing where it searches.
    #[error(
        "task.friction_scan.search_limit = {limit}: there is nothing to touch within so many metres of \
         task.friction_scan.home along the approach; the finger would pass the nearest object, \
         sim.object.{nearest}, at {gap:.4} m"
    )]
    Nothing {
        /// How far it searches, m.
        limit: f64,
        /// The object that it comes closest to.
        nearest: String,
        /// How close, m.
        gap: f64,
    },
    /// It cannot go there.
    #[error(
        "task.friction_scan: the finger touches the specimen with its dome's centre at {position}, which \
         cannot be reached: {source}"
    )]
    BeyondReach {
        /// Where, m, in W.
        position: DVec3,
        /// Why it cannot.
        source: Box<KinematicsError>,
    },
    /// It must not go there.
    #[error(
        "task.friction_scan: the finger touches the specimen with its dome's centre at {position}; \
         expected within control.limits.workspace_lower and workspace_upper"
    )]
    OutsideWorkspace {
        /// Where, m, in W.
        position: DVec3,
    },
}

/// Refuses a friction scan of `config` whose finger would not meet anything in `world`.
///
/// # Errors
/// Saying what is in the way, or that nothing is.
pub fn check_specimen(
    config: &ExperimentConfig,
    fingers: &[FingerGeometry],
    world: &World,
) -> Result<(), SpecimenError> {
    let (TaskConfig::FrictionScan(scan), Some(finger)) = (&config.task, fingers.first()) else {
        return Ok(());
    };
    let tip_radius = config.sim.as_ref().map_or(0.0, |sim| sim.feeler.tip_radius);
    let dome = config.sensor.fingertip(0).layout.dome_radius + tip_radius;
    let position = first_touch(scan, world, dome)?;
    let limits = &config.control.limits;
    let lower = DVec3::from_array(limits.workspace_lower);
    let upper = DVec3::from_array(limits.workspace_upper);
    if position.clamp(lower, upper) != position {
        return Err(SpecimenError::OutsideWorkspace { position });
    }
    let middle = (finger.joint_lower() + finger.joint_upper()) / 2.0;
    let reached = inverse_kinematics(finger, position, middle);
    reached
        .map(|_| ())
        .map_err(|source| SpecimenError::BeyondReach {
            position,
            source: Box::new(source),
        })
}

/// Where the centre of a dome of radius `dome` (m) is when it first touches something, m, in W.
fn first_touch(
    scan: &FrictionScanConfig,
    world: &World,
    dome: f64,
) -> Result<DVec3, SpecimenError> {
    let home = DVec3::from_array(scan.home);
    let approach = DVec3::from_array(scan.approach).normalize_or_zero();
    let (mut travel, mut nearest, mut closest) = (0.0, String::new(), f64::INFINITY);
    for _ in 0..MAX_STEPS {
        let position = home + travel * approach;
        let Some((object, distance)) = world.nearest_object(position) else {
            break;
        };
        let gap = distance - dome;
        if gap < closest {
            (nearest, closest) = (object.to_string(), gap);
        }
        if gap <= TOUCHING {
            return Ok(position);
        }
        // Nothing is nearer than the gap, so that the dome may go so far.
        travel += gap;
        if travel > scan.search_limit {
            break;
        }
    }
    Err(SpecimenError::Nothing {
        limit: scan.search_limit,
        nearest,
        gap: closest,
    })
}
