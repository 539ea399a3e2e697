//! Keys, liveliness tokens and source ids compared with pyzeros, whose output `references/tokens.py` prints.

use feeler_ros2::{Endpoint, EndpointKind, History, NodeName, Qos, Token, key};

const JOINTS: &str = "sensor_msgs/msg/JointState";
const TRIGGER: &str = "std_srvs/srv/Trigger";

fn hash() -> String {
    format!("RIHS01_{}", "a".repeat(64))
}

/// Token of the node `feeler`, or of an endpoint whose topic is resolved by the node's name.
fn token(
    namespace: &str,
    entity_id: u64,
    endpoint: Option<(EndpointKind, &str, &str, Qos)>,
) -> Token {
    let name = NodeName::new(7, namespace, "feeler").expect("a name");
    let endpoint = endpoint.map(|(kind, topic, type_name, qos)| {
        let topic = name.resolve(topic).expect("a topic");
        Endpoint::new(kind, &topic, type_name, &hash(), qos)
    });
    Token {
        domain: name.domain(),
        session: "87e60c99".into(),
        node_id: 0,
        entity_id,
        enclave: String::new(),
        namespace: name.namespace().into(),
        node: name.name().into(),
        endpoint,
    }
}

#[test]
fn tokens_and_keys_match_pyzeros() {
    use EndpointKind::{Client, Publisher, Server, Subscriber};
    let history = |history| Qos {
        history,
        ..Qos::DEFAULT
    };
    let (keep_all, usual) = (history(History::KeepAll), history(History::KeepLast(42)));
    let tokens = [
        token("/", 0, None),
        token("/lab/left", 0, None),
        token(
            "/",
            1,
            Some((Publisher, "/joint_states", JOINTS, Qos::LATCHED)),
        ),
        token(
            "/lab/left",
            2,
            Some((Publisher, "finger_0/wrench", JOINTS, keep_all)),
        ),
        token(
            "lab",
            3,
            Some((Subscriber, "/joint_states", JOINTS, Qos::SENSOR_DATA)),
        ),
        token("lab", 4, Some((Subscriber, "/joint_states", JOINTS, usual))),
        token("/", 5, Some((Server, "/stop", TRIGGER, Qos::DEFAULT))),
        token("/", 6, Some((Client, "/stop", TRIGGER, Qos::DEFAULT))),
    ];
    let mut made = Vec::new();
    for token in &tokens {
        let text = token.to_string();
        let gid: String = token
            .gid()
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect();
        made.push(format!("{text} {gid}"));
    }
    made.push(key(7, "/joint_states", JOINTS, &hash()));
    made.push(key(7, "/lab/left/finger_0/wrench", JOINTS, &hash()));
    let expected: Vec<&str> = include_str!("../references/tokens.txt").lines().collect();
    assert_eq!(made, expected);
}
