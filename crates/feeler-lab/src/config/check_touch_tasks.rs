//! What every value of the tasks must be that follow an outline and carry an object.

use super::ExperimentConfig;
use super::checker::{Checker, MAX};
use feeler::control::feeler_shape::FeelerShape;
use feeler::control::task::carry::CarryConfig;
use feeler::control::task::contour::ContourConfig;
use feeler_sim::shape::ShapeConfig;

/// Most waypoints of a path.
const MAX_WAYPOINTS: usize = 1000;

/// Requires something to touch, and homes, where the fingers may go.
pub(super) fn check_within_reach(key: &str, config: &ExperimentConfig, checker: &mut Checker) {
    let limits = &config.control.limits;
    let (lower, upper) = (limits.workspace_lower, limits.workspace_upper);
    let inside = |place: [f64; 3], axes: std::ops::Range<usize>| {
        axes.into_iter()
            .all(|axis| (lower[axis]..=upper[axis]).contains(&place[axis]))
    };
    for (finger, home) in config.task.homes().into_iter().enumerate() {
        checker.require(
            &format!("{key}: home of finger {finger}"),
            format!("{home:?}"),
            inside(home, 0..3),
            &format!("a place within control.limits, {lower:?} to {upper:?}"),
        );
    }
    // What is within reach of a real rig nobody can tell.
    let Some(sim) = &config.sim else { return };
    let mut objects = sim.object.values();
    checker.require(
        "sim.object",
        "no object within the fingers' reach".to_string(),
        // Not along z: what is pressed from above is below the fingers.
        objects.any(|o| o.shape != ShapeConfig::HalfSpace && inside(o.position, 0..2)),
        &format!("an object whose position is within control.limits along x and y, {lower:?} to {upper:?}"),
    );
}

pub(super) fn check_contour(key: &str, contour: &ContourConfig, checker: &mut Checker) {
    checker.vector(&format!("{key}.home"), contour.home);
    let [x, y, _] = contour.approach;
    checker.direction(&format!("{key}.approach"), [x, y, 0.0]);
    let positive = [
        ("search_speed", contour.search_speed),
        ("search_limit", contour.search_limit),
        ("follow_speed", contour.follow_speed),
        ("touch_force", contour.touch_force),
        ("force_gain", contour.force_gain),
        ("press_speed", contour.press_speed),
        ("closing_distance", contour.closing_distance),
        ("lost_time", contour.lost_time),
        ("follow_limit", contour.follow_limit),
        ("clearance", contour.clearance),
        ("return_speed", contour.return_speed),
        ("home_tolerance", contour.home_tolerance),
    ];
    check_positive(key, &positive, checker);
    checker.not_negative(&format!("{key}.friction_gain"), contour.friction_gain);
    more_than(
        key,
        "contact_force",
        contour.contact_force,
        "touch_force",
        contour.touch_force,
        checker,
    );
    check_feeler(key, &contour.feeler, checker);
}

pub(super) fn check_carry(key: &str, carry: &CarryConfig, checker: &mut Checker) {
    let positive = [
        ("search_speed", carry.search_speed),
        ("search_limit", carry.search_limit),
        ("friction", carry.friction),
        ("touch_force", carry.touch_force),
        ("slip_threshold", carry.slip_threshold),
        ("force_gain", carry.force_gain),
        ("press_speed", carry.press_speed),
        ("carry_speed", carry.carry_speed),
        ("lost_time", carry.lost_time),
        ("give", carry.give),
        ("return_speed", carry.return_speed),
        ("home_tolerance", carry.home_tolerance),
    ];
    check_positive(key, &positive, checker);
    checker.between(&format!("{key}.margin"), carry.margin, 1.0, 10.0);
    checker.not_negative(&format!("{key}.place_gain"), carry.place_gain);
    more_than(
        key,
        "grip_force",
        carry.grip_force,
        "touch_force",
        carry.touch_force,
        checker,
    );
    more_than(
        key,
        "crush_force",
        carry.crush_force,
        "grip_force",
        carry.grip_force,
        checker,
    );
    checker.require(
        &format!("{key}.waypoint"),
        format!("{} waypoints", carry.waypoint.len()),
        (1..=MAX_WAYPOINTS).contains(&carry.waypoint.len()),
        &format!("1 to {MAX_WAYPOINTS} waypoints"),
    );
    for (index, waypoint) in carry.waypoint.iter().enumerate() {
        checker.vector(&format!("{key}.waypoint[{index}].to"), waypoint.to);
        checker.not_negative(&format!("{key}.waypoint[{index}].hold"), waypoint.hold);
    }
    for (index, finger) in carry.finger.iter().enumerate() {
        checker.vector(&format!("{key}.finger[{index}].home"), finger.home);
        checker.direction(&format!("{key}.finger[{index}].approach"), finger.approach);
    }
    check_feeler(key, &carry.feeler, checker);
}

pub(super) fn check_feeler(key: &str, feeler: &FeelerShape, checker: &mut Checker) {
    let positive = [
        ("normal_stiffness", feeler.normal_stiffness),
        ("shear_stiffness", feeler.shear_stiffness),
        ("tip_radius", feeler.tip_radius),
    ];
    check_positive(&format!("{key}.feeler"), &positive, checker);
}

fn check_positive(key: &str, fields: &[(&str, f64)], checker: &mut Checker) {
    for (field, value) in fields {
        checker.positive(&format!("{key}.{field}"), *value);
    }
}

/// Requires one value to be more than another.
fn more_than(key: &str, field: &str, value: f64, other: &str, least: f64, checker: &mut Checker) {
    checker.require(
        &format!("{key}.{field}"),
        value.to_string(),
        value > least && value <= MAX,
        &format!("more than {key}.{other} = {least}, at most {:e}", MAX),
    );
}
