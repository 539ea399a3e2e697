//! Interface and configuration of the rig that a rig program serves.

use crate::hand::run_clock::RigSpeed;
use crate::inboxes::peers::Expected;
use crate::messages::message::InstrumentsMessage;
use feeler::hand::{Hand, HandCommand, HandError, HandState};
use feeler::sensor::forces::{SensorError, TactileFrame};
use feeler::sensor::image::Frame;

/// Output of a finger's sensor in a rig.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SensorOutput<'a> {
    /// Latest camera image.
    Picture(&'a Frame),
    /// Latest forces, if measured directly.
    Forces(&'a TactileFrame),
}

/// Drives, encoders, instruments and cameras of a rig, real or simulated.
pub trait Rig {
    /// Returns the number of fingers.
    fn finger_count(&self) -> usize;

    /// Returns the rig time (s), on the clock of all stamps.
    fn time(&self) -> f64;

    /// Reads the encoders into `state`. Returns the instrument readings, or `None` if the rig has no instruments.
    ///
    /// # Errors
    /// If encoders or instruments cannot be read.
    fn read(&mut self, state: &mut HandState) -> Result<Option<InstrumentsMessage>, HandError>;

    /// Returns the current output of the sensor of `finger`, or `None` if another program reads its camera.
    ///
    /// # Errors
    /// If the sensor fails.
    fn expose(&mut self, finger: usize) -> Result<Option<SensorOutput<'_>>, SensorError> {
        let _ = finger;
        Ok(None)
    }

    /// Returns the number of [`advance`](Self::advance) calls per control period.
    fn steps_per_period(&self) -> usize {
        1
    }

    /// Called at the start of each control period, before its steps.
    fn begin_period(&mut self) {}

    /// Commands the drives for one step. A simulated rig also advances its time by the step.
    ///
    /// # Errors
    /// If the drives fail.
    fn advance(&mut self, command: &HandCommand) -> Result<(), HandError>;

    /// Restarts failed drives after the resulting stop has been resumed. The default does nothing, for drives that only
    /// need to be read and commanded again.
    ///
    /// # Errors
    /// If the drives still fail.
    fn restart(&mut self) -> Result<(), HandError> {
        Ok(())
    }
}

/// Adapter that serves any [`Hand`] as a rig, read and commanded once per control period.
#[derive(Debug)]
pub struct ServedHand<H> {
    hand: H,
    time: f64,
}

impl<H: Hand> ServedHand<H> {
    /// Wraps `hand`, whose state stamps define the rig time.
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

/// Configuration of a rig program.
#[derive(Debug, Clone)]
pub struct RigConfig {
    /// Configuration that other programs must match.
    pub expected: Expected,
    /// Control period (s, rig time).
    pub period: f64,
    /// Number of control periods after which data is stale.
    pub stale_periods: f64,
    /// Speed of the rig's time.
    pub speed: RigSpeed,
    /// Continues after drive or encoder failures if `true`: the program stops the hand with the reason, and
    /// [restarts](Rig::restart) the rig once the stop has been resumed. Otherwise a failure ends the program, as always
    /// in lockstep.
    pub survives_faults: bool,
}
