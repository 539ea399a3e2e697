//! What every value of a task must be.

use super::checker::Checker;
use crate::control::task::TaskConfig;
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
    for (index, finger) in screw.finger.iter().enumerate() {
        checker.vector(&format!("{key}.finger[{index}].home"), finger.home);
        for (field, direction) in [("approach", finger.approach), ("stroke", finger.stroke)] {
            checker.direction(&format!("{key}.finger[{index}].{field}"), direction);
        }
    }
}
