//! From the stamp of a picture to the command's last byte on the bus, in a hand that closes the cap in real time over emulated servos at
//! 4 Mbaud.
//!
//! Not a bench of divan's: what counts is when bytes arrive at another thread. A thread per finger is its camera: it draws what the
//! simulated world looks like by then, which stands for exposure and transfer, and stamps the picture when it is complete. Forces, flags,
//! law and servos are those of a rig. The emulated bus says when bytes were on the wire.
//!
//! `cargo bench -p feeler-lab --bench picture_to_bus [-- SECONDS]`

#[cfg(not(target_os = "linux"))]
fn main() {}

#[cfg(target_os = "linux")]
fn main() {
    let seconds = std::env::args().skip(1).find_map(|word| word.parse().ok());
    let seconds = seconds.unwrap_or(18.0);
    for experiment in ["cap-closing", "three-fingers"] {
        for follows in [true, false] {
            rig::measure(experiment, follows, seconds).unwrap_or_else(|error| panic!("{error}"));
        }
    }
}

#[cfg(target_os = "linux")]
mod rig {
    use feeler::control::control_loop::ControlLoop;
    use feeler::control::live_touch::{LiveArrivals, LiveTouch, live};
    use feeler::control::phase::Phase;
    use feeler::pace::{Following, Pace, Punctuality, Schedule};
    use feeler::sensor::camera::{Camera, CameraError};
    use feeler::sensor::fingertip::Fingertip;
    use feeler::sensor::frame::Frame;
    use feeler::sensor::optical::OpticalSensor;
    use feeler_drives::clock::RigClock;
    use feeler_drives::config::DrivesConfig;
    use feeler_drives::emulator::{EmulatedBus, Emulator};
    use feeler_drives::hand::DriveHand;
    use feeler_drives::packet::instruction::SYNC_WRITE;
    use feeler_drives::registers::Registers;
    use feeler_lab::config::Experiment;
    use feeler_lab::experiment::{controller, driven, fingers_at_home, layouts, world};
    use feeler_sim::rig::SimRig;
    use feeler_sim::sensor_faults::SensorFaults;
    use feeler_sim::sim_camera::SimCamera;
    use std::error::Error;
    use std::ops::ControlFlow;
    use std::sync::atomic::AtomicBool;
    use std::sync::{Arc, Mutex, PoisonError};

    /// Which picture it was, when its exposure began and when it was complete, s.
    #[derive(Clone, Copy, Default)]
    struct Taken {
        exposed: f64,
        complete: f64,
    }

    /// A fingertip's camera: a picture each period.
    struct LiveCamera {
        camera: SimCamera,
        pace: Pace,
        clock: RigClock,
        pictures: u64,
        /// All pictures so far.
        taken: Arc<Mutex<Vec<Taken>>>,
    }

