//! Latency from the timestamp of an image to the last byte of the command on the bus, for a hand that closes the cap
//! in real time with emulated servos at 4 Mbaud.
//!
//! This benchmark does not use divan because it measures when bytes arrive at another thread. A thread per finger
//! emulates the camera: it renders the current state of the simulated world, which takes the place of exposure and
//! transfer, and timestamps the complete image. Forces, flags, law and servos are those of a rig. The emulated bus
//! provides the times of the bytes on the wire.
//!
//! `cargo bench -p feeler-lab --bench picture_to_bus [-- SECONDS]`

#[cfg(not(target_os = "linux"))]
fn main() {}

#[cfg(target_os = "linux")]
fn main() {
    let seconds = std::env::args().skip(1).find_map(|word| word.parse().ok());
    let seconds = seconds.unwrap_or(12.0);
    for experiment in ["cap-closing", "three-fingers"] {
        for cameras in [Cameras::Triggered, Cameras::Free] {
            for steps in [Steps::Follow, Steps::OwnClock] {
                let measured = rig::measure(experiment, (cameras, steps), seconds);
                measured.unwrap_or_else(|error| panic!("{error}"));
            }
        }
    }
}

/// Timing of the cameras.
#[cfg(target_os = "linux")]
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cameras {
    /// All at once, by a common trigger.
    Triggered,
    /// One after the other, evenly spaced over the period.
    Free,
}

/// Timing of the control steps.
#[cfg(target_os = "linux")]
#[derive(Debug, Clone, Copy, PartialEq)]
enum Steps {
    /// When all images have arrived.
    Follow,
    /// By an independent clock.
    OwnClock,
}

#[cfg(target_os = "linux")]
mod rig {
    use super::{Cameras, Steps};
    use feeler::control::{BackgroundSensor, ControlLoop, NewDataSignal, Phase, live};
    use feeler::pace::real_time::fine_timer;
    use feeler::pace::{DataDriven, FixedRate, Punctuality, Schedule};
    use feeler::sensor::fingertip::Fingertip;
    use feeler::sensor::forces::OpticalSensor;
    use feeler::sensor::image::{Camera, CameraError, Frame};
    use feeler_drives::RigClock;
    use feeler_drives::config::DrivesConfig;
    use feeler_drives::emulator::{EmulatedBus, Emulator};
    use feeler_drives::hand::DriveHand;
    use feeler_drives::packet::instruction::SYNC_WRITE;
    use feeler_drives::registers::Registers;
    use feeler_lab::config::Experiment;
    use feeler_lab::experiment::rigs::driven;
    use feeler_lab::experiment::{controller, fingers_at_home, layouts, world};
    use feeler_sim::optics::SimCamera;
    use feeler_sim::rig::{SensorFaults, SimRig};
    use std::error::Error;
    use std::ops::ControlFlow;
    use std::sync::atomic::AtomicBool;
    use std::sync::{Arc, Mutex, PoisonError};
    use std::time::Duration;

    /// Start times of the exposures of a camera (s).
    type Pictures = Arc<Mutex<Vec<f64>>>;

    /// An image that a command is based on.
    struct Used {
        /// Time at which it was complete (s).
        stamp: f64,
        sequence: u64,
    }

    /// Sensors of the fingertips, each on a separate thread.
    struct Sensing {
        touches: Vec<BackgroundSensor>,
        arrivals: NewDataSignal,
        /// Exposures of each camera.
        pictures: Vec<Pictures>,
    }

    /// Camera of a fingertip that takes an image in each period.
    struct LiveCamera {
        camera: SimCamera,
        pace: FixedRate,
        /// Delay relative to the pace.
        offset: Duration,
        clock: RigClock,
        pictures: u64,
        exposures: Pictures,
    }

