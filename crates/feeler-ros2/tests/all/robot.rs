//! A robot as a hand: joint states are received, and velocities sent.

#![cfg(feature = "zenoh")]

use crate::ports::unused_endpoint;
use assert_no_alloc::assert_no_alloc;
use feeler::hand::{Hand, HandCommand, HandState, JointVector};
use feeler_record::ros::{JointState, Time};
use feeler_record::wire::cdr;
use feeler_ros2::message::Float64MultiArray;
use feeler_ros2::{
    GraphClock, Node, NodeConfig, NodeName, Publisher, Qos, RosCommands, RosHand, RosHandConfig,
    Subscription,
};
use std::sync::mpsc::{Receiver, channel};
use std::thread::sleep;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

const NAMES: [&str; 3] = ["a", "b", "c"];

/// Robot that does not move and stores the commands it receives.
struct Robot {
    states: Publisher<JointState>,
    told: Receiver<Vec<f64>>,
    _commands: Subscription,
    _node: Node,
}

impl Robot {
    fn at(endpoint: &str) -> Self {
        let mut node = Node::open(NodeConfig {
            name: NodeName::new(0, "/", "robot").expect("a name"),
            connect: vec![endpoint.into()],
            listen: Vec::new(),
        })
        .expect("a node");
        let (sender, told) = channel();
        let heard = move |bytes: &[u8], _| {
            let message: Float64MultiArray = cdr::decode(bytes).expect("velocities");
            // The test may be over.
            let _ = sender.send(message.data);
        };
        Self {
            states: node
                .publish("/joint_states", Qos::DEFAULT)
                .expect("a topic"),
            _commands: node
                .subscribe::<Float64MultiArray>("/commands", Qos::DEFAULT, heard)
                .expect("a topic"),
            told,
            _node: node,
        }
    }

    /// Publishes joint states with the current time.
    fn say(&mut self) {
        let now = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .expect("a time");
        let mut message = JointState {
            name: NAMES.map(String::from).to_vec(),
            position: vec![0.1, 0.2, 0.3],
            velocity: vec![0.0; 3],
            ..JointState::default()
        };
        message.header.stamp = Time::of(now.as_secs_f64()).expect("a time");
        self.states.publish(&message).expect("a message");
    }
}

/// Hand with a limit of `most_age` (s) on joint states, its robot and node, after the first joint states arrived.
fn hand_and_robot(most_age: f64) -> (RosHand, Robot, Node) {
    let endpoint = unused_endpoint();
    let mut node = Node::open(NodeConfig {
        name: NodeName::new(0, "/", "hand").expect("a name"),
        connect: Vec::new(),
        listen: vec![endpoint.clone()],
    })
    .expect("a node");
    let config = RosHandConfig {
        joints: vec![NAMES.map(String::from).to_vec()],
        joint_states: "/joint_states".into(),
        commands: RosCommands::Velocities("/commands".into()),
        most_age,
        speed: 1.0,
    };
    let mut hand = RosHand::new(&mut node, config, GraphClock::TimeOfDay).expect("a hand");
    let mut robot = Robot::at(&endpoint);
    let mut state = HandState::zero(1);
    while hand.read(&mut state).is_err() {
        robot.say();
        sleep(Duration::from_millis(5));
    }
    (hand, robot, node)
}

fn command(velocity: JointVector) -> HandCommand {
    let mut command = HandCommand::stop(1);
    command.relay(&[velocity]);
    command
}

#[test]
fn reading_and_commanding_allocate_nothing() {
    let (mut hand, mut robot, _node) = hand_and_robot(600.0);
    let (mut state, command) = (HandState::zero(1), command([1.0, 0.0, 0.0].into()));
    for _ in 0..200 {
        robot.say();
        let done = assert_no_alloc(|| {
            let read = hand.read(&mut state);
            read.and_then(|()| hand.command(&command))
        });
        done.expect("a period");
    }
    assert_eq!(robot.told.recv().expect("velocities"), [1.0, 0.0, 0.0]);
}

#[test]
fn zeros_are_sent_if_the_control_loop_hangs_and_on_drop() {
    let (mut hand, mut robot, _node) = hand_and_robot(1.0);
    let moving = command([1.0, 2.0, 3.0].into());
    // Repeat until the robot, which has just joined, receives a command.
    let moved = loop {
        robot.say();
        // On a busy computer, joint states may be stale.
        let _ = hand.command(&moving);
        match robot.told.recv_timeout(Duration::from_millis(50)) {
            Ok(told) if told != [0.0; 3] => break told,
            _ => {}
        }
    };
    assert_eq!(moved, [1.0, 2.0, 3.0]);
    // Without further commands the robot is stopped, on a busy computer at some later time.
    let last = robot.told.iter().find(|told| *told != moved);
    assert_eq!(last.expect("an end"), [0.0; 3]);
    // Commands based on joint states that have become too old are rejected.
    sleep(Duration::from_millis(1100));
    let stale = hand.command(&moving).expect_err("stale").to_string();
    assert!(stale.contains("/joint_states: data"), "{stale}");
    drop(hand);
    assert!(robot.told.try_iter().all(|told| told == [0.0; 3]));
}

#[test]
fn dropping_a_moving_hand_stops_the_robot() {
    let (mut hand, mut robot, node) = hand_and_robot(600.0);
    let moving = command(JointVector::splat(3, 1.0));
    while robot.told.recv_timeout(Duration::from_millis(50)).is_err() {
        hand.command(&moving).expect("a command");
    }
    drop((hand, node));
    let mut told = [1.0; 3].to_vec();
    while told != [0.0; 3] {
        told = robot.told.recv().expect("zeros");
    }
    robot.say();
}
