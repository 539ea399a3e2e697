//! Units of joint positions and velocities.

use feeler_record::FingerModel;

/// Units of the positions and velocities of the joints of `fingers`.
pub fn joint_units(fingers: &[FingerModel]) -> [&'static str; 2] {
    let joints = fingers.iter().map(|finger| finger.geometry.is_prismatic());
    let prismatic = joints.collect::<Vec<_>>().concat();
    match (prismatic.contains(&true), prismatic.contains(&false)) {
        (false, _) => ["rad", "rad/s"],
        (true, false) => ["m", "m/s"],
        (true, true) => ["rad or m", "rad/s or m/s"],
    }
}
