//! The screw task: repeats SEARCH, MOVE, RELEASE and RETURN (paper, section V.B).

pub use super::screw_config::{FingerPathConfig, ScrewConfig};

use super::Task;
use super::homing::homeward;
use super::search::check_search;
use crate::control::phase::Phase;
use crate::control::plan::Plan;
use crate::control::sense::{FingerReadings, HandReadings};
use crate::control::stop_reason::StopReason;
use glam::DVec3;

/// State machine of the task.
#[derive(Debug, Clone)]
pub struct ScrewTask {
    config: ScrewConfig,
    paths: Vec<Path>,
    phase: Phase,
    stroke: u32,
}

/// State of one finger on its rectangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path {
    /// Position to which the finger returns (m, in W).
    pub home: DVec3,
    /// Position at the start of the task (m, in W).
    start: DVec3,
    /// Unit vector towards the object, in W.
    pub approach: DVec3,
    /// Unit vector along the stroke, in W.
    pub stroke: DVec3,
    /// Position at which the stroke began (m, in W).
    pub stroke_start: DVec3,
}

impl ScrewTask {
    /// Creates the task in its initial state, before the first stroke.
    pub fn new(config: &ScrewConfig) -> Self {
        Self {
            paths: config.finger.iter().map(Path::new).collect(),
            config: config.clone(),
            phase: Phase::Search,
            stroke: 1,
        }
    }

    fn end_stroke(&mut self) {
        if self.stroke < self.config.strokes {
            self.stroke += 1;
            self.phase = Phase::Search;
        } else {
            self.phase = Phase::Done;
        }
    }

    fn all(
        &self,
        hand: &HandReadings<'_>,
        through: impl Fn(&Path, &FingerReadings<'_>) -> bool,
    ) -> bool {
        let mut fingers = self.paths.iter().zip(hand.fingers());
        fingers.all(|(path, finger)| through(path, &finger))
    }

    fn check_search(&self, hand: &HandReadings<'_>) -> Result<(), StopReason> {
        for (finger, (path, sense)) in self.paths.iter().zip(hand.fingers()).enumerate() {
            if !hand.has_closed(finger, self.config.grasp_force) {
                let travel = path.approached(sense.pose.position);
                check_search(finger, travel, self.config.search_limit)?;
            }
        }
        Ok(())
    }
}

impl Task for ScrewTask {
    /// Starts the next phase once every finger has completed the current one.
    fn advance(&mut self, hand: &HandReadings<'_>) -> Result<(), StopReason> {
        let config = &self.config;
        match self.phase {
            Phase::Search => {
                self.check_search(hand)?;
                if (0..self.paths.len()).all(|f| hand.has_closed(f, config.grasp_force)) {
                    for (path, finger) in self.paths.iter_mut().zip(hand.poses) {
                        path.stroke_start = finger.position;
                    }
                    self.phase = Phase::Move;
                }
            }
            Phase::Move => {
                if self.all(hand, |p, f| p.travelled(f.pose.position) >= config.travel) {
                    self.phase = Phase::Release;
                }
            }
            Phase::Release => {
                if self.all(hand, |p, f| p.approached(f.pose.position) <= 0.0) {
                    self.phase = Phase::Return;
                }
            }
            Phase::Return => {
                let home = |p: &Path, f: &FingerReadings<'_>| {
                    p.home.distance(f.pose.position) <= config.home_tolerance
                };
                if self.all(hand, home) {
                    self.end_stroke();
                }
            }
            Phase::Done | Phase::Stopped => {}
        }
        Ok(())
    }

    fn plan(&self, finger: usize, hand: &HandReadings<'_>) -> Plan {
        let (Some(path), Some(sense)) = (self.paths.get(finger), hand.finger(finger)) else {
            return Plan::default();
        };
        let position = sense.pose.position;
        let velocity = match self.phase {
            Phase::Search if !hand.has_closed(finger, self.config.grasp_force) => {
                self.config.search_speed * path.approach
            }
            Phase::Move if path.travelled(position) < self.config.travel => {
                self.config.move_speed * path.stroke
            }
            Phase::Release => -self.config.return_speed * path.approach,
            Phase::Return => homeward(path.home - position, self.config.return_speed),
            _ => DVec3::ZERO,
        };
        Plan {
            velocity,
            towards_object: path.approach,
            reflex: matches!(self.phase, Phase::Search | Phase::Move),
            keep_grasp: self.phase == Phase::Move,
        }
    }

    accessors!(phase, stroke);
}

impl Path {
    /// Creates the rectangle of `config`, at its start.
    pub fn new(config: &FingerPathConfig) -> Self {
        let home = DVec3::from_array(config.home);
        Self {
            home,
            start: home,
            approach: DVec3::from_array(config.approach).normalize_or_zero(),
            stroke: DVec3::from_array(config.stroke).normalize_or_zero(),
            stroke_start: home,
        }
    }

    /// Distance along the stroke of a finger at `position` (m).
    pub fn travelled(&self, position: DVec3) -> f64 {
        (position - self.stroke_start).dot(self.stroke)
    }

    /// Distance from home towards the object of a finger at `position` (m).
    pub fn approached(&self, position: DVec3) -> f64 {
        (position - self.home).dot(self.approach)
    }

    /// Moves home to at most `clearance` (m) from where this stroke began.
    pub fn stay_near(&mut self, clearance: f64) {
        let way = self.searched(self.stroke_start) - clearance;
        self.home = self.start + way.max(0.0) * self.approach;
    }

    /// Distance from the start of the task towards the object of a finger at `position` (m).
    pub fn searched(&self, position: DVec3) -> f64 {
        (position - self.start).dot(self.approach)
    }
}
