//! Task that screws a cap until the hand detects that it is closed, or unscrews it until it is open.
//!
//! The strokes are those of the [screw task](super::screw), with two differences. First, the task controls the grip
//! itself: it presses each finger with a definite force, whether the finger slips or not. Second, it continues until
//! the state of the cap is known. It grips gently at first. Once a stroke turns the cap by less than half of the
//! expected angle, it uses the maximum grip. Once the fingers have slipped over a cap at rest in two consecutive
//! strokes, the resistance measured so far decides the outcome.

use super::cap_config::{CapConfig, Until};
use super::cap_estimator::CapEstimator;
use super::homing::homeward;
use super::resistance_curve::ResistanceCurve;
use super::screw::{Path, ScrewConfig};
use super::{Finding, Task};
use crate::control::phase::Phase;
use crate::control::plan::Plan;
use crate::control::sense::{FingerReadings, HandReadings};
use crate::control::stop_reason::StopReason;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Number of consecutive strokes in which a cap must stand still.
const STILL_STROKES: u32 = 2;
/// Share of the expected turn below which a stroke has met resistance.
const FREE_SHARE: f64 = 0.5;
/// Share of the requested grip at which a finger counts as gripping.
const GRIPPING: f64 = 0.9;
/// Share of the maximum friction force at which a finger stops dragging: beyond it, something other than friction
/// holds the finger.
const DRAGGED: f64 = 0.97;
/// Share of the maximum friction force above which a finger slows down.
const SLOWED: f64 = 0.92;
/// Maximum compression of elements as a share of the damaging force. The rest is left for shear and noise.
const GUARDED: f64 = 0.85;

/// State machine of the task.
#[derive(Debug, Clone)]
pub struct CapTask {
    config: ScrewConfig,
    cap: CapConfig,
    paths: Vec<Path>,
    touch: CapEstimator,
    curve: ResistanceCurve,
    phase: Phase,
    stroke: u32,
    /// `true` if the maximum grip is used.
    firm: bool,
    /// Number of consecutive strokes in which the cap stood still.
    still: u32,
    /// Angle by which the cap was turned before this stroke, and in it (rad).
    turned: f64,
    stroke_turn: f64,
    outcome: Option<&'static str>,
    findings: [Finding; 6],
}

impl CapTask {
    /// Creates the task in its initial state.
    pub fn new(config: &ScrewConfig, cap: &CapConfig) -> Self {
        let axis = DVec2::from_array(cap.axis);
        let paths: Vec<_> = config.finger.iter().map(Path::new).collect();
        let sense = paths.first().map_or(1.0, |path| {
            (path.home.truncate() - axis).perp_dot(path.stroke.truncate())
        });
        let mut task = Self {
            touch: CapEstimator::new(axis, cap.feeler, sense, paths.len()),
            paths,
            config: config.clone(),
            cap: cap.clone(),
            curve: ResistanceCurve::default(),
            phase: Phase::Search,
            stroke: 1,
            firm: config.until == Until::Open,
            still: 0,
            turned: 0.0,
            stroke_turn: 0.0,
            outcome: None,
            findings: [Finding {
                name: "",
                value: 0.0,
            }; 6],
        };
        task.note(0.0);
        task
    }

    /// Requested grip force of each finger (N).
    fn grip(&self) -> f64 {
        match self.firm {
            true => self.cap.grip,
            false => self.config.grasp_force.min(self.cap.grip),
        }
    }

    fn search(&mut self, hand: &HandReadings<'_>) {
        let limit = self.config.search_limit;
        let mut fingers = self.paths.iter().zip(hand.fingers());
        let lost = fingers.any(|(path, finger)| {
            path.searched(finger.pose.position) > limit && !finger.flags().touch
        });
        let enough = GRIPPING * self.grip();
        if lost {
            self.end("no cap");
            self.phase = Phase::Release;
        } else if self
            .touch
            .fingers
            .iter()
            .all(|finger| finger.grip >= enough)
        {
            for (path, pose) in self.paths.iter_mut().zip(hand.poses) {
                path.stroke_start = pose.position;
                path.stay_near(self.cap.clearance);
            }
            self.touch.begin_stroke();
            self.stroke_turn = 0.0;
            self.phase = Phase::Move;
        }
    }

    fn screw(&mut self, hand: &HandReadings<'_>) {
        self.stroke_turn += self.touch.turned();
        let torque = self.touch.torque();
        self.curve.push(torque, self.turned + self.stroke_turn);
        self.note(torque);
        let mut fingers = self.paths.iter().zip(hand.poses).enumerate();
        if fingers.all(|(finger, (path, pose))| {
            path.travelled(pose.position) >= self.config.travel || self.drag(finger) >= DRAGGED
        }) {
            self.turned += self.stroke_turn;
            self.judge();
            self.stroke_turn = 0.0;
            self.note(0.0);
            self.phase = Phase::Release;
        }
    }

