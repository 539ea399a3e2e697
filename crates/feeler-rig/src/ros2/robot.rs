//! Serves a robot's joints and fingertips.

use super::fingertip::Fingertip;
use super::graph::{GraphOptions, check_ports, config};
use super::joints::RobotRig;
use crate::session::RigSession;
use feeler::hand::FingerGeometry;
use feeler_console::{CommandError, Outcome, Warnings, watch_for_interrupt};
use feeler_lab::config::RosConfig;
use feeler_lab::experiment::fingers_at_home;
use feeler_lab::experiment::rigs::linked::rig_config;
use feeler_link::programs::{ProgramError, RigProgram, RigSpeed};
use feeler_link::security::Right;
use feeler_ros2::{
    GraphClock, GripperConfig, Node, RosCommands, RosHand, RosHandConfig, RosHandError, SensorAge,
};
use std::io::Write;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

/// Default name of the node.
const NODE_NAME: &str = "feeler_rig";
/// Interval between checks for missing joint states.
const LOOK: Duration = Duration::from_millis(20);

/// Serves the robot named in the table `[ros2]` of the session's experiment to the hand, until Ctrl-C. The age of data is judged by
/// the time of day or, if `use_sim_time`, by the topic `/clock`, which advances by `rig_speed` seconds per second.
///
/// # Errors
/// If the experiment names no robot, the speed is [`RigSpeed::Lockstep`], or the node or the network fails.
pub fn serve_robot(
    session: &RigSession,
    graph: &GraphOptions,
    use_sim_time: bool,
    rig_speed: RigSpeed,
    out: &mut dyn Write,
) -> Result<Outcome, CommandError> {
    let RigSpeed::Times(speed) = rig_speed else {
        return Err("--speed max: a robot does not wait for the hand; expected a number".into());
    };
    let experiment = &session.experiment;
    let robot = experiment.config.ros2.as_ref().ok_or_else(|| {
        let name = &experiment.config.name;
        format!(
            "experiment {name}: expected a table [ros2] that names the robot's joints and topics (see docs/ros2.md)"
        )
    })?;
    let graph = config(graph, NODE_NAME)?;
    check_ports(&graph, &session.link.endpoints())?;
    let name = &session.name;
    let network = session.connect(&[Right::Rig])?;
    let interrupted = watch_for_interrupt()?;
    let warnings = Warnings::on_stderr();
    let mut node = Node::open(graph)?;
    let clock = match use_sim_time {
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
        let network = || session.connect(&[Right::Sense(finger)]);
        let fingertip = Fingertip::new(&mut node, experiment, finger, config, &age, network)?;
        fingertips.extend(fingertip);
    }
    writeln!(
        out,
        "serving the robot at {} as the rig of {name}, as the ROS 2 node {}; press Ctrl-C to stop",
        robot.joint_states,
        node.name()
    )?;
    out.flush()?;
    let (geometries, _) = fingers_at_home(&experiment.config)?;
    let hand = robot_hand(&mut node, robot, &geometries, age)?;
    let rig = RobotRig::new(hand, warnings.clone());
    let mut program = RigProgram::new(rig, &rig_config(experiment, rig_speed)?, network)?;
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

/// Creates the [`RosHand`] that drives the robot.
fn robot_hand(
    node: &mut Node,
    robot: &RosConfig,
    geometries: &[FingerGeometry],
    age: SensorAge,
) -> Result<RosHand, RosHandError> {
    let fingers = robot.finger.iter();
    let commands = match (&robot.gripper, geometries.first()) {
        (Some(gripper), Some(first)) => RosCommands::Gripper(GripperConfig {
            action: gripper.action.clone(),
            max_effort: gripper.max_effort,
            interval: gripper.interval,
            range: (first.joint_lower()[0], first.joint_upper()[0]),
            speed: first.joint_speed_limit()[0],
        }),
        _ => RosCommands::Velocities(robot.commands.clone()),
    };
    let config = RosHandConfig {
        joints: fingers.map(|finger| finger.joints.clone()).collect(),
        joint_states: robot.joint_states.clone(),
        commands,
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
