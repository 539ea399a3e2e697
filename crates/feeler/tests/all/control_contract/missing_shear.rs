//! Slip detection by missing shear: sticking and slipping elements, and objects that move with the fingertip.

use super::rig::{ELEMENTS, config, layout};
use feeler::control::law::LawConfig;
use feeler::control::{
    FeelerShape, FingerReadings, FingertipPose, Plan, SlipDetector, TactileReading,
};
use feeler::hand::JointState;
use glam::{DMat3, DVec3};

/// Missing shear above which an element slips (N).
const THRESHOLD: f64 = 0.0098;
/// Displacement of the fingertip between two frames (m, in W and T), across its apex element, which points along x.
/// It loads sticking elements with 40 mN.
const WAY: DVec3 = DVec3::new(0.0, 3.2e-4, 0.0);
/// Touching elements: the apex and one next to it.
const TOUCHING: [usize; 2] = [0, 1];
/// Normal force of touching elements (N); their shear grows as the fingertip moves.
const PRESSED: f64 = 0.8;

/// Readings of touching elements before and after the fingertip moves by `WAY`, while the object moves by the
/// fraction `share` of it and element 0 loses `slip` newtons of shear.
fn frames(share: f64, slip: f64) -> [TactileReading; 2] {
    let (layout, feeler) = (layout(), FeelerShape::default());
    [0.0, 1.0].map(|gone| {
        let mut touch = TactileReading::none(ELEMENTS);
        touch.frame.sequence = 1 + gone as u64;
        for element in TOUCHING {
            // The feeler is deflected against the fingertip's motion.
            let way = layout.elements[element].rotation.transpose() * WAY;
            let before = -(0.2 / way.length()) * way;
            let stretched = before - gone * (1.0 - share) * feeler.shear_stiffness * way;
            let pushed = PRESSED + gone * (1.0 - share) * feeler.normal_stiffness * way.z;
            touch.frame.forces[element] = stretched.with_z(pushed);
        }
        let force = &mut touch.frame.forces[0];
        *force -= gone * slip * force.with_z(0.0).normalize();
        touch.flags.largest_element = Some(0);
        touch.flags.grasp_force = 2.0 * PRESSED;
        touch
    })
}

/// Missing shear of the touching elements, as computed by `detector`.
fn missing(mut detector: SlipDetector, share: f64, slip: f64) -> [f64; 2] {
    let layout = layout();
    let mut last = [0.0; 2];
    for (touch, position) in frames(share, slip).iter().zip([DVec3::ZERO, WAY]) {
        let sense = FingerReadings {
            pose: FingertipPose {
                position,
                ..FingertipPose::default()
            },
            joints: JointState::default(),
            touch,
            layout: &layout,
        };
        let missing = detector.detect(&sense);
        last = TOUCHING.map(|element| missing[element]);
    }
    last
}

fn still() -> SlipDetector {
    SlipDetector::new(FeelerShape::default(), ELEMENTS)
}

fn moving() -> SlipDetector {
    SlipDetector::for_movable_object(FeelerShape::default(), 0.1, ELEMENTS)
}

#[test]
fn sticking_elements_miss_no_shear_and_slipping_ones_miss_their_loss() {
    for detector in [still, moving] {
        let stuck = missing(detector(), 0.0, 0.0);
        assert!(stuck.iter().all(|&m| m <= 1e-9), "{stuck:?}");
        let slipped = missing(detector(), 0.0, 0.03);
        assert!(slipped[0] > THRESHOLD && slipped[1] <= 1e-9, "{slipped:?}");
    }
}

#[test]
fn shear_missing_on_all_elements_is_motion_of_the_object() {
    for share in [0.3, 0.7, 1.0] {
        let taken_for_slip = missing(still(), share, 0.0);
        assert!(taken_for_slip[0] > THRESHOLD / 2.0, "{taken_for_slip:?}");
        let along = missing(moving(), share, 0.0);
        assert!(along.iter().all(|&m| m <= 1e-9), "{share}: {along:?}");
        let slipped = missing(moving(), share, 0.03);
        assert!(slipped[0] > THRESHOLD && slipped[1] <= 1e-9, "{slipped:?}");
    }
}

#[test]
fn the_object_moves_no_farther_than_the_fingertip() {
    // A larger loss of the only touching element is slip.
    let detect = |slip| {
        let mut detector = moving();
        let layout = layout();
        let mut own = 0.0;
        for (mut touch, position) in frames(1.0, slip).into_iter().zip([DVec3::ZERO, WAY]) {
            touch.frame.forces[1] = DVec3::ZERO;
            let sense = FingerReadings {
                pose: FingertipPose {
                    position,
                    ..FingertipPose::default()
                },
                joints: JointState::default(),
                touch: &touch,
                layout: &layout,
            };
            own = detector.detect(&sense)[0];
        }
        own
    };
    assert!(detect(0.0) <= 0.0);
    assert!(detect(0.03) > THRESHOLD);
}

