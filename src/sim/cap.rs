//! The cap on its thread: a torque that resists turning, and a seat that stops it (design, section 8).

use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Newton steps per time step; three suffice unless every feeler is at its friction limit.
const MAX_ITERATIONS: usize = 32;
/// Torques are balanced to this, N·m: far below what the torque sensor resolves (0.1 mN·m).
const TORQUE_TOLERANCE: f64 = 1e-9;

/// A round cap, its thread and its seat.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CapConfig {
    /// Radius, m.
    pub radius: f64,
    /// Height, m.
    pub height: f64,
    /// Centre of the open cap in W, m.
    pub position: [f64; 3],
    /// Torque that turns the cap before it is seated, N·m.
    pub running_torque: f64,
    /// Angle by which the cap turns before it meets its seat, rad.
    pub seat_angle: f64,
    /// Rise of the resisting torque once the cap is on its seat, N·m/rad.
    pub seat_stiffness: f64,
    /// Torque that sets the cap going, relative to the torque that keeps it going, at least 1.
    pub static_factor: f64,
    /// Descent per turn, m.
    pub lead: f64,
}

/// How the cap stands.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct CapState {
    /// Angle by which the cap has been turned on the bottle, rad, positive when closing
    /// (counter-clockwise about W's z, as seen from above).
    pub angle: f64,
    /// Angle by which the bottle has turned with the torque sensor's shaft, rad.
    pub twist: f64,
    /// Whether the cap turned on the bottle in the last step.
    pub turning: bool,
    /// Torque about W's z on the bottle by the cap, N·m.
    pub torque: f64,
}

/// What the fingers do to the cap at one angle of it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Grip {
    /// Torque about W's z on the cap by the fingers, N·m.
    pub torque: f64,
    /// By how much that torque falls per angle that the cap gives way, N·m/rad, at least 0.
    pub stiffness: f64,
}

/// Position and rotation of the cap in W.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CapPose {
    /// The cap's centre, m.
    pub centre: DVec3,
    /// From the cap's frame to W.
    pub rotation: DMat3,
}

impl CapConfig {
    /// Torque that resists turning at `angle` (rad) while the cap turns, N·m.
    pub fn resisting_torque(&self, angle: f64) -> f64 {
        self.running_torque + self.seat_stiffness * (angle - self.seat_angle).max(0.0)
    }

    /// Pose of the cap in `state`; `start_angle` is the rotation (rad) of its frame at angle 0.
    pub fn pose(&self, state: &CapState, start_angle: f64) -> CapPose {
        let descent = self.lead * state.angle / TAU;
        CapPose {
            centre: DVec3::from_array(self.position) - descent * DVec3::Z,
            rotation: DMat3::from_rotation_z(start_angle + state.angle + state.twist),
        }
    }

    /// Turns the cap and the bottle under it until their torques balance the fingers' `grip`.
    ///
    /// The cap sticks to its thread while the grip's torque is below the resisting torque
    /// (`static_factor` times that, unless it was turning already), and otherwise turns until both
    /// are equal. The bottle follows the torque against `shaft_stiffness`, N·m/rad.
    pub fn turn(
        &self,
        state: &mut CapState,
        shaft_stiffness: f64,
        grip: impl Fn(&CapState) -> Grip,
    ) {
        let factor = if state.turning {
            1.0
        } else {
            self.static_factor
        };
        let (start, breakaway) = (state.angle, factor * self.resisting_torque(state.angle));
        // Which way the cap turns, once it does.
        let mut direction = None;
        for _ in 0..MAX_ITERATIONS {
            let Grip { torque, stiffness } = grip(state);
            state.torque = torque;
            if direction.is_none() && torque.abs() > breakaway + TORQUE_TOLERANCE {
                direction = Some(torque.signum());
            }
            let unbalance = if let Some(direction) = direction {
                let slope = stiffness + self.resistance_slope(state.angle, torque);
                let excess = direction * torque - self.resisting_torque(state.angle);
                // The thread holds; it never turns the cap back.
                let turned =
                    direction * (state.angle - start) + excess / slope.max(f64::MIN_POSITIVE);
                state.angle = start + direction * turned.max(0.0);
                let twist = direction * self.resisting_torque(state.angle) / shaft_stiffness;
                let unbalance = excess
                    .abs()
                    .max(shaft_stiffness * (twist - state.twist).abs());
                state.twist = twist;
                unbalance
            } else {
                let unbalance = torque - shaft_stiffness * state.twist;
                state.twist += unbalance / (shaft_stiffness + stiffness);
                unbalance.abs()
            };
            if unbalance <= TORQUE_TOLERANCE {
                break;
            }
        }
        state.turning = direction.is_some();
    }

    /// Rise of the resisting torque per angle in the direction of `torque`. A seated cap that comes
    /// loose meets less and less resistance; counting that as 0 keeps the steps stable.
    fn resistance_slope(&self, angle: f64, torque: f64) -> f64 {
        if torque > 0.0 && angle >= self.seat_angle {
            self.seat_stiffness
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cap() -> CapConfig {
        CapConfig {
            radius: 0.014,
            height: 0.02,
            position: [0.0, 0.0, 0.1],
            running_torque: 0.003,
            seat_angle: 0.35,
            seat_stiffness: 0.5,
            static_factor: 1.05,
            lead: 0.003,
        }
    }

    /// A grip like a torsion spring of `stiffness` whose far end was turned to `drive`.
    fn spring(stiffness: f64, drive: f64) -> impl Fn(&CapState) -> Grip {
        move |state| Grip {
            torque: stiffness * (drive - state.angle - state.twist),
            stiffness,
        }
    }

    #[test]
    fn a_seated_cap_stops_where_the_spring_and_the_seat_balance() {
        let (cap, mut state, spring_stiffness) = (cap(), CapState::default(), 0.3);
        for drive in 1..=600 {
            cap.turn(
                &mut state,
                1e9,
                spring(spring_stiffness, 1e-3 * f64::from(drive)),
            );
        }
        // k (drive - angle) = T_run + k_seat (angle - seat)
        let expected = (spring_stiffness * 0.6 - cap.running_torque
            + cap.seat_stiffness * cap.seat_angle)
            / (spring_stiffness + cap.seat_stiffness);
        assert!((state.angle - expected).abs() < 1e-6);
        assert!((state.torque - cap.resisting_torque(state.angle)).abs() < 1e-6);
    }

    #[test]
    fn a_cap_sticks_until_the_static_torque_is_reached() {
        let (cap, mut state) = (cap(), CapState::default());
        cap.turn(&mut state, 1e9, spring(1.0, 0.00314));
        assert_eq!((state.angle, state.turning), (0.0, false));
        cap.turn(&mut state, 1e9, spring(1.0, 0.00316));
        assert!((state.angle - 0.00016).abs() < 1e-6, "{}", state.angle);
    }

    #[test]
    fn the_bottle_twists_by_torque_over_shaft_stiffness() {
        let (cap, mut state) = (cap(), CapState::default());
        cap.turn(&mut state, 10.0, spring(1.0, 0.002));
        assert!((state.twist - state.torque / 10.0).abs() < 1e-9);
        assert!((state.torque - 0.002 / 1.1).abs() < 1e-8);
    }
}
