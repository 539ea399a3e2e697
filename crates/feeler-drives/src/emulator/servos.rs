//! All servos of an emulated bus, with the mechanism that they move.

use super::fault::BusFault;
use super::log::PacketLog;
use super::plant::Plant;
use super::servo::EmulatedServo;
use crate::config::DrivesConfig;
use crate::packet::Protocol;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Noise of the measured current, relative to the stall current: half width of a uniform distribution; assumed.
const CURRENT_NOISE: f64 = 0.01;

/// Configuration of an emulated bus.
#[derive(Debug, Clone)]
pub struct EmulatorConfig {
    /// Protocol of the servos.
    pub protocol: Protocol,
    /// Baud rate.
    pub baud_rate: u32,
    /// Servos in their initial state.
    pub servos: Vec<EmulatedServo>,
    /// Encoder noise: half width of a uniform distribution, counts.
    pub noise: f64,
    /// Random seed for noise and faults.
    pub seed: u64,
}

impl EmulatorConfig {
    /// Creates the configuration for the servos of `config`. Omits servos of unknown models.
    pub fn of(config: &DrivesConfig, seed: u64) -> Self {
        let servo = |joint: &crate::config::JointDriveConfig| {
            Some(EmulatedServo::new(joint.id, joint.known_model()?))
        };
        Self {
            protocol: config.protocol,
            baud_rate: config.baud_rate,
            servos: config.servos().filter_map(servo).collect(),
            noise: 0.3,
            seed,
        }
    }
}

/// The servos of an emulated bus and the mechanism that they move.
pub(super) struct Servos {
    pub(super) protocol: Protocol,
    pub(super) servos: Vec<EmulatedServo>,
    plant: Box<dyn Plant>,
    noise: f64,
    random: Pcg64,
    /// Random number generator for the noise of currents.
    current_random: Pcg64,
    goals: Vec<f64>,
    time: f64,
    pub(super) log: PacketLog,
}

impl Servos {
    pub(super) fn new(config: &EmulatorConfig, plant: Box<dyn Plant>) -> Self {
        Self {
            protocol: config.protocol,
            goals: vec![0.0; config.servos.len()],
            servos: config.servos.clone(),
            plant,
            noise: config.noise,
            random: Pcg64::seed_from_u64(config.seed),
            current_random: Pcg64::seed_from_u64(config.seed ^ 0xA3),
            time: 0.0,
            log: PacketLog::default(),
        }
    }

    /// Advances to `now`, s.
    pub(super) fn advance(&mut self, now: f64) {
        let step = now - self.time;
        if step <= 0.0 {
            return;
        }
        let servos = self.servos.iter_mut().enumerate();
        for (goal, (index, servo)) in self.goals.iter_mut().zip(servos) {
            *goal = servo.drive(step, self.plant.motion(index), self.plant.load(index));
        }
        self.plant.advance(now, &self.goals);
        for (index, servo) in self.servos.iter_mut().enumerate() {
            let noise = self.noise * self.random.random_range(-1.0..=1.0);
            let current_noise = CURRENT_NOISE * self.current_random.random_range(-1.0..=1.0);
            let motion = self.plant.motion(index);
            servo.measure(now, step, motion, noise, current_noise);
        }
        self.time = now;
    }

    /// Injects a fault of a servo; ignores faults of the bus.
    pub(super) fn inject(&mut self, fault: BusFault, now: f64) {
        let id = fault.servo();
        for servo in self.servos.iter_mut().filter(|s| Some(s.id) == id) {
            match fault {
                BusFault::Silent(_) => servo.silence(),
                BusFault::Reboot(_) => servo.reboot(now),
                BusFault::Overheat(_) => servo.overheat(),
                BusFault::Undervoltage(_) => servo.lower_supply(),
                BusFault::Hardware(_, faults) => servo.break_down(faults),
                BusFault::Load(_, torque) => servo.load = torque,
                BusFault::Jump(_) => servo.jump += 8192,
                BusFault::FlipBytes(_)
                | BusFault::LoseBytes(_)
                | BusFault::Echo
                | BusFault::CablePulled
                | BusFault::Late(_)
                | BusFault::Latency(_) => {}
            }
        }
    }
}
