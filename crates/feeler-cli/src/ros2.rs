//! The `feeler ros2` subcommand: a running rig or a recording as a node in a ROS 2 graph over Zenoh.

#![cfg_attr(
    not(feature = "ros2"),
    allow(dead_code, reason = "this program has no ROS 2")
)]

use super::link::{ExperimentArguments, LinkArguments};
use super::{CommandError, Outcome};
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment of a networked rig (a file, or the name of a built-in one), or a recording (a run's folder, or
    /// FILE.mcap).
    ///
    /// A folder or a name that ends in .mcap is replayed in real time; anything else is a rig.
    what: String,
    /// Speed of the replay relative to real time.
    #[arg(long, value_name = "FACTOR")]
    speed: Option<f64>,
    /// Stamp messages with the time of the rig or recording, and publish it as /clock, instead of using the time of
    /// day.
    #[arg(long)]
    use_sim_time: bool,
    #[command(flatten)]
    graph: GraphArguments,
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    link: LinkArguments,
}

/// Arguments of the node.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "ROS 2")]
pub struct GraphArguments {
    /// Endpoint of the ROS 2 router (rmw_zenohd) or of another node; retried until available [default:
    /// tcp/localhost:7447]
    #[arg(long, value_name = "ENDPOINT")]
    ros_connect: Vec<String>,
    /// Endpoint at which to listen for other nodes [default: tcp/localhost:0, any free port]
    #[arg(long, value_name = "ENDPOINT")]
    ros_listen: Vec<String>,
    /// ROS domain, 0 to 232 [default: ROS_DOMAIN_ID, otherwise 0]
    #[arg(long, value_name = "NUMBER")]
    domain_id: Option<u32>,
    /// Namespace of the node and its topics, e.g. /left.
    #[arg(long, default_value = "/")]
    namespace: String,
    /// Name of the node [default: feeler, for `feeler ros2-rig` feeler_rig]
    #[arg(long, value_name = "NAME")]
    node_name: Option<String>,
}

/// Publishes a rig until Ctrl-C, or a recording until its end.
#[cfg(feature = "ros2")]
pub fn ros2(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    use feeler_report::run::RECORDING;
    use std::path::Path;
    let path = Path::new(&arguments.what);
    let is_folder = path.is_dir();
    if !is_folder && path.extension().is_none_or(|extension| extension != "mcap") {
        if arguments.speed.is_some() {
            return Err(
                format!("--speed requires a recording; {} is a rig", arguments.what).into(),
            );
        }
        let session = arguments.values.session(&arguments.what, &arguments.link)?;
        let graph = (&arguments.graph).into();
        return feeler_rig::publish_rig(&session, &graph, arguments.use_sim_time, out);
    }
    if let Some(option) = arguments.values.given().or(arguments.link.given()) {
        let what = path.display();
        return Err(format!("{option} requires a rig; {what} is a recording").into());
    }
    let recording = match is_folder {
        true => path.join(RECORDING),
        false => path.to_path_buf(),
    };
    let (graph, speed) = ((&arguments.graph).into(), arguments.speed.unwrap_or(1.0));
    feeler_rig::publish_recording(&recording, &graph, arguments.use_sim_time, speed, out)
}

/// Returns an error: this build has no ROS 2.
#[cfg(not(feature = "ros2"))]
pub fn ros2(arguments: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    Err(not_built(&format!("ros2 {}", arguments.what)))
}

#[cfg(feature = "ros2")]
impl From<&GraphArguments> for feeler_rig::GraphOptions {
    fn from(arguments: &GraphArguments) -> Self {
        Self {
            connect: arguments.ros_connect.clone(),
            listen: arguments.ros_listen.clone(),
            domain: arguments.domain_id,
            namespace: arguments.namespace.clone(),
            name: arguments.node_name.clone(),
        }
    }
}

/// Returns the error that `what` requires ROS 2.
#[cfg(not(feature = "ros2"))]
pub fn not_built(what: &str) -> CommandError {
    format!("{what}: this program was built without ROS 2; build it with --features ros2").into()
}
