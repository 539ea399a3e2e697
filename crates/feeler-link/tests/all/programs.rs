//! Hand, rig and sensor programs over an in-memory network give the same run as a single control loop.

use feeler::control::task::TaskConfig;
use feeler::control::{ControlConfig, ControlLoop, Controller, FlaggedSensor, Phase, StopReason};
use feeler::hand::{
    FingerConfig, FingerGeometry, Hand, HandCommand, HandError, HandState, JointState, JointVector,
    fingertip_pose, inverse_kinematics,
};
use feeler::pace::FreeRunning;
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig};
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use feeler_link::inboxes::{Expected, Exposed, read};
use feeler_link::messages::JointCounts;
use feeler_link::messages::message::{
    HandMode, Heartbeat, InstrumentsMessage, MessageHeader, NO_FINGER, PROTOCOL, ProgramKind,
    ResumeMessage, StopMessage, TactileUpdate,
};
use feeler_link::programs::{
    HandConfig, HandProgram, ProgramError, Rig, RigConfig, RigProgram, RigSpeed, SensorConfig,
    SensorOutput, SensorProgram,
};
use feeler_link::transport::{
    LinkError, MessageHandler, Network, Outlet, ProgramRole, Topic, encode, header,
};
use feeler_record::InstrumentRecord;
use glam::DVec3;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

#[derive(serde::Deserialize)]
struct Config {
    finger: FingerConfig,
    layout: LayoutConfig,
    control: ControlConfig,
    task: TaskConfig,
}

impl Config {
    fn new() -> Self {
        toml::from_str(include_str!("../../../feeler/examples/own_hand.toml")).unwrap()
    }

    fn controller(&self) -> Controller {
        let fingers = [FingerGeometry::new(&self.finger).unwrap()];
        let layouts = [ElementLayout::new(&self.layout)];
        Controller::new(self.control.clone(), &self.task, &fingers, &layouts).expect("a controller")
    }
}

/// Finger with ideal drives, whose feelers are springs on a wall.
#[derive(Clone)]
struct Toy {
    finger: FingerGeometry,
    layout: ElementLayout,
    period: f64,
    joints: JointVector,
    velocity: JointVector,
    steps: u64,
    frame: TactileFrame,
}

impl Toy {
    fn new(config: &Config) -> Self {
        let finger = FingerGeometry::new(&config.finger).unwrap();
        let layout = ElementLayout::new(&config.layout);
        let home = config.task.homes()[0].into();
        Self {
            joints: inverse_kinematics(&finger, home, finger.joint_lower()).unwrap(),
            period: config.control.period,
            velocity: JointVector::default(),
            steps: 0,
            frame: TactileFrame::unloaded(layout.elements.len()),
            finger,
            layout,
        }
    }

    fn feel(&mut self) -> &TactileFrame {
        let (centre, rotation) = fingertip_pose(&self.finger, self.joints);
        for (element, force) in self.frame.forces.iter_mut().enumerate() {
            let tip = centre + rotation * self.layout.tip(element);
            *force = DVec3::Z * (200.0 * (tip.x + 0.018)).max(0.0);
        }
        (self.frame.sequence, self.frame.stamp) = (self.steps, self.time());
        &self.frame
    }
}

impl Rig for Toy {
    fn finger_count(&self) -> usize {
        1
    }

    fn time(&self) -> f64 {
        self.steps as f64 * self.period
    }

    fn read(&mut self, state: &mut HandState) -> Result<Option<InstrumentsMessage>, HandError> {
        state.stamp = self.time();
        state.joints.fill(JointState {
            position: self.joints,
            velocity: self.velocity,
        });
        Ok(Some(InstrumentsMessage {
            torque: self.steps as f64,
            ..InstrumentsMessage::default()
        }))
    }

    fn expose(&mut self, _: usize) -> Result<Option<SensorOutput<'_>>, SensorError> {
        Ok(Some(SensorOutput::Forces(self.feel())))
    }

    fn advance(&mut self, command: &HandCommand) -> Result<(), HandError> {
        self.velocity = command.joint_velocity()[0];
        self.joints += self.period * self.velocity;
        self.steps += 1;
        Ok(())
    }
}

/// The toy as hand and sensor of a control loop in one process.
#[derive(Clone)]
struct Shared(std::rc::Rc<std::cell::RefCell<Toy>>);

