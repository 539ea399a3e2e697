//! Control loop: reads the sensors, computes a command, and sends it to the hand.

use super::controller::Controller;
use super::sense::HandReadings;
use super::stop_reason::StopReason;
use super::touch::{TactileReading, TactileSource};
use crate::hand::{Hand, HandCommand, HandError, HandState, JointState};
use crate::pace::{Schedule, Tick};
use crate::sensor::forces::reading::SensorError;
use glam::DVec3;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

/// Error that aborts a control cycle.
#[derive(Debug, thiserror::Error)]
pub enum ControlError {
    /// A tactile sensor delivered no valid reading.
    #[error("finger {finger}: {source}")]
    Sensor {
        /// Index of the finger.
        finger: usize,
        /// Error of the sensor.
        source: SensorError,
    },
    /// The hand could not be read or commanded.
    #[error(transparent)]
    Hand(#[from] HandError),
}

/// Control loop that connects sensors, hand and controller. All times come from the data; the loop does not read a
/// clock.
pub struct ControlLoop<S, H> {
    sensors: Vec<S>,
    hand: H,
    controller: Controller,
    touches: Vec<TactileReading>,
    state: HandState,
    command: HandCommand,
}

/// Hooks that run around each step of [`ControlLoop::run_supervised`].
pub trait Supervisor<S, H> {
    /// Value with which a hook ends the run.
    type Break;

    /// Called when a step is due, before anything is read. The hook may stop the hand or resume it.
    fn before_step(&mut self, control_loop: &mut ControlLoop<S, H>, tick: &Tick);

    /// Called after every step, for example to record or display it, or to end the run.
    fn after_step(
        &mut self,
        control_loop: &mut ControlLoop<S, H>,
        tick: &Tick,
    ) -> ControlFlow<Self::Break>;
}

/// A closure is a supervisor with only the hook after each step.
impl<S, H, B, F> Supervisor<S, H> for F
where
    F: FnMut(&mut ControlLoop<S, H>, &Tick) -> ControlFlow<B>,
{
    type Break = B;

    fn before_step(&mut self, _: &mut ControlLoop<S, H>, _: &Tick) {}

    fn after_step(&mut self, control_loop: &mut ControlLoop<S, H>, tick: &Tick) -> ControlFlow<B> {
        self(control_loop, tick)
    }
}

impl<S: TactileSource, H: Hand> ControlLoop<S, H> {
    /// Creates a loop from `hand`, one sensor per finger and a controller.
    pub fn new(sensors: Vec<S>, hand: H, controller: Controller) -> Self {
        let fingers = hand.finger_count();
        // Before the first reading, all joints of each finger are at 0.
        let mut state = HandState::zero(fingers);
        for (joints, finger) in state.joints.iter_mut().zip(controller.fingers()) {
            *joints = JointState::zero(finger.geometry().joint_count());
        }
        let nothing = |s: &S| TactileReading::none(s.element_count());
        Self {
            touches: sensors.iter().map(nothing).collect(),
            state,
            command: HandCommand::stop(fingers),
            sensors,
            hand,
            controller,
        }
    }

    /// Runs one control cycle: reads the hand and the sensors, computes the command, and sends it to the hand.
    ///
    /// # Errors
    /// If a sensor or the hand fails. The hand is commanded to stop first.
    pub fn step(&mut self) -> Result<(), ControlError> {
        self.sense()?;
        self.act()
    }

    /// First half of a [`step`](Self::step): reads the hand and the sensors.
    ///
    /// # Errors
    /// If the hand or a sensor fails. The hand is commanded to stop first.
    pub fn sense(&mut self) -> Result<(), ControlError> {
        if let Err(error) = self.read() {
            let what = match error {
                ControlError::Sensor { .. } => "a tactile sensor",
                ControlError::Hand(_) => "the hand's joint state",
            };
            self.controller.stop(StopReason::ReadFailed { what });
            self.command.set_to_stop();
            // Report the first error; ignore a failure of the stop command.
            let _ = self.hand.command(&self.command);
            return Err(error);
        }
        Ok(())
    }

    /// Second half of a [`step`](Self::step): computes the command from the latest readings and sends it to the hand.
    ///
    /// # Errors
    /// If the hand fails.
    pub fn act(&mut self) -> Result<(), ControlError> {
        self.controller
            .decide(&self.touches, &self.state, &mut self.command);
        Ok(self.hand.command(&self.command)?)
    }

    /// Reads the hand and the sensors and updates the task's plans: the part of a [`step`](Self::step) before the
    /// control laws. For callers that replace the laws by calling [`follow`](Self::follow).
    ///
    /// # Errors
    /// If the hand or a sensor fails. The hand is commanded to stop first.
    pub fn plan(&mut self) -> Result<(), ControlError> {
        self.sense()?;
        self.controller.plan(&self.touches, &self.state);
        Ok(())
    }

