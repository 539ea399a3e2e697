//! Keys that each right may write and read, as access-control rules for Zenoh.
//!
//! All messages pass through the hand, whose rules are decisive. The other programs accept messages from the hand only.

use super::right::{CertificateName, MAX_SERIAL, Right};
use super::withdrawn::{self, WithdrawnError};
use crate::transport::endpoints::LinkConfig;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// Side of a connection: the hand, or a program that connects to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The hand, which routes all messages.
    Hand,
    /// A program that connects to the hand.
    Member,
}

/// Zenoh key expressions, relative to the rig's key.
#[derive(Debug, Clone, PartialEq, Default)]
struct Keys {
    /// Keys that the holder of a right may write.
    writes: Vec<String>,
    /// Keys that the holder may read.
    reads: Vec<String>,
}

/// Returns Zenoh's access-control settings for `config`, or `None` without certificates or a TLS endpoint. Peers on
/// endpoints without TLS have all rights; [`LinkConfig::check`] prevents such endpoints from being public by mistake.
///
/// # Errors
/// If a list of revoked certificates exists but cannot be read.
pub fn access_control(config: &LinkConfig, role: Role) -> Result<Option<Value>, WithdrawnError> {
    let endpoints = || config.listen.iter().chain(&config.connect);
    let Some(folder) = &config.certificates else {
        return Ok(None);
    };
    if !endpoints().any(|endpoint| endpoint.starts_with("tls/")) {
        return Ok(None);
    }
    let withdrawn = withdrawn::beside(folder)?;
    let is_open = endpoints().any(|endpoint| !endpoint.starts_with("tls/"));
    Ok(Some(rules(&config.rig, role, &withdrawn, is_open)))
}

/// Returns the access-control settings for the rig named `rig`. All other access is denied. The revoked certificates in
/// `withdrawn` have no rights. If `is_open`, peers without TLS have all rights.
pub fn rules(rig: &str, role: Role, withdrawn: &BTreeSet<CertificateName>, is_open: bool) -> Value {
    let rights = match role {
        Role::Hand => Right::all(),
        Role::Member => vec![Right::Hand],
    };
    let [mut rules, mut subjects, mut policies] = [const { Vec::new() }; 3];
    for right in rights {
        let names: Vec<String> = names(right, withdrawn).collect();
        // Zenoh rejects empty lists.
        if names.is_empty() {
            continue;
        }
        let id = right.to_string();
        let permitted = permissions(&id, rig, &keys(right));
        let ids: Vec<&Value> = permitted.iter().map(|rule| &rule["id"]).collect();
        policies.push(json!({"rules": ids, "subjects": [id]}));
        subjects.push(json!({"id": id, "cert_common_names": names}));
        rules.extend(permitted);
    }
    if is_open {
        let permitted = permissions("open", rig, &everything());
        let ids: Vec<&Value> = permitted.iter().map(|rule| &rule["id"]).collect();
        policies.push(json!({"rules": ids, "subjects": ["open"]}));
        subjects.push(json!({"id": "open", "link_protocols": ["tcp", "udp"]}));
        rules.extend(permitted);
    }
    json!({
        "enabled": true, "default_permission": "deny",
        "rules": rules, "subjects": subjects, "policies": policies,
    })
}

/// Returns all possible certificate names for a right, including those that are not issued yet, without the revoked
/// ones.
fn names(
    right: Right,
    withdrawn: &BTreeSet<CertificateName>,
) -> impl Iterator<Item = String> + use<'_> {
    let all = (1..=MAX_SERIAL).map(move |serial| CertificateName { right, serial });
    all.filter(|name| !withdrawn.contains(name))
        .map(|name| name.to_string())
}

/// Returns the keys that a right permits.
fn keys(right: Right) -> Keys {
    let of = |writes: &[&str], reads: &[&str]| Keys {
        writes: writes.iter().map(ToString::to_string).collect(),
        reads: reads.iter().map(ToString::to_string).collect(),
    };
    match right {
        Right::Hand => everything(),
        Right::Rig => of(
            &[
                "hand/state",
                "finger/*/picture",
                "finger/*/forces",
                "heartbeat/world",
                // The rig stops the hand if its drives fail.
                "stop",
            ],
            &["hand/command", "hand/mode", "heartbeat/**"],
        ),
        Right::Sense(n) => Keys {
            writes: vec![
                format!("finger/{n}/tactile"),
                format!("heartbeat/sense/{n}"),
            ],
            reads: vec![
                format!("finger/{n}/picture"),
                format!("finger/{n}/forces"),
                "hand/mode".into(),
                "heartbeat/**".into(),
            ],
        },
        Right::Order => of(
            &["stop", "resume", "heartbeat/order", "heartbeat/watch"],
            &["**"],
        ),
        Right::Stop => of(&["stop", "heartbeat/order"], &["hand/mode", "heartbeat/**"]),
        Right::Watch => of(&["heartbeat/watch"], &["**"]),
    }
}

fn everything() -> Keys {
    Keys {
        writes: vec!["**".into()],
        reads: vec!["**".into()],
    }
}

