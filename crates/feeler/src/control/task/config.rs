//! Selection and parameters of the task.

use super::Task;
use super::cap::CapTask;
use super::cap_config::Until;
use super::carry::{Carry, CarryConfig};
use super::contour::{Contour, ContourConfig};
use super::friction_scan::{FrictionScan, FrictionScanConfig};
use super::grip::{Grip, GripConfig, GripLaw};
use super::probe::{Probe, ProbeConfig};
use super::screw::{ScrewConfig, ScrewTask};
use crate::check::Checker;
use crate::control::flags::FlagThresholds;
use crate::control::limits::LimitsConfig;
use serde::{Deserialize, Serialize};

/// The task of an experiment with its parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", try_from = "Tasks")]
pub enum TaskConfig {
    /// Turns an object by repeatedly grasping, turning and releasing it.
    Screw(ScrewConfig),
    /// Moves a finger around an upright object and traces its outline.
    Contour(ContourConfig),
    /// Slides or lifts an object along a path.
    Carry(CarryConfig),
    /// Grips an object, holds it while an arm carries it, and releases it when it is put down.
    Grip(GripConfig),
    /// Slides over a flat specimen and measures its friction.
    FrictionScan(FrictionScanConfig),
    /// Touches, presses, shears and slides at three places, for identification of hand and object.
    Probe(ProbeConfig),
}

impl TaskConfig {
    /// Creates the task in its initial state.
    pub fn task(&self) -> Box<dyn Task> {
        match self {
            Self::Screw(config) => match (config.until, &config.cap) {
                (Until::Closed | Until::Open, Some(cap)) => Box::new(CapTask::new(config, cap)),
                _ => Box::new(ScrewTask::new(config)),
            },
            Self::Contour(config) => Box::new(Contour::new(config)),
            Self::Carry(config) => Box::new(Carry::new(config)),
            Self::Grip(config) => Box::new(Grip::new(config)),
            Self::FrictionScan(config) => Box::new(FrictionScan::new(config)),
            Self::Probe(config) => Box::new(Probe::new(config)),
        }
    }

    /// Name of the task in experiment files.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Screw(_) => "screw",
            Self::Contour(_) => "contour",
            Self::Carry(_) => "carry",
            Self::Grip(_) => "grip",
            Self::FrictionScan(_) => "friction_scan",
            Self::Probe(_) => "probe",
        }
    }

    /// Start position of each finger's dome centre (m, in W).
    pub fn homes(&self) -> Vec<[f64; 3]> {
        match self {
            Self::Screw(config) => config.finger.iter().map(|path| path.home).collect(),
            Self::Contour(config) => vec![config.home],
            Self::Carry(config) => config.finger.iter().map(|finger| finger.home).collect(),
            Self::Grip(config) => config.finger.iter().map(|finger| finger.home).collect(),
            Self::FrictionScan(config) => vec![config.home],
            Self::Probe(config) => config.finger.iter().map(|path| path.home).collect(),
        }
    }

    /// Number of times that the fingers grasp and release the object.
    pub fn strokes(&self) -> u32 {
        match self {
            Self::Screw(config) => config.strokes,
            Self::Contour(_) | Self::Carry(_) | Self::Grip(_) => 1,
            Self::FrictionScan(config) => config.strokes,
            Self::Probe(_) => Probe::PLACES,
        }
    }

    /// Tasks whose fingers are controlled by a [law](crate::control::law), for messages.
    pub const WITH_LAW: &str = "task.screw with until = \"strokes\"";

    /// Returns whether the experiment's control law must be a policy, which controls the fingers while they hold an
    /// object.
    pub fn takes_policy_only(&self) -> bool {
        matches!(self, Self::Grip(config) if config.law == GripLaw::Policy)
    }

    /// Returns whether the experiment's control law controls the fingers. The other tasks control their contact forces
    /// themselves and ignore the law.
    pub fn takes_law(&self) -> bool {
        matches!(self, Self::Screw(config) if config.until == Until::Strokes)
    }

    /// Checks that every value of the table `task` is in its range, for a control period of `period` seconds.
    /// `thresholds` defines F1 and F2; home positions must be within `limits`.
    pub fn check(
        &self,
        period: f64,
        thresholds: &FlagThresholds,
        limits: &LimitsConfig,
        checker: &mut Checker,
    ) {
        let key = format!("task.{}", self.name());
        match self {
            Self::Screw(screw) => screw.check(&key, checker),
            Self::FrictionScan(scan) => scan.check(&key, period, thresholds, checker),
            Self::Probe(probe) => probe.check(&key, thresholds, checker),
            Self::Contour(contour) => {
                contour.check(&key, checker);
                self.check_homes(&key, limits, checker);
            }
            Self::Grip(grip) => {
                grip.check(&key, checker);
                self.check_homes(&key, limits, checker);
            }
            Self::Carry(carry) => {
                carry.check(&key, checker);
                self.check_homes(&key, limits, checker);
            }
        }
    }

    /// Checks that the home positions are within the workspace.
    fn check_homes(&self, key: &str, limits: &LimitsConfig, checker: &mut Checker) {
        let (lower, upper) = (limits.workspace_lower, limits.workspace_upper);
        for (finger, home) in self.homes().into_iter().enumerate() {
            checker.require(
                &format!("{key}: home of finger {finger}"),
                format!("{home:?}"),
                (0..3).all(|axis| (lower[axis]..=upper[axis]).contains(&home[axis])),
                &format!("a place within control.limits, {lower:?} to {upper:?}"),
            );
        }
    }

    /// Grasp force that each finger must reach before it moves on (N).
    pub fn grasp_force(&self) -> f64 {
        match self {
            Self::Screw(config) => config.grasp_force,
            Self::FrictionScan(config) => config.load,
            Self::Probe(config) => config.press_force,
            Self::Contour(config) => config.contact_force,
            Self::Carry(config) => config.grip_force,
            Self::Grip(config) => config.grip_force,
        }
    }
}

/// Task as a table of an experiment file; exactly one field must be set. Unlike an enum, it gives a helpful message for
/// unknown keys.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Tasks {
    screw: Option<ScrewConfig>,
    contour: Option<ContourConfig>,
    carry: Option<CarryConfig>,
    grip: Option<GripConfig>,
    friction_scan: Option<FrictionScanConfig>,
    probe: Option<ProbeConfig>,
}

impl TryFrom<Tasks> for TaskConfig {
    type Error = &'static str;

    fn try_from(tasks: Tasks) -> Result<Self, Self::Error> {
        let found = [
            tasks.screw.map(Self::Screw),
            tasks.contour.map(Self::Contour),
            tasks.carry.map(Self::Carry),
            tasks.grip.map(Self::Grip),
            tasks.friction_scan.map(Self::FrictionScan),
            tasks.probe.map(Self::Probe),
        ];
        let mut found = found.into_iter().flatten();
        match (found.next(), found.next()) {
            (Some(task), None) => Ok(task),
            (None, _) => Err("expected a task, as in [task.screw], got none"),
            (Some(_), Some(_)) => Err("expected exactly one task, as in [task.screw], got several"),
        }
    }
}
