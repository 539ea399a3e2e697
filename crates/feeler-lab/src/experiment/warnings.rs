//! Warnings about valid settings that are probably mistakes.

use crate::config::{Experiment, ExperimentConfig, Sensing};
use feeler::hand::FingerGeometry;
use feeler_sim::objects::{MotionConfig, ObjectConfig};
use feeler_sim::rig::FaultKind;
use feeler_sim::shapes::{Shape, ShapeConfig};
use std::fmt;

/// A likely mistake in an experiment.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// An object is larger than the reach of any finger, often because of a mesh in millimetres.
    LargeObject {
        /// Name of the object.
        object: String,
        /// Largest extent of the object (m).
        size: f64,
        /// Reach of the longest finger (m).
        reach: f64,
        /// `true` if the shape is in a file, whose unit may be wrong.
        from_file: bool,
    },
    /// A fault that affects only images is configured in an experiment without images.
    NoPictures {
        /// Index of the fault.
        fault: usize,
    },
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LargeObject {
                object,
                size,
                reach,
                from_file,
            } => {
                write!(
                    f,
                    "sim.object.{object}: {size:.3} m large, while a finger reaches {reach:.3} m \
                     (its links and the dome's radius)"
                )?;
                if *from_file {
                    write!(f, "; is its file in millimetres? Then set scale = 0.001")?;
                }
                Ok(())
            }
            Self::NoPictures { fault } => write!(
                f,
                "sim.fault[{fault}].kind.stuck_rows: the fault has no effect with sensing = \"direct\", \
                 which takes no images; expected sensing = \"image\""
            ),
        }
    }
}

/// Returns the likely mistakes in `experiment`. Invalid parts are skipped because they are rejected elsewhere.
pub fn warnings(experiment: &Experiment) -> Vec<Warning> {
    let config = &experiment.config;
    let mut warnings = Vec::new();
    let Some(sim) = &config.sim else {
        return warnings;
    };
    let reach = reach(config);
    for (name, object) in &sim.object {
        let from_file = matches!(
            object.shape,
            ShapeConfig::Mesh { .. } | ShapeConfig::ConvexHull { .. }
        );
        // Tables and walls are large.
        let furniture = !from_file && object.motion == MotionConfig::Fixed;
        let size = size(object, experiment).filter(|&size| size > reach && !furniture);
        warnings.extend(size.map(|size| Warning::LargeObject {
            object: name.clone(),
            size,
            reach,
            from_file,
        }));
    }
    if config.sensing == Sensing::Direct {
        let faults = sim.fault.iter().enumerate();
        let stuck = faults.filter(|(_, f)| matches!(f.kind, FaultKind::StuckRows { .. }));
        warnings.extend(stuck.map(|(fault, _)| Warning::NoPictures { fault }));
    }
    warnings
}

/// Reach of the longest finger from its base (m).
fn reach(config: &ExperimentConfig) -> f64 {
    let fingers = config.hand.finger.iter().enumerate();
    let reach = fingers.filter_map(|(finger, description)| {
        let dome_radius = config.sensor.fingertip(finger).layout.dome_radius;
        Some(FingerGeometry::of(description).ok()?.reach() + dome_radius)
    });
    reach.fold(0.0, f64::max)
}

/// Largest side of the bounding box of an object in its own frame (m). `None` if the object is infinite or its shape
/// is invalid.
fn size(object: &ObjectConfig, experiment: &Experiment) -> Option<f64> {
    if object.shape == ShapeConfig::HalfSpace {
        return None;
    }
    let shape = Shape::new(&object.shape, experiment.folder()).ok()?;
    let (collider, _) = shape.collider();
    Some(collider.compute_local_aabb().extents().max_element())
}
