//! Constants of a run for its recording.

use super::solids::solids;
use crate::config::{ExperimentConfig, Sensing};
use crate::experiment::{ExperimentError, layouts};
use feeler::control::task::TaskConfig;
use feeler::control::task::cap_config::Until;
use feeler::hand::FingerDescription;
use feeler::sensor::fingertip::ElementLayout;
use feeler_record::{CapFacts, CarryGoal, FingerModel, RunFacts, SensingKind};
use feeler_sim::objects::{Object, ObjectConfig};
use feeler_sim::shapes::{ShapeConfig, section};
use feeler_sim::world::{SimConfig, World};
use glam::DVec3;
use std::collections::BTreeMap;
use std::path::Path;

/// Returns the constants of a run of `config` that its report requires.
///
/// # Errors
/// If a fingertip is invalid.
pub fn run_facts(config: &ExperimentConfig) -> Result<RunFacts, ExperimentError> {
    Ok(facts_with(config, &layouts(config)?))
}

/// Like [`run_facts`], for a hand that follows the requests of another program.
///
/// # Errors
/// Same as [`run_facts`].
pub fn following_facts(config: &ExperimentConfig) -> Result<RunFacts, ExperimentError> {
    Ok(following(run_facts(config)?))
}

/// Returns `facts` for a hand that follows the requests of another program.
pub fn following(facts: RunFacts) -> RunFacts {
    RunFacts {
        law: Some(RunFacts::REQUESTS.to_string()),
        ..facts
    }
}

/// Like [`run_facts`], for fingertips with the elements of `layouts`.
fn facts_with(config: &ExperimentConfig, layouts: &[ElementLayout]) -> RunFacts {
    let paths: Vec<([f64; 3], [f64; 3])> = match &config.task {
        TaskConfig::Screw(screw) => {
            let fingers = screw.finger.iter();
            fingers.map(|path| (path.approach, path.stroke)).collect()
        }
        TaskConfig::FrictionScan(scan) => vec![(scan.approach, scan.slide)],
        TaskConfig::Probe(probe) => {
            let fingers = probe.finger.iter();
            fingers.map(|path| (path.approach, path.stroke)).collect()
        }
        // The directions of these tasks are not known in advance.
        TaskConfig::Contour(_) | TaskConfig::Carry(_) | TaskConfig::Grip(_) => Vec::new(),
    };
    let unit = |direction| DVec3::from_array(direction).normalize_or_zero().to_array();
    RunFacts {
        experiment: config.name.clone(),
        task: config.task.name().into(),
        seed: config.seed,
        version: env!("CARGO_PKG_VERSION").to_string(),
        sensing: match config.sensing {
            Sensing::Image => SensingKind::Image,
            Sensing::Direct => SensingKind::Direct,
        },
        law: Some(config.control.law.name().to_string()),
        control_period: config.control.period,
        fingers: config.hand.finger.len(),
        cap_radius: config.sim.as_ref().map_or(0.0, cap_radius),
        feeler_tip_radius: config.sim.as_ref().map_or(0.0, |sim| sim.feeler.tip_radius),
        touch_force_threshold: config.control.touch_force,
        over_force_threshold: config.control.over_force,
        slip_threshold: config.control.slip_threshold,
        grasp_force_threshold: config.task.grasp_force(),
        approach: paths.iter().map(|path| unit(path.0)).collect(),
        stroke_direction: paths.iter().map(|path| unit(path.1)).collect(),
        stroke_count: config.task.strokes(),
        truth: BTreeMap::new(),
        section: true_section(config).map_or_else(Vec::new, |(_, section)| section),
        cap: cap_facts(config),
        carry: carry_goal(config),
        hand: hand(config, layouts),
        solids: config.sim.as_ref().map_or_else(Vec::new, solids),
        replay_of: None,
    }
}

/// Returns the constants of a run of `config` in `world`. They include ground truth: the static and kinetic friction
/// coefficients of each object that defines its own friction.
pub fn simulated_facts(
    config: &ExperimentConfig,
    layouts: &[ElementLayout],
    world: &World,
) -> RunFacts {
    let objects = world.model().objects.iter();
    let truth = objects
        .filter_map(|object| Some((&object.name, object.friction?)))
        .flat_map(|(name, friction)| {
            [
                (format!("{name}.static_friction"), friction.static_friction),
                (
                    format!("{name}.kinetic_friction"),
                    friction.kinetic_friction,
                ),
            ]
        });
    RunFacts {
        truth: truth.collect(),
        ..facts_with(config, layouts)
    }
}

/// Returns the models of the fingers.
fn hand(config: &ExperimentConfig, layouts: &[ElementLayout]) -> Vec<FingerModel> {
    let fingers = config.hand.finger.iter().zip(layouts);
    let model = |(geometry, layout): (&FingerDescription, &ElementLayout)| {
        let elements = 0..layout.elements.len();
        FingerModel {
            geometry: geometry.clone(),
            dome_radius: layout.dome_radius,
            element_tips: elements
                .map(|element| layout.tip(element).to_array())
                .collect(),
        }
    };
    fingers.map(model).collect()
}

/// Returns the criteria for the cap, unless the number of strokes is fixed. They include the friction limit in a
/// simulated world, without the variation by the seed.
pub(crate) fn cap_facts(config: &ExperimentConfig) -> Option<CapFacts> {
    let TaskConfig::Screw(screw) = &config.task else {
        return None;
    };
    let known = screw.cap.as_ref()?;
    let sim = config.sim.as_ref()?;
    let (_, object, _) = sim.cap()?;
    let own = object.friction.unwrap_or(sim.feeler.friction());
    let limit = own.static_friction * known.grip * cap_radius(sim);
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

/// Returns the criteria of a carry task.
fn carry_goal(config: &ExperimentConfig) -> Option<CarryGoal> {
    let TaskConfig::Carry(carry) = &config.task else {
        return None;
    };
    let heights = carry.waypoint.iter().map(|waypoint| waypoint.to[2]);
    Some(CarryGoal {
        end: carry.waypoint.last()?.to,
        highest: heights.fold(0.0, f64::max),
        crush_force: carry.crush_force,
    })
}

/// Maximum radius of the cap (m); 0 if there is no cap.
fn cap_radius(sim: &SimConfig) -> f64 {
    match sim.cap().map(|(_, object, _)| &object.shape) {
        Some(
            &ShapeConfig::Cylinder { radius, .. } | &ShapeConfig::KnurledCylinder { radius, .. },
        ) => radius,
        _ => 0.0,
    }
}

/// Returns the object whose outline is traced, and its true cross-section. `None` if the task traces no
/// outline, or if the shape of the object is read from a file.
pub(crate) fn true_section(config: &ExperimentConfig) -> Option<(&ObjectConfig, Vec<[f64; 2]>)> {
    let TaskConfig::Contour(contour) = &config.task else {
        return None;
    };
    let mut objects = config.sim.iter().flat_map(|sim| &sim.object);
    let (name, config) = objects.find(|(_, o)| o.shape != ShapeConfig::HalfSpace)?;
    let object = Object::new(name, config, 0.0, Path::new("")).ok()?;
    let section = section(&object, contour.home[2]);
    (!section.is_empty()).then_some((config, section))
}
