//! Checks that the finger of a friction scan can reach the specimen.

use crate::config::ExperimentConfig;
use feeler::control::task::TaskConfig;
use feeler::control::task::friction_scan::FrictionScanConfig;
use feeler::hand::{FingerGeometry, KinematicsError, inverse_kinematics};
use feeler_sim::world::World;
use glam::DVec3;

/// Distance at which a dome counts as touching (m).
const TOUCHING: f64 = 1e-4;
/// Maximum number of search steps. A finger that passes very close to an object for long counts as touching.
const MAX_STEPS: usize = 10_000;

/// Reason why a finger cannot press on the specimen.
#[derive(Debug, thiserror::Error)]
pub enum SpecimenError {
    /// The search path meets no object.
    #[error(
        "task.friction_scan.search_limit = {limit}: nothing to touch within this distance (m) of \
         task.friction_scan.home along the approach; the finger would pass the nearest object, \
         sim.object.{nearest}, at {gap:.4} m"
    )]
    Nothing {
        /// Length of the search (m).
        limit: f64,
        /// The object nearest to the path.
        nearest: String,
        /// Distance from that object (m).
        gap: f64,
    },
    /// The finger cannot reach the contact position.
    #[error(
        "task.friction_scan: the finger touches the specimen with its dome's centre at {position}, which \
         cannot be reached: {source}"
    )]
    BeyondReach {
        /// Position of the dome's centre in W (m).
        position: DVec3,
        /// Reason from the inverse kinematics.
        source: Box<KinematicsError>,
    },
    /// The contact position is outside of the workspace.
    #[error(
        "task.friction_scan: the finger touches the specimen with its dome's centre at {position}; \
         expected within control.limits.workspace_lower and workspace_upper"
    )]
    OutsideWorkspace {
        /// Position of the dome's centre in W (m).
        position: DVec3,
    },
}

/// Rejects a friction scan in `config` whose finger would not meet an object in `world` or could not reach it.
///
/// # Errors
/// Describes the obstacle, or the nearest object.
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

/// Returns the position (m, in W) at which the centre of a dome of radius `dome` (m) first touches an object.
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
        // The gap to the nearest object is a safe step (sphere tracing).
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
