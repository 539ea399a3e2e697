//! Resultant force of a tactile frame, compared with a case calculated by hand.

use feeler::control::{FingerReadings, FingertipPose, TactileReading};
use feeler::glam::{DMat3, DVec3};
use feeler::hand::JointState;
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig, RingConfig};
use feeler::sensor::forces::NO_FORCE;

/// One element at the apex and one on the equator, towards y of `T`.
fn layout() -> ElementLayout {
    let ring = |polar_angle_deg| RingConfig {
        elements: 1,
        polar_angle_deg,
    };
    ElementLayout::new(&LayoutConfig {
        dome_radius: 0.018,
        rings: vec![ring(0.0), ring(90.0)],
        grid: None,
    })
}

/// At the apex, the axes of `E` are y, z, x of `T`; at the other element they are -x, z, y. With compression towards
/// the dome, the first force is (-2, 0.3, -0.1) N in `T`, the second (-0.2, -1, 0.4) N.
#[test]
fn the_resultant_is_the_sum_of_the_objects_forces_on_the_fingertip() {
    let layout = layout();
    let mut touch = TactileReading::none(2);
    touch.frame.forces = vec![DVec3::new(0.3, -0.1, 2.0), DVec3::new(0.2, 0.4, 1.0)];
    let close = |force: DVec3, expected: DVec3| {
        assert!(force.distance(expected) < 1e-12, "{force}");
    };
    close(touch.frame.resultant(&layout), DVec3::new(-2.2, -0.7, 0.3));
    // A fingertip that points along y of W: x of T is y, and y of T is -x.
    let pose = FingertipPose {
        position: DVec3::ONE,
        rotation: DMat3::from_cols(DVec3::Y, -DVec3::X, DVec3::Z),
    };
    let sense = |touch| FingerReadings {
        pose,
        joints: JointState::default(),
        touch,
        layout: &layout,
    };
    close(sense(&touch).resultant(), DVec3::new(0.7, -2.2, 0.3));
    let sum = sense(&touch).force(0) + sense(&touch).force(1);
    close(sense(&touch).resultant(), sum);
    touch.frame.forces[1] = NO_FORCE;
    assert!(touch.frame.resultant(&layout).is_nan());
}
