//! Configuration and report of a hand program.

use crate::hand::remote::{RemoteFinger, RemoteHand};
use crate::hand::run_clock::RigSpeed;
use crate::inboxes::peers::Expected;
use crate::messages::rejection::Rejections;
use feeler::control::{ControlConfig, ControlLoop};
use feeler::pace::PunctualitySummary;
use std::fmt;

/// Control loop of a hand whose drives and fingers are in other programs.
pub type RemoteLoop = ControlLoop<RemoteFinger, RemoteHand>;

/// Configuration of a hand program.
#[derive(Debug, Clone)]
pub struct HandConfig {
    /// Control period, maximum age of data, and resume policy.
    pub control: ControlConfig,
    /// Configuration that other programs must match.
    pub expected: Expected,
    /// Number of sensing elements of each finger.
    pub elements: Vec<usize>,
    /// Speed of the rig's time. A rig with another speed is refused.
    pub speed: RigSpeed,
    /// Maximum duration of a run (s, rig time).
    pub time_limit: f64,
}

/// Summary of a hand program's run.
#[derive(Debug, Clone)]
pub struct HandReport {
    /// Duration of the run (s, rig time).
    pub duration: f64,
    /// Number of control steps.
    pub steps: u64,
    /// Timing of the control steps; empty in lockstep.
    pub punctuality: PunctualitySummary,
    /// Number of lost tactile updates.
    pub lost: u64,
    /// Counters of rejected messages.
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