/// Speeds towards the object (m/s) that the law requests for a finger at rest, for each shear force (N) of element 0.
/// The paper's SLIP is always set.
fn pressing(shear: &[(u64, f64)]) -> Vec<f64> {
    let law = LawConfig::named("tri-axial-missing-shear").expect("a law");
    let control = config().control;
    let law = law.finger_law(control.reflex(), control.touch_force, ELEMENTS);
    let mut law = law.expect("a law").expect("a law for each finger");
    let layout = layout();
    let plan = Plan {
        towards_object: DVec3::X,
        reflex: true,
        keep_grasp: true,
        ..Plan::default()
    };
    let speeds = shear.iter().map(|&(sequence, shear)| {
        let mut touch = TactileReading::none(ELEMENTS);
        touch.frame.sequence = sequence;
        touch.frame.forces[0] = DVec3::new(shear, 0.0, PRESSED);
        touch.flags.largest_element = Some(0);
        touch.flags.grasp_force = PRESSED;
        touch.flags.slip = true;
        let sense = FingerReadings {
            pose: FingertipPose::default(),
            joints: JointState::default(),
            touch: &touch,
            layout: &layout,
        };
        law.velocity(&plan, &sense).dot(DVec3::X)
    });
    speeds.collect()
}

#[test]
fn the_law_presses_on_missing_shear_and_ignores_the_slip_flag() {
    let speed = config().control.recompression_speed;
    // The third frame is processed twice, as in a control step without a new frame.
    let felt = [(1, 0.3), (2, 0.3), (3, 0.2), (3, 0.2), (4, 0.2), (5, 0.4)];
    assert_eq!(pressing(&felt), [0.0, 0.0, speed, speed, 0.0, 0.0]);
}

/// A sticking feeler is a spring between its tip's rest position and a contact point on which its sphere rolls. After
/// any small motion, the only missing shear is the uncertainty of 8 % of the change.
#[test]
fn sticking_elements_miss_no_shear_in_any_motion_of_the_fingertip() {
    let (layout, feeler) = (layout(), FeelerShape::default());
    let start = DMat3::from_euler(glam::EulerRot::XYZ, 0.3, -0.7, 1.1);
    let way = 2e-4 * DVec3::new(0.5, -0.8, 0.6);
    for element in [0, 3, 17] {
        for spin in [
            DVec3::ZERO,
            DVec3::X,
            DVec3::Y,
            DVec3::Z,
            DVec3::new(1.0, -2.0, 0.5),
        ] {
            for lost in [0.0, 0.03] {
                let turn = 0.004 * spin;
                let angle = turn.length();
                let axis = turn.try_normalize().unwrap_or(DVec3::X);
                let poses = [
                    FingertipPose {
                        position: DVec3::new(0.1, 0.2, -0.3),
                        rotation: start,
                    },
                    FingertipPose {
                        position: DVec3::new(0.1, 0.2, -0.3) + way,
                        rotation: DMat3::from_axis_angle(axis, angle) * start,
                    },
                ];
                let springs = DVec3::new(
                    feeler.shear_stiffness,
                    feeler.shear_stiffness,
                    feeler.normal_stiffness,
                );
                let [before, now] = poses.map(|pose| {
                    let rest = pose.position + pose.rotation * layout.tip(element);
                    (rest, pose.rotation * layout.elements[element].rotation)
                });
                let first = DVec3::new(0.2, -0.1, 0.5);
                // The force deflects the feeler's tip from its rest position, and the tip's centre rolls.
                let tip = before.0 + before.1 * (first.with_z(-first.z) / springs);
                let outward = before.1.z_axis;
                let tip = tip - turn.cross(feeler.tip_radius * outward);
                let second = springs * (now.1.transpose() * (tip - now.0));
                let mut second = second.with_z(-second.z);
                let change = (second - first).with_z(0.0);
                second -= lost * second.with_z(0.0).normalize();
                let mut detector = SlipDetector::new(feeler, ELEMENTS);
                let mut missing = 0.0;
                for (sequence, (force, pose)) in (1..).zip([first, second].into_iter().zip(poses)) {
                    let mut touch = TactileReading::none(ELEMENTS);
                    touch.frame.sequence = sequence;
                    touch.frame.forces[element] = force;
                    let sense = FingerReadings {
                        pose,
                        joints: JointState::default(),
                        touch: &touch,
                        layout: &layout,
                    };
                    missing = detector.detect(&sense)[element];
                }
                let expected = lost - 0.08 * change.length();
                // Second order in the rotation: the tip's 2 mm times 127 N/m.
                assert!(
                    (missing - expected).abs() < 2e-5,
                    "{element} {spin}: {missing} {expected}"
                );
            }
        }
    }
}

#[test]
fn missing_shear_decays_and_its_carried_part_is_bounded() {
    let (layout, feeler) = (layout(), FeelerShape::default());
    let after = |losses: &[f64]| {
        let mut detector = SlipDetector::new(feeler, ELEMENTS);
        let mut force = DVec3::new(0.5, 0.0, PRESSED);
        let mut missing = 0.0;
        for (sequence, lost) in (1..).zip(losses) {
            force.x -= lost;
            let mut touch = TactileReading::none(ELEMENTS);
            touch.frame.sequence = sequence;
            touch.frame.forces[0] = force;
            let sense = FingerReadings {
                pose: FingertipPose::default(),
                joints: JointState::default(),
                touch: &touch,
                layout: &layout,
            };
            missing = detector.detect(&sense)[0];
        }
        missing
    };
    assert!((after(&[0.0, 0.002]) - 0.002).abs() < 1e-12);
    // 0.8 of it, and 0.8 of that in the next frame.
    assert!((after(&[0.0, 0.002, 0.0]) - 0.0016).abs() < 1e-12);
    assert!((after(&[0.0, 0.002, 0.001]) - 0.0026).abs() < 1e-12);
    assert!((after(&[0.0, 0.1, 0.0]) - 0.004).abs() < 1e-12);
    assert_eq!(after(&[0.0, -0.1, 0.0]), 0.0);
}
