//! What every value of a task must be.

use super::checker::{Checker, MAX};
use crate::control::task::TaskConfig;
use crate::control::task::cap_config::{CapConfig, Until};
use crate::control::task::screw::ScrewConfig;

pub(super) fn check_task(task: &TaskConfig, checker: &mut Checker) {
    let key = format!("task.{}", task.name());
    match task {
        TaskConfig::Screw(screw) => check_screw(&key, screw, checker),
    }
}

fn check_screw(key: &str, screw: &ScrewConfig, checker: &mut Checker) {
    checker.require(
        &format!("{key}.strokes"),
        screw.strokes.to_string(),
        (1..=1000).contains(&screw.strokes),
        "1 to 1000",
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
        ("feeler.normal_stiffness", cap.feeler.normal_stiffness),
        ("feeler.shear_stiffness", cap.feeler.shear_stiffness),
        ("feeler.tip_radius", cap.feeler.tip_radius),
    ];
    for (field, value) in positive {
        checker.positive(&format!("{key}.{field}"), value);
    }
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