impl Hand for Shared {
    fn finger_count(&self) -> usize {
        1
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        self.0.borrow_mut().read(state).map(|_| ())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        self.0.borrow_mut().advance(command)
    }
}

impl TactileSensor for Shared {
    fn element_count(&self) -> usize {
        self.0.borrow().layout.elements.len()
    }

    fn read(&mut self, reading: &mut TactileFrame) -> Result<(), SensorError> {
        reading.clone_from(self.0.borrow_mut().feel());
        Ok(())
    }
}

/// Time after which a program counts as hanging.
const HANGS: Duration = Duration::from_secs(60);

/// Joint angles, grasp force and phase of every step.
type Trace = Vec<(JointVector, f64, Phase)>;

fn in_one_process(config: &Config) -> Trace {
    let toy = Shared(std::rc::Rc::new(std::cell::RefCell::new(Toy::new(config))));
    let sensors = vec![FlaggedSensor::new(toy.clone(), config.control.thresholds())];
    let mut control_loop = ControlLoop::new(sensors, toy, config.controller());
    let mut trace = Trace::new();
    let never = AtomicBool::new(false);
    control_loop
        .run(&mut FreeRunning::default(), 0, &never, |after, _| {
            let force = after.touches()[0].flags.grasp_force;
            let phase = after.controller().phase();
            trace.push((after.state().joints[0].position, force, phase));
            match phase {
                Phase::Done | Phase::Stopped => ControlFlow::Break(()),
                _ => ControlFlow::Continue(()),
            }
        })
        .unwrap();
    trace
}

/// Network that delivers messages between threads of this process immediately.
#[derive(Clone, Default)]
struct Hub(Arc<Mutex<Vec<(usize, Topic, MessageHandler)>>>);

/// Connection of a program to the hub. It does not receive its own messages.
struct Port {
    hub: Hub,
    number: usize,
}

impl Hub {
    fn port(&self, number: usize) -> Arc<dyn Network> {
        let hub = self.clone();
        Arc::new(Port { hub, number })
    }
}

impl Outlet for Port {
    fn send(&self, topic: Topic, bytes: Vec<u8>) -> Result<(), LinkError> {
        let listeners = self.hub.0.lock().unwrap();
        let others = listeners
            .iter()
            .filter(|l| l.0 != self.number && l.1 == topic);
        let others: Vec<MessageHandler> = others.map(|l| l.2.clone()).collect();
        drop(listeners);
        for heard in others {
            heard(topic, &bytes);
        }
        Ok(())
    }
}

impl Network for Port {
    fn listen(&self, topic: Topic, heard: MessageHandler) -> Result<(), LinkError> {
        self.hub.0.lock().unwrap().push((self.number, topic, heard));
        Ok(())
    }
}

/// Connection that loses one command in fifty.
struct Lossy {
    port: Arc<dyn Network>,
    commands: AtomicUsize,
}

impl Outlet for Lossy {
    fn send(&self, topic: Topic, bytes: Vec<u8>) -> Result<(), LinkError> {
        let is_lost =
            topic == Topic::Command && self.commands.fetch_add(1, Ordering::Relaxed) % 50 == 49;
        match is_lost {
            true => Ok(()),
            false => self.port.send(topic, bytes),
        }
    }
}

impl Network for Lossy {
    fn listen(&self, topic: Topic, heard: MessageHandler) -> Result<(), LinkError> {
        self.port.listen(topic, heard)
    }
}

fn expected() -> Expected {
    Expected {
        experiment: "toy".into(),
        fingertips: vec!["tip".into()],
        joints: JointCounts::default(),
        speed: None,
    }
}

fn hand(config: &Config, network: Arc<dyn Network>) -> HandProgram {
    let hand = HandConfig {
        control: config.control.clone(),
        expected: expected(),
        elements: vec![ElementLayout::new(&config.layout).elements.len()],
        speed: RigSpeed::Lockstep,
        time_limit: 60.0,
    };
    HandProgram::new(&hand, config.controller(), network).unwrap()
}

fn sensor(config: &Config, network: Arc<dyn Network>) -> Result<SensorProgram, ProgramError> {
    let sensor = SensorConfig {
        finger: 0,
        elements: ElementLayout::new(&config.layout).elements.len(),
        picture_size: (0, 0),
        thresholds: config.control.thresholds(),
        fingertip: "tip".into(),
        expected: expected(),
    };
    SensorProgram::new(&sensor, network)
}

