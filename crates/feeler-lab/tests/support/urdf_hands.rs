//! Hands of two opposite fingers whose middle posture points at a cap, from the URDF files in docs/hands.

use std::f64::consts::PI;
use std::path::Path;

/// Setting for two fingers like those of an Allegro Hand.
pub fn allegro() -> String {
    let rpy = [[0.0873, -0.5992, 0.0], [0.0873, -0.5992, PI]];
    hand("allegro", [-0.0955, -0.0435, 0.0063], rpy)
}

/// Setting for two fingers like those of a LEAP Hand.
pub fn leap() -> String {
    let rpy = [[PI, -0.6561, PI], [PI, -0.6561, 0.0]];
    hand("leap", [-0.1303, -0.0082, 0.0096], rpy)
}

/// Setting for two fingers of the file `name`-finger.urdf, at `base` (m) with orientation `rpy` (rad) and opposite to it.
fn hand(name: &str, [x, y, z]: [f64; 3], rpy: [[f64; 3]; 2]) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/hands");
    let file = folder.join(format!("{name}-finger.urdf"));
    let finger = |base: [f64; 3], rpy: [f64; 3]| {
        format!(
            "{{ urdf = {file:?}, tip = \"tip\", base_position = {base:?}, base_rpy = {rpy:?} }}"
        )
    };
    let (one, other) = (finger([x, y, z], rpy[0]), finger([-x, -y, z], rpy[1]));
    format!("hand.finger=[{one}, {other}]")
}
