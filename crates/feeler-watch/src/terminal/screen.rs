//! Terminal view of a run: display and key actions.

use super::action::Action;
use super::rate_meter::RateMeter;
use super::view::View;
use crate::history::History;
use crate::snapshot::{
    Fault, Finger, Program, ProgramState, Snapshot, TaskState, TimeBase, Torque, UNKNOWN,
};
use feeler::control::{StopReason, TactileReading};
use feeler::pace::Tick;
use feeler::sensor::fingertip::ElementLayout;
use feeler_console::CommandError;
use feeler_lab::config::{Experiment, ExperimentConfig, Sensing};
use feeler_lab::experiment::{Instruments, SimulatedLoop, layouts};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Sender name of a stop that the user triggers by a key.
const BY: &str = "the keyboard";

/// Terminal view of a run.
pub struct Screen {
    view: View,
    run: RunState,
}

/// Data of a run that is kept between steps.
struct RunState {
    config: ExperimentConfig,
    layouts: Vec<ElementLayout>,
    title: String,
    /// Frame rate of each finger; with direct sensing, the rate of force samples.
    frames: Vec<RateMeter>,
    /// Rate of control steps.
    steps: RateMeter,
    torque: History,
    fault: Option<Fault>,
    speed: Speedometer,
    /// Number of steps that began after the next one was due; `None` if steps are not tied to real time.
    late: Option<u64>,
    /// Angle of the cap (rad), if the run has a cap.
    cap_angle: Option<f64>,
    newest_torque: f64,
}

impl Screen {
    /// Checks that a terminal view is possible, before anything is started.
    pub fn check() -> Result<(), CommandError> {
        View::check_terminal().map_err(|e| format!("--top: {e}").into())
    }

    /// Opens the terminal view for a run of `experiment`; `is_paced` is `true` if its steps are tied to real time.
    /// `interrupted` is set when the user quits.
    pub fn open(
        experiment: &Experiment,
        is_paced: bool,
        interrupted: &Arc<AtomicBool>,
    ) -> Result<Self, CommandError> {
        let run = RunState::new(&experiment.config, is_paced)?;
        let view = View::open(interrupted).map_err(|e| format!("--top: {e}"))?;
        Ok(Self { view, run })
    }

    /// Registers the latest step of `control_loop`, shows it if an update is due, and executes key actions.
    pub fn step(
        &mut self,
        control_loop: &mut SimulatedLoop,
        instruments: &Instruments,
        tick: &Tick,
    ) {
        self.run.step(control_loop, instruments, tick);
        self.view.show(|| self.run.snapshot(control_loop));
        for action in self.view.actions() {
            match action {
                Action::Stop => control_loop
                    .controller_mut()
                    .stop(StopReason::Requested { by: BY.into() }),
                Action::Resume => control_loop.controller_mut().resume(),
                // The view sets the interrupt flag itself.
                Action::Quit => {}
            }
        }
    }

    /// Shows the end of the run until the user quits.
    pub fn wait_for_quit(mut self, control_loop: &SimulatedLoop) {
        let snapshot = Snapshot {
            notice: "the run has ended and its report is written; press q to quit".into(),
            hand_listens: false,
            ..self.run.snapshot(control_loop)
        };
        self.view.wait_for_quit(snapshot);
    }
}

impl RunState {
    fn new(config: &ExperimentConfig, is_paced: bool) -> Result<Self, CommandError> {
        let sensing = match config.sensing {
            Sensing::Image => "images",
            Sensing::Direct => "direct sensing",
        };
        Ok(Self {
            layouts: layouts(config)?,
            title: format!("{}, {sensing}, seed {}", config.name, config.seed),
            frames: vec![RateMeter::default(); config.hand.finger.len()],
            steps: RateMeter::default(),
            torque: History::default(),
            fault: None,
            speed: Speedometer::new(),
            late: is_paced.then_some(0),
            cap_angle: None,
            newest_torque: UNKNOWN,
            config: config.clone(),
        })
    }

    fn step(&mut self, control_loop: &SimulatedLoop, instruments: &Instruments, tick: &Tick) {
        let now = control_loop.state().stamp;
        for (frames, touch) in self.frames.iter_mut().zip(control_loop.touches()) {
            frames.newest(touch.frame.sequence, now);
        }
        self.steps.next(now);
        self.newest_torque = instruments.torque.torque;
        self.torque.push(now, self.newest_torque);
        self.cap_angle = self.config.cap().map(|_| instruments.cap.angle);
        if let Some(late) = &mut self.late {
            *late += u64::from(tick.overran);
        }
        self.speed.time(now);
        self.take_fault(control_loop, now);
    }

