//! A hand that follows the velocities of another program.

use super::rig::{Analyzers, Config, config, geometries, hand_at_home, layout, pressed, state};
use assert_no_alloc::assert_no_alloc;
use feeler::control::task::follow::{FollowTask, HandVelocities, Requests};
use feeler::control::{Controller, Phase, StopReason, TactileReading};
use feeler::hand::{Hand, HandCommand};

/// Time until a request expires (s): the tenth control step after its arrival is the first without it.
const LIFETIME: f64 = 0.095;

struct Following {
    config: Config,
    requests: Requests,
    controller: Controller,
    hand: super::hand::IdealHand,
    analyzers: Analyzers,
    steps: u64,
}

impl Following {
    fn new() -> Self {
        let config = config();
        let requests = Requests::default();
        let fingers = geometries(&config);
        let task = FollowTask::new(requests.clone(), fingers.clone(), LIFETIME);
        let layouts = vec![layout(); fingers.len()];
        let control = config.control.clone();
        let controller = Controller::with_task(control, Box::new(task), &fingers, &layouts);
        Self {
            hand: hand_at_home(&config),
            analyzers: Analyzers::new(&config),
            controller: controller.expect("a controller"),
            requests,
            config,
            steps: 0,
        }
    }

    /// Requests a velocity of joint 1 of finger 0 (rad/s).
    fn request(&self, velocity: f64) -> u64 {
        let mut velocities = HandVelocities::default();
        velocities[0] = [0.0, velocity, 0.0].into();
        self.requests.request(velocities)
    }

    /// Executes a control step, without allocating, and returns the velocity of joint 1 of finger 0 (rad/s).
    fn step(&mut self) -> f64 {
        self.steps += 1;
        let state = state(&self.hand);
        let force = 1e-6 * self.steps as f64;
        let frames = [
            pressed(self.steps, state.stamp, force),
            pressed(self.steps, state.stamp, -force),
        ];
        let touches: Vec<TactileReading> = self.analyzers.touches(&frames);
        let mut command = HandCommand::stop(2);
        let controller = &mut self.controller;
        assert_no_alloc(|| controller.decide(&touches, &state, &mut command));
        self.hand.command(&command).expect("a hand");
        command.joint_velocity()[0][1]
    }
}

#[test]
fn a_request_moves_its_joint_until_it_expires() {
    let mut following = Following::new();
    assert_eq!(following.step(), 0.0);
    assert_eq!(following.request(0.1), 1);
    assert_eq!(following.requests.followed(), 0);
    let mut moved = 0;
    for step in 0..30 {
        let velocity = following.step();
        assert!((0.0..=0.1 + 1e-9).contains(&velocity), "{step}: {velocity}");
        moved += usize::from(velocity > 0.099);
    }
    // The acceleration limit permits the velocity within one step.
    assert_eq!(moved, 10);
    assert_eq!(following.requests.followed(), 1);
    // The same velocity again is a new request.
    following.request(0.1);
    following.step();
    assert!((following.step() - 0.1).abs() < 1e-9);
    assert_eq!(following.controller.stop_reason(), None);
    following.requests.end();
    following.step();
    assert_eq!(following.controller.phase(), Phase::Done);
}

#[test]
fn a_request_is_limited_and_checked_like_any_velocity() {
    let mut following = Following::new();
    following.step();
    following.request(1e3);
    let limit =
        following.config.control.limits.joint_acceleration * following.config.control.period;
    let velocity = following.step();
    assert!(velocity > 0.0 && velocity <= limit + 1e-12, "{velocity}");
    following.request(f64::NAN);
    assert_eq!(following.step(), 0.0);
    assert!(following.controller.stop_reason().is_some());
}

#[test]
fn a_request_to_a_stopped_hand_is_not_followed_when_it_resumes() {
    let mut following = Following::new();
    following.step();
    let by = "a test".to_string();
    following.controller.stop(StopReason::Requested { by });
    for _ in 0..20 {
        assert_eq!(following.step(), 0.0);
        following.request(0.1);
    }
    following.controller.resume();
    for _ in 0..3 {
        assert_eq!(following.step(), 0.0);
    }
    following.request(0.1);
    assert!(following.step() > 0.0);
}
