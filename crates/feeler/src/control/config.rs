//! Configuration of the controller.

use super::flags::FlagThresholds;
use super::limits::LimitsConfig;
use super::monitor::MonitorConfig;
use crate::check::{Checker, MAX};
use crate::control::law::tri_axial::Reflex;
use crate::control::law::{HandLaw, LawConfig, LawError};
use crate::control::task::TaskConfig;
use crate::sensor::fingertip::layout::ElementLayout;
use serde::{Deserialize, Serialize};

/// Parameters of the controller, the table `[control]` of an experiment file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ControlConfig {
    /// Control period (s).
    pub period: f64,
    /// Maximum age of forces, in control periods. If forces are older, the hand stops.
    pub stale_periods: f64,
    /// F1: compression above which an element is in contact (N).
    pub touch_force: f64,
    /// F2: compression above which an element must not be pressed further (N).
    pub over_force: f64,
    /// dr: shear rate above which an element counts as slipping (N/s).
    pub slip_threshold: f64,
    /// v_r: speed at which a slipping finger is pressed into the object (re-compression, m/s).
    pub recompression_speed: f64,
    /// Grasp force below which a moving finger is pressed into the object, as after a slip (N).
    pub minimum_grasp_force: f64,
    /// Policy for resuming after a stop caused by stale data.
    pub resume: ResumePolicy,
    /// Reaction of a moving hand if its recording cannot be written.
    pub on_recording_failure: RecordingFailure,
    /// Control law with which each finger follows the task's plan.
    pub law: LawConfig,
    /// Limits that every command must respect.
    pub limits: LimitsConfig,
    /// Thresholds of the sensor plausibility checks.
    #[serde(skip_serializing_if = "MonitorConfig::is_default")]
    pub monitor: MonitorConfig,
}

impl Default for ControlConfig {
    /// Values of the reference experiment.
    fn default() -> Self {
        Self {
            period: 0.01,
            stale_periods: 3.5,
            touch_force: 0.1,
            over_force: 0.505,
            slip_threshold: 6.5,
            recompression_speed: 0.0064,
            minimum_grasp_force: 0.08,
            resume: ResumePolicy::default(),
            on_recording_failure: RecordingFailure::default(),
            law: LawConfig::default(),
            limits: LimitsConfig::default(),
            monitor: MonitorConfig::default(),
        }
    }
}

/// Policy for resuming after a stop caused by stale data.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum ResumePolicy {
    /// Resumes when an operator or a program requests it.
    #[default]
    Told,
    /// Resumes as soon as the data are fresh again.
    Fresh,
}

/// Reaction of a moving hand if its recording cannot be written, for example because the disk is full or hangs. In
/// simulated time, the run waits for a slow disk, and ends if the disk is full.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RecordingFailure {
    /// The hand continues; the recording has a gap or ends early.
    #[default]
    Continue,
    /// The hand stops and the run ends.
    Stop,
}

impl ControlConfig {
    /// Thresholds of the contact flags TOUCH, SLIP and OVER.
    pub fn thresholds(&self) -> FlagThresholds {
        FlagThresholds {
            touch_force: self.touch_force,
            over_force: self.over_force,
            slip_threshold: self.slip_threshold,
        }
    }

    /// Parameters of the paper's re-compression reflex.
    pub fn reflex(&self) -> Reflex {
        Reflex {
            recompression_speed: self.recompression_speed,
            minimum_grasp_force: self.minimum_grasp_force,
        }
    }

    /// Creates the control law for a hand whose fingers have the elements of `layouts`, in its initial state.
    ///
    /// # Errors
    /// If a policy file has not been loaded, or the policy was made for other fingertips.
    pub fn hand_law(&self, layouts: &[ElementLayout]) -> Result<Box<dyn HandLaw>, LawError> {
        self.law
            .hand_law(self.reflex(), &self.thresholds(), layouts)
    }

    /// Checks that all values, including those of `task`, are in their ranges. Keys are those of an experiment file:
    /// `control` and `task`.
    pub fn check(&self, task: &TaskConfig, checker: &mut Checker) {
        checker.between("control.period", self.period, 1e-4, 1.0);
        checker.between("control.stale_periods", self.stale_periods, 0.5, 1e3);
        checker.positive("control.touch_force", self.touch_force);
        checker.positive("control.slip_threshold", self.slip_threshold);
        checker.require(
            "control.over_force",
            self.over_force.to_string(),
            self.over_force <= MAX && self.over_force > self.touch_force,
            &format!(
                "more than control.touch_force (F1) = {}, at most {MAX:e}",
                self.touch_force
            ),
        );
        checker.not_negative("control.recompression_speed", self.recompression_speed);
        checker.not_negative("control.minimum_grasp_force", self.minimum_grasp_force);
        self.law.check("control.law", &self.thresholds(), checker);
        self.limits
            .check("control.limits", self.over_force, checker);
        self.monitor.check("control.monitor", checker);
        self.check_law_of(task, checker);
        task.check(self.period, &self.thresholds(), &self.limits, checker);
    }

    /// Checks that a task that needs a policy has one, and that a task without a law has the default law.
    fn check_law_of(&self, task: &TaskConfig, checker: &mut Checker) {
        if task.takes_policy_only() {
            checker.require(
                "control.law",
                format!("{:?}", self.law.name()),
                matches!(self.law, LawConfig::Policy(_)),
                "control.law.policy with a file, because task.grip.law = \"policy\"",
            );
            return;
        }
        checker.require(
            "control.law",
            format!("{:?}", self.law.name()),
            task.takes_law() || self.law == LawConfig::default(),
            &format!(
                "{:?}, the default, because task.{} controls its contact forces itself; only {} takes another law, and task.grip with law = \"policy\" a policy",
                LawConfig::default().name(),
                task.name(),
                TaskConfig::WITH_LAW,
            ),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::law::best::BestConfig;

    fn fields(control: &ControlConfig, task: &str) -> Vec<String> {
        let task: TaskConfig = toml::from_str(task).expect("a valid task");
        let mut checker = Checker::default();
        control.check(&task, &mut checker);
        let problems = checker.problems().into_iter();
        problems.map(|problem| problem.field).collect()
    }

    #[test]
    fn defaults_are_in_their_ranges() {
        let control = ControlConfig::default();
        assert_eq!(fields(&control, "screw = { finger = [] }"), [""; 0]);
        let contour = "contour = { home = [0.05, 0.0, 0.1], approach = [-1.0, 0.0, 0.0] }";
        assert_eq!(fields(&control, contour), [""; 0]);
    }

    /// All problems are reported, including those of the law, the limits and the task.
    #[test]
    fn every_problem_has_its_key() {
        let control = ControlConfig {
            period: f64::NAN,
            over_force: 0.05,
            law: LawConfig::Best(BestConfig {
                element_force: 0.0,
                ..BestConfig::default()
            }),
            limits: LimitsConfig {
                joint_acceleration: 0.0,
                ..LimitsConfig::default()
            },
            ..ControlConfig::default()
        };
        let contour = "contour = { home = [0.5, 0.0, 0.1], approach = [0.0, 0.0, 1.0] }";
        let expected = [
            "control.period",
            "control.over_force",
            "control.law.best.element_force",
            "control.limits.joint_acceleration",
            "control.law",
            "task.contour.approach",
            "task.contour: home of finger 0",
        ];
        assert_eq!(fields(&control, contour), expected);
    }
}
