//! Lists all missing keys of a file; the TOML parser reports only the first one.
//!
//! The table is deserialized repeatedly, each time with placeholders for the keys found missing so far, until no key is
//! missing or another error occurs. The deserialized values are discarded.

use super::place::{Place, Stop};
use serde::Deserialize;
use toml::{Table, Value};

/// Maximum number of keys listed. A file that lacks more is probably not an experiment at all.
const MOST: usize = 20;

/// Returns the keys that a `T` requires and `table` lacks, up to [`MOST`]. The list may be incomplete if the table
/// has other errors.
pub(super) fn missing<'de, T: Deserialize<'de>>(table: Table) -> Vec<String> {
    let table = Value::Table(table);
    let mut missing: Vec<String> = Vec::new();
    while missing.len() < MOST {
        match T::deserialize(Place::root(&table, &missing)) {
            Err(Stop::At(path)) if !missing.contains(&path) => missing.push(path),
            _ => break,
        }
    }
    // The required keys of a missing table are more informative than the table itself.
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
    fn list_entries_are_numbered() {
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
    fn no_keys_are_reported_after_another_error() {
        let text = "name = 3\n";
        assert_eq!(of(text), [""; 0]);
    }

    #[test]
    fn long_lists_are_truncated() {
        let faults = "[[sim.fault]]\n".repeat(1000);
        assert_eq!(of(&faults).len(), super::MOST);
    }
}
