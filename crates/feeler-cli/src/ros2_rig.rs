//! The `feeler ros2-rig` subcommand: a robot in a ROS 2 graph as the rig of an experiment.

#![cfg_attr(
    not(feature = "ros2"),
    allow(dead_code, reason = "this program has no ROS 2")
)]

use super::ros2::GraphArguments;
use crate::link::{ExperimentArguments, LinkArguments};
use feeler_link::programs::RigSpeed;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Experiment whose table [ros2] names the robot's joints and topics: a file, or the name of a built-in one.
    experiment: String,
    /// Measure the age of data by the /clock of a simulation instead of the time of day.
    #[arg(long)]
    use_sim_time: bool,
    /// Speed of the simulation's clock relative to real time, the same as the hand's.
    #[arg(long, default_value = "1", requires = "use_sim_time")]
    speed: RigSpeed,
    #[command(flatten)]
    graph: GraphArguments,
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    link: LinkArguments,
}

/// Serves the robot until Ctrl-C.
#[cfg(feature = "ros2")]
pub fn ros2_rig(
    arguments: &Arguments,
    out: &mut dyn std::io::Write,
) -> Result<crate::Outcome, crate::CommandError> {
    let session = arguments
        .values
        .session(&arguments.experiment, &arguments.link)?;
    let graph = (&arguments.graph).into();
    feeler_rig::serve_robot(
        &session,
        &graph,
        arguments.use_sim_time,
        arguments.speed,
        out,
    )
}

/// Returns an error: this build has no ROS 2.
#[cfg(not(feature = "ros2"))]
pub fn ros2_rig(
    arguments: &Arguments,
    _: &mut dyn std::io::Write,
) -> Result<crate::Outcome, crate::CommandError> {
    let experiment = &arguments.experiment;
    Err(crate::ros2::not_built(&format!("ros2-rig {experiment}")))
}