    /// Completes a [`step`](Self::step) after [`plan`](Self::plan), using the velocities of the control laws.
    ///
    /// # Errors
    /// If the hand fails.
    pub fn act_with_laws(&mut self) -> Result<(), ControlError> {
        self.controller
            .act_with_laws(&self.touches, &self.state, &mut self.command);
        Ok(self.hand.command(&self.command)?)
    }

    /// Completes a [`step`](Self::step) after [`plan`](Self::plan), using the given fingertip velocities (m/s, in W)
    /// instead of those of the control laws. The same limits apply; see [`Controller::follow`].
    ///
    /// # Errors
    /// If the hand fails.
    pub fn follow(&mut self, velocities: &[DVec3]) -> Result<(), ControlError> {
        self.controller
            .follow(velocities, &self.state, &mut self.command);
        Ok(self.hand.command(&self.command)?)
    }

    /// Runs a step at each tick of `schedule` until `each_step` breaks or `interrupted` is set (Ctrl-C), then stops
    /// the hand. `each_step` is called after every step with the loop and the tick. Returns the value with which
    /// `each_step` broke, if any.
    ///
    /// Missed periods are skipped. If more than `max_missed` consecutive periods are missed, the hand is stopped with
    /// [`StopReason::MissedPeriods`], because the drives were executing a stale command.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn run<B>(
        &mut self,
        schedule: &mut impl Schedule,
        max_missed: u64,
        interrupted: &AtomicBool,
        mut each_step: impl FnMut(&mut Self, &Tick) -> ControlFlow<B>,
    ) -> Result<Option<B>, ControlError> {
        self.run_supervised(schedule, max_missed, interrupted, &mut each_step)
    }

    /// Like [`run`](Self::run), but with hooks before and after each step.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn run_supervised<V: Supervisor<S, H>>(
        &mut self,
        schedule: &mut impl Schedule,
        max_missed: u64,
        interrupted: &AtomicBool,
        supervisor: &mut V,
    ) -> Result<Option<V::Break>, ControlError> {
        let mut broke = None;
        while let Some(tick) = schedule.next_tick(interrupted) {
            if tick.missed > max_missed {
                let (missed, limit) = (tick.missed, max_missed);
                let reason = StopReason::MissedPeriods { missed, limit };
                self.controller.stop(reason);
            }
            supervisor.before_step(self, &tick);
            self.step()?;
            if let ControlFlow::Break(value) = supervisor.after_step(self, &tick) {
                broke = Some(value);
                break;
            }
        }
        self.command.set_to_stop();
        self.hand.command(&self.command)?;
        Ok(broke)
    }

    fn read(&mut self) -> Result<(), ControlError> {
        self.hand.read(&mut self.state)?;
        self.sensors.iter_mut().for_each(S::begin);
        for (finger, (sensor, touch)) in self.sensors.iter_mut().zip(&mut self.touches).enumerate()
        {
            sensor
                .touch(touch)
                .map_err(|source| ControlError::Sensor { finger, source })?;
        }
        Ok(())
    }

    /// Replaces the hand with another one that has the same number of fingers.
    pub fn with_hand<G: Hand>(self, hand: G) -> ControlLoop<S, G> {
        ControlLoop::new(self.sensors, hand, self.controller)
    }

    /// Replaces the sensors, one per finger, with the result of `change`.
    ///
    /// # Errors
    /// Those of `change`.
    pub fn try_map_sensors<T: TactileSource, E>(
        self,
        change: impl FnOnce(Vec<S>) -> Result<Vec<T>, E>,
    ) -> Result<ControlLoop<T, H>, E> {
        let sensors = change(self.sensors)?;
        Ok(ControlLoop::new(sensors, self.hand, self.controller))
    }

    /// Sensors, one per finger.
    pub fn sensors(&self) -> &[S] {
        &self.sensors
    }

    /// Latest tactile reading of each finger.
    pub fn touches(&self) -> &[TactileReading] {
        &self.touches
    }

    /// Latest tactile readings with the fingertip poses of the latest step.
    pub fn hand_sense(&self) -> HandReadings<'_> {
        self.controller.hand_sense(&self.touches, &self.state)
    }

    /// Latest joint state.
    pub fn state(&self) -> &HandState {
        &self.state
    }

    /// Latest command.
    pub fn command(&self) -> &HandCommand {
        &self.command
    }

    /// Controller of the loop.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// Mutable access to the controller, to stop the hand or to resume it.
    pub fn controller_mut(&mut self) -> &mut Controller {
        &mut self.controller
    }
}
