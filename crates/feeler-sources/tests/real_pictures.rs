//! Pictures of a real hemispherical sensor with 331 pins, where they are at hand.

#[path = "../examples/contact_pose.rs"]
#[allow(dead_code)]
mod contact_pose;

use contact_pose::{DataSet, contact_pose, data_folder};
use std::io::Write;

/// Bounds: what the data's README knows to be possible (0.080 mm, 0.88 and 0.76 degrees), rounded up
/// for depth and the second tilt.
#[test]
fn contact_pose_is_told_from_real_pictures() {
    let folder = data_folder();
    if !folder.join("targets.csv").exists() {
        // Not `eprintln!`, which the harness keeps to itself where a test passes. The data are no part of the repository,
        // so that it is no failure where all else is required.
        let folder = folder.display();
        let _ = writeln!(
            std::io::stderr(),
            "SKIPPED contact_pose_is_told_from_real_pictures: there is no {folder}; set FEELER_DATA"
        );
        return;
    }
    let found = contact_pose(&DataSet::read(&folder).unwrap()).unwrap();
    let pins = found.pins;
    assert!((325..=340).contains(&pins), "{pins} pins");
    for (told, bound) in found.told.iter().zip([0.085, 0.88, 0.77]) {
        assert!(told.error <= bound, "{:?}", found.told);
    }
}
