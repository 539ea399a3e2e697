//! What every value of a task must be.

use super::ExperimentConfig;
use super::check_touch_tasks::{check_carry, check_contour, check_feeler, check_within_reach};
use super::checker::{Checker, MAX};
use feeler::control::controller::ControlConfig;
use feeler::control::task::TaskConfig;
use feeler::control::task::cap_config::{CapConfig, Until};
use feeler::control::task::friction_scan::FrictionScanConfig;
use feeler::control::task::screw::ScrewConfig;
use glam::DVec3;

/// Sliding and pressing are this far apart at least, degrees.
const MIN_SLIDE: f64 = 5.0;
/// Control periods that a friction scan settles for at least: half of them tell the noise.
const MIN_PERIODS_AT_REST: f64 = 20.0;

pub(super) fn check_task(config: &ExperimentConfig, checker: &mut Checker) {
    let key = format!("task.{}", config.task.name());
    match &config.task {
        TaskConfig::Screw(screw) => check_screw(&key, screw, checker),
        TaskConfig::FrictionScan(scan) => check_friction_scan(&key, scan, &config.control, checker),
        TaskConfig::Contour(contour) => {
            check_contour(&key, contour, checker);
            check_within_reach(&key, config, checker);
        }
        TaskConfig::Carry(carry) => {
            check_carry(&key, carry, checker);
            check_within_reach(&key, config, checker);
        }
    }
}

fn check_screw(key: &str, screw: &ScrewConfig, checker: &mut Checker) {
    checker.require(
        &format!("{key}.strokes"),
        screw.strokes.to_string(),
        (1..=100_000).contains(&screw.strokes),
        "1 to 100000",
    );
    let positive = [
        ("search_speed", screw.search_speed),
        ("grasp_force", screw.grasp_force),
        ("search_limit", screw.search_limit),
        ("move_speed", screw.move_speed),
        ("travel", screw.travel),
        ("return_speed", screw.return_speed),
        ("home_tolerance", screw.home_tolerance),
    ];
    for (field, value) in positive {
        checker.positive(&format!("{key}.{field}"), value);
    }
    checker.require(
        &format!("{key}.cap"),
        "none".to_string(),
        screw.until == Until::Strokes || screw.cap.is_some(),
        &format!(
            "what is known of the cap, as in [{key}.cap], because the strokes are not counted"
        ),
    );
    if let Some(cap) = &screw.cap {
        check_cap(&format!("{key}.cap"), screw, cap, checker);
    }
    for (index, finger) in screw.finger.iter().enumerate() {
        checker.vector(&format!("{key}.finger[{index}].home"), finger.home);
        for (field, direction) in [("approach", finger.approach), ("stroke", finger.stroke)] {
            checker.direction(&format!("{key}.finger[{index}].{field}"), direction);
        }
    }
}

fn check_friction_scan(
    key: &str,
    scan: &FrictionScanConfig,
    control: &ControlConfig,
    checker: &mut Checker,
) {
    checker.vector(&format!("{key}.home"), scan.home);
    checker.direction(&format!("{key}.approach"), scan.approach);
    let [approach, slide] = [scan.approach, scan.slide].map(DVec3::from_array);
    checker.require(
        &format!("{key}.slide"),
        format!("{:?}", scan.slide),
        slide
            .normalize_or_zero()
            .cross(approach.normalize_or_zero())
            .length()
            >= MIN_SLIDE.to_radians().sin(),
        &format!(
            "a direction {MIN_SLIDE} degrees or more off {key}.approach = {:?}",
            scan.approach
        ),
    );
    let positive = [
        ("search_speed", scan.search_speed),
        ("search_limit", scan.search_limit),
        ("load_gain", scan.load_gain),
        ("slide_speed", scan.slide_speed),
        ("travel", scan.travel),
        ("slide_limit", scan.slide_limit),
        ("return_speed", scan.return_speed),
        ("home_tolerance", scan.home_tolerance),
    ];
    for (field, value) in positive {
        checker.positive(&format!("{key}.{field}"), value);
    }
    let (touch, over) = (control.touch_force, control.over_force);
    checker.require(
        &format!("{key}.load"),
        scan.load.to_string(),
        scan.load > touch && scan.load < over,
        &format!(
            "more than control.touch_force (F1) = {touch}, less than control.over_force (F2) = {over}"
        ),
    );
    let least = MIN_PERIODS_AT_REST * control.period;
    checker.between(&format!("{key}.settle_time"), scan.settle_time, least, 1e3);
    checker.require(
        &format!("{key}.strokes"),
        scan.strokes.to_string(),
        (3..=1000).contains(&scan.strokes),
        "3 to 1000: one that does not count, one each way",
    );
}

fn check_cap(key: &str, screw: &ScrewConfig, cap: &CapConfig, checker: &mut Checker) {
    let [x, y] = cap.axis;
    checker.vector(&format!("{key}.axis"), [x, y, 0.0]);
    let positive = [
        ("grip_gain", cap.grip_gain),
        ("clearance", cap.clearance),
        ("still_turn", cap.still_turn),
        ("most_friction", cap.most_friction),
        ("most_turns", cap.most_turns),
        ("open_turns", cap.open_turns),
    ];
    for (field, value) in positive {
        checker.positive(&format!("{key}.{field}"), value);
    }
    check_feeler(key, &cap.feeler, checker);
    checker.not_negative(&format!("{key}.softest_seat"), cap.softest_seat);
    checker.require(
        &format!("{key}.grip"),
        cap.grip.to_string(),
        cap.grip >= screw.grasp_force && cap.grip <= MAX,
        &format!(
            "from task.screw.grasp_force = {} to {MAX:e}",
            screw.grasp_force
        ),
    );
    checker.positive(&format!("{key}.damage_force"), cap.damage_force);
    checker.require(
        &format!("{key}.least_turns"),
        cap.least_turns.to_string(),
        (0.0..cap.most_turns).contains(&cap.least_turns),
        &format!("from 0 to less than {key}.most_turns = {}", cap.most_turns),
    );
}
