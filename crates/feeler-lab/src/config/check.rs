//! What every value of an experiment must be. Numbers that are not finite are never in range.

use super::ExperimentConfig;
use super::check_faults::check_faults;
use super::check_law::{check_law, check_law_of_task};
use super::check_sim::check_sim;
use super::check_task::check_task;
use super::checker::{Checker, MAX, Problem};
use feeler::control::controller::ControlConfig;
use feeler::hand::MAX_FINGERS;
use feeler::sensor::drift::DriftConfig;
use feeler::sensor::fingertip::{FingertipConfig, MAX_ELEMENTS};

/// Physics steps in one control period at most: beyond, a run would seem to hang.
const MAX_STEPS_PER_PERIOD: f64 = 1000.0;

/// Longest name, bytes: it becomes part of a folder's name.
const MAX_NAME: usize = 64;

/// Every value of `config` that is out of its range.
///
/// What the camera, the fingers and the optics are made of is checked where they are built.
pub fn check(config: &ExperimentConfig) -> Vec<Problem> {
    let mut checker = Checker::default();
    let name = &config.name;
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    checker.require(
        "name",
        format!("{name:?}"),
        (1..=MAX_NAME).contains(&name.len()) && name.chars().all(plain),
        &format!("1 to {MAX_NAME} letters, digits, hyphens and underscores"),
    );
    checker.between("time_limit", config.time_limit, 1e-3, 1e5);
    check_fingertip("sensor.fingertip", &config.sensor.fingertip, &mut checker);
    for (finger, own) in config.sensor.finger.iter().enumerate() {
        if let Some(fingertip) = &own.fingertip {
            let key = format!("sensor.finger[{finger}].fingertip");
            check_fingertip(&key, fingertip, &mut checker);
        }
    }
    if let Some(drift) = &config.sensor.drift {
        check_drift(drift, &mut checker);
    }
    check_fingers(config, &mut checker);
    check_control(&config.control, &mut checker);
    check_law_of_task(config, &mut checker);
    check_task(config, &mut checker);
    if let Some(sim) = &config.sim {
        check_sim(sim, &mut checker);
        check_faults(config, sim, &mut checker);
        check_step(config.control.period, sim.step, &mut checker);
    }
    checker.problems
}

fn check_step(period: f64, step: f64, checker: &mut Checker) {
    let steps = period / step;
    checker.require(
        "control.period",
        period.to_string(),
        (steps - steps.round()).abs() < 1e-6 && (0.5..=MAX_STEPS_PER_PERIOD).contains(&steps),
        &format!("1 to {MAX_STEPS_PER_PERIOD} times sim.step = {step}, a whole number"),
    );
}

fn check_drift(drift: &DriftConfig, checker: &mut Checker) {
    let shares = [
        ("tolerance", drift.tolerance),
        ("displacement_tolerance", drift.displacement_tolerance),
        ("gain_rate", drift.gain_rate),
        ("rezero_rate", drift.rezero_rate),
    ];
    for (field, share) in shares {
        checker.between(&format!("sensor.drift.{field}"), share, 0.0, 1.0);
    }
}

fn check_fingertip(key: &str, fingertip: &FingertipConfig, checker: &mut Checker) {
    let layout = &fingertip.layout;
    checker.between(
        &format!("{key}.layout.dome_radius"),
        layout.dome_radius,
        1e-3,
        1.0,
    );
    checker.between(
        &format!("{key}.moments.subregion_radius"),
        fingertip.moments.subregion_radius,
        1e-6,
        layout.dome_radius,
    );
    checker.require(
        &format!("{key}.layout.rings"),
        format!("{} rings", layout.rings.len()),
        !layout.rings.is_empty(),
        "at least one ring, as in [{ elements = 8, polar_angle_deg = 22.5 }]",
    );
    for (index, ring) in layout.rings.iter().enumerate() {
        let ring_key = format!("{key}.layout.rings[{index}]");
        checker.require(
            &format!("{ring_key}.elements"),
            ring.elements.to_string(),
            (1..=MAX_ELEMENTS).contains(&ring.elements),
            &format!("1 to {MAX_ELEMENTS}"),
        );
        checker.between(
            &format!("{ring_key}.polar_angle_deg"),
            ring.polar_angle_deg,
            0.0,
            180.0,
        );
    }
}

fn check_fingers(config: &ExperimentConfig, checker: &mut Checker) {
    let (hand, task) = (config.hand.finger.len(), config.task.homes().len());
    checker.require(
        "hand.finger",
        format!("{hand} fingers"),
        (1..=MAX_FINGERS).contains(&hand),
        "1 to 5 fingers",
    );
    checker.require(
        &format!("task.{}.finger", config.task.name()),
        format!("{task} fingers"),
        task == hand,
        &format!("as many fingers as hand.finger has, {hand}"),
    );
    let sensors = config.sensor.finger.len();
    checker.require(
        "sensor.finger",
        format!("{sensors} fingers"),
        sensors == 0 || sensors == hand,
        &format!("none, or as many as hand.finger has, {hand}; an empty one is as [sensor] says"),
    );
}

fn check_control(control: &ControlConfig, checker: &mut Checker) {
    checker.between("control.period", control.period, 1e-4, 1.0);
    checker.between("control.stale_periods", control.stale_periods, 0.5, 1e3);
    checker.positive("control.touch_force", control.touch_force);
    checker.positive("control.slip_threshold", control.slip_threshold);
    checker.require(
        "control.over_force",
        control.over_force.to_string(),
        control.over_force <= MAX && control.over_force > control.touch_force,
        &format!(
            "more than control.touch_force (F1) = {}, at most {MAX:e}",
            control.touch_force
        ),
    );
    checker.not_negative("control.recompression_speed", control.recompression_speed);
    checker.not_negative("control.minimum_grasp_force", control.minimum_grasp_force);
    check_law(control, checker);
    let limits = &control.limits;
    checker.positive("control.limits.fingertip_speed", limits.fingertip_speed);
    checker.positive(
        "control.limits.joint_acceleration",
        limits.joint_acceleration,
    );
    if let Some(limit) = limits.element_force {
        checker.require(
            "control.limits.element_force",
            limit.to_string(),
            limit.is_finite() && limit > control.over_force,
            &format!("more than control.over_force = {}", control.over_force),
        );
    }
    checker.vector("control.limits.workspace_lower", limits.workspace_lower);
    let (lower, upper) = (limits.workspace_lower, limits.workspace_upper);
    checker.require(
        "control.limits.workspace_upper",
        format!("{upper:?}"),
        upper.iter().zip(lower).all(|(&u, l)| u <= 10.0 && u > l),
        &format!("more than control.limits.workspace_lower = {lower:?}, at most 10"),
    );
}
