//! Example of a custom rig on the network: drives, encoders and a sensor, controlled by `feeler hand`. The hardware is
//! simulated: ideal velocity drives, and feelers that act as springs against a wall.
//!
//! ```text
//! cargo run -p feeler-cli --features link --example own_rig
//! cargo run -p feeler-cli --features link -- hand crates/feeler-cli/examples/own_rig.toml    # in another terminal
//! ```

use feeler::glam::DVec3;
use feeler::hand::{
    Hand, HandCommand, HandError, HandState, JointState, JointVector, fingertip_pose,
};
use feeler::pace::{FixedRate, Schedule};
use feeler_lab::config::Experiment;
use feeler_lab::experiment::rigs::linked::{expected, rig_config};
use feeler_lab::experiment::{fingers_at_home, layouts};
use feeler_link::programs::{RigProgram, RigSpeed, SensorConfig, SensorProgram, ServedHand};
use feeler_link::transport::Network;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Joint angles (rad) and time (s), as measured by the encoders and the clock of a real rig.
type Joints = Arc<Mutex<(JointVector, f64)>>;

/// A finger with ideal velocity drives.
struct MyHand {
    joints: Joints,
    velocity: JointVector,
    period: f64,
}

impl Hand for MyHand {
    fn finger_count(&self) -> usize {
        1
    }

    fn read(&mut self, state: &mut HandState) -> Result<(), HandError> {
        let (position, stamp) = *self.joints.lock().unwrap_or_else(PoisonError::into_inner); // on hardware: read the encoders
        let velocity = self.velocity;
        state.stamp = stamp;
        state.joints.fill(JointState { position, velocity });
        Ok(())
    }

    fn command(&mut self, command: &HandCommand) -> Result<(), HandError> {
        self.velocity = command.joint_velocity()[0]; // on hardware: send it to the drives
        let mut joints = self.joints.lock().unwrap_or_else(PoisonError::into_inner);
        joints.0 += self.period * self.velocity;
        joints.1 += self.period;
        Ok(())
    }
}

/// Serves the drives and the sensor of `experiment` until `interrupted`. Time runs at `speed` times real time.
pub fn serve(
    experiment: &Experiment,
    network: &Arc<dyn Network>,
    speed: f64,
    interrupted: &AtomicBool,
) -> Result<(), Failure> {
    let period = experiment.config.control.period;
    let (_, home) = fingers_at_home(&experiment.config)?;
    let joints = Joints::new(Mutex::new((home[0], 0.0)));
    let hand = MyHand {
        joints: joints.clone(),
        velocity: JointVector::default(),
        period,
    };
    let config = rig_config(experiment, RigSpeed::Times(speed))?;
    let mut rig = RigProgram::new(ServedHand::new(hand), &config, network.clone())?;
    std::thread::scope(|scope| {
        let sensing =
            scope.spawn(|| sense(experiment, network, period / speed, &joints, interrupted));
        rig.run(interrupted)?;
        sensing.join().map_err(|_| "the sensor program panicked")?
    })
}

/// Publishes the forces of the spring-like feelers every `period` seconds.
fn sense(
    experiment: &Experiment,
    network: &Arc<dyn Network>,
    period: f64,
    joints: &Joints,
    interrupted: &AtomicBool,
) -> Result<(), Failure> {
    const WALL: f64 = -0.018; // m, x in W
    const STIFFNESS: f64 = 200.0; // N/m
    let layout = &layouts(&experiment.config)?[0];
    let (fingers, _) = fingers_at_home(&experiment.config)?;
    let expected = expected(experiment)?;
    let config = SensorConfig {
        finger: 0,
        elements: layout.elements.len(),
        picture_size: (0, 0), // the rig has no camera
        thresholds: experiment.config.control.thresholds(),
        fingertip: expected.fingertips[0].clone(),
        expected,
    };
    let mut program = SensorProgram::new(&config, network.clone())?;
    let mut pace = FixedRate::new(period)?;
    while let Some(tick) = pace.next_tick(interrupted) {
        let (theta, stamp) = *joints.lock().unwrap_or_else(PoisonError::into_inner);
        let (centre, rotation) = fingertip_pose(&fingers[0], theta);
        let forces = (0..layout.elements.len()).map(|element| {
            let tip = centre + rotation * layout.tip(element); // on hardware: read the sensor (`None`: force is invalid)
            Some(DVec3::Z * (STIFFNESS * (tip.x - WALL)).max(0.0))
        });
        program.publish((tick.number, stamp, Instant::now()), forces)?;
        program.check_peers();
    }
    Ok(())
}

#[allow(dead_code, reason = "a test includes this file for `serve`")]
fn main() -> Result<(), Failure> {
    use feeler_link::transport::{HAND_ENDPOINT, LinkConfig};
    let experiment = Experiment::load("crates/feeler-cli/examples/own_rig.toml", &[])?;
    let config = LinkConfig {
        rig: experiment.config.name.clone(),
        connect: vec![HAND_ENDPOINT.into()],
        ..LinkConfig::default()
    };
    let network: Arc<dyn Network> = Arc::new(feeler_link::transport::Link::open(&config)?);
    let interrupted = Arc::new(AtomicBool::new(false));
    let raised = interrupted.clone();
    ctrlc::set_handler(move || raised.store(true, Ordering::Relaxed))?;
    println!("serving {}; Ctrl-C ends it", config.rig);
    serve(&experiment, &network, 1.0, &interrupted)
}