fn rig(config: &Config, network: Arc<dyn Network>) -> RigProgram<Toy> {
    let rig = RigConfig {
        expected: expected(),
        period: config.control.period,
        stale_periods: config.control.stale_periods,
        speed: RigSpeed::Lockstep,
        survives_faults: false,
    };
    RigProgram::new(Toy::new(config), &rig, network).unwrap()
}

/// Runs rig and sensor programs in the background until `hand_side` returns.
fn beside_rig_and_sensor<T>(hub: &Hub, hand_side: impl FnOnce() -> T) -> T {
    let over = AtomicBool::new(false);
    thread::scope(|scope| {
        scope.spawn(|| rig(&Config::new(), hub.port(1)).run(&over).unwrap());
        scope.spawn(|| {
            let mut program = sensor(&Config::new(), hub.port(2)).unwrap();
            while !over.load(Ordering::Relaxed) {
                let Some(exposed) = program.next_exposed(Duration::from_millis(10)) else {
                    continue;
                };
                let Exposed::Forces(message) = &exposed else {
                    panic!("forces expected")
                };
                let forces = message.forces.iter().map(|&force| Some(force.into()));
                let taken = exposed.header();
                program
                    .publish_exposed(taken, Instant::now(), forces)
                    .unwrap();
            }
        });
        let result = hand_side();
        over.store(true, Ordering::Relaxed);
        result
    })
}

