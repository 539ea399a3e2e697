//! A gripper as a hand of two fingers: joint states are received, and goals of its action sent.

#![cfg(feature = "zenoh")]

use crate::ports::unused_endpoint;
use assert_no_alloc::assert_no_alloc;
use feeler::hand::{Hand, HandCommand, HandState, JointVector};
use feeler_record::ros::{JointState, Time};
use feeler_ros2::message::{SendGripperGoal, SendGripperGoalRequest, SendGripperGoalResponse};
use feeler_ros2::{
    GraphClock, GripperConfig, Node, NodeConfig, NodeName, Publisher, Qos, RosCommands, RosHand,
    RosHandConfig, RosHandError,
};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::thread::sleep;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Position of the gripper, which does not move (m), and its speed limit (m/s).
const POSITION: f64 = 0.02;
const SPEED: f64 = 0.1;

/// Gripper that stores its goals.
struct Gripper {
    states: Publisher<JointState>,
    goals: Receiver<SendGripperGoalRequest>,
    /// `true` if goals are rejected.
    rejects: Arc<AtomicBool>,
    _node: Node,
}

fn node(name: &str, connect: Vec<String>, listen: Vec<String>) -> Node {
    let name = NodeName::new(0, "/", name).expect("a name");
    let config = NodeConfig {
        name,
        connect,
        listen,
    };
    Node::open(config).expect("a node")
}

impl Gripper {
    fn at(endpoint: &str) -> Self {
        let mut node = node("gripper", vec![endpoint.into()], Vec::new());
        let (sender, goals) = channel();
        let rejects = Arc::new(AtomicBool::new(false));
        let own = rejects.clone();
        let answer = move |goal| {
            // The test may be over.
            let _ = sender.send(goal);
            SendGripperGoalResponse {
                accepted: !own.load(Ordering::Relaxed),
                ..SendGripperGoalResponse::default()
            }
        };
        node.serve::<SendGripperGoal>("/gripper/_action/send_goal", answer)
            .expect("a service");
        Self {
            states: node
                .publish("/joint_states", Qos::DEFAULT)
                .expect("a topic"),
            goals,
            rejects,
            _node: node,
        }
    }

    /// Publishes joint states with the current time.
    fn say(&mut self) {
        let now = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .expect("a time");
        let mut message = JointState {
            name: vec!["wrist".into(), "jaw".into()],
            position: vec![1.0, POSITION],
            velocity: vec![0.0; 2],
            ..JointState::default()
        };
        message.header.stamp = Time::of(now.as_secs_f64()).expect("a time");
        self.states.publish(&message).expect("a message");
    }

    /// Goals so far.
    fn taken(&self) -> Vec<SendGripperGoalRequest> {
        self.goals.try_iter().collect()
    }
}

/// Hand of a gripper with a limit of `most_age` (s) on joint states, after the first ones arrived.
fn hand_and_gripper(most_age: f64) -> (RosHand, Gripper, Node) {
    let endpoint = unused_endpoint();
    let mut node = node("hand", Vec::new(), vec![endpoint.clone()]);
    let mut hand =
        RosHand::new(&mut node, config(most_age, 1), GraphClock::TimeOfDay).expect("a hand");
    let mut gripper = Gripper::at(&endpoint);
    let mut state = HandState::zero(2);
    while hand.read(&mut state).is_err() {
        gripper.say();
        sleep(Duration::from_millis(5));
    }
    // Zenoh finds the action's server at some time.
    while gripper.taken().is_empty() {
        gripper.say();
        let _ = hand.command(&closing(1e-3));
        sleep(Duration::from_millis(5));
    }
    let _ = hand.command(&HandCommand::stop(2));
    (hand, gripper, node)
}

