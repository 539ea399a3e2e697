//! Fingers that follow a task's plan exactly, with one feeler each that a test loads.

use feeler::control::task::Task;
use feeler::control::{
    FeelerShape, FingertipPose, FlagAnalyzer, FlagThresholds, HandReadings, Phase, Plan,
    StopReason, TactileReading,
};
use feeler::hand::JointState;
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig, RingConfig};
use glam::{DMat3, DVec3};

/// Control period (s).
pub const PERIOD: f64 = 0.01;
/// Distance from the dome's centre to the tip of the unloaded feeler (m).
pub const DOME: f64 = 0.018;
pub const FEELER: FeelerShape = FeelerShape {
    normal_stiffness: 2000.0,
    shear_stiffness: 1000.0,
    tip_radius: 0.002,
};

/// Phases of a completed task, in order.
pub const PHASES: [Phase; 5] = [
    Phase::Search,
    Phase::Move,
    Phase::Release,
    Phase::Return,
    Phase::Done,
];

fn layout() -> ElementLayout {
    let ring = |elements, polar_angle_deg| RingConfig {
        elements,
        polar_angle_deg,
    };
    ElementLayout::new(&LayoutConfig {
        dome_radius: DOME,
        rings: vec![ring(1, 0.0), ring(2, 45.0)],
        grid: None,
    })
}

/// A fingertip.
#[derive(Clone)]
pub struct Finger {
    /// Centre of the dome (m, in W).
    pub position: DVec3,
    /// Outward unit vector along the feeler (in W).
    pub axis: DVec3,
    /// Force on the feeler (N, in W).
    pub force: DVec3,
    analyzer: FlagAnalyzer,
}

impl Finger {
    pub fn new(home: [f64; 3], axis: DVec3, over_force: f64) -> Self {
        let thresholds = FlagThresholds {
            touch_force: 0.05,
            over_force,
            slip_threshold: 1e3,
        };
        Self {
            position: home.into(),
            axis,
            force: DVec3::ZERO,
            analyzer: FlagAnalyzer::new(thresholds, 3),
        }
    }

    /// Position of the tip without a force (m, in W).
    pub fn free_tip(&self) -> DVec3 {
        self.position + DOME * self.axis
    }

    fn pose(&self) -> FingertipPose {
        let across = self.axis.any_orthonormal_vector();
        FingertipPose {
            position: self.position,
            rotation: DMat3::from_cols(self.axis, across, self.axis.cross(across)),
        }
    }

    fn touch(&mut self, layout: &ElementLayout, step: u64) -> TactileReading {
        let mut touch = TactileReading::none(3);
        let in_tip = self.pose().rotation.transpose() * self.force;
        let own = layout.elements[0].rotation.transpose() * in_tip;
        touch.frame.forces[0] = own.with_z(-own.z);
        touch.frame.sequence = step;
        touch.frame.stamp = PERIOD * step as f64;
        touch.analyze(&mut self.analyzer);
        touch
    }
}

/// A task and its fingers.
pub struct Run<T> {
    pub task: T,
    pub fingers: Vec<Finger>,
    pub steps: u64,
}

impl<T: Task> Run<T> {
    pub fn new(task: T, fingers: Vec<Finger>) -> Self {
        Self {
            task,
            fingers,
            steps: 0,
        }
    }

    /// Runs one control step: the task plans from the forces on the feelers, and the fingers move. Returns the plans.
    pub fn step(&mut self) -> Result<Vec<Plan>, StopReason> {
        let layouts = vec![layout(); self.fingers.len()];
        let poses: Vec<_> = self.fingers.iter().map(Finger::pose).collect();
        let pairs = self.fingers.iter_mut().zip(&layouts);
        let touches: Vec<_> = pairs
            .map(|(f, layout)| f.touch(layout, self.steps))
            .collect();
        let hand = HandReadings {
            stamp: PERIOD * self.steps as f64,
            poses: &poses,
            joints: &vec![JointState::default(); self.fingers.len()],
            touches: &touches,
            layouts: &layouts,
            closed: &[],
        };
        self.task.advance(&hand)?;
        let count = self.fingers.len();
        let plans: Vec<_> = (0..count).map(|f| self.task.plan(f, &hand)).collect();
        // A finger that does not exist has an empty plan.
        assert_eq!(self.task.plan(count, &hand), Plan::default());
        for (finger, plan) in self.fingers.iter_mut().zip(&plans) {
            // These tasks control their contact forces themselves.
            assert!(!plan.reflex && !plan.keep_grasp);
            finger.position += PERIOD * plan.velocity;
        }
        self.steps += 1;
        Ok(plans)
    }

    pub fn finding(&self, name: &str) -> f64 {
        let mut findings = self.task.findings().iter();
        let found = findings.find(|finding| finding.name == name);
        found.unwrap_or_else(|| panic!("no {name}")).value
    }

    pub fn done(&self) -> bool {
        self.task.phase() == Phase::Done
    }
}
