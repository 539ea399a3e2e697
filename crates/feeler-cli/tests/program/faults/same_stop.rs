//! An image with an invalid force stops the hand at the same frame and for the same reason in a run, in a replay and
//! over the link.

use super::bench::{load, step_at};
use feeler::control::{ControlLoop, Controller, FlagAnalyzer, StopReason, TactileReading};
use feeler::hand::{HandState, JointState, JointVector};
use feeler::sensor::forces::{NO_FORCE, SensingChain};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::replay::{Replay, ReplayFrom, recorded_experiment};
use feeler_lab::experiment::{
    Session, SimRigServer, controller, fingers_at_home, layouts, run_facts,
};
use feeler_link::hand::{RemoteFinger, RemoteHand, RunClock};
use feeler_link::inboxes::{Expected, HandInbox, Inbox};
use feeler_link::messages::message::{
    Heartbeat, MessageHeader, NO_FINGER, PROTOCOL, StateMessage, TactileUpdate,
};
use feeler_link::messages::{Echo, JointCounts};
use feeler_link::programs::{Rig, RigSpeed, SensorOutput};
use feeler_link::transport::{LinkError, Outlet, Shared, Topic, header, monotonic};
use feeler_record::wire::{Message, cdr};
use feeler_record::{RecordOptions, Recorder, Recording, RunLog};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Time at which the camera of finger 1 fails (s).
const FROM: f64 = 0.05;
/// Maximum number of control steps.
const STEPS: usize = 10;
/// Upper half of the image saturated, or dark.
const FAULTS: [&str; 2] = [
    "{from=0.05, kind.stuck_rows={finger=1, first=0, count=240, gray=255}}",
    "{from=0.05, kind.stuck_rows={finger=1, first=0, count=240, gray=0}}",
];

/// Control step in which the hand stopped, and the reason.
type Stopped = (usize, StopReason);

fn stopped(step: usize, controller: &Controller) -> Option<Stopped> {
    Some((step, controller.stop_reason()?.clone()))
}

/// Runs `experiment` and records it at `path` with its images.
fn in_a_run(experiment: &Experiment, path: &Path) -> Option<Stopped> {
    let options = RecordOptions {
        calibrations: experiment.calibration_texts().unwrap(),
        pictures: true,
        ..RecordOptions::default()
    };
    let facts = run_facts(&experiment.config).unwrap();
    let recorder = Recorder::create_with(path, &facts, &experiment.toml, &options).unwrap();
    let mut session = Session::new(experiment).unwrap();
    let mut log = RunLog::new(recorder, &facts).unwrap().with_pictures();
    let mut found = None;
    for step in 0..STEPS {
        let instruments = session.step().unwrap();
        instruments
            .record(session.control_loop(), &mut log)
            .unwrap();
        found = found.or(stopped(step, session.control_loop().controller()));
    }
    log.into_recorder().finish(None).unwrap();
    found
}

/// Replays the recording. The replay must give the recorded data bit for bit.
fn in_a_replay(recording: &Recording, from: ReplayFrom<'_>) -> Option<Stopped> {
    let experiment = recorded_experiment(recording, &[]).unwrap();
    let mut replay = Replay::new(recording, from, &experiment).unwrap();
    let mut found = None;
    for step in 0..replay.steps() {
        replay.step().unwrap();
        found = found.or(stopped(step, replay.controller()));
    }
    let comparison = replay.finish().0;
    assert!(comparison.same(), "{comparison:?}");
    found
}

/// Discards the hand's commands.
struct Nowhere;

impl Outlet for Nowhere {
    fn send(&self, _topic: Topic, _bytes: Vec<u8>) -> Result<(), LinkError> {
        Ok(())
    }
}

/// Instance of the rig program. The sensor programs have the following numbers.
const WORLD: u64 = 1;

/// A hand program without a network: messages of sensor programs and rig are put directly into its inbox.
struct LinkedHand {
    rig: SimRigServer,
    sensors: Vec<(SensingChain, TactileReading, FlagAnalyzer)>,
    inbox: Shared<HandInbox>,
    control_loop: ControlLoop<RemoteFinger, RemoteHand>,
    slip_threshold: f64,
}

impl LinkedHand {
    fn new(experiment: &Experiment) -> Self {
        let config = &experiment.config;
        let layouts = layouts(config).unwrap();
        let elements: Vec<_> = layouts.iter().map(|layout| layout.elements.len()).collect();
        let fingers = elements.len();
        let expected = Expected {
            experiment: "same".into(),
            fingertips: vec!["tip".into(); fingers],
            joints: JointCounts::default(),
            speed: None,
        };
        let period = config.control.period;
        let clock = RunClock::new(RigSpeed::Lockstep, period, f64::INFINITY);
        let inbox = Shared::new(HandInbox::new(&elements, clock, expected));
        inbox.lock().sent.sent(1, 0.0);
        let remote = |finger| RemoteFinger::new(inbox.clone(), finger, elements[finger]);
        let remote = (0..fingers).map(remote).collect();
        let who = (0, fingers);
        let hand = RemoteHand::new(inbox.clone(), Arc::new(Nowhere), monotonic(), who);
        let (geometries, _) = fingers_at_home(config).unwrap();
        let controller = controller(experiment, &geometries, &layouts).unwrap();
        let thresholds = config.control.thresholds();
        let sensor = |finger: usize| {
            let sensing = SensingChain::of_fingertip(config.sensor.fingertip(finger)).unwrap();
            let calibration = experiment.calibration(finger).unwrap();
            let analyzer = FlagAnalyzer::new(thresholds, elements[finger]);
            let touch = TactileReading::none(elements[finger]);
            let sensing = sensing.with_calibration(calibration).unwrap();
            (sensing, touch, analyzer)
        };
        let linked = Self {
            rig: SimRigServer::new(experiment).unwrap(),
            sensors: (0..fingers).map(sensor).collect(),
            control_loop: ControlLoop::new(remote, hand, controller),
            slip_threshold: thresholds.slip_threshold,
            inbox,
        };
        linked.introduce(WORLD, "world", NO_FINGER);
        for finger in 0..fingers as u32 {
            linked.introduce(WORLD + 1 + u64::from(finger), "sense", finger);
        }
        linked
    }