    impl Camera for LiveCamera {
        fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
            self.pace.wait();
            std::thread::sleep(self.offset);
            let exposed = self.clock.now();
            self.camera.capture(frame)?;
            let complete = self.clock.now();
            (frame.sequence, frame.stamp) = (self.pictures, complete);
            self.pictures += 1;
            let exposures = self.exposures.lock();
            exposures
                .unwrap_or_else(PoisonError::into_inner)
                .push(exposed);
            Ok(())
        }
    }

    /// Starts the sensors of all fingers on their threads.
    fn sensors(
        experiment: &Experiment,
        rig: &SimRig,
        clock: &RigClock,
        cameras: Cameras,
    ) -> Result<Sensing, Box<dyn Error>> {
        let config = &experiment.config;
        let sim = config.simulation()?;
        let (mut sensors, mut pictures) = (Vec::new(), Vec::new());
        let fingers = config.hand.finger.len();
        // All cameras have the same deadlines.
        let pace = FixedRate::new(config.control.period)?;
        for finger in 0..fingers {
            let fingertip = config.sensor.fingertip(finger);
            let made = Fingertip::new(fingertip)?;
            let (period, seed) = (config.control.period, config.seed);
            let faults = SensorFaults::new(&[], finger, made.layout.elements.len(), period, seed);
            let camera = SimCamera::new(rig.clone(), finger, &made, &sim.optics, faults, seed)?;
            let exposures = Pictures::default();
            pictures.push(exposures.clone());
            let camera = LiveCamera {
                camera,
                pace: pace.clone(),
                offset: match cameras {
                    Cameras::Triggered => Duration::ZERO,
                    Cameras::Free => {
                        Duration::from_secs_f64(period * finger as f64 / fingers as f64)
                    }
                },
                clock: clock.clone(),
                pictures: 0,
                exposures,
            };
            sensors.push(OpticalSensor::new(
                camera,
                fingertip,
                experiment.calibration(finger)?,
            )?);
        }
        let (touches, arrivals) = live(sensors, config.control.thresholds())?;
        Ok(Sensing {
            touches,
            arrivals,
            pictures,
        })
    }

    /// Closes the cap for at most `seconds`, with steps triggered by images or by an independent clock.
    pub fn measure(
        name: &str,
        (cameras, steps): (Cameras, Steps),
        seconds: f64,
    ) -> Result<(), Box<dyn Error>> {
        let experiment = Experiment::load(name, &[])?;
        let config = &experiment.config;
        let rig = SimRig::new(world(&experiment)?);
        let clock = RigClock::real();
        let emulator = driven::emulated_bus(&experiment, &rig, clock.clone())?;
        let drives = DrivesConfig {
            port: emulator.path().into(),
            ..driven::drives(&experiment)
        };
        let (fingers, _) = fingers_at_home(config)?;
        let (period, stale) = (config.control.period, config.control.stale_periods);
        let controller = controller(&experiment, &fingers, &layouts(config)?)?;
        let Sensing {
            touches,
            arrivals,
            pictures,
        } = sensors(&experiment, &rig, &clock, cameras)?;
        // Last, because the watchdogs of the servos start here.
        let hand = DriveHand::open(&drives, &fingers, stale * period, clock.clone())?;
        let mut control_loop = ControlLoop::new(touches, hand, controller);
        let mut schedule: Box<dyn Schedule> = match steps {
            Steps::Follow => Box::new(DataDriven::new(arrivals, period)?),
            Steps::OwnClock => Box::new(FixedRate::new(period)?),
        };
        // After the other threads have started, because they would inherit it.
        let _ = fine_timer();
        let (mut punctuality, mut used) = (Punctuality::new()?, Vec::new());
        let begin = goals(&emulator.servos()).len();
        let end = clock.now() + seconds;
        let go_on = AtomicBool::new(false);
        control_loop.run(&mut schedule, stale as u64, &go_on, |control_loop, tick| {
            punctuality.record(tick);
            let touches = control_loop.touches().iter();
            let pictures = touches.map(|touch| Used {
                stamp: touch.stamp,
                sequence: touch.frame.sequence,
            });
            used.push(pictures.collect::<Vec<_>>());
            let over = control_loop.controller().phase() == Phase::Done;
            match over || clock.now() > end || control_loop.controller().stop_reason().is_some() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        })?;
        let ended = control_loop.controller();
        println!(
            "{name}, cameras {cameras:?}, steps {steps:?}: {}",
            punctuality.summary()
        );
        if let Some(reason) = ended.stop_reason() {
            println!("  the hand stopped: {reason}");
        }
        println!("  {:?} at the end", ended.phase());
        report(&emulator, begin, &used, &pictures);
        Ok(())
    }

    /// Times at which the last byte of each velocity command was on the wire (s).
    fn goals(bus: &EmulatedBus) -> Vec<f64> {
        let goal = Registers::of(feeler_drives::packet::Protocol::Dynamixel).goal_velocity;
        let [low, high] = goal.address.to_le_bytes();
        let entries = bus
            .log()
            .entries()
            .filter(|entry| entry.instruction == SYNC_WRITE);
        let written = entries.filter(|entry| entry.parameters.starts_with(&[low, high]));
        written.map(|entry| entry.time).collect()
    }

    /// Prints the latencies from the images that each command is based on.
    fn report(emulator: &Emulator, begin: usize, used: &[Vec<Used>], pictures: &[Pictures]) {
        std::thread::sleep(Duration::from_millis(20));
        let written = goals(&emulator.servos());
        let steps = written[begin..].iter().zip(used);
        // Skip the steps before the first images.
        let steps = steps.filter(|(_, used)| used.iter().all(|picture| picture.stamp.is_finite()));
        let steps: Vec<_> = steps.collect();
        let exposed = |finger: usize, sequence: u64| {
            let pictures = pictures[finger].lock();
            let pictures = pictures.unwrap_or_else(PoisonError::into_inner);
            pictures[sequence as usize]
        };
        let stamps = |used: &[Used]| used.iter().map(|picture| picture.stamp).collect::<Vec<_>>();
        let oldest = |used: &[Used]| stamps(used).into_iter().fold(f64::INFINITY, f64::min);
        let newest = |used: &[Used]| stamps(used).into_iter().fold(0.0, f64::max);
        let first = |used: &[Used]| {
            let pictures = used.iter().enumerate();
            let exposed = pictures.map(|(finger, picture)| exposed(finger, picture.sequence));
            exposed.fold(f64::INFINITY, f64::min)
        };
        let from = |begin: &dyn Fn(&[Used]) -> f64| -> Vec<f64> {
            let delays = steps.iter().map(|(written, used)| *written - begin(used));
            delays.collect()
        };
        print("oldest image complete", from(&oldest));
        print("newest image complete", from(&newest));
        print("oldest image exposed", from(&first));
    }

    fn print(from: &str, mut delays: Vec<f64>) {
        delays.sort_by(f64::total_cmp);
        let Some(last) = delays.len().checked_sub(1) else {
            println!("  no measurements");
            return;
        };
        let at = |share: f64| delays[(last as f64 * share) as usize] * 1e3;
        println!(
            "  {from} to last byte of the command on the bus, {} steps: p50 {:.3} ms, p99 {:.3} ms, max {:.3} ms",
            delays.len(),
            at(0.5),
            at(0.99),
            at(1.0),
        );
    }
}
