//! The screw task, with a hand that executes commands exactly and a wall as the object.

use super::hand::IdealHand;
use super::rig::{
    Analyzers, Config, config, controller, geometries, hand_at_home, pressed, screw, state,
};
use feeler::control::task::screw::ScrewConfig;
use feeler::control::{Controller, Phase, StopReason};
use feeler::hand::kinematics::fingertip_pose;
use feeler::hand::{Hand, HandCommand};
use glam::DVec3;

/// Distance of the wall from home (m) and its stiffness (N/m).
const WALL: f64 = 0.004;
const STIFFNESS: f64 = 2000.0;

struct Run {
    config: Config,
    screw: ScrewConfig,
    controller: Controller,
    analyzers: Analyzers,
    hand: IdealHand,
    commands: Vec<HandCommand>,
    periods: u64,
    /// Grasp force of finger 0 at the time of the decision (N).
    grasp_force: f64,
}

impl Run {
    fn new(mut config: Config) -> Self {
        let (controller, hand) = (controller(&config), hand_at_home(&config));
        Self {
            analyzers: Analyzers::new(&config),
            screw: screw(&mut config).clone(),
            grasp_force: 0.0,
            config,
            controller,
            hand,
            commands: Vec::new(),
            periods: 0,
        }
    }

    fn position(&self, finger: usize) -> DVec3 {
        let geometry = &geometries(&self.config)[finger];
        fingertip_pose(geometry, self.hand.joints[finger].position).0
    }

    /// Runs one control step with the wall `wall` metres from home.
    fn step(&mut self, wall: f64) {
        let fingers = self.screw.finger.iter().enumerate();
        let frames: Vec<_> = fingers
            .map(|(finger, path)| {
                let from_home = self.position(finger) - DVec3::from(path.home);
                let depth = from_home.dot(path.approach.into()) - wall;
                pressed(self.periods, self.hand.stamp, STIFFNESS * depth.max(0.0))
            })
            .collect();
        let mut command = HandCommand::stop(2);
        let touches = self.analyzers.touches(&frames);
        self.grasp_force = touches[0].flags.grasp_force;
        self.controller
            .decide(&touches, &state(&self.hand), &mut command);
        self.hand.command(&command).expect("an ideal hand");
        self.commands.push(command);
        self.periods += 1;
    }
}

#[test]
fn four_strokes_have_the_configured_phases_and_travel() {
    let mut run = Run::new(config());
    let (mut phases, mut start) = (vec![], [DVec3::ZERO; 2]);
    while run.periods < 3000 && run.controller.phase() != Phase::Done {
        run.step(WALL);
        let now = (run.controller.task().stroke(), run.controller.phase());
        if phases.last() == Some(&now) {
            continue;
        }
        phases.push(now);
        for (finger, start) in start.iter_mut().enumerate() {
            // Position of the finger at the time of the decision.
            let position = run.controller.poses()[finger].position;
            let path = &run.screw.finger[finger];
            match now.1 {
                Phase::Move => *start = position,
                Phase::Release => {
                    let travel = (position - *start).dot(path.stroke.into());
                    // It stops in the first period past the end, at most one period's motion further.
                    let most = run.screw.travel + 1.1 * run.screw.move_speed * 0.01;
                    assert!((run.screw.travel..most).contains(&travel), "{travel} m");
                }
                Phase::Search | Phase::Done => {
                    let off = (position - DVec3::from(path.home)).length();
                    let most = run.screw.home_tolerance + 1e-4;
                    assert!(off < most, "{off} m from home");
                }
                _ => {}
            }
        }
    }
    let stroke = |n| [Phase::Search, Phase::Move, Phase::Release, Phase::Return].map(|p| (n, p));
    let mut expected: Vec<_> = (1..=4).flat_map(stroke).collect();
    expected.push((4, Phase::Done));
    assert_eq!(phases, expected);
    assert_eq!(run.controller.stop_reason(), None);
    run.step(WALL);
    run.step(WALL);
    let last = run.commands.last().expect("a command");
    assert_eq!(
        *last,
        HandCommand::stop(2),
        "the hand must be at rest after the task"
    );
}

#[test]
fn each_finger_waits_for_the_other_to_grasp() {
    let mut run = Run::new(config());
    while run.grasp_force < run.screw.grasp_force {
        run.step(WALL);
        assert!(run.periods < 1000);
    }
    // Both touch at the same time. A finger whose wall is out of reach keeps the other waiting.
    let mut run = Run::new(config());
    run.screw.finger[1].home[0] -= 0.004;
    for _ in 0..150 {
        run.step(WALL);
    }
    let speed = |finger: usize| run.controller.fingers()[finger].velocity.length();
    assert_eq!(run.controller.phase(), Phase::Search);
    assert_eq!(speed(0), 0.0);
    assert_eq!(speed(1), run.screw.search_speed);
}

#[test]
fn a_search_without_contact_stops_the_hand_with_a_reason() {
    let mut run = Run::new(config());
    while run.periods < 1000 && run.controller.phase() == Phase::Search {
        run.step(1.0);
    }
    assert_eq!(run.controller.phase(), Phase::Stopped);
    let limit = run.screw.search_limit;
    let Some(&StopReason::NothingToGrasp { travel, .. }) = run.controller.stop_reason() else {
        panic!("{:?}", run.controller.stop_reason())
    };
    // Detected in the first period past the limit.
    assert!((limit..limit + 1e-4).contains(&travel), "{travel} m");
    let commands = run.commands.len();
    for _ in 0..10 {
        run.step(1.0);
    }
    let after = &run.commands[commands - 1..];
    assert!(after.iter().all(|c| *c == HandCommand::stop(2)));
}

#[test]
fn an_overload_stops_the_hand_permanently() {
    let mut config = config();
    config.control.limits.element_force = Some(5.0);
    let mut run = Run::new(config);
    while run.controller.phase() == Phase::Search {
        run.step(WALL);
        assert_eq!(run.controller.stop_reason(), None);
    }
    // The wall moves 5 mm closer, which adds 10 N.
    run.step(WALL - 0.005);
    let Some(&StopReason::Overload { finger, force, .. }) = run.controller.stop_reason() else {
        panic!("{:?}", run.controller.stop_reason())
    };
    assert_eq!(finger, 0);
    assert!(force > 10.0, "{force} N");
    assert!(!StopReason::is_recoverable(
        run.controller.stop_reason().unwrap()
    ));
    assert_eq!(run.commands.last(), Some(&HandCommand::stop(2)));
}