    /// Evaluates the completed stroke.
    fn judge(&mut self) {
        let Some(radius) = self.touch.radius() else {
            return self.end("no cap");
        };
        let free = FREE_SHARE * self.config.travel / radius.max(f64::MIN_POSITIVE);
        let mut fingers = self.touch.fingers.iter().enumerate();
        let at_limit = fingers.all(|(finger, felt)| felt.slid || self.drag(finger) >= DRAGGED);
        match self.stroke_turn < self.cap.still_turn && self.firm && at_limit {
            true => self.still += 1,
            false => self.still = 0,
        }
        let most = match self.config.until {
            Until::Open => self.cap.open_turns,
            _ => self.cap.most_turns,
        };
        if self.turned > TAU * most {
            self.end(match self.config.until {
                Until::Open => "open",
                _ => "spinning freely",
            });
        } else if self.still >= STILL_STROKES {
            self.end(self.verdict());
        } else if self.stroke >= self.config.strokes {
            self.end("undecided");
        }
        let resists = self.stroke_turn < free;
        // A closing cap resists more and more; an opening cap stops resisting once it has come loose.
        self.firm = resists || (self.firm && self.config.until == Until::Closed);
    }

    /// Outcome for a cap that cannot be turned any further.
    fn verdict(&self) -> &'static str {
        let too_early = self.turned < TAU * self.cap.least_turns;
        let stiffness = self.stiffness().unwrap_or(f64::INFINITY);
        match self.config.until {
            Until::Open => "stuck",
            _ if too_early || stiffness < self.cap.softest_seat => "cross-threaded",
            _ => "closed",
        }
    }

    /// Measured stiffness of the resistance that the cap has met (N·m/rad).
    fn stiffness(&self) -> Option<f64> {
        self.curve
            .stiffness(self.config.grasp_force / self.cap.grip)
    }

    /// Force of `finger` along its stroke, as a share of the force that the maximum friction allows.
    fn drag(&self, finger: usize) -> f64 {
        let felt = self.touch.fingers.get(finger);
        felt.map_or(0.0, |felt| felt.shear) / (self.cap.most_friction * self.grip())
    }

    fn end(&mut self, outcome: &'static str) {
        self.outcome = self.outcome.or(Some(outcome));
    }

    /// Updates the recorded findings; `torque` is the current torque on the cap (N·m).
    fn note(&mut self, torque: f64) {
        let grips = self.touch.fingers.iter().map(|finger| finger.grip);
        let found = [
            ("torque_nm", torque),
            ("turned_rad", self.turned + self.stroke_turn),
            ("grip_n", grips.fold(f64::INFINITY, f64::min)),
            ("radius_m", self.touch.radius().unwrap_or(0.0)),
            ("largest_torque_nm", self.curve.largest),
            ("stiffness_nm_per_rad", self.stiffness().unwrap_or(0.0)),
        ];
        self.findings = found.map(|(name, value)| Finding { name, value });
    }

    /// Speed towards the axis that regulates the grip of `finger` (m/s).
    fn press(&self, finger: usize) -> f64 {
        let Some(felt) = self.touch.fingers.get(finger) else {
            return 0.0;
        };
        let missing = self.grip() - felt.grip;
        let left = GUARDED * self.cap.damage_force - felt.largest;
        let (inward, outward) = (self.config.search_speed, self.config.return_speed);
        (self.cap.grip_gain * missing.min(left)).clamp(-outward, inward)
    }

    /// Speed of the stroke of `finger` (m/s), reduced if it would press an element too hard or drag beyond the
    /// maximum friction.
    fn pace(&self, finger: usize) -> f64 {
        let largest = self.touch.fingers.get(finger).map_or(0.0, |f| f.largest);
        let left = 1.0 - largest / self.cap.damage_force;
        let further = (DRAGGED - self.drag(finger)) / (DRAGGED - SLOWED);
        let share = (left / (1.0 - GUARDED)).min(further);
        self.config.move_speed * share.clamp(0.0, 1.0)
    }
}