#[test]
fn three_programs_in_lockstep_match_one_control_loop() {
    let config = Config::new();
    let hub = Hub::default();
    let (trace, instruments) = beside_rig_and_sensor(&hub, || {
        let mut program = hand(&config, hub.port(0));
        let never = AtomicBool::new(false);
        assert!(program.wait_for_others(&never).unwrap());
        let (mut trace, mut instruments) = (Trace::new(), Vec::new());
        let broke: Option<()> = program
            .run(&never, |after, at: InstrumentRecord<'_>| {
                let force = after.touches()[0].flags.grasp_force;
                let phase = after.controller().phase();
                trace.push((after.state().joints[0].position, force, phase));
                instruments.push(at.torque.map(|torque| torque.torque));
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!(broke, None);
        assert_eq!(program.controller().phase(), Phase::Done);
        assert_eq!(program.report().steps, trace.len() as u64);
        (trace, instruments)
    });
    assert_eq!(trace, in_one_process(&config));
    assert!(trace.iter().any(|(_, force, _)| *force > 0.4));
    // Instrument readings are passed on with the state they were read with.
    let counted: Vec<_> = (0..trace.len()).map(|step| Some(step as f64)).collect();
    assert_eq!(instruments, counted);
}

#[test]
fn lost_commands_are_sent_again_in_lockstep() {
    let config = Config::new();
    let hub = Hub::default();
    let network = Arc::new(Lossy {
        port: hub.port(0),
        commands: AtomicUsize::new(0),
    });
    let (trace, sent) = beside_rig_and_sensor(&hub, || {
        let mut program = hand(&config, network.clone());
        let never = AtomicBool::new(false);
        assert!(program.wait_for_others(&never).unwrap());
        let mut trace = Trace::new();
        let broke: Option<()> = program
            .run(&never, |after, _| {
                let force = after.touches()[0].flags.grasp_force;
                let phase = after.controller().phase();
                trace.push((after.state().joints[0].position, force, phase));
                ControlFlow::Continue(())
            })
            .unwrap();
        assert_eq!(broke, None);
        (trace, network.commands.load(Ordering::Relaxed))
    });
    assert!(
        sent > trace.len() + 1,
        "{sent} commands, some of them repeated"
    );
    assert_eq!(trace, in_one_process(&config));
}

#[test]
fn a_run_returns_the_value_of_its_callbacks_break() {
    let config = Config::new();
    let hub = Hub::default();
    let broke = beside_rig_and_sensor(&hub, || {
        let mut program = hand(&config, hub.port(0));
        let never = AtomicBool::new(false);
        assert!(program.wait_for_others(&never).unwrap());
        let mut steps = 0;
        program.run(&never, |_, _| {
            steps += 1;
            match steps {
                7 => ControlFlow::Break("seven"),
                _ => ControlFlow::Continue(()),
            }
        })
    });
    assert_eq!(broke.unwrap(), Some("seven"));
}

#[test]
fn a_stop_order_is_reported_and_obeyed() {
    let config = Config::new();
    let hub = Hub::default();
    let warnings = Arc::new(Mutex::new(Vec::new()));
    let (stopped, moved) = beside_rig_and_sensor(&hub, || {
        let mut program = hand(&config, hub.port(0));
        let heard = warnings.clone();
        program.set_warn(Box::new(move |text| {
            heard.lock().unwrap().push(text.to_string())
        }));
        let never = AtomicBool::new(false);
        assert!(program.wait_for_others(&never).unwrap());
        let stop = StopMessage {
            protocol: feeler_link::messages::message::PROTOCOL,
            from: "a test".into(),
            id: 7,
        };
        let (mut stopped, mut moved, mut steps) = (None, 0, 0);
        program
            .run(&never, |after, _| {
                steps += 1;
                if steps == 20 {
                    hub.port(9)
                        .send(Topic::Stop, encode(&stop).unwrap())
                        .unwrap();
                }
                let moves = *after.command() != HandCommand::stop(1);
                moved += usize::from(steps > 20 && moves);
                let reason = after.controller().stop_reason();
                stopped = stopped.take().or(reason.map(ToString::to_string));
                match steps < 60 {
                    true => ControlFlow::Continue(()),
                    false => ControlFlow::Break(()),
                }
            })
            .unwrap();
        (stopped, moved)
    });
    assert!(stopped.is_some_and(|reason| reason.contains("a test")));
    assert_eq!(moved, 0);
    let warnings = warnings.lock().unwrap();
    assert!(
        warnings.iter().any(|warning| warning.contains("a test")),
        "{warnings:?}"
    );
}

/// A resume order is not lost if it arrives during a step.
#[test]
fn a_stop_can_be_resumed_within_a_step() {
    let config = Config::new();
    let hub = Hub::default();
    let somebody = hub.port(9);
    let commands = Arc::new(AtomicUsize::new(0));
    let counted = commands.clone();
    // Commands are sent in the middle of a step, and delivered immediately.
    let resume_in_time: MessageHandler = Arc::new(move |_, _| {
        if counted.fetch_add(1, Ordering::Relaxed) == 30 {
            let resume = ResumeMessage {
                protocol: PROTOCOL,
                from: "a test".into(),
                number: 1,
            };
            let bytes = encode(&resume).unwrap();
            somebody.send(Topic::Resume, bytes).unwrap();
        }
    });
    hub.port(8).listen(Topic::Command, resume_in_time).unwrap();
    let stop = StopMessage {
        protocol: PROTOCOL,
        from: "a test".into(),
        id: 7,
    };
    let mut stopped = Vec::new();
    beside_rig_and_sensor(&hub, || {
        let mut program = hand(&config, hub.port(0));
        let never = AtomicBool::new(false);
        assert!(program.wait_for_others(&never).unwrap());
        let broke = program.run(&never, |after, _| {
            let commands = commands.load(Ordering::Relaxed);
            if commands == 10 {
                let bytes = encode(&stop).unwrap();
                hub.port(7).send(Topic::Stop, bytes).unwrap();
            }
            stopped.push(after.controller().stop_reason().is_some());
            match commands < 50 {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            }
        });
        broke.unwrap();
    });
    let steps: Vec<usize> = (0..stopped.len()).filter(|&step| stopped[step]).collect();
    assert_eq!(steps, (10..=30).collect::<Vec<_>>());
}

/// A rig in lockstep that hangs stops the hand until the stop is resumed.
#[test]
fn a_hanging_rig_in_lockstep_stops_the_hand() {
    let config = Config::new();
    let hub = Hub::default();
    let (mut reasons, never) = (Vec::new(), AtomicBool::new(false));
    let mut program = beside_rig_and_sensor(&hub, || {
        let mut program = hand(&config, hub.port(0));
        assert!(program.wait_for_others(&never).unwrap());
        let broke = program.run(&never, |_, _| ControlFlow::Break(()));
        assert_eq!(broke.unwrap(), Some(()));
        program
    });
    // Rig and sensor have ended. They may have answered the last command, which gives one more step.
    program
        .run(&never, |after, _| {
            reasons.push(after.controller().stop_reason().cloned());
            match after.controller().stop_reason() {
                None => ControlFlow::Continue(()),
                Some(_) => ControlFlow::Break(()),
            }
        })
        .unwrap();
    assert!(reasons.len() <= 2, "{reasons:?}");
    let Some(Some(StopReason::StaleState { age, .. })) = reasons.last() else {
        panic!("{reasons:?}")
    };
    assert!(*age > 19.0, "{age} s");
}

#[test]
fn a_hand_waits_for_missing_programs_and_refuses_mismatching_ones() {
    let config = Config::new();
    let hub = Hub::default();
    let mut program = hand(&config, hub.port(0));
    assert_eq!(program.missing(), ["world", "sense of finger 0"]);
    let interrupted = AtomicBool::new(true);
    assert!(!program.wait_for_others(&interrupted).unwrap());
    let other = RigConfig {
        expected: Expected {
            experiment: "another".into(),
            ..expected()
        },
        period: 0.01,
        stale_periods: 3.5,
        speed: RigSpeed::Lockstep,
        survives_faults: false,
    };
    let _rig = RigProgram::new(Toy::new(&config), &other, hub.port(1)).unwrap();
    interrupted.store(false, Ordering::Relaxed);
    // It warns, and keeps waiting for a matching program.
    let warnings = Arc::new(Mutex::new(Vec::new()));
    let heard = warnings.clone();
    program.set_warn(Box::new(move |text| {
        heard.lock().unwrap().push(text.to_string())
    }));
    let refused = || warnings.lock().unwrap().first().cloned();
    let is_whole = thread::scope(|scope| {
        let waiting = scope.spawn(|| program.wait_for_others(&interrupted));
        let began = Instant::now();
        while refused().is_none() && began.elapsed() < HANGS {
            thread::sleep(Duration::from_millis(5));
        }
        interrupted.store(true, Ordering::Relaxed);
        waiting.join().unwrap()
    });
    assert!(!is_whole.unwrap());
    let refused = refused().unwrap();
    assert!(refused.contains("runs experiment another"), "{refused}");
}

/// An image echoes the latest step at its arrival, regardless of the duration of sensing.
#[test]
fn age_of_an_image_is_counted_from_its_arrival() {
    let config = Config::new();
    let hub = Hub::default();
    let heard = Arc::new(Mutex::new(Vec::new()));
    let note = heard.clone();
    let listening = hub.port(9).listen(
        Topic::Tactile(0),
        Arc::new(move |_, bytes: &[u8]| note.lock().unwrap().push(bytes.to_vec())),
    );
    listening.unwrap();
    let mut program = sensor(&config, hub.port(2)).unwrap();
    let hand = hub.port(0);
    let say = |topic, bytes: Result<Vec<u8>, LinkError>| hand.send(topic, bytes.unwrap()).unwrap();
    let heartbeat = Heartbeat {
        protocol: PROTOCOL,
        instance: 7,
        program: ProgramKind::Hand,
        finger: NO_FINGER,
        experiment: "toy".into(),
        sequence: 1,
        ..Heartbeat::default()
    };
    say(Topic::Heartbeat(ProgramRole::Hand), encode(&heartbeat));
    let mode = |step| HandMode {
        header: header(7, step, 0.0),
        token: 1000 + step,
        ..HandMode::default()
    };
    say(Topic::Mode, encode(&mode(1)));
    let first = Instant::now();
    thread::sleep(Duration::from_millis(30));
    let arrived = Instant::now();
    thread::sleep(Duration::from_millis(30));
    say(Topic::Mode, encode(&mode(2)));
    let elements = ElementLayout::new(&config.layout).elements.len();
    let forces = (0..elements).map(|_| Some(DVec3::ZERO));
    program.publish((4, -3.0, arrived), forces).unwrap();
    let update: TactileUpdate = read(&heard.lock().unwrap()[0]).unwrap();
    let MessageHeader {
        sequence,
        stamp,
        instance,
        clock,
        echo_step,
        echo_token,
        echo_age,
        ..
    } = update.header;
    assert_eq!((sequence, stamp, instance), (5, -3.0, clock));
    assert_eq!((echo_step, echo_token), (1, 1001));
    // The clocks are read one after the other.
    let waited = arrived.duration_since(first).as_secs_f64();
    assert!(
        (waited..waited + 0.02).contains(&echo_age),
        "{echo_age} s, {waited} s"
    );
}
