//! A ros2_control robot as a [`Hand`].

use super::peers::{Running, Words, pyzeros, script};
use crate::ports::unused_endpoint;
use feeler::hand::{Hand, HandCommand, HandState, JointVector};
use feeler_ros2::{GraphClock, Node, NodeConfig, NodeName, RosCommands, RosHand, RosHandConfig};
use serde_json::json;
use std::io::Write;
use std::process::Stdio;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Time after which a robot is considered hung, far longer than any needs on a busy computer.
const PATIENCE: Duration = Duration::from_secs(400);
/// Maximum age of joint states (s), long enough for a busy computer.
const MAX_AGE: f64 = 2.0;

/// Repeats `attempt` until it returns a value.
pub fn until<T>(what: &str, mut attempt: impl FnMut() -> Option<T>) -> T {
    let begin = Instant::now();
    loop {
        if let Some(found) = attempt() {
            return found;
        }
        assert!(begin.elapsed() < PATIENCE, "{what}");
        sleep(Duration::from_millis(5));
    }
}

#[test]
fn ros2_control_robot_works_as_a_hand() {
    let Some(python) = pyzeros() else { return };
    let endpoint = unused_endpoint();
    let mut node = Node::open(NodeConfig {
        name: NodeName::new(0, "/", "feeler_hand").expect("a name"),
        connect: Vec::new(),
        listen: vec![endpoint.clone()],
    })
    .expect("a node");
    let config = RosHandConfig {
        joints: vec![["first", "second", "third"].map(String::from).to_vec()],
        joint_states: "/joint_states".into(),
        commands: RosCommands::Velocities("/forward_velocity_controller/commands".into()),
        most_age: MAX_AGE,
        speed: 1.0,
    };
    let mut hand = RosHand::new(&mut node, config, GraphClock::TimeOfDay).expect("a hand");
    let mut state = HandState::zero(1);
    let nothing = hand
        .read(&mut state)
        .expect_err("no robot is there")
        .to_string();
    assert!(
        nothing.contains("/joint_states: no message received"),
        "{nothing}"
    );

    let robot = json!({
        "joints": ["first", "second", "third"], "home": [0.0, 0.0, 0.0], "speed": 1.0, "sim_time": false, "finger": null,
    });
    let robot = script(&python, "robot.py", &[&endpoint, &robot.to_string()])
        .stdin(Stdio::piped())
        .spawn();
    let mut robot = Running(robot.expect("the robot"));
    let mut words = Words::of(&mut robot);
    assert_eq!(words.next()["ready"], true);
    let mut orders = robot.0.stdin.take().expect("its input");
    until("joint states", || hand.read(&mut state).ok());

    // The joints follow the commanded velocities.
    let velocity = JointVector::from([0.5, -1.0, 2.0]);
    let mut command = HandCommand::stop(1);
    command.relay(&[velocity]);
    until("the joints move", || {
        // A busy computer makes joint states stale at times.
        hand.command(&command).ok()?;
        hand.read(&mut state).ok()?;
        (state.joints[0].velocity == velocity && state.joints[0].position[2] > 0.1).then_some(())
    });
    let ratio = state.joints[0].position / velocity;
    assert!((ratio - ratio[0]).abs().max_element() < 1e-9, "{ratio}");

    // Without joint states, reading fails, which stops the control loop.
    orders.write_all(b"silent\n").expect("an order");
    let stale = until("stale joint states", || hand.read(&mut state).err()).to_string();
    assert!(stale.starts_with("/joint_states: data"), "{stale}");

    // Commands based on stale states are refused, and zero velocities are sent.
    let refused = hand.command(&command).expect_err("stale").to_string();
    assert!(refused.starts_with("/joint_states: data"), "{refused}");

    // Stamps in the past or in the future are detected, too.
    for late in ["late 5", "late -5"] {
        orders
            .write_all(format!("{late}\n").as_bytes())
            .expect("an order");
        let words = if late.contains('-') {
            "ahead of the clock"
        } else {
            "by their stamp"
        };
        until(late, || {
            let error = hand.read(&mut state).err()?.to_string();
            error.contains(words).then_some(())
        });
    }
    orders.write_all(b"well\n").expect("an order");
    until("joint states again", || hand.read(&mut state).ok());

    // Dropping the hand stops the robot.
    drop(hand);
    sleep(Duration::from_millis(300));
    orders.write_all(b"end\n").expect("an order");
    let end = words.next();
    assert_eq!(end["last"], json!([0.0, 0.0, 0.0]), "{end}");
    assert!(end["moved"].as_u64() > Some(0), "{end}");
}