    /// Registers a stop of the hand as a fault, which is over once the hand resumes.
    fn take_fault(&mut self, control_loop: &SimulatedLoop, now: f64) {
        let reason = control_loop.controller().stop_reason();
        match (reason, &mut self.fault) {
            (Some(_), Some(Fault { over: false, .. })) | (None, None) => {}
            (Some(reason), _) => {
                self.fault = Some(Fault {
                    time: now,
                    words: format!("the hand was stopped: {reason}"),
                    over: false,
                });
            }
            (None, Some(fault)) => fault.over = true,
        }
    }

    fn snapshot(&self, control_loop: &SimulatedLoop) -> Snapshot {
        let controller = control_loop.controller();
        Snapshot {
            title: self.title.clone(),
            time: control_loop.state().stamp,
            clock: TimeBase::Simulated {
                speed: self.speed.speed,
            },
            task: Some(TaskState {
                phase: controller.phase(),
                stroke: controller.task().stroke(),
                strokes: Some(self.config.task.strokes()),
            }),
            fingers: self.fingers(control_loop),
            torque: Some(Torque {
                newest: self.newest_torque,
                history: self.torque.values(),
                interval: self.torque.interval(),
            }),
            true_cap_angle: self.cap_angle,
            programs: self.programs(control_loop),
            fault: self.fault.clone(),
            hand_listens: true,
            missed: None,
            notice: String::new(),
        }
    }

    fn fingers(&self, control_loop: &SimulatedLoop) -> Vec<Finger> {
        let touches = control_loop.touches().iter().zip(&self.layouts);
        let fingers = touches.zip(&control_loop.state().joints).enumerate();
        fingers
            .map(|(number, ((touch, layout), joints))| Finger {
                number,
                flags: touch.flags,
                thresholds: self.config.control.thresholds(),
                grasp_target: self.config.task.grasp_force(),
                elements: layout.elements.clone(),
                forces: touch.frame.forces.clone(),
                shear_rates: touch.shear_rate.clone(),
                joints: joints.position,
            })
            .collect()
    }

    /// Lists the sensors, the hand and the rig, which share this process, as separate programs.
    fn programs(&self, control_loop: &SimulatedLoop) -> Vec<Program> {
        let now = control_loop.state().stamp;
        let sensors = self.frames.iter().zip(control_loop.touches()).enumerate();
        let mut programs: Vec<_> = sensors
            .map(|(finger, (frames, touch))| self.sensor(finger, frames, touch, now))
            .collect();
        programs.push(Program {
            late: self.late,
            ..program("hand", &self.steps, 0.0)
        });
        // The rig is read once per control step.
        programs.push(program("rig", &self.steps, 0.0));
        programs
    }

    fn sensor(
        &self,
        finger: usize,
        frames: &RateMeter,
        touch: &TactileReading,
        now: f64,
    ) -> Program {
        let age = now - touch.stamp;
        let limit = self.config.control.stale_periods * self.config.control.period;
        let state = if age > limit {
            ProgramState::Silent
        } else {
            ProgramState::Alive
        };
        Program {
            finger: Some(finger),
            state,
            ..program("sensor", frames, age)
        }
    }
}

fn program(name: &str, rate_meter: &RateMeter, age: f64) -> Program {
    Program {
        name: name.into(),
        finger: None,
        version: env!("CARGO_PKG_VERSION").into(),
        rate: rate_meter.rate(),
        age,
        received: Some(rate_meter.received()),
        lost: rate_meter.lost(),
        late: None,
        state: ProgramState::Alive,
    }
}

/// Measures the speed of simulated time.
struct Speedometer {
    /// Real and simulated time (s) at the start of the current measurement.
    begun: (Instant, f64),
    /// Speed relative to real time, from the last measurement.
    speed: f64,
}

impl Speedometer {
    /// Duration of a measurement.
    const DURATION: Duration = Duration::from_millis(500);

    fn new() -> Self {
        Self {
            begun: (Instant::now(), 0.0),
            speed: UNKNOWN,
        }
    }

    /// Registers the current simulated time (s).
    fn time(&mut self, time: f64) {
        let (begun, from) = self.begun;
        let elapsed = begun.elapsed();
        if elapsed >= Self::DURATION {
            self.speed = (time - from) / elapsed.as_secs_f64();
            self.begun = (Instant::now(), time);
        }
    }
}
