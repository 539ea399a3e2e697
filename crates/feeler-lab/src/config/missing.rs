//! All keys that a file lacks, as a parser stops at the first one.
//!
//! A table is read again and again, each time with a stand-in for every key that was missing before, until nothing is
//! missing any more or something else is wrong. What was read is thrown away.

use super::place::{Place, Stop};
use serde::Deserialize;
use toml::{Table, Value};

/// Most keys that are listed: whoever lacks more has another file in mind.
const MOST: usize = 20;

/// The keys that a `T` needs and `table` lacks, up to [`MOST`]; as far as it can be told where something else is wrong, too.
pub(super) fn missing<'de, T: Deserialize<'de>>(table: Table) -> Vec<String> {
    let table = Value::Table(table);
    let mut missing: Vec<String> = Vec::new();
    while missing.len() < MOST {
        match T::deserialize(Place::root(&table, &missing)) {
            Err(Stop::At(path)) if !missing.contains(&path) => missing.push(path),
            _ => break,
        }
    }
    // Of a table that is missing, the keys that it needs say more.
    let whole = missing.clone();
    let below = |path: &str| format!("{path}.");
    missing.retain(|path| !whole.iter().any(|other| other.starts_with(&below(path))));
    missing
}

#[cfg(test)]
mod tests {
    use super::missing;
    use crate::config::ExperimentConfig;

    fn of(text: &str) -> Vec<String> {
        missing::<ExperimentConfig>(text.parse().expect("TOML"))
    }

    #[test]
    fn every_missing_key_is_found() {
        assert_eq!(of(""), ["name", "sensor.calibration", "task"]);
        let text = "name = \"x\"\n[sensor]\n[task.screw]\n[sim.object.cap]\nmotion.thread = { lead = 0.003 }\n";
        let expected = [
            "sensor.calibration",
            "sim.object.cap.motion.thread.running_torque",
            "sim.object.cap.motion.thread.seat_angle",
            "sim.object.cap.motion.thread.seat_stiffness",
            "sim.object.cap.motion.thread.static_factor",
            "sim.object.cap.shape",
            "sim.object.cap.position",
            "task.screw.finger",
        ];
        assert_eq!(of(text), expected);
    }

    #[test]
    fn entries_of_lists_have_their_numbers() {
        let text = "name = \"x\"\ntask.contour = {}\n[sensor]\ncalibration = \"c\"\n[sim]\nobject = {}\n\
            [[sim.fault]]\nkind.frozen_frame = { finger = 0 }\n[[sim.fault]]\nkind.dropped_frames = { finger = 0 }\n[[sim.fault]]\n";
        let expected = [
            "sim.fault[1].kind.dropped_frames.probability",
            "sim.fault[2].kind",
            "task.contour.home",
            "task.contour.approach",
        ];
        assert_eq!(of(text), expected);
    }

    #[test]
    fn nothing_is_missing_where_something_else_is_wrong() {
        let text = "name = 3\n";
        assert_eq!(of(text), [""; 0]);
    }

    #[test]
    fn a_long_list_ends() {
        let faults = "[[sim.fault]]\n".repeat(1000);
        assert_eq!(of(&faults).len(), super::MOST);
    }
}
