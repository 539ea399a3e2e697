//! Serves a robot's joints and fingertips.

use super::Arguments;
use super::fingertip::Fingertip;
use super::joints::RobotRig;
use crate::interrupt::watch_for_interrupt;
use crate::ros2::graph::{check_ports, config};
use crate::warnings::Warnings;
use crate::{CommandError, Outcome};
use feeler_lab::config::{Experiment, RosConfig};
use feeler_lab::experiment::linked::rig_config;
use feeler_link::programs::{ProgramError, RigProgram, RigSpeed};
use feeler_link::right::Right;
use feeler_ros2::freshness::GraphClock;
use feeler_ros2::node::Node;
use feeler_ros2::ros_hand::{RosHand, RosHandConfig, RosHandError};
use feeler_ros2::ros_sensor::SensorAge;
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Default name of the node.
const NODE_NAME: &str = "feeler_rig";
/// Interval of checks for missing joint states.
const LOOK: Duration = Duration::from_millis(20);

/// Serves the experiment's robot until Ctrl-C.
pub fn ros2_rig(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let RigSpeed::Times(speed) = arguments.speed else {
        return Err("--speed max: a robot does not wait for the hand; expected a number".into());
    };
    let experiment = Experiment::load(&arguments.experiment, &arguments.values.settings())?;
    let robot = experiment.config.ros2.as_ref().ok_or_else(|| {
        let name = &experiment.config.name;
        format!(
            "experiment {name}: expected a table [ros2] that names the robot's joints and topics (see docs/ros2.md)"
        )
    })?;
    let graph = config(&arguments.graph, NODE_NAME)?;
    check_ports(&graph, &arguments.link.endpoints())?;
    let name = arguments.values.rig(&experiment);
    let network = arguments.link.with_right(&[Right::Rig])?.connect(&name)?;
    let interrupted = watch_for_interrupt()?;
    let warnings = Warnings::on_stderr();
    let mut node = Node::open(graph)?;
    let clock = match arguments.use_sim_time {
        true => GraphClock::simulated(&mut node)?,
        false => GraphClock::TimeOfDay,
    };
    let control = &experiment.config.control;
    let age = SensorAge {
        clock,
        most: control.stale_periods * control.period,
        speed,
    };
    let mut fingertips = Vec::new();
    for (finger, config) in robot.finger.iter().enumerate() {
        let network = || {
            let link = arguments.link.with_right(&[Right::Sense(finger)])?;
            link.connect(&name)
        };
        let of = (&experiment, finger);
        fingertips.extend(Fingertip::new(&mut node, of, config, &age, network)?);
    }
    writeln!(
        out,
        "serving the robot at {} as the rig of {name}, as the ROS 2 node {}; press Ctrl-C to stop",
        robot.joint_states,
        node.name()
    )?;
    out.flush()?;
    let rig = RobotRig::new(robot_hand(&mut node, robot, age)?, warnings.clone());
    let mut program = RigProgram::new(rig, &rig_config(&experiment, arguments.speed)?, network)?;
    program.set_warn(warnings.warn());
    thread::scope(|scope| {
        let mut sensing = Vec::new();
        for fingertip in &mut fingertips {
            fingertip.set_warn(warnings.warn());
            let interrupted = &interrupted;
            sensing.push(scope.spawn(move || {
                let ended = fingertip.run(interrupted);
                // If one of them ends, all end.
                interrupted.store(true, Ordering::Relaxed);
                ended
            }));
        }
        let served = serve_joints(&mut program, &interrupted);
        interrupted.store(true, Ordering::Relaxed);
        let ended = sensing.into_iter().map(|thread| {
            let ended = thread.join();
            ended.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        });
        ended.fold(served, Result::and)
    })?;
    writeln!(out, "{}", program.report())?;
    Ok(Outcome::Done)
}

/// Creates the hand of the robot.
fn robot_hand(node: &mut Node, robot: &RosConfig, age: SensorAge) -> Result<RosHand, RosHandError> {
    let fingers = robot.finger.iter();
    let config = RosHandConfig {
        joints: fingers.map(|finger| finger.joints.clone()).collect(),
        joint_states: robot.joint_states.clone(),
        commands: robot.commands.clone(),
        most_age: age.most,
        speed: age.speed,
    };
    RosHand::new(node, config, age.clock)
}

/// Serves the joints until `interrupted` is set. While joint states are missing, the robot is commanded to hold still
/// and nothing is published, so that the hand stops too; both resume when joint states return.
fn serve_joints(
    program: &mut RigProgram<RobotRig>,
    interrupted: &AtomicBool,
) -> Result<(), ProgramError> {
    while !interrupted.load(Ordering::Relaxed) {
        match program.run(interrupted) {
            Err(ProgramError::Hand(_)) => thread::sleep(LOOK),
            ended => return ended,
        }
    }
    Ok(())
}
