//! ROS 2 node configured by the command line.

use feeler_console::{CommandError, Warnings};
use feeler_lab::config::Experiment;
use feeler_ros2::parameter::{Meaning, Parameters};
use feeler_ros2::{NODE_ENDPOINT, Node, NodeConfig, NodeName, ROUTER_ENDPOINT, serve_parameters};
use serde_json::json;
use std::time::{Duration, Instant};

/// Environment variable of the domain.
const DOMAIN_VARIABLE: &str = "ROS_DOMAIN_ID";

/// Reason given when setting a parameter is rejected.
const FIXED: &str = "read-only: an experiment's values are checked together when its programs start; restart them with --set";

/// Time without any peer after which a warning is printed.
const PATIENCE: Duration = Duration::from_secs(2);

/// Default name of a hand's node.
pub const NODE_NAME: &str = "feeler";

/// Returns the ROS domain given by the environment, by default 0.
pub fn domain_of_environment() -> Result<u32, CommandError> {
    match std::env::var(DOMAIN_VARIABLE) {
        Ok(text) if !text.is_empty() => text.parse().map_err(|_| {
            format!("{DOMAIN_VARIABLE}: expected a number from 0 to 232, got {text:?}").into()
        }),
        _ => Ok(0),
    }
}

/// Connection and name of a ROS 2 node.
#[derive(Debug, Clone, Default)]
pub struct GraphOptions {
    /// Endpoints of the router or of other nodes; if empty, the default router of this computer.
    pub connect: Vec<String>,
    /// Endpoints to listen on; if empty, any free port of this computer.
    pub listen: Vec<String>,
    /// ROS domain, 0 to 232; if `None`, the environment variable `ROS_DOMAIN_ID`, else 0.
    pub domain: Option<u32>,
    /// Namespace of the node and its topics, such as `/left`.
    pub namespace: String,
    /// Name of the node, or `None` for the default.
    pub name: Option<String>,
}

/// Configuration of a node with the default name `name`.
pub fn config(options: &GraphOptions, name: &str) -> Result<NodeConfig, CommandError> {
    let domain = options.domain.map_or_else(domain_of_environment, Ok)?;
    let name = options.name.as_deref().unwrap_or(name);
    let given = |places: &[String], usual: &str| match places {
        [] => vec![usual.to_string()],
        places => places.to_vec(),
    };
    Ok(NodeConfig {
        name: NodeName::new(domain, &options.namespace, name)?,
        connect: given(&options.connect, ROUTER_ENDPOINT),
        listen: given(&options.listen, NODE_ENDPOINT),
    })
}

/// Rejects a ROS 2 router at one of `hands`, the endpoints of the rig's hand. Both have the same default port, and
/// connecting to the wrong one yields no data.
pub fn check_ports(graph: &NodeConfig, hands: &[String]) -> Result<(), CommandError> {
    let place = |endpoint: &str| {
        let (protocol, address) = endpoint.split_once('/')?;
        let (host, port) = address.rsplit_once(':')?;
        let host = match host {
            "localhost" | "127.0.0.1" | "[::1]" | "[::]" | "0.0.0.0" => "localhost",
            other => other,
        };
        // TLS endpoints of the link use TCP, too.
        let protocol = protocol.replace("tls", "tcp");
        Some((
            protocol,
            host.to_string(),
            port.split('#').next()?.to_string(),
        ))
    };
    let is_hand = |router: &&String| {
        hands
            .iter()
            .any(|hand| place(hand).is_some_and(|at| place(router) == Some(at)))
    };
    match graph.connect.iter().find(is_hand) {
        None => Ok(()),
        Some(endpoint) => Err(format!(
            "the rig's hand and the ROS 2 router cannot both be at {endpoint}; leave that port to ROS 2, start the hand with --listen tcp/127.0.0.1:7557, and this and all other programs of the rig with --connect tcp/127.0.0.1:7557"
        )
        .into()),
    }
}

/// Warns while a node has no peers, e.g. because no router is running.
pub struct PeerWatch {
    places: String,
    since: Instant,
    is_told: bool,
    warnings: Warnings,
}

impl PeerWatch {
    /// Creates a watch that warns while a node connected as in `graph` has no peers.
    pub fn new(graph: &NodeConfig) -> Self {
        Self {
            places: graph.connect.join(", "),
            since: Instant::now(),
            is_told: false,
            warnings: Warnings::on_stderr(),
        }
    }

    /// Checks whether `node` has peers, and prints a message on changes.
    pub fn look(&mut self, node: &Node) {
        match (node.has_company(), self.is_told) {
            (false, false) if self.since.elapsed() >= PATIENCE => {
                let line = format!(
                    "ROS 2: nothing found at {}; waiting for a router (ros2 run rmw_zenoh_cpp rmw_zenohd) or a node there",
                    self.places
                );
                self.warnings.queue(&line);
                self.is_told = true;
            }
            (true, true) => {
                self.warnings.queue("ROS 2: connected");
                self.is_told = false;
            }
            (true, false) => self.since = Instant::now(),
            (false, _) => {}
        }
    }
}

/// Serves all values of the experiment's tables for control and task, including law and thresholds, as parameters.
pub fn serve_settings(
    node: &mut Node,
    experiment: &Experiment,
    use_sim_time: bool,
) -> Result<(), CommandError> {
    let (config, described) = (&experiment.config, experiment.described());
    let mut parameters = Parameters::new(FIXED);
    parameters.add("experiment", &json!(config.name));
    parameters.add("control", &serde_json::to_value(&config.control)?);
    parameters.add("task", &serde_json::to_value(&config.task)?);
    parameters.add("use_sim_time", &json!(use_sim_time));
    parameters.describe_by(|name| {
        let described = described.get(name)?;
        Some(Meaning {
            description: described.comment.clone(),
            expected: described.expected.clone(),
            range: described.range,
        })
    });
    Ok(serve_parameters(node, parameters)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hand_and_router_must_not_share_an_endpoint() {
        let check = |router: &str, hand: &str| {
            let graph = NodeConfig {
                name: NodeName::new(0, "/", "a").expect("a name"),
                connect: vec![router.into()],
                listen: Vec::new(),
            };
            check_ports(&graph, &[hand.into()]).is_ok()
        };
        assert!(!check("tcp/localhost:7447", "tcp/127.0.0.1:7447"));
        assert!(!check("tcp/10.0.0.5:7447", "tls/10.0.0.5:7447"));
        assert!(check("tcp/localhost:7447", "tcp/127.0.0.1:7557"));
        assert!(check("tcp/10.0.0.5:7447", "tcp/10.0.0.6:7447"));
    }
}
