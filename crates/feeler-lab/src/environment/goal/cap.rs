//! Goal of closing a cap. Rewards are in mN·m.
//!
//! The potential is the tightening torque of the cap, plus 1 mN·m per radian that the cap turns before its seat. The
//! second term rewards progress towards the seat, where the torque does not rise yet. For a cap that is closed until
//! it is tight, torque above the tight level does not count, and the episode ends there. A cap is tight at the same
//! fraction of the friction limit as in reports.
//!
//! An element that is pressed above its limit costs 10 mN·m per newton and second: 0.1 N too much for one second costs
//! 1 mN·m, a fortieth of the final torque of the reference cap. The limit is that of the claim `no-damage`, 1.25 F2, or
//! the task's `damage_force` if present. Slip work costs 0.05 mN·m per mJ: the reference run slips for 58 mJ, so a
//! tenth of its gain depends on how gentle it is.

use super::{Goal, Seen, Verdict, no_goal};
use crate::config::Experiment;
use crate::environment::EnvironmentError;
use crate::experiment::cap_facts;
use feeler::control::task::TaskConfig;
use feeler_report::claims::DAMAGE_FORCE;
use feeler_report::measures::TIGHT;
use feeler_sim::objects::Motion;

/// Reward per radian by which the cap turns before it reaches its seat (mN·m).
const TURN: f64 = 1.0;
/// Cost per newton above the limit and per second (mN·m).
const OVERLOAD: f64 = 10.0;
/// Cost per joule of slip work (mN·m).
const SLIP: f64 = 50.0;

/// The goal of closing a cap, with its state in the episode.
#[derive(Debug, Clone, Default)]
pub(super) struct CapGoal {
    /// Compression F_z above which an element is overloaded (N).
    limit: f64,
    /// Torque at which the cap counts as tight (N·m). `None` if the number of strokes is fixed.
    tight: Option<f64>,
    /// Angle at which the cap meets its seat (rad).
    seat: f64,
    potential: f64,
    torque: f64,
    angle: f64,
    slip_work: f64,
}

impl CapGoal {
    fn look(&mut self, seen: &Seen<'_>) {
        self.torque = seen.truth.cap_torque.unwrap_or(0.0);
        self.angle = seen.truth.cap_angle.unwrap_or(0.0);
        self.slip_work = seen.truth.slip_work;
        let torque = self.torque.min(self.tight.unwrap_or(f64::INFINITY));
        self.potential = 1e3 * torque + TURN * self.angle.min(self.seat);
    }
}

impl Goal for CapGoal {
    fn names(&self) -> &'static [&'static str] {
        &["cap_torque_nm", "cap_angle_rad"]
    }

    fn begin(&mut self, experiment: &Experiment, seen: &Seen<'_>) -> Result<(), EnvironmentError> {
        let config = &experiment.config;
        let (TaskConfig::Screw(screw), Some((name, ..))) = (&config.task, config.cap()) else {
            return Err(no_goal(experiment));
        };
        let claimed = DAMAGE_FORCE * config.control.over_force;
        self.limit = screw.cap.as_ref().map_or(claimed, |cap| cap.damage_force);
        self.tight = cap_facts(config).map(|cap| TIGHT * cap.friction_limit);
        let object = seen.world.model().object(name);
        let object = object.and_then(|index| seen.world.model().objects.get(index));
        self.seat = match object.map(|object| &object.motion) {
            // The angle of the seat varies with the seed.
            Some(Motion::Turns(hinge)) => hinge.thread.seat_angle,
            _ => return Err(no_goal(experiment)),
        };
        self.look(seen);
        Ok(())
    }

    fn judge(&mut self, seen: &Seen<'_>) -> Verdict {
        let (potential, slip_work) = (self.potential, self.slip_work);
        self.look(seen);
        let gained = self.potential - potential;
        let overload = OVERLOAD * seen.excess(self.limit) * seen.period;
        let slipped = SLIP * (self.slip_work - slip_work);
        Verdict {
            reward: gained - overload - slipped,
            over: self.tight.is_some() && self.reached(),
        }
    }

    /// Returns `true` if the cap is tight or, for a fixed number of strokes, has reached its seat.
    fn reached(&self) -> bool {
        match self.tight {
            Some(tight) => self.torque >= tight,
            None => self.angle >= self.seat,
        }
    }

    fn tell(&self, values: &mut [f64]) {
        values.copy_from_slice(&[self.torque, self.angle]);
    }
}