/// Returns rules, named after `id`, that permit `keys` of a rig. They never permit queries, queryables, deletions or
/// liveliness, which the link does not use.
fn permissions(id: &str, rig: &str, keys: &Keys) -> Vec<Value> {
    let whole = |keys: &[String]| -> Vec<String> {
        keys.iter()
            .map(|key| format!("feeler/{rig}/{key}"))
            .collect()
    };
    let rule = |what: &str, flow: &str, message: &str, keys: Vec<String>| {
        json!({
            "id": format!("{id}-{what}"), "permission": "allow",
            "flows": [flow], "messages": [message], "key_exprs": keys,
        })
    };
    let (subscribe, put) = ("declare_subscriber", "put");
    vec![
        rule("writes", "ingress", put, whole(&keys.writes)),
        rule("subscribes", "ingress", subscribe, whole(&keys.reads)),
        rule("reads", "egress", put, whole(&keys.reads)),
        // A program only sends messages with a known subscriber. Subscriptions are not secret.
        rule("hears-of", "egress", subscribe, whole(&["**".into()])), // words: allow
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn permitted<'a>(rules: &'a Value, id: &str) -> Vec<&'a str> {
        let all = rules["rules"].as_array().unwrap();
        let rule = all.iter().find(|rule| rule["id"] == id).unwrap();
        let keys = rule["key_exprs"].as_array().unwrap();
        keys.iter().map(|key| key.as_str().unwrap()).collect()
    }

    fn names_of<'a>(rules: &'a Value, id: &str) -> Vec<&'a str> {
        let all = rules["subjects"].as_array().unwrap();
        let subject = all.iter().find(|subject| subject["id"] == id).unwrap();
        let names = subject["cert_common_names"].as_array().unwrap();
        names.iter().map(|name| name.as_str().unwrap()).collect()
    }

    #[test]
    fn a_sensor_writes_only_for_its_finger() {
        let rules = rules("bench", Role::Hand, &BTreeSet::new(), false);
        let writes = permitted(&rules, "sense-1-writes");
        let expected = [
            "feeler/bench/finger/1/tactile",
            "feeler/bench/heartbeat/sense/1",
        ];
        assert_eq!(writes, expected);
        let reads = permitted(&rules, "sense-1-subscribes");
        assert!(
            reads.contains(&"feeler/bench/finger/1/picture"),
            "{reads:?}"
        );
        assert_eq!(reads, permitted(&rules, "sense-1-reads"));
        assert!(
            !reads.iter().any(|key| key.contains("command")),
            "{reads:?}"
        );
    }

    #[test]
    fn only_permitted_rights_write_orders_and_states() {
        let rules = rules("bench", Role::Hand, &BTreeSet::new(), false);
        let may = |key: &str| -> Vec<String> {
            let of = |right: &Right| permitted(&rules, &format!("{right}-writes")).contains(&key);
            let rights = Right::all().into_iter().filter(of);
            rights.map(|right| right.to_string()).collect()
        };
        assert_eq!(may("feeler/bench/stop"), ["rig", "order", "stop"]);
        assert_eq!(may("feeler/bench/resume"), ["order"]);
        assert_eq!(may("feeler/bench/hand/state"), ["rig"]);
        assert_eq!(may("feeler/bench/**"), ["hand"]);
    }

    #[test]
    fn only_puts_and_subscriptions_are_permitted() {
        for role in [Role::Hand, Role::Member] {
            let rules = rules("bench", role, &BTreeSet::new(), true);
            assert_eq!(rules["default_permission"], "deny");
            for rule in rules["rules"].as_array().unwrap() {
                let messages = rule["messages"].as_array().unwrap();
                let known = messages
                    .iter()
                    .all(|m| m == "put" || m == "declare_subscriber");
                assert!(known, "{rule}");
                let keys = rule["key_exprs"].as_array().unwrap();
                let of_rig = |key: &Value| key.as_str().unwrap().starts_with("feeler/bench/");
                assert!(keys.iter().all(of_rig), "{rule}");
            }
        }
    }

    #[test]
    fn withdrawn_certificates_are_excluded() {
        let withdrawn = BTreeSet::from(["sense-0.17".parse().unwrap()]);
        let hand = rules("bench", Role::Hand, &withdrawn, false);
        let names = names_of(&hand, "sense-0");
        assert_eq!(names.len(), MAX_SERIAL as usize - 1);
        assert!(!names.contains(&"sense-0.17") && names.contains(&"sense-0.18"));
        let member = rules("bench", Role::Member, &withdrawn, false);
        assert_eq!(member["subjects"].as_array().unwrap().len(), 1);
        assert_eq!(names_of(&member, "hand")[0], "hand.1");
    }

    #[test]
    fn peers_without_tls_have_all_rights() {
        let mut config = LinkConfig {
            rig: "bench".into(),
            listen: vec!["tcp/127.0.0.1:7447".into()],
            certificates: Some("nowhere".into()),
            ..LinkConfig::default()
        };
        assert_eq!(access_control(&config, Role::Hand).unwrap(), None);
        config.listen.push("tls/10.0.0.5:7447".into());
        let both = access_control(&config, Role::Hand).unwrap().unwrap();
        assert_eq!(permitted(&both, "open-writes"), ["feeler/bench/**"]);
        config.listen.remove(0);
        let tls = access_control(&config, Role::Hand).unwrap().unwrap();
        assert!(!tls.to_string().contains("open"), "{tls}");
    }
}
