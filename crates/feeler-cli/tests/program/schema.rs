//! `feeler schema` prints every message, and docs/link.md agrees with it.

use crate::program::{folder, run};
use feeler_link::messages::message::TactileUpdate;
use feeler_record::wire::Message;

/// Separator between the text of a message and the texts of the types in it.
const SEPARATOR: &str =
    "================================================================================";

#[test]
fn every_message_is_printed() {
    let printed = run(&folder("schema-all"), &["schema"]).done();
    let heads = printed.lines().filter(|line| line.starts_with("#### "));
    let recorded = include_str!("../../../feeler-record/src/messages/channels.rs");
    let efforts = include_str!("../../../feeler-record/src/messages/efforts.rs");
    let felt = include_str!("../../../feeler-record/src/messages/felt.rs");
    let linked = include_str!("../../../feeler-link/src/messages/message.rs");
    let written = [recorded, efforts, felt, linked].map(|text| text.matches("\nmessage!(").count());
    // The ROS 2 messages, for images and seven for viewers, are written without the macro.
    assert_eq!(heads.count(), written.iter().sum::<usize>() + 8);
}

#[test]
fn single_message_is_printed() {
    let folder = folder("schema-one");
    for name in ["TactileUpdate", "feeler_msgs/msg/TactileUpdate"] {
        let printed = run(&folder, &["schema", name]).done();
        assert_eq!(printed, TactileUpdate::SCHEMA);
    }
    let refused = run(&folder, &["schema", "Torque"]);
    refused.refused(&["\"Torque\"", "feeler_msgs/msg/TorqueSensor"]);
}

#[test]
fn link_documentation_matches_the_schemas() {
    let documentation = include_str!("../../../../docs/link.md");
    let printed = run(&folder("schema-documentation"), &["schema"]).done();
    let mut compared = 0;
    for schema in printed
        .split("#### ")
        .filter(|s| s.contains(", linked as "))
    {
        let (head, text) = schema.split_once('\n').expect("a line with its name");
        let (_, key) = head.split_once(", linked as ").expect("its key");
        assert!(documentation.contains(key), "no key {key}");
        for part in text.split(SEPARATOR) {
            assert!(
                documentation.contains(part.trim()),
                "missing in docs/link.md:\n{part}"
            );
            compared += 1;
        }
    }
    assert!(compared > 9, "{compared}");
}
