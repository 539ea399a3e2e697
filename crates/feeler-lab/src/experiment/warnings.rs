//! What may be meant, but more often is a mistake.

use crate::config::{Experiment, ExperimentConfig, Sensing};
use feeler_sim::fault::FaultKind;
use feeler_sim::object::{MotionConfig, ObjectConfig};
use feeler_sim::shape::{Shape, ShapeConfig};
use std::fmt;

/// A likely mistake in an experiment.
#[derive(Debug, Clone, PartialEq)]
pub enum Warning {
    /// An object is larger than any finger reaches: a mesh in millimetres, most often.
    LargeObject {
        /// Its name.
        object: String,
        /// Its largest extent, m.
        size: f64,
        /// How far the longest finger reaches, m.
        reach: f64,
        /// Whether it comes from a file, in whose unit the mistake may be.
        from_file: bool,
    },
    /// A fault of pictures in an experiment without pictures.
    NoPictures {
        /// The fault, counted from 0.
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
                "sim.fault[{fault}].kind.stuck_rows: nothing happens with sensing = \"direct\", \
                 which takes no pictures; expected sensing = \"image\""
            ),
        }
    }
}

/// The likely mistakes in `experiment`. What cannot be built is left to be refused.
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

/// How far the longest finger reaches from its base, m.
fn reach(config: &ExperimentConfig) -> f64 {
    let fingers = config.hand.finger.iter().enumerate();
    let reach = fingers.map(|(finger, links)| {
        let dome_radius = config.sensor.fingertip(finger).layout.dome_radius;
        links.links.iter().sum::<f64>() + dome_radius
    });
    reach.fold(0.0, f64::max)
}

/// The largest extent of an object along an axis of its shape, m; none without an end to it.
fn size(object: &ObjectConfig, experiment: &Experiment) -> Option<f64> {
    if object.shape == ShapeConfig::HalfSpace {
        return None;
    }
    let shape = Shape::new(&object.shape, experiment.folder()).ok()?;
    let (collider, _) = shape.collider();
    Some(collider.compute_local_aabb().extents().max_element())
}
