//! `feeler ros2`: a running rig, or a recording, as a node in a ROS 2 graph over Zenoh.

use super::link::{ExperimentArguments, LinkArguments};
use super::{CommandError, Outcome};
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The experiment of a rig of several programs (a file, or the name of a built-in one), or a recording (the folder of a
    /// run, or a file *.mcap). What is a folder or ends with .mcap is replayed in real time; all else is a rig.
    what: String,
    /// Replay this many times as fast as it was.
    #[arg(long, value_name = "FACTOR")]
    speed: Option<f64>,
    /// Stamp by the rig's or the recording's own time, and publish that as /clock; without, stamps are of the time of day.
    #[arg(long)]
    use_sim_time: bool,
    #[command(flatten)]
    graph: GraphArguments,
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    link: LinkArguments,
}

/// How the node takes part in its graph.
#[derive(Debug, Clone, clap::Args)]
#[command(next_help_heading = "ROS 2")]
pub struct GraphArguments {
    /// Where the graph's router (rmw_zenohd) or another node is; tried until it is there [default: tcp/localhost:7447]
    #[arg(long, value_name = "ENDPOINT")]
    ros_connect: Vec<String>,
    /// Where to listen for other nodes [default: tcp/localhost:0, any port that is free]
    #[arg(long, value_name = "ENDPOINT")]
    ros_listen: Vec<String>,
    /// Domain of the graph, 0 to 232 [default: that of the environment's ROS_DOMAIN_ID, else 0]
    #[arg(long, value_name = "NUMBER")]
    domain_id: Option<u32>,
    /// Namespace of the node and of its topics, as in /left.
    #[arg(long, default_value = "/")]
    namespace: String,
    /// Name of the node [default: feeler, or feeler_rig of `feeler ros2-rig`]
    #[arg(long, value_name = "NAME")]
    node_name: Option<String>,
}

/// Publishes a rig or a recording until Ctrl-C, or until the recording ends.
#[cfg(feature = "ros2")]
pub fn ros2(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    use feeler_report::make::RECORDING;
    use std::path::Path;
    let path = Path::new(&arguments.what);
    let is_folder = path.is_dir();
    if !is_folder && path.extension().is_none_or(|extension| extension != "mcap") {
        if arguments.speed.is_some() {
            return Err(format!("--speed is for a recording; {} is a rig", arguments.what).into());
        }
        let session = arguments.values.session(&arguments.what, &arguments.link)?;
        let graph = (&arguments.graph).into();
        return feeler_rig::publish_rig(&session, &graph, arguments.use_sim_time, out);
    }
    if let Some(option) = arguments.values.given().or(arguments.link.given()) {
        let what = path.display();
        return Err(format!("{option} is for a rig; {what} is a recording").into());
    }
    let recording = match is_folder {
        true => path.join(RECORDING),
        false => path.to_path_buf(),
    };
    let (graph, speed) = ((&arguments.graph).into(), arguments.speed.unwrap_or(1.0));
    feeler_rig::publish_recording(&recording, &graph, arguments.use_sim_time, speed, out)
}

/// Says that there is no ROS 2.
#[cfg(not(feature = "ros2"))]
pub fn ros2(arguments: &Arguments, _: &mut dyn Write) -> Result<Outcome, CommandError> {
    let Arguments {
        what,
        speed: _,
        use_sim_time: _,
        graph,
        values: _,
        link: _,
    } = arguments;
    Err(graph.not_built(&format!("ros2 {what}")))
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

#[cfg(not(feature = "ros2"))]
impl GraphArguments {
    /// Says that there is no ROS 2 to do `what` in.
    pub fn not_built(&self, what: &str) -> CommandError {
        let Self {
            ros_connect: _,
            ros_listen: _,
            domain_id: _,
            namespace: _,
            node_name: _,
        } = self;
        format!("{what}: this program was built without ROS 2; build it with --features ros2")
            .into()
    }
}
