//! A cap that is to be closed. Rewards are in mN·m.
//!
//! The potential is the torque that the cap is tightened to, and 1 mN·m for each radian that it turns, as far as its seat:
//! before the seat the torque does not rise, and a stroke that brings the cap nearer to it should not count for nothing. Of a cap
//! that is closed until it is tight, no more torque counts than that, and the episode ends there: tight is what a report calls so, a
//! share of the torque that friction allows.
//!
//! An element that is pressed above its limit costs 10 mN·m for each newton and second: 0.1 N too much for a stroke of a second
//! costs 1 mN·m, a fortieth of what the reference cap is tightened to. The limit is that of the claim `no-damage`, 1.25 F2, or
//! the task's `damage_force` where it has one. Work of slip costs 0.05 mN·m for each mJ: the
//! reference run slips for 58 mJ, so that a tenth of what it gains tells a gentle way from a rough one.

use super::{Goal, Seen, Verdict, no_goal};
use crate::config::Experiment;
use crate::environment::EnvironmentError;
use crate::experiment::cap_facts;
use feeler::control::task::TaskConfig;
use feeler_report::cap::TIGHT;
use feeler_report::claims::DAMAGE_FORCE;
use feeler_sim::object::Motion;

/// Of a radian towards the seat, mN·m.
const TURN: f64 = 1.0;
/// Of a newton above the limit for a second, mN·m.
const OVERLOAD: f64 = 10.0;
/// Of a joule that slip takes, mN·m.
const SLIP: f64 = 50.0;

/// The goal, with its memory.
#[derive(Debug, Clone, Default)]
pub(super) struct CapGoal {
    /// Force F_z above which an element is pressed too hard, N.
    limit: f64,
    /// Torque from which the cap is tight, N·m; none where it is to be as tight as can be.
    tight: Option<f64>,
    /// Angle at which the cap meets its seat, rad.
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
            // The seed varies it.
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

    /// Of strokes that are counted: the cap has met its seat.
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