    fn introduce(&self, instance: u64, program: &str, finger: u32) {
        let heartbeat = Heartbeat {
            protocol: PROTOCOL,
            instance,
            program: program.into(),
            finger,
            experiment: "same".into(),
            fingertip: "tip".into(),
            sequence: 1,
            ..Heartbeat::default()
        };
        let place = heartbeat.place().expect("a place");
        self.put(Topic::Heartbeat(place), &heartbeat);
    }

    fn put<M: Message>(&self, topic: Topic, message: &M) {
        let mut bytes = Vec::new();
        cdr::encode(message, &mut bytes).unwrap();
        let taken = self.inbox.lock().take_in(topic, &bytes, 0.0);
        assert!(taken.is_ok(), "{topic}: {taken:?}");
    }

    fn step(&mut self, step: usize) {
        let mut state = HandState::zero(self.sensors.len());
        self.rig.read(&mut state).unwrap();
        let echo = Echo {
            step: 1,
            token: self.inbox.lock().sent.token(1),
            arrived: 0.0,
        };
        let now = header(WORLD, step as u64 + 1, state.stamp).echoing(echo, 0.0);
        let vectors = |of: fn(&JointState) -> JointVector| {
            let joints = state.joints.iter().map(of);
            JointCounts::default().to_message(joints).unwrap()
        };
        let message = StateMessage {
            header: now,
            position: vectors(|joints| joints.position),
            velocity: vectors(|joints| joints.velocity),
            ..StateMessage::default()
        };
        self.put(Topic::State, &message);
        for finger in 0..self.sensors.len() {
            let update = self.sense(finger, now);
            self.put(Topic::Tactile(finger), &update);
        }
        self.control_loop.step().unwrap();
        self.rig.begin_period();
        for _ in 0..self.rig.steps_per_period() {
            self.rig.advance(self.control_loop.command()).unwrap();
        }
    }

    /// The message that the sensor program of `finger` publishes.
    fn sense(&mut self, finger: usize, now: MessageHeader) -> TactileUpdate {
        let (sensing, touch, analyzer) = &mut self.sensors[finger];
        let Some(SensorOutput::Picture(frame)) = self.rig.expose(finger).unwrap() else {
            panic!("expected an image")
        };
        let mut readings = vec![Default::default(); sensing.element_count()];
        sensing.sense(&frame.picture, &mut readings).unwrap();
        for (force, reading) in touch.frame.forces.iter_mut().zip(&readings) {
            *force = reading.force.unwrap_or(NO_FORCE);
        }
        (touch.frame.sequence, touch.frame.stamp) = (frame.sequence, frame.stamp);
        touch.analyze(analyzer);
        let header = MessageHeader {
            instance: WORLD + 1 + finger as u64,
            ..now
        };
        TactileUpdate::of_touch(header, finger, touch, self.slip_threshold)
    }
}

fn in_a_linked_hand(experiment: &Experiment) -> Option<Stopped> {
    let mut hand = LinkedHand::new(experiment);
    (0..STEPS).find_map(|step| {
        hand.step(step);
        stopped(step, hand.control_loop.controller())
    })
}

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("same-stop-{name}.mcap"))
}

#[test]
fn unusable_image_stops_run_replay_and_linked_hand_at_the_same_frame() {
    for (index, fault) in FAULTS.into_iter().enumerate() {
        let experiment = load(&["sensing=image"], fault);
        let path = file(&index.to_string());
        let run = in_a_run(&experiment, &path);
        let Some((step, StopReason::NoForce { finger: 1, .. })) = run else {
            panic!("{fault}: {run:?}")
        };
        assert_eq!(step, step_at(FROM), "{fault}");
        let recording = Recording::read(&path).unwrap();
        assert_eq!(in_a_replay(&recording, ReplayFrom::Frames(&path)), run);
        assert_eq!(in_a_replay(&recording, ReplayFrom::Forces), run);
        fs::remove_file(&path).unwrap();
        assert_eq!(in_a_linked_hand(&experiment), run, "{fault}");
    }
    assert_eq!(in_a_linked_hand(&load(&["sensing=image"], "")), None);
}

/// Drift correction changes the forces, and a replay reproduces them.
#[test]
fn drift_is_corrected_in_a_run_and_in_its_replay() {
    let forces = |settings: &[&str], name: &str| {
        let path = file(name);
        let run = in_a_run(&load(settings, ""), &path);
        assert_eq!(run, None);
        let recording = Recording::read(&path).unwrap();
        assert_eq!(in_a_replay(&recording, ReplayFrom::Frames(&path)), None);
        fs::remove_file(&path).unwrap();
        recording.fingers[0].tactile.clone()
    };
    let plain = forces(&["sensing=image"], "plain");
    let corrected = forces(&["sensing=image", "sensor.drift={}"], "corrected");
    assert_ne!(plain, corrected);
}
