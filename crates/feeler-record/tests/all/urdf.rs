//! Checks that fingertip poses in the URDF, parsed by another library, match the kinematics.

use feeler::hand::kinematics::fingertip_pose;
use feeler::hand::{FingerConfig, FingerDescription, FingerGeometry, JointVector};
use feeler_record::messages::{FingerModel, frame, joint_names};
use feeler_record::viewers::urdf;
use feeler_record::{Solid, SolidFrame, SolidShape};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use proptest::prelude::*;
use std::f64::consts::TAU;
use urdf_rs::{Geometry, JointType, Robot};

const DOME: f64 = 0.018;

fn finger(base_position: [f64; 3], (phi1_deg, phi2_deg): (f64, f64), l2: f64) -> FingerConfig {
    FingerConfig {
        base_position,
        phi1_deg,
        phi2_deg,
        links: [l2, 0.06, 0.055],
        joint_lower_deg: [-60.0, -30.0, -150.0],
        joint_upper_deg: [60.0, 120.0, 0.0],
        joint_speed_limit: [2.0, 2.5, 3.0],
    }
}

fn built(description: &FingerDescription) -> FingerGeometry {
    FingerGeometry::of(description).unwrap()
}

fn parse(fingers: &[FingerDescription], solids: &[Solid]) -> Robot {
    let model = |geometry: &FingerDescription| FingerModel {
        geometry: geometry.clone(),
        dome_radius: DOME,
        element_tips: Vec::new(),
    };
    let models: Vec<_> = fingers.iter().map(model).collect();
    let text = urdf("two & a half <fingers>", &models, solids).unwrap();
    urdf_rs::read_from_string(&text).unwrap_or_else(|error| panic!("{error}: {text}"))
}

/// Computes the pose of `link` in the world by URDF's conventions. `angle` returns the angle of a joint by name.
fn pose(robot: &Robot, link: &str, angle: &impl Fn(&str) -> f64) -> DAffine3 {
    let Some(joint) = robot.joints.iter().find(|joint| joint.child.link == link) else {
        assert_eq!(link, "world");
        return DAffine3::IDENTITY;
    };
    let [roll, pitch, yaw] = *joint.origin.rpy;
    let turned =
        DMat3::from_rotation_z(yaw) * DMat3::from_rotation_y(pitch) * DMat3::from_rotation_x(roll);
    let origin = DAffine3::from_mat3_translation(turned, DVec3::from(*joint.origin.xyz));
    let axis = DVec3::from(*joint.axis.xyz);
    let moved = match joint.joint_type {
        JointType::Fixed => DAffine3::IDENTITY,
        JointType::Prismatic => DAffine3::from_translation(axis * angle(&joint.name)),
        _ => DAffine3::from_quat(DQuat::from_axis_angle(axis, angle(&joint.name))),
    };
    pose(robot, &joint.parent.link, angle) * origin * moved
}

proptest! {
    /// Up to rounding errors of lengths below 10 m.
    #[test]
    fn fingertip_poses_match_the_kinematics(
        base in prop::array::uniform3(-1.0..1.0),
        phi in (-180.0..180.0, -180.0..180.0),
        l2 in prop_oneof![Just(0.0), 0.001..0.1],
        theta in prop::array::uniform3(-3.0..3.0),
    ) {
        let fingers = [finger([0.0; 3], (0.0, 0.0), 0.03), finger(base, phi, l2)].map(Into::into);
        let robot = parse(&fingers, &[]);
        let names: Vec<_> = joint_names(1, 3).collect();
        let angle = |joint: &str| {
            let index = names.iter().position(|name| name == joint);
            index.map_or(0.0, |index| theta[index])
        };
        let drawn = pose(&robot, &frame(1, "dome"), &angle);
        let (position, rotation) = fingertip_pose(&built(&fingers[1]), theta.into());
        prop_assert!((drawn.translation - position).length() < 1e-12);
        let off = drawn.matrix3 - rotation;
        prop_assert!(off.to_cols_array().iter().all(|entry| entry.abs() < 1e-12));
    }
}

/// A finger with a sliding base, and a last joint that bends with the one before.
const COUPLED: &str = r#"{
    "base_position": [0.1, -0.2, 0.3],
    "base_rpy": [0.4, -0.5, 0.6],
    "joints": [
        { "name": "slide", "lower": -0.02, "upper": 0.03, "speed": 0.1 },
        { "name": "bend", "lower": -0.5, "upper": 1.5, "speed": 2.0 }
    ],
    "frames": [
        { "type": "prismatic", "joint": "slide", "xyz": [0.01, 0.02, 0.0], "axis": [0.0, 1.0, 1.0] },
        { "joint": "bend", "xyz": [0.0, 0.0, 0.04], "rpy": [0.3, 0.0, 0.2], "axis": [0.0, -1.0, 0.0] },
        { "mimic": { "joint": "bend", "multiplier": -0.8, "offset": 0.1 }, "xyz": [0.05, 0.0, 0.01] }
    ],
    "tip_position": [0.03, 0.01, 0.0],
    "tip_rpy": [0.0, 0.2, 0.0]
}"#;

