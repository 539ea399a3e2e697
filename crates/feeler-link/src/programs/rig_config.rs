//! What a rig program serves: drives and encoders, and cameras where it has them.

use crate::message::InstrumentsMessage;
use crate::peers::Expected;
use crate::run_clock::RigSpeed;
use feeler::hand::{Hand, HandCommand, HandError, HandState};
use feeler::sensor::frame::Frame;
use feeler::sensor::reading::{SensorError, TactileFrame};

/// What the sensor of a finger delivered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SensorOutput<'a> {
    /// Its camera's newest picture.
    Picture(&'a Frame),
    /// The newest forces, where they are sensed directly.
    Forces(&'a TactileFrame),
}

/// A rig as its program sees it. Real drives keep their own time; a simulated rig goes on by its steps.
pub trait Rig {
    /// Number of fingers.
    fn finger_count(&self) -> usize;

    /// The rig's time, s: the clock of all stamps.
    fn time(&self) -> f64;

    /// Fills `state` with what the encoders read; what the rig's instruments read, where it has any.
    ///
    /// # Errors
    /// When they cannot be read.
    fn read(&mut self, state: &mut HandState) -> Result<Option<InstrumentsMessage>, HandError>;

    /// What the sensor of `finger` delivers now; nothing where another program has its camera.
    ///
    /// # Errors
    /// When it delivers nothing.
    fn expose(&mut self, finger: usize) -> Result<Option<SensorOutput<'_>>, SensorError> {
        let _ = finger;
        Ok(None)
    }

    /// Steps that [`advance`](Self::advance) makes of a control period.
    fn steps_per_period(&self) -> usize {
        1
    }

    /// Called before the steps of a control period.
    fn begin_period(&mut self) {}

    /// Goes on by a step in which the drives do what `command` says.
    ///
    /// # Errors
    /// When the drives fail.
    fn advance(&mut self, command: &HandCommand) -> Result<(), HandError>;

    /// Makes drives that failed ready to move again, after somebody has resumed the stop that came of it. Without more to do,
    /// they are read and commanded again.
    ///
    /// # Errors
    /// When they still fail.
    fn restart(&mut self) -> Result<(), HandError> {
        Ok(())
    }
}

/// A user's own [`Hand`] as a rig: its drives and encoders, read and commanded once a control period.
#[derive(Debug)]
pub struct ServedHand<H> {
    hand: H,
    time: f64,
}

impl<H: Hand> ServedHand<H> {
    /// Serves `hand`, whose states are stamped on the rig's clock.
    pub fn new(hand: H) -> Self {
        Self { hand, time: 0.0 }
    }
}

impl<H: Hand> Rig for ServedHand<H> {
    fn finger_count(&self) -> usize {
        self.hand.finger_count()
    }

    fn time(&self) -> f64 {
        self.time
    }

    fn read(&mut self, state: &mut HandState) -> Result<Option<InstrumentsMessage>, HandError> {
        self.hand.read(state)?;
        self.time = state.stamp;
        Ok(None)
    }

    fn advance(&mut self, command: &HandCommand) -> Result<(), HandError> {
        self.hand.command(command)
    }
}

/// What a rig program is made of.
#[derive(Debug, Clone)]
pub struct RigConfig {
    /// What the other programs must agree in.
    pub expected: Expected,
    /// The control period, s of the rig's time.
    pub period: f64,
    /// Control periods after which data are stale.
    pub stale_periods: f64,
    /// How fast the rig's time goes.
    pub speed: RigSpeed,
    /// Whether the program goes on where drives or encoders fail: it stops the hand and says why, and
    /// [restarts](Rig::restart) the rig once somebody has resumed that stop. Else it ends. A rig that waits for the hand always does.
    pub survives_faults: bool,
}
