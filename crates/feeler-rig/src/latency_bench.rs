//! The `feeler bench link` subcommand: latency from a tactile update to the command computed from it.

use crate::link_options::{LinkOptions, ListenOptions};
use feeler::pace::{Clock, FixedRate, Monotonic};
use feeler_console::{CommandError, Outcome, watch_for_interrupt};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::fingers_at_home;
use feeler_lab::experiment::rigs::linked::{expected, hand_program};
use feeler_link::inboxes::{Beacon, RigInbox, listen};
use feeler_link::messages::message::{
    Heartbeat, MessageHeader, NO_ELEMENT, NO_FINGER, StateMessage, TactileUpdate,
};
use feeler_link::programs::RigSpeed;
use feeler_link::transport::{
    Network, Shared, TimeSource, Topic, draw_instance, header, monotonic, send,
};
use feeler_record::wire::{Message, Vector3};
use hdrhistogram::Histogram;
use std::io::Write;
use std::net::TcpListener;
use std::ops::ControlFlow;
use std::process::{Child, Command};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Experiment whose hand is measured.
const EXPERIMENT: &str = "cap-closing";

/// Options of the latency measurement.
#[derive(Debug, Clone, Copy)]
pub struct LatencyBench {
    /// Control steps per second.
    pub rate: u32,
    /// Duration of the measurement in seconds.
    pub seconds: u32,
}

fn experiment() -> Result<Experiment, CommandError> {
    // The joints of the bench ignore commands.
    let settings = [
        "sensing=direct",
        "control.monitor.joint_deviation=0",
        "time_limit=1e5",
    ];
    Ok(Experiment::load(EXPERIMENT, &settings.map(String::from))?)
}

/// Sends tactile updates to the hand at the endpoint `hand`, `rate` times per second, until Ctrl-C: the second process of
/// [`measure_latency`].
///
/// # Errors
/// If the network cannot be opened or refuses a message.
pub fn send_readings(hand: &str, rate: u32) -> Result<Outcome, CommandError> {
    let stop = watch_for_interrupt()?;
    Sensors::new(&experiment()?, hand)?.send(rate, &stop)
}

/// Measures the time from the stamp of a tactile update to the command computed from it, between two programs on this
/// computer. Starts this program again as `bench link --sensors-of ENDPOINT`, which calls [`send_readings`].
///
/// # Errors
/// If the second process or the network cannot be started, or the hand stops.
pub fn measure_latency(bench: LatencyBench, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = experiment()?;
    let stop = watch_for_interrupt()?;
    let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
    let endpoint = format!("tcp/127.0.0.1:{port}");
    let network = LinkOptions::default().listen("bench", &ListenOptions::at(&endpoint))?;
    let _sensors = KilledOnDrop(
        Command::new(std::env::current_exe()?)
            .args(["bench", "link", "--rate", &bench.rate.to_string()])
            .args(["--sensors-of", &endpoint])
            .spawn()?,
    );
    let mut program = hand_program(&experiment, RigSpeed::Lockstep, network)?;
    if !program.wait_for_others(&stop)? {
        return Ok(Outcome::GivenUp);
    }
    writeln!(out, "measuring for {} s", bench.seconds)?;
    out.flush()?;
    let mut latency = Histogram::<u64>::new_with_bounds(1, 10_000_000_000, 3)?;
    let steps = u64::from(bench.rate) * u64::from(bench.seconds);
    // A warm-up of one second is not measured.
    let (mut step, getting_going) = (0, u64::from(bench.rate));
    program.run(&stop, |control_loop, _| {
        // The sensors number their frames by the time of exposure.
        let touches = control_loop.touches().iter();
        let oldest = touches.map(|touch| touch.frame.sequence).min().unwrap_or(0);
        step += 1;
        if step > getting_going {
            latency.saturating_record(now().saturating_sub(oldest));
        }
        match step < steps + getting_going {
            true => ControlFlow::Continue(()),
            false => ControlFlow::Break(()),
        }
    })?;
    if let (true, Some(reason)) = (latency.is_empty(), program.controller().stop_reason()) {
        return Err(format!("no measurement, because the hand stopped: {reason}").into());
    }
    let at = |quantile| latency.value_at_quantile(quantile) as f64 / 1e3;
    writeln!(
        out,
        "{} steps at {} Hz, two fingers of 41 elements: from stamp to command {:.0} us (median), {:.0} us (99 %), \
         {:.0} us (maximum)",
        latency.len(),
        bench.rate,
        at(0.5),
        at(0.99),
        latency.max() as f64 / 1e3,
    )?;
    Ok(Outcome::Done)
}

