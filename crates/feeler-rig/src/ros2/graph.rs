//! The node that the command line asks for.

use feeler_console::CommandError;
use feeler_console::Warnings;
use feeler_lab::config::Experiment;
use feeler_ros2::name::NodeName;
use feeler_ros2::node::{NODE_ENDPOINT, Node, NodeConfig, ROUTER_ENDPOINT};
use feeler_ros2::parameter::{Meaning, Parameters};
use feeler_ros2::parameter_server::serve_parameters;
use serde_json::json;
use std::time::{Duration, Instant};

/// Where a program learns in which domain it is.
const DOMAIN_VARIABLE: &str = "ROS_DOMAIN_ID";

/// Why no parameter can be set.
const FIXED: &str = "an experiment's values are checked together when its programs start, and stay as they are; start them with --set";

/// A node that is alone for so long is told of.
const PATIENCE: Duration = Duration::from_secs(2);

/// What the node of a hand is called where nobody says otherwise.
pub const NODE_NAME: &str = "feeler";

/// The domain that the environment names.
pub fn domain_of_environment() -> Result<u32, CommandError> {
    match std::env::var(DOMAIN_VARIABLE) {
        Ok(text) if !text.is_empty() => text.parse().map_err(|_| {
            format!("{DOMAIN_VARIABLE}: a number from 0 to 232 expected, found {text:?}").into()
        }),
        _ => Ok(0),
    }
}

/// How a node takes part in its graph.
#[derive(Debug, Clone, Default)]
pub struct GraphOptions {
    /// Endpoints of the router or of other nodes; if empty, the default router of this computer.
    pub connect: Vec<String>,
    /// Endpoints to listen on; if empty, any free port of this computer.
    pub listen: Vec<String>,
    /// Domain of the graph, 0 to 232; if `None`, the environment variable `ROS_DOMAIN_ID`, else 0.
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

/// Refuses a router of the graph where the hand of a rig is, at one of `hands`: both have the same port unless told otherwise, and whoever
/// takes the one for the other hears nothing.
pub fn check_ports(graph: &NodeConfig, hands: &[String]) -> Result<(), CommandError> {
    let place = |endpoint: &str| {
        let (protocol, address) = endpoint.split_once('/')?;
        let (host, port) = address.rsplit_once(':')?;
        let host = match host {
            "localhost" | "127.0.0.1" | "[::1]" | "[::]" | "0.0.0.0" => "localhost",
            other => other,
        };
        // The link's TLS is over TCP, too.
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
            "the hand of the rig and the router of ROS 2 cannot both be at {endpoint}; leave that port to ROS 2, start the hand with --listen tcp/127.0.0.1:7557, and its other programs and this one with --connect tcp/127.0.0.1:7557"
        )
        .into()),
    }
}

/// Tells a user whose node is alone, as where no router was started.
pub struct Company {
    places: String,
    since: Instant,
    is_told: bool,
    warnings: Warnings,
}

impl Company {
    /// Of a node that looks for others where `graph` says.
    pub fn new(graph: &NodeConfig) -> Self {
        Self {
            places: graph.connect.join(", "),
            since: Instant::now(),
            is_told: false,
            warnings: Warnings::on_stderr(),
        }
    }

    /// Looks whether `node` is alone, and says what is new of that.
    pub fn look(&mut self, node: &Node) {
        match (node.has_company(), self.is_told) {
            (false, false) if self.since.elapsed() >= PATIENCE => {
                let line = format!(
                    "ROS 2: nobody is at {}; waiting for a router there (ros2 run rmw_zenoh_cpp rmw_zenohd) or a node",
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

/// Serves law, thresholds and all other values of control and task as parameters.
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
    fn the_hand_and_the_router_are_told_apart() {
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
