//! The loop: feel, decide, move.

use super::controller::Controller;
use super::sense::HandSense;
use super::stop_reason::StopReason;
use super::touch::{FingerTouch, TouchSource};
use crate::hand::{Hand, HandCommand, HandError, HandState};
use crate::pace::{Schedule, Tick};
use crate::sensor::reading::SensorError;
use glam::DVec3;
use std::ops::ControlFlow;
use std::sync::atomic::AtomicBool;

/// Why the loop could not go round.
#[derive(Debug, thiserror::Error)]
pub enum ControlError {
    /// A tactile sensor delivered no forces.
    #[error("finger {finger}: {source}")]
    Sensor {
        /// The finger.
        finger: usize,
        /// What the sensor said.
        source: SensorError,
    },
    /// The hand could not be read or moved.
    #[error(transparent)]
    Hand(#[from] HandError),
}

/// Sensors, hand and controller, wired up. Time is that of the data; the loop knows no clock.
pub struct ControlLoop<S, H> {
    sensors: Vec<S>,
    hand: H,
    controller: Controller,
    touches: Vec<FingerTouch>,
    state: HandState,
    command: HandCommand,
}

/// What a program does around each step of [`ControlLoop::run_supervised`].
pub trait Supervisor<S, H> {
    /// What it ends the run with.
    type Break;

    /// Called when a step is due, before anything is read: stops the hand or lets it go on, as it has to.
    fn before_step(&mut self, control_loop: &mut ControlLoop<S, H>, tick: &Tick);

    /// Called after every step, which it sees whole: records, shows, ends the run.
    fn after_step(
        &mut self,
        control_loop: &mut ControlLoop<S, H>,
        tick: &Tick,
    ) -> ControlFlow<Self::Break>;
}

/// A program that has nothing to do before a step.
struct AfterStep<F>(F);

impl<S, H, B, F> Supervisor<S, H> for AfterStep<F>
where
    F: FnMut(&mut ControlLoop<S, H>, &Tick) -> ControlFlow<B>,
{
    type Break = B;

    fn before_step(&mut self, _: &mut ControlLoop<S, H>, _: &Tick) {}

    fn after_step(&mut self, control_loop: &mut ControlLoop<S, H>, tick: &Tick) -> ControlFlow<B> {
        (self.0)(control_loop, tick)
    }
}

impl<S: TouchSource, H: Hand> ControlLoop<S, H> {
    /// A loop over one sensor per finger of `hand`.
    pub fn new(sensors: Vec<S>, hand: H, controller: Controller) -> Self {
        let fingers = hand.finger_count();
        let nothing = |s: &S| FingerTouch::none(s.element_count());
        Self {
            touches: sensors.iter().map(nothing).collect(),
            state: HandState::zero(fingers),
            command: HandCommand::stop(fingers),
            sensors,
            hand,
            controller,
        }
    }

    /// Goes round once: reads the hand and the sensors, decides, commands the hand.
    ///
    /// # Errors
    /// When a sensor or the hand fails. The hand is then told to stop first.
    pub fn step(&mut self) -> Result<(), ControlError> {
        self.sense()?;
        self.act()
    }

    /// The first half of a [`step`](Self::step): reads the hand and the sensors.
    ///
    /// # Errors
    /// When one of them fails. The hand is then told to stop first.
    pub fn sense(&mut self) -> Result<(), ControlError> {
        if let Err(error) = self.read() {
            let what = match error {
                ControlError::Sensor { .. } => "a tactile sensor",
                ControlError::Hand(_) => "the hand's joint state",
            };
            self.controller.stop(StopReason::ReadFailed { what });
            self.command.set_to_stop();
            // The error that is reported is the first one, not what stopping may add to it.
            let _ = self.hand.command(&self.command);
            return Err(error);
        }
        Ok(())
    }

    /// The second half of a [`step`](Self::step): decides on what was read, commands the hand.
    ///
    /// # Errors
    /// When the hand fails.
    pub fn act(&mut self) -> Result<(), ControlError> {
        self.controller
            .decide(&self.touches, &self.state, &mut self.command);
        Ok(self.hand.command(&self.command)?)
    }