/// Configuration for two fingers of this number of joints.
fn config(most_age: f64, joints: usize) -> RosHandConfig {
    RosHandConfig {
        joints: vec![vec!["jaw".into(); joints]; 2],
        joint_states: "/joint_states".into(),
        commands: RosCommands::Gripper(GripperConfig {
            action: "/gripper".into(),
            max_effort: Some(12.0),
            interval: 0.001,
            range: (0.0, 0.03),
            speed: SPEED,
        }),
        most_age,
        speed: 1.0,
    }
}

/// Both fingers close at a mean of `speed` (m/s).
fn closing(speed: f64) -> HandCommand {
    let mut command = HandCommand::stop(2);
    command.relay(&[0.5, 1.5].map(|share| JointVector::splat(1, share * speed)));
    command
}

#[test]
fn goals_follow_the_velocity_on_a_leash_without_allocation() {
    let (mut hand, mut gripper, _node) = hand_and_gripper(0.05);
    let mut state = HandState::zero(2);
    let mut goals = Vec::new();
    // On a busy computer, joint states may be stale for a while.
    while goals.len() < 100 {
        gripper.say();
        let command = closing(0.05);
        let _ = assert_no_alloc(|| hand.read(&mut state).and_then(|()| hand.command(&command)));
        sleep(Duration::from_millis(2));
        goals.extend(gripper.taken());
    }
    let positions: Vec<_> = goals.iter().map(|goal| goal.command.position[0]).collect();
    assert!(positions.is_sorted(), "{positions:?}");
    // The gripper stands, so the goal reaches the end of its leash: the speed limit in the maximum age.
    let leash = SPEED * 0.05;
    let most = positions.last().expect("a goal") - POSITION;
    assert!((0.0..=leash + 1e-12).contains(&most), "{most} m");
    for goal in &goals {
        assert_eq!(goal.command.name, ["jaw"]);
        assert_eq!(goal.command.effort, [12.0]);
        assert_eq!(goal.command.position.len(), 1);
    }
    let mut ids: Vec<_> = goals.iter().map(|goal| goal.goal_id).collect();
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), goals.len());
}

#[test]
fn stale_joint_states_and_stops_send_no_goals_and_rejections_are_errors() {
    let (mut hand, mut gripper, _node) = hand_and_gripper(0.5);
    // A stop: the gripper keeps its last goal. One may still be under way.
    sleep(Duration::from_millis(100));
    gripper.taken();
    for _ in 0..20 {
        gripper.say();
        let _ = hand.command(&HandCommand::stop(2));
        sleep(Duration::from_millis(2));
    }
    assert_eq!(gripper.taken(), []);
    sleep(Duration::from_millis(600));
    let stale = hand.command(&closing(0.05)).expect_err("stale").to_string();
    assert!(stale.contains("/joint_states: data"), "{stale}");
    sleep(Duration::from_millis(50));
    assert_eq!(gripper.taken(), []);
    gripper.rejects.store(true, Ordering::Relaxed);
    let rejected = loop {
        gripper.say();
        match hand.command(&closing(0.05)) {
            Err(error) if error.to_string().contains("rejected") => break error.to_string(),
            _ => sleep(Duration::from_millis(5)),
        }
    };
    assert!(
        rejected.starts_with("/gripper: the gripper rejected a goal at 0.0"),
        "{rejected}"
    );
}

#[test]
fn a_gripper_without_a_server_and_fingers_with_several_joints_are_refused() {
    let (mut hand, gripper, mut node) = hand_and_gripper(600.0);
    let several = RosHand::new(&mut node, config(1.0, 2), GraphClock::TimeOfDay);
    let error = several.err().expect("an error");
    assert!(
        matches!(
            error,
            RosHandError::GripperJoints {
                finger: 0,
                actual: 2
            }
        ),
        "{error}"
    );
    // The gripper's node ends, and with it the action's server.
    drop(gripper);
    let missing = loop {
        match hand.command(&closing(0.05)) {
            Err(error) => break error.to_string(),
            Ok(()) => sleep(Duration::from_millis(5)),
        }
    };
    assert!(
        missing.contains("ParallelGripperCommand_SendGoal: "),
        "{missing}"
    );
}
