//! The rig of `stiff-feelers.toml`: two fingers at a bottle cap.

use crate::experiment_file::read;
use feeler::hand::{FingerDescription, FingerGeometry};
use feeler::sensor::fingertip::{ElementLayout, FingertipConfig};
use feeler_sim::world::SimConfig;

const FILE: &str = "tests/stiff-feelers.toml";

/// The simulated world.
pub fn sim() -> SimConfig {
    read(FILE, "sim")
}

/// The first `count` fingers.
pub fn fingers(count: usize) -> Vec<(FingerGeometry, ElementLayout)> {
    let fingertip: FingertipConfig = read(FILE, "sensor.fingertip");
    let layout = ElementLayout::new(&fingertip.layout);
    let fingers: Vec<FingerDescription> = read(FILE, "hand.finger");
    let fingers = fingers.iter().take(count);
    fingers
        .map(|f| (FingerGeometry::of(f).expect("a finger"), layout.clone()))
        .collect()
}
