//! Hashes of all used types compared with ROS 2's own generator, whose output `references/type_hashes.py` prints.

use feeler_record::ros::{JointState, PointCloud2, TFMessage, Text, WrenchStamped};
use feeler_record::tactile_array::TactileArray;
use feeler_record::wire::Message;
use feeler_ros2::message::*;
use feeler_ros2::{Service, TypeDescription};
use std::collections::BTreeMap;

fn message<M: Message>() -> (String, String) {
    let description = TypeDescription::of_message::<M>().expect(M::SCHEMA_NAME);
    (M::SCHEMA_NAME.into(), description.hash())
}

fn service<S: Service>() -> (String, String) {
    let description = TypeDescription::of_service::<S>().expect(S::NAME);
    (S::NAME.into(), description.hash())
}

#[test]
fn hashes_match_the_official_generator() {
    let reference = include_str!("../references/type_hashes.txt");
    let expected: BTreeMap<String, String> = reference
        .lines()
        .filter_map(|line| line.split_once(' '))
        .map(|(name, hash)| (name.into(), hash.into()))
        .collect();
    let made = BTreeMap::from([
        message::<Clock>(),
        message::<DiagnosticArray>(),
        message::<Float64MultiArray>(),
        message::<JointState>(),
        message::<PointCloud2>(),
        message::<TFMessage>(),
        message::<TactileArray>(),
        message::<TactileState>(),
        message::<Text>(),
        message::<WrenchStamped>(),
        service::<DescribeParameters>(),
        service::<GetParameterTypes>(),
        service::<GetParameters>(),
        service::<ListParameters>(),
        service::<SendGripperGoal>(),
        service::<SetParameters>(),
        service::<SetParametersAtomically>(),
        service::<Trigger>(),
    ]);
    assert_eq!(made, expected);
}

#[test]
fn ros_package_contains_the_hashed_text() {
    macro_rules! in_package {
        ($name:literal) => {
            include_str!(concat!("../../../../ros2/feeler_msgs/msg/", $name, ".msg"))
        };
    }
    let own = include_str!("../../msg/feeler_msgs/TactileState.msg");
    assert_eq!(in_package!("TactileState"), own);
    let array = TactileArray::SCHEMA;
    assert!(array.starts_with(in_package!("TactileArray")));
    assert!(array.ends_with(in_package!("TactileChannel")));
}
