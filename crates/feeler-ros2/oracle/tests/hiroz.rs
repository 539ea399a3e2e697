//! Compares keys and liveliness tokens with another Rust implementation of `rmw_zenoh`, for arbitrary names, types and
//! quality-of-service settings.

use feeler_ros2::{
    Durability, Endpoint, EndpointKind, History, NodeName, Qos, Reliability, Token, dds_type, key,
};
use hiroz_protocol::entity::{
    EndpointEntity, EndpointKind as TheirKind, Entity, NodeEntity, TypeHash, TypeInfo,
};
use hiroz_protocol::format::KeyExprFormatter;
use hiroz_protocol::format::rmw_zenoh::{RmwZenohFormatter, dds_type_name};
use hiroz_protocol::qos::{QosDurability, QosHistory, QosProfile, QosReliability};
use proptest::prelude::*;

fn qos() -> impl Strategy<Value = Qos> {
    let reliability = prop_oneof![Just(Reliability::Reliable), Just(Reliability::BestEffort)];
    let durability = prop_oneof![Just(Durability::TransientLocal), Just(Durability::Volatile)];
    let history = prop_oneof![
        (1..100_usize).prop_map(History::KeepLast),
        Just(History::KeepAll)
    ];
    (reliability, durability, history).prop_map(|(reliability, durability, history)| Qos {
        reliability,
        durability,
        history,
    })
}

fn theirs(qos: Qos) -> QosProfile {
    QosProfile {
        reliability: match qos.reliability {
            Reliability::Reliable => QosReliability::Reliable,
            Reliability::BestEffort => QosReliability::BestEffort,
        },
        durability: match qos.durability {
            Durability::TransientLocal => QosDurability::TransientLocal,
            Durability::Volatile => QosDurability::Volatile,
        },
        history: match qos.history {
            History::KeepLast(depth) => QosHistory::KeepLast(depth),
            History::KeepAll => QosHistory::KeepAll,
        },
        ..QosProfile::default()
    }
}

fn kind() -> impl Strategy<Value = (EndpointKind, TheirKind)> {
    prop_oneof![
        Just((EndpointKind::Publisher, TheirKind::Publisher)),
        Just((EndpointKind::Subscriber, TheirKind::Subscription)),
        Just((EndpointKind::Server, TheirKind::Service)),
        Just((EndpointKind::Client, TheirKind::Client)),
    ]
}

/// Regular expression of one part of a ROS 2 name.
const PART: &str = "[a-zA-Z][a-zA-Z0-9]{0,8}";

fn parts(most: usize) -> impl Strategy<Value = String> {
    let parts = proptest::collection::vec(PART, 0..=most);
    parts.prop_map(|parts| parts.iter().map(|part| format!("/{part}")).collect())
}

proptest! {
    #[test]
    fn keys_and_tokens_match_hiroz(
        (domain, session) in (0..=232_u32, "[1-9a-f][0-9a-f]{30}[1-9a-f]"),
        (namespace, node, topic) in (parts(3), PART, (parts(2), PART)),
        (package, type_name, bytes) in ("[a-z][a-z0-9]{0,8}", "[A-Z][a-zA-Z0-9]{0,8}", any::<[u8; 32]>()),
        (kind, qos, entity_id) in (kind(), qos(), 1..10_000_u64),
    ) {
        let root = if namespace.is_empty() { "/" } else { "" };
        let name = NodeName::new(domain, &format!("{root}{namespace}"), &node).expect("a name");
        let topic = format!("{}/{}", topic.0, topic.1);
        let their_hash = TypeHash::new(1, bytes);
        let (hash, canonical) = (their_hash.to_rihs_string(), format!("{package}/msg/{type_name}"));
        let of_node = NodeEntity {
            domain_id: domain as usize,
            z_id: session.parse().expect("an id"),
            id: 0,
            name: node.clone(),
            namespace: namespace.clone(),
            enclave: String::new(),
        };
        let session = of_node.z_id.to_string();
        let dds = dds_type_name(&format!("{package}::msg"), &type_name);
        prop_assert_eq!(&dds_type(&canonical), &dds);
        let endpoint = EndpointEntity {
            id: entity_id as usize,
            node: Some(of_node.clone()),
            kind: kind.1,
            topic: topic.clone(),
            type_info: Some(TypeInfo::new(&dds, their_hash)),
            qos: theirs(qos),
        };
        let mut token = Token {
            domain,
            session,
            node_id: 0,
            entity_id: 0,
            enclave: String::new(),
            namespace: name.namespace().into(),
            node,
            endpoint: None,
        };
        let whole = RmwZenohFormatter::node_liveliness_key_expr(&of_node).expect("a token");
        prop_assert_eq!(token.to_string(), whole.0.to_string());
        token.entity_id = entity_id;
        token.endpoint = Some(Endpoint::new(kind.0, &topic, &canonical, &hash, qos));
        let whole = RmwZenohFormatter::liveliness_key_expr(&endpoint, &of_node.z_id).expect("a token");
        prop_assert_eq!(token.to_string(), whole.0.to_string());
        let of_topic = RmwZenohFormatter::topic_key_expr(&endpoint).expect("a key");
        prop_assert_eq!(key(domain, &topic, &canonical, &hash), of_topic.to_string());
        // The other implementation parses the token.
        let ours = &token.to_string().try_into().expect("a key expression");
        let read = RmwZenohFormatter::parse_liveliness(ours).expect("an entity");
        prop_assert_eq!(read, Entity::Endpoint(endpoint));
    }
}
