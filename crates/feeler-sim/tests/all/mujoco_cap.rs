//! Two fingertips turn a cap: feeler's quasi-static feelers compared with MuJoCo under the same motion.
//!
//! `references/mujoco_cap_*.json` contain MuJoCo's results; `references/mujoco_cap.py` regenerates them.

use crate::mujoco_scene::{Reference, Scene, reference};
use glam::DVec3;

/// Deviation of feeler from MuJoCo.
#[derive(Debug)]
struct Difference {
    /// Maximum while MuJoCo has converged, relative to MuJoCo's final cap angle.
    converged_cap_angle: f64,
    /// At the end, relative to MuJoCo's final cap angle.
    final_cap_angle: f64,
    /// RMS over time and touching elements, relative to the RMS of MuJoCo's forces.
    forces: f64,
}

fn compare(reference: &Reference, time_step: f64) -> Difference {
    let header = &reference.header;
    let mut scene = Scene::new(header, time_step);
    let every = (header.sample / time_step).round() as usize;
    let last = *reference.cap_angle.last().expect("samples");
    let (mut worst, mut in_the_end) = (0.0_f64, 0.0);
    let (mut error, mut size) = (0.0, 0.0);
    let mut steps = 0_u32;
    for (sample, &angle) in reference.cap_angle.iter().enumerate() {
        for _ in 0..every {
            steps += 1;
            let time = f64::from(steps) * time_step;
            let poses = scene.poses(|finger| header.joints(finger, time));
            scene.advance(&poses);
        }
        in_the_end = (scene.cap_angle() - angle) / last;
        if (sample + 1) as f64 * header.sample <= header.converged_until {
            worst = worst.max(in_the_end.abs());
        }
        for finger in 0..header.bases.len() {
            for element in 0..scene.fingers[finger].1.elements.len() {
                let name = format!("{finger}/{element}");
                let theirs = reference.forces.get(&name).map_or([0.0; 3], |f| f[sample]);
                let theirs = DVec3::from_array(theirs);
                error += (scene.force(finger, element) - theirs).length_squared();
                size += theirs.length_squared();
            }
        }
    }
    Difference {
        converged_cap_angle: worst,
        final_cap_angle: in_the_end,
        forces: (error / size).sqrt(),
    }
}

/// Maximum relative deviations of cap angle and forces.
const GOALS: (f64, f64) = (0.015, 0.05);

fn check(name: &str) {
    let reference = reference(name);
    assert!(reference.cap_angle.last().is_some_and(|&a| a > 0.1));
    let differences = [0.001, 0.0005, 0.00025].map(|step| (step, compare(&reference, step)));
    for (step, difference) in &differences {
        println!("{name}, {step} s: {difference:?}");
    }
    for (step, difference) in &differences {
        let (angle, forces) = (difference.converged_cap_angle, difference.forces);
        assert!(angle <= GOALS.0, "{step} s: {difference:?}");
        assert!(
            difference.final_cap_angle.abs() <= GOALS.0,
            "{step} s: {difference:?}"
        );
        assert!(forces <= GOALS.1, "{step} s: {difference:?}");
    }
}

#[test]
fn with_round_tips_cap_angle_and_element_forces_agree_with_mujoco() {
    check("round_tips");
}

/// Point tips do not roll.
#[test]
fn with_point_tips_cap_angle_and_element_forces_agree_with_mujoco() {
    check("point_tips");
}
