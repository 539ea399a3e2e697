//! The constants of a run, for its recording.

use crate::config::{ExperimentConfig, Sensing};
use crate::control::task::TaskConfig;
use crate::control::task::screw::FingerPathConfig;
use crate::record::RunFacts;
use crate::sim::config::SimConfig;
use crate::sim::object::Object;
use crate::sim::section::section;
use crate::sim::shape::ShapeConfig;
use glam::DVec3;
use std::path::Path;

/// The constants of a run of `config` that its report needs.
pub fn run_facts(config: &ExperimentConfig) -> RunFacts {
    let screw = match &config.task {
        TaskConfig::Screw(screw) => Some(screw),
        _ => None,
    };
    let directions = |pick: fn(&FingerPathConfig) -> [f64; 3]| {
        let paths = screw.into_iter().flat_map(|screw| &screw.finger);
        paths
            .map(|path| DVec3::from_array(pick(path)).normalize_or_zero().to_array())
            .collect()
    };
    RunFacts {
        experiment: config.name.clone(),
        task: config.task.name().to_string(),
        seed: config.seed,
        version: env!("CARGO_PKG_VERSION").to_string(),
        sensing: match config.sensing {
            Sensing::Image => "image".to_string(),
            Sensing::Direct => "direct".to_string(),
        },
        control_period: config.control.period,
        fingers: config.hand.finger.len(),
        cap_radius: cap_radius(&config.sim),
        feeler_tip_radius: config.sim.feeler.tip_radius,
        touch_force_threshold: config.control.touch_force,
        over_force_threshold: config.control.over_force,
        slip_threshold: config.control.slip_threshold,
        grasp_force_threshold: screw.map_or(0.0, |screw| screw.grasp_force),
        approach: directions(|path| path.approach),
        stroke_direction: directions(|path| path.stroke),
        stroke_count: config.task.strokes(),
        section: true_section(config),
        replay_of: None,
    }
}

/// Radius of the cap at its widest, m; 0 when there is no cap.
fn cap_radius(sim: &SimConfig) -> f64 {
    match sim.cap().map(|(_, object, _)| &object.shape) {
        Some(
            &ShapeConfig::Cylinder { radius, .. } | &ShapeConfig::KnurledCylinder { radius, .. },
        ) => radius,
        _ => 0.0,
    }
}

/// The true section of the object whose outline is to be drawn; none where that is not the task, or a file would have to be
/// read for it.
fn true_section(config: &ExperimentConfig) -> Vec<[f64; 2]> {
    let TaskConfig::Contour(contour) = &config.task else {
        return Vec::new();
    };
    let mut objects = config.sim.object.iter();
    let Some((name, object)) = objects.find(|(_, o)| o.shape != ShapeConfig::HalfSpace) else {
        return Vec::new();
    };
    Object::new(name, object, 0.0, Path::new(""))
        .map(|object| section(&object, contour.home[2]))
        .unwrap_or_default()
}