    impl Camera for LiveCamera {
        fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
            self.pace.wait();
            let exposed = self.clock.now();
            self.camera.capture(frame)?;
            let complete = self.clock.now();
            (frame.sequence, frame.stamp) = (self.pictures, complete);
            self.pictures += 1;
            let mut taken = self.taken.lock().unwrap_or_else(PoisonError::into_inner);
            taken.push(Taken { exposed, complete });
            Ok(())
        }
    }

    type Pictures = Arc<Mutex<Vec<Taken>>>;

    /// The sensors of all fingers on their threads, and what each camera takes.
    fn sensors(
        experiment: &Experiment,
        rig: &SimRig,
        clock: &RigClock,
    ) -> Result<(Vec<LiveTouch>, LiveArrivals, Vec<Pictures>), Box<dyn Error>> {
        let config = &experiment.config;
        let sim = config.simulation()?;
        let (mut sensors, mut pictures) = (Vec::new(), Vec::new());
        for finger in 0..config.hand.finger.len() {
            let fingertip = config.sensor.fingertip(finger);
            let made = Fingertip::new(fingertip)?;
            let (period, seed) = (config.control.period, config.seed);
            let faults = SensorFaults::new(&[], finger, made.layout.elements.len(), period, seed);
            let camera = SimCamera::new(rig.clone(), finger, &made, &sim.optics, faults, seed)?;
            let taken = Pictures::default();
            pictures.push(taken.clone());
            let camera = LiveCamera {
                camera,
                pace: Pace::new(period)?,
                clock: clock.clone(),
                pictures: 0,
                taken,
            };
            sensors.push(OpticalSensor::new(
                camera,
                fingertip,
                experiment.calibration(finger)?,
            )?);
        }
        let (touches, arrivals) = live(sensors, config.control.thresholds())?;
        Ok((touches, arrivals, pictures))
    }

    /// Closes the cap for so many `seconds`, by steps that follow the pictures or have a clock of their own.
    pub fn measure(name: &str, follows: bool, seconds: f64) -> Result<(), Box<dyn Error>> {
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
        let hand = DriveHand::open(&drives, &fingers, stale * period, clock.clone())?;
        let controller = controller(&experiment, &fingers, &layouts(config)?)?;
        let (touches, arrivals, pictures) = sensors(&experiment, &rig, &clock)?;
        let mut control_loop = ControlLoop::new(touches, hand, controller);
        let mut schedule: Box<dyn Schedule> = match follows {
            true => Box::new(Following::new(arrivals, period)?),
            false => Box::new(Pace::new(period)?),
        };
        let (mut punctuality, mut used) = (Punctuality::new()?, Vec::new());
        let begin = goals(&emulator.servos()).len();
        let end = clock.now() + seconds;
        let go_on = AtomicBool::new(false);
        control_loop.run(&mut schedule, stale as u64, &go_on, |control_loop, tick| {
            punctuality.record(tick);
            let touches = control_loop.touches().iter();
            let pictures = touches.map(|touch| (touch.stamp, touch.frame.sequence));
            used.push(pictures.collect::<Vec<_>>());
            let over = control_loop.controller().phase() == Phase::Done;
            match over || clock.now() > end || control_loop.controller().stop_reason().is_some() {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            }
        })?;
        let ended = control_loop.controller();
        let how = match follows {
            true => "steps that follow the pictures",
            false => "steps with a clock of their own",
        };
        println!("{name}, {how}: {}", punctuality.summary());
        if let Some(reason) = ended.stop_reason() {
            println!("  the hand stopped: {reason}");
        }
        println!("  {:?} at the end", ended.phase());
        report(&emulator, begin, &used, &pictures);
        Ok(())
    }

    /// When the last byte of each command to all goals was on the wire, s.
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

    /// Prints how long it took, from the oldest of the pictures that each command was made of.
    fn report(emulator: &Emulator, begin: usize, used: &[Vec<(f64, u64)>], pictures: &[Pictures]) {
        std::thread::sleep(std::time::Duration::from_millis(20));
        let written = goals(&emulator.servos());
        let steps = written[begin..].iter().zip(used);
        let mut complete = Vec::new();
        let mut exposed = Vec::new();
        for (written, used) in steps {
            let oldest = used
                .iter()
                .map(|(stamp, _)| *stamp)
                .fold(f64::INFINITY, f64::min);
            // Before the first pictures there is nothing to tell.
            if used.iter().any(|(stamp, _)| stamp.is_nan()) {
                continue;
            }
            complete.push(written - oldest);
            let first = used.iter().zip(pictures).map(|((_, sequence), pictures)| {
                let pictures = pictures.lock().unwrap_or_else(PoisonError::into_inner);
                let taken = pictures
                    .get(*sequence as usize)
                    .copied()
                    .unwrap_or_default();
                debug_assert!(taken.complete >= taken.exposed);
                taken.exposed
            });
            exposed.push(written - first.fold(f64::INFINITY, f64::min));
        }
        for (from, mut delays) in [("complete", complete), ("exposed", exposed)] {
            delays.sort_by(f64::total_cmp);
            let Some(last) = delays.len().checked_sub(1) else {
                println!("  nothing was measured");
                return;
            };
            let at = |share: f64| delays[(last as f64 * share) as usize] * 1e3;
            println!(
                "  picture {from} to the command's last byte on the bus, the oldest finger's, {} steps: p50 {:.3} ms, p99 {:.3} ms, most {:.3} ms",
                delays.len(),
                at(0.5),
                at(0.99),
                at(1.0),
            );
        }
    }
}