    /// Reads the hand and the sensors, and plans: a [`step`](Self::step) up to where the control laws would
    /// decide. For whoever decides in their place, with [`follow`](Self::follow).
    ///
    /// # Errors
    /// When one of them fails. The hand is then told to stop first.
    pub fn plan(&mut self) -> Result<(), ControlError> {
        self.sense()?;
        self.controller.plan(&self.touches, &self.state);
        Ok(())
    }

    /// The rest of a [`step`](Self::step) after [`plan`](Self::plan), as the control laws say.
    ///
    /// # Errors
    /// When the hand fails.
    pub fn obey(&mut self) -> Result<(), ControlError> {
        self.controller
            .obey(&self.touches, &self.state, &mut self.command);
        Ok(self.hand.command(&self.command)?)
    }

    /// The rest of a [`step`](Self::step) after [`plan`](Self::plan): commands the hand what the limits let through of
    /// these velocities of the fingertips, m/s, in W ([`Controller::follow`]).
    ///
    /// # Errors
    /// When the hand fails.
    pub fn follow(&mut self, velocities: &[DVec3]) -> Result<(), ControlError> {
        self.controller
            .follow(velocities, &self.state, &mut self.command);
        Ok(self.hand.command(&self.command)?)
    }

    /// Makes a step whenever `schedule` says so, until `each_step` breaks or `interrupted` is raised (Ctrl-C);
    /// then tells the hand to stop. `each_step` sees the loop after every step, and how punctual that was.
    /// Returns what `each_step` broke with, if it did.
    ///
    /// Missed periods are not made up for. More than `most_missed` in a row stop the hand with
    /// [`StopReason::MissedPeriods`]: its drives went on with an old command for so long.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn run<B>(
        &mut self,
        schedule: &mut impl Schedule,
        most_missed: u64,
        interrupted: &AtomicBool,
        each_step: impl FnMut(&mut Self, &Tick) -> ControlFlow<B>,
    ) -> Result<Option<B>, ControlError> {
        self.run_supervised(
            schedule,
            most_missed,
            interrupted,
            &mut AfterStep(each_step),
        )
    }

    /// As [`run`](Self::run), for a program that has something to do before each step, too.
    ///
    /// # Errors
    /// As [`step`](Self::step).
    pub fn run_supervised<V: Supervisor<S, H>>(
        &mut self,
        schedule: &mut impl Schedule,
        most_missed: u64,
        interrupted: &AtomicBool,
        supervisor: &mut V,
    ) -> Result<Option<V::Break>, ControlError> {
        let mut broke = None;
        while let Some(tick) = schedule.next_tick(interrupted) {
            if tick.missed > most_missed {
                let (missed, limit) = (tick.missed, most_missed);
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

    /// The same sensors and controller with another hand, of as many fingers.
    pub fn with_hand<G: Hand>(self, hand: G) -> ControlLoop<S, G> {
        ControlLoop::new(self.sensors, hand, self.controller)
    }

    /// The same with what `change` makes of the sensors, one per finger.
    ///
    /// # Errors
    /// Those of `change`.
    pub fn try_map_sensors<T: TouchSource, E>(
        self,
        change: impl FnOnce(Vec<S>) -> Result<Vec<T>, E>,
    ) -> Result<ControlLoop<T, H>, E> {
        let sensors = change(self.sensors)?;
        Ok(ControlLoop::new(sensors, self.hand, self.controller))
    }

    /// The sensors, one per finger.
    pub fn sensors(&self) -> &[S] {
        &self.sensors
    }

    /// What each finger felt.
    pub fn touches(&self) -> &[FingerTouch] {
        &self.touches
    }

    /// What the hand felt, where its fingertips are as of the newest step.
    pub fn hand_sense(&self) -> HandSense<'_> {
        self.controller.hand_sense(&self.touches, &self.state)
    }

    /// The newest joint state.
    pub fn state(&self) -> &HandState {
        &self.state
    }

    /// The newest command.
    pub fn command(&self) -> &HandCommand {
        &self.command
    }

    /// The controller, as of the newest step.
    pub fn controller(&self) -> &Controller {
        &self.controller
    }

    /// The controller, for who stops the hand or lets it go on from outside the control law.
    pub fn controller_mut(&mut self) -> &mut Controller {
        &mut self.controller
    }
}