/// A child process that is killed on drop.
struct KilledOnDrop(Child);

impl Drop for KilledOnDrop {
    fn drop(&mut self) {
        // The process may already have exited.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The rig and the sensors of all fingers, simulated in one program.
struct Sensors {
    network: Arc<dyn Network>,
    /// Messages received from the hand.
    inbox: Shared<RigInbox>,
    clock: TimeSource,
    world: u64,
    fingers: Vec<u64>,
    elements: usize,
    /// Joint positions of all fingers in the home posture, in the layout of a state message.
    home: Vec<Vector3>,
    /// Control period in the rig's time (s).
    period: f64,
    _beacons: Vec<Arc<Beacon>>,
}

impl Sensors {
    fn new(experiment: &Experiment, hand: &str) -> Result<Self, CommandError> {
        let network = LinkOptions::connecting_to(hand).connect("bench")?;
        let expected = expected(experiment)?;
        let beacon = |program: &str, finger: u32, fingertip: &str| {
            let instance = draw_instance();
            let heartbeat = Heartbeat {
                instance,
                program: program.into(),
                finger,
                experiment: expected.experiment.clone(),
                fingertip: fingertip.into(),
                age: f64::NAN,
                // The hand answers at once.
                speed: RigSpeed::Lockstep.times(),
                ..Heartbeat::default()
            };
            Beacon::start(network.clone(), heartbeat).map(|beacon| (instance, Arc::new(beacon)))
        };
        let (world, of_world) = beacon("world", NO_FINGER, "")?;
        let (mut fingers, mut beacons) = (Vec::new(), vec![of_world.clone()]);
        for (finger, fingertip) in expected.fingertips.iter().enumerate() {
            let (instance, beacon) = beacon("sense", finger as u32, fingertip)?;
            fingers.push(instance);
            beacons.push(beacon);
        }
        let identity = (fingers.len(), world);
        let inbox = Shared::new(RigInbox::new(identity, f64::INFINITY, expected.clone()));
        let clock = monotonic();
        // The content of commands does not matter here, only their latency.
        let topics: Vec<Topic> = Topic::heartbeats().chain([Topic::Mode]).collect();
        listen(&*network, &topics, &inbox, &clock, &of_world)?;
        let config = &experiment.config;
        let (_, home) = fingers_at_home(config)?;
        Ok(Self {
            network,
            home: expected.joints.to_message(home)?,
            inbox,
            clock,
            world,
            fingers,
            elements: config.sensor.fingertip.layout.element_count(),
            period: config.control.period,
            _beacons: beacons,
        })
    }

    /// Sends a set of updates in each period.
    fn send(&self, rate: u32, stop: &AtomicBool) -> Result<Outcome, CommandError> {
        let mut pace = FixedRate::new(1.0 / f64::from(rate))?;
        let elements = self.elements;
        let still = vec![Vector3::default(); self.home.len()];
        for sequence in 1.. {
            if stop.load(Ordering::Relaxed) || pace.wait_interruptible(stop).is_none() {
                break;
            }
            let (echo, stamp) = (self.inbox.lock().echo, sequence as f64 * self.period);
            let header = |instance| MessageHeader {
                clock: self.world,
                ..header(instance, sequence, stamp).echoing(echo, (self.clock)())
            };
            // As in a real rig, joint states are known before images have been converted to forces.
            let state = StateMessage {
                header: header(self.world),
                position: self.home.clone(),
                velocity: still.clone(),
                ..StateMessage::default()
            };
            self.publish(Topic::State, &state)?;
            for (finger, &instance) in self.fingers.iter().enumerate() {
                let update = TactileUpdate {
                    header: header(instance),
                    finger: finger as u32,
                    frame: now(),
                    largest_element: NO_ELEMENT,
                    forces: vec![Vector3::default(); elements],
                    shear_rate: vec![0.0; elements],
                    slip_mask: vec![0; elements.div_ceil(8)],
                    invalid_mask: vec![0; elements.div_ceil(8)],
                    ..TactileUpdate::default()
                };
                self.publish(Topic::Tactile(finger), &update)?;
            }
        }
        Ok(Outcome::Done)
    }

    fn publish<M: Message>(&self, topic: Topic, message: &M) -> Result<(), CommandError> {
        Ok(send(&*self.network, topic, message)?)
    }
}

/// Returns the time of the monotonic clock shared by all programs on this computer (ns).
fn now() -> u64 {
    Monotonic::new().now().as_nanos() as u64
}