proptest! {
    /// Up to rounding errors of lengths below 1 m.
    #[test]
    fn fingertip_poses_of_chains_match_the_kinematics(slide in -0.02..0.03, bend in -0.5..1.5) {
        let fingers = [serde_json::from_str(COUPLED).unwrap()];
        let (robot, geometry) = (parse(&fingers, &[]), built(&fingers[0]));
        let joints = JointVector::from([slide, bend]);
        let positions: Vec<_> = geometry.frame_positions(joints).collect();
        prop_assert_eq!(&positions, &[slide, bend, -0.8 * bend + 0.1]);
        let names: Vec<_> = joint_names(0, 3).collect();
        let position = |joint: &str| {
            let index = names.iter().position(|name| name == joint);
            index.map_or(0.0, |index| positions[index])
        };
        let drawn = pose(&robot, &frame(0, "dome"), &position);
        let (position, rotation) = fingertip_pose(&geometry, joints);
        prop_assert!((drawn.translation - position).length() < 1e-12);
        let off = drawn.matrix3 - rotation;
        prop_assert!(off.to_cols_array().iter().all(|entry| entry.abs() < 1e-12));
    }
}

#[test]
fn coupled_frames_have_the_limits_of_their_joint() {
    let robot = parse(&[serde_json::from_str(COUPLED).unwrap()], &[]);
    let joints = robot
        .joints
        .iter()
        .filter(|j| j.joint_type != JointType::Fixed);
    let limits = joints.map(|joint| [joint.limit.lower, joint.limit.upper, joint.limit.velocity]);
    let expected = [[-0.02, 0.03, 0.1], [-0.5, 1.5, 2.0], [-1.1, 0.5, 1.6]];
    for (limits, expected) in limits.zip(expected) {
        for (limit, expected) in limits.into_iter().zip(expected) {
            assert!(
                (limit - expected).abs() < 1e-12,
                "{limit} instead of {expected}"
            );
        }
    }
    let dome = robot.links.iter().find(|link| link.name == "finger_0_dome");
    assert_eq!(dome.unwrap().visual.len(), 1);
}

#[test]
fn limits_and_lengths_match_the_experiment() {
    let fingers = [finger([0.0; 3], (0.0, 0.0), 0.0).into()];
    let (robot, finger) = (parse(&fingers, &[]), built(&fingers[0]));
    assert_eq!(robot.name, "two & a half <fingers>");
    for (index, name) in joint_names(0, 3).enumerate() {
        let joint = robot.joints.iter().find(|joint| joint.name == name);
        let joint = joint.expect("the joint");
        assert_eq!(joint.joint_type, JointType::Revolute);
        assert_eq!(joint.limit.lower, finger.joint_lower()[index]);
        assert_eq!(joint.limit.upper, finger.joint_upper()[index]);
        assert_eq!(joint.limit.velocity, finger.joint_speed_limit()[index]);
    }
    let drawn: Vec<usize> = robot.links.iter().map(|link| link.visual.len()).collect();
    // World and base are frames without shapes; the first link has zero length.
    assert_eq!(drawn, [0, 0, 0, 1, 1, 1]);
}

#[test]
fn moving_solids_float_and_fixed_solids_are_part_of_the_world() {
    let solid = |name: &str, frame, shape| Solid {
        name: name.into(),
        frame,
        position: [0.0, 0.0, 0.25],
        orientation: DQuat::from_rotation_x(0.5).to_array(),
        shape,
    };
    let corner = |angle: f64| [0.014 * angle.cos(), 0.014 * angle.sin()];
    let outline = (0..40).map(|k| corner(TAU * f64::from(k) / 40.0)).collect();
    let size = [0.03, 0.02, 0.01];
    let solids = [
        solid("table", SolidFrame::World, SolidShape::Box { size }),
        solid(
            "cap",
            SolidFrame::Cap,
            SolidShape::Prism {
                outline,
                length: 0.02,
            },
        ),
    ];
    let robot = parse(&[], &solids);
    let joints: Vec<_> = robot.joints.iter().map(|joint| &joint.child.link).collect();
    assert_eq!(joints, ["cap"]);
    assert_eq!(robot.joints[0].joint_type, JointType::Floating);
    let [world, cap] = &robot.links[..] else {
        panic!("{:?}", robot.links);
    };
    let Geometry::Box { size: drawn } = &world.visual[0].geometry else {
        panic!("{:?}", world.visual);
    };
    assert_eq!(**drawn, size);
    assert!((world.visual[0].origin.rpy[0] - 0.5).abs() < 1e-12);
    assert_eq!(*world.visual[0].origin.xyz, [0.0, 0.0, 0.25]);
    let Geometry::Cylinder { radius, length } = cap.visual[0].geometry else {
        panic!("{:?}", cap.visual);
    };
    assert!((radius - 0.014).abs() < 1e-12 && length == 0.02);
}
