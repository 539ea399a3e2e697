use super::*;
use crate::control::sense::FingertipPose;
use crate::control::touch::TactileReading;
use crate::hand::JointState;
use crate::sensor::fingertip::layout::{ElementLayout, LayoutConfig, RingConfig};

const STIFFNESS: Stiffness = Stiffness {
    normal: 200.0,
    shear: 100.0,
};
/// Depth of the most pressed feeler (m).
const DEPTH: f64 = 1e-3;

/// Number of frames in which the finger moves.
const MOVING: u64 = 26;

/// A finger whose apex touches an object on W's z axis. It moves along -y of W by 0.1 mm every 10 ms, until it stops.
struct Rig {
    layout: ElementLayout,
    grip: NeededGrip,
    frames: u64,
}

impl Rig {
    fn new() -> Self {
        let ring = |elements, polar_angle_deg| RingConfig {
            elements,
            polar_angle_deg,
        };
        let layout = ElementLayout::new(&LayoutConfig {
            dome_radius: 0.018,
            rings: vec![ring(1, 0.0), ring(4, 45.0)],
            grid: None,
        });
        let mut grip = NeededGrip::new(0.1, layout.elements.len());
        grip.set_stiffness(STIFFNESS);
        Self {
            layout,
            grip,
            frames: 0,
        }
    }

    /// Processes the next frame, with `normal` force and `shear` along y of W on the apex (N). Returns the inward
    /// speed (m/s).
    fn frame(&mut self, normal: f64, shear: f64, turns: bool) -> f64 {
        self.frames += 1;
        let mut touch = TactileReading::none(self.layout.elements.len());
        touch.frame.sequence = self.frames;
        touch.frame.stamp = 0.01 * self.frames as f64;
        let own = self.layout.elements[0].rotation.transpose() * DVec3::new(0.0, shear, 0.0);
        touch.frame.forces[0] = own.with_z(normal);
        let pose = FingertipPose {
            position: DVec3::new(-0.033, -1e-4 * self.frames.min(MOVING) as f64, 0.0),
            ..FingertipPose::default()
        };
        let sense = FingerReadings {
            pose,
            joints: JointState::default(),
            touch: &touch,
            layout: &self.layout,
        };
        let surface = Surface {
            stiffness: STIFFNESS,
            pivot: DVec2::ZERO,
        };
        let along = self.grip.predict_shear(&sense);
        self.grip.feel(&sense, surface, turns, along);
        -self.grip.speed(DEPTH)
    }

    /// Sticks while the shear rises to 0.25 N, by 10 mN a frame; then slips until 0.15 N are left. Returns the inward
    /// speed in the frame of the slip (m/s).
    fn slip(&mut self, turns: bool) -> f64 {
        for step in 1..=25 {
            let speed = self.frame(0.3, 0.01 * f64::from(step), turns);
            assert_eq!(speed, 0.0, "{step}");
        }
        self.frame(0.3, 0.15, turns)
    }
}

#[test]
fn a_slip_presses_the_finger_deeper_in_the_same_frame() {
    // One frame's pulse, less the 5 % by which the gain loosens the grip, as the load is lower now.
    let depth = 0.01 * Rig::new().slip(true);
    let expected = (PULSE - 0.01 * GAIN * LARGEST_ERROR) * DEPTH;
    assert!((depth / expected - 1.0).abs() < 0.05, "{depth} {expected}");
}

#[test]
fn the_grip_follows_the_load_once_the_friction_is_known() {
    let mut rig = Rig::new();
    rig.slip(true);
    let mut speeds = |normal, shear| (0..100).fold(0.0, |_, _| rig.frame(normal, shear, true));
    // With a friction of about 0.8, 0.25 N are needed for a load of 0.2 N.
    let [loose, slightly] = [speeds(0.9, 0.2), speeds(0.27, 0.2)];
    assert!((loose + OUTWARD_SPEED).abs() < 1e-12, "{loose}");
    assert!(slightly < 0.0 && slightly > 0.8 * loose, "{slightly}");
}

#[test]
fn a_light_load_is_held_with_enough_force_to_notice_slip() {
    let mut rig = Rig::new();
    rig.slip(true);
    let speed = (0..100).fold(0.0, |_, _| rig.frame(0.12, 0.0, true));
    assert!(speed > 0.0, "{speed}");
}

#[test]
fn nothing_is_learnt_unless_the_finger_turns_the_object() {
    assert_eq!(Rig::new().slip(false), 0.0);
}
