//! The constants of a run, for its recording.

use crate::config::{ExperimentConfig, Sensing};
use crate::control::task::TaskConfig;
use crate::control::task::cap_config::Until;
use crate::control::task::screw::{FingerPathConfig, ScrewConfig};
use crate::record::{CapFacts, RunFacts};
use crate::sim::config::SimConfig;
use crate::sim::shape::ShapeConfig;
use glam::DVec3;

/// The constants of a run of `config` that its report needs.
pub fn run_facts(config: &ExperimentConfig) -> RunFacts {
    let TaskConfig::Screw(screw) = &config.task;
    let directions = |pick: fn(&FingerPathConfig) -> [f64; 3]| {
        let paths = screw.finger.iter();
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
        grasp_force_threshold: screw.grasp_force,
        approach: directions(|path| path.approach),
        stroke_direction: directions(|path| path.stroke),
        stroke_count: config.task.strokes(),
        cap: cap_facts(config, screw),
        replay_of: None,
    }
}

/// What the cap is held to, unless strokes are counted. A simulated world knows its friction; what varies of it from seed to seed is
/// left out.
fn cap_facts(config: &ExperimentConfig, screw: &ScrewConfig) -> Option<CapFacts> {
    let known = screw.cap.as_ref()?;
    let (_, object, _) = config.sim.cap()?;
    let own = object.friction.unwrap_or(config.sim.feeler.friction());
    let limit = own.static_friction * known.grip * cap_radius(&config.sim);
    let limit = limit * config.hand.finger.len() as f64;
    let sense = match screw.until {
        Until::Strokes => return None,
        Until::Closed => 1.0,
        Until::Open => -1.0,
    };
    (limit > 0.0).then_some(CapFacts {
        sense,
        friction_limit: limit,
        damage_force: known.damage_force,
    })
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
