//! What a hand program is made of, and what came of it.

use crate::peers::Expected;
use crate::rejection::Rejections;
use crate::remote::{RemoteFinger, RemoteHand};
use crate::run_clock::RigSpeed;
use feeler::control::control_loop::ControlLoop;
use feeler::control::controller::ControlConfig;
use feeler::pace::PunctualitySummary;
use std::fmt;

/// The control loop of a hand whose drives and fingers are in other programs.
pub type RemoteLoop = ControlLoop<RemoteFinger, RemoteHand>;

/// What a hand program is made of.
#[derive(Debug, Clone)]
pub struct HandConfig {
    /// Period, stale limit and what to do when data are fresh again.
    pub control: ControlConfig,
    /// What the other programs must agree in.
    pub expected: Expected,
    /// Number of sensing elements of each finger.
    pub elements: Vec<usize>,
    /// How fast the rig's time goes. A rig of another speed is refused.
    pub speed: RigSpeed,
    /// How long a run takes at most, s of the rig's time.
    pub time_limit: f64,
}

/// What came of a hand program's run.
#[derive(Debug, Clone)]
pub struct HandReport {
    /// The rig's time that the run took, s.
    pub duration: f64,
    /// Control steps.
    pub steps: u64,
    /// How punctual they were; no steps where the rig waits for the hand.
    pub punctuality: PunctualitySummary,
    /// Tactile updates that never came.
    pub lost: u64,
    /// Messages that were refused.
    pub rejected: Rejections,
}

impl fmt::Display for HandReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (duration, steps) = (self.duration, self.steps);
        writeln!(
            f,
            "{duration:.2} s of the rig's time in {steps} control steps"
        )?;
        writeln!(f, "{}", self.punctuality)?;
        let (lost, rejected) = (self.lost, &self.rejected);
        write!(f, "{lost} tactile updates lost; refused: {rejected}")
    }
}