impl Task for CapTask {
    fn advance(&mut self, hand: &HandReadings<'_>) -> Result<(), StopReason> {
        self.touch.feel(hand);
        let all = |through: &dyn Fn(&Path, &FingerReadings<'_>) -> bool| {
            let mut fingers = self.paths.iter().zip(hand.fingers());
            fingers.all(|(path, finger)| through(path, &finger))
        };
        match self.phase {
            Phase::Search => self.search(hand),
            Phase::Move => self.screw(hand),
            Phase::Release => {
                if all(&|p, f| p.approached(f.pose.position) <= 0.0) {
                    self.phase = Phase::Return;
                }
            }
            Phase::Return => {
                let tolerance = self.config.home_tolerance;
                if all(&|p, f| p.home.distance(f.pose.position) <= tolerance) {
                    if self.outcome.is_some() {
                        self.phase = Phase::Done;
                    } else {
                        self.stroke += 1;
                        self.phase = Phase::Search;
                    }
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
        let (away, along) = self.touch.directions(position);
        let velocity = match self.phase {
            Phase::Search => self.press(finger) * path.approach,
            Phase::Move if path.travelled(position) < self.config.travel => {
                self.pace(finger) * along - self.press(finger) * away
            }
            Phase::Move => -self.press(finger) * away,
            Phase::Release => -self.config.return_speed * path.approach,
            Phase::Return => homeward(path.home - position, self.config.return_speed),
            Phase::Done | Phase::Stopped => DVec3::ZERO,
        };
        // The task controls the grip. A reflex that presses on slip would never reach the friction limit of a
        // definite grip.
        Plan {
            velocity,
            towards_object: path.approach,
            reflex: false,
            keep_grasp: false,
        }
    }

    accessors!(phase, stroke, findings, outcome);

    fn failed(&self) -> bool {
        self.outcome
            .is_some_and(|o| !["closed", "open"].contains(&o))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::feeler_shape::FeelerShape;
    use crate::control::task::screw::FingerPathConfig;

    const RADIUS: f64 = 0.014;
    const TRAVEL: f64 = 0.02;

    /// Returns a task of two fingers on a cap that is screwed until `until`.
    fn task(until: Until) -> CapTask {
        let finger = |side: f64| FingerPathConfig {
            home: [0.05 * side, 0.0, 0.0],
            approach: [-side, 0.0, 0.0],
            stroke: [0.0, side, 0.0],
        };
        let cap = CapConfig {
            axis: [0.0; 2],
            grip: 8.0,
            damage_force: 4.0,
            grip_gain: 0.002,
            clearance: 0.002,
            still_turn: 0.05,
            most_friction: 1.5,
            softest_seat: 0.0,
            least_turns: 0.0,
            most_turns: 3.0,
            open_turns: 3.0,
            feeler: FeelerShape::default(),
        };
        let config = ScrewConfig {
            until,
            strokes: 20,
            search_speed: 0.01,
            grasp_force: 3.0,
            search_limit: 0.05,
            move_speed: 0.02,
            travel: TRAVEL,
            return_speed: 0.05,
            home_tolerance: 0.001,
            cap: None,
            finger: vec![finger(1.0), finger(-1.0)],
        };
        CapTask::new(&config, &cap)
    }

    /// Returns the outcome after each stroke, given the turn of the cap (rad) and whether both fingers slip.
    fn judged(task: &mut CapTask, strokes: &[(f64, bool)]) -> Vec<Option<&'static str>> {
        let judge = |&(turn, slid): &(f64, bool)| {
            for felt in &mut task.touch.fingers {
                (felt.radius, felt.largest, felt.slid) = (RADIUS, 1.0, slid);
            }
            task.stroke_turn = turn;
            task.turned += turn;
            task.judge();
            task.outcome
        };
        strokes.iter().map(judge).collect()
    }

    const STILL: (f64, bool) = (0.01, true);
    /// Less than half of the turn of a freely turning cap.
    const TURNS: (f64, bool) = (0.3 * TRAVEL / RADIUS, true);

    #[test]
    fn a_cap_has_stood_still_after_two_strokes_in_a_row() {
        for (until, outcome) in [(Until::Closed, "closed"), (Until::Open, "stuck")] {
            let mut task = task(until);
            let strokes = [TURNS, STILL, TURNS, STILL, TURNS, STILL, STILL];
            let mut expected = [None; 7];
            expected[6] = Some(outcome);
            assert_eq!(judged(&mut task, &strokes), expected, "{until:?}");
        }
    }

    #[test]
    fn gentle_strokes_and_strokes_without_slip_do_not_count_as_still() {
        let mut gentle = task(Until::Closed);
        // The first stroke is gentle; it makes the next one firm.
        assert_eq!(
            judged(&mut gentle, &[STILL, STILL, STILL]),
            [None, None, Some("closed")]
        );
        let mut sticks = task(Until::Open);
        let stuck = (STILL.0, false);
        assert_eq!(
            judged(&mut sticks, &[STILL, stuck, STILL, STILL]),
            [None, None, None, Some("stuck")]
        );
    }
}
