//! Objects that turn about an axis: a cap on its thread with a seat, or a hinge.

pub use super::thread_config::{HingeConfig, ThreadConfig};

use super::holder::PlaySpring;
use super::pose::{Pose, Screw};
use feeler::hand::sin_cos_of;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::TAU;

/// Maximum number of Newton steps per time step; three suffice unless every feeler is at its friction limit.
const MAX_ITERATIONS: usize = 32;
/// Assumed relative error of a grip's stiffness. In the reference run it exceeds 4e-5 in one of a hundred steps.
const STIFFNESS_ERROR: f64 = 1e-4;
/// Tolerance of the torque balance (N·m), far below the resolution of the torque sensor (0.1 mN·m).
const TORQUE_TOLERANCE: f64 = 1e-9;

/// Rotational joint of an object about its z axis: a thread, or a hinge without seat and lead.
#[derive(Debug, Clone, PartialEq)]
pub struct Hinge {
    /// Parameters of the thread.
    pub thread: ThreadConfig,
    /// `true` if the support yields to the torque, as the shaft of the torque sensor does.
    pub on_torque_sensor: bool,
}

/// State of an object on a hinge or thread.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Turn {
    /// Angle of the object (rad), positive in the closing direction: counter-clockwise about its z, seen from above.
    pub angle: f64,
    /// Angle by which the support has turned, within its play and with the torque sensor's shaft (rad).
    pub twist: f64,
    /// Displacement of the support along W's x and y (m).
    pub shift: DVec2,
    /// `true` if the object turned in the last step.
    pub turning: bool,
    /// Torque on the support about the object's z (N·m).
    pub torque: f64,
}

impl Turn {
    /// Returns `true` if the object has no load and its support is not deflected.
    pub(crate) fn is_unloaded(&self) -> bool {
        self.torque == 0.0 && self.twist == 0.0 && self.shift == DVec2::ZERO && !self.turning
    }
}

/// Load of the fingers on the object along a degree of freedom: rotation about its z, or translation.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FingerLoad {
    /// Torque (N·m) or force (N) on the object.
    pub load: f64,
    /// Decrease of the load per motion of the object (N·m/rad or N/m), valid for motions up to `room`.
    pub stiffness: f64,
    /// Stiffness if all feelers were sticking, at least 0.
    pub firm: f64,
    /// Lower bound of the motion (rad or m) before a feeler changes between stick and slip; 0 if unknown.
    pub room: f64,
}

impl Hinge {
    /// Creates a hinge that is not on the torque sensor.
    pub fn plain(hinge: &HingeConfig) -> Self {
        Self {
            thread: ThreadConfig {
                running_torque: hinge.running_torque,
                seat_angle: f64::INFINITY,
                seat_stiffness: 0.0,
                static_factor: hinge.static_factor,
                lead: 0.0,
                fault: None,
            },
            on_torque_sensor: false,
        }
    }

    /// Creates the thread of a cap whose bottle is mounted on the torque sensor.
    pub fn on_thread(thread: &ThreadConfig) -> Self {
        Self {
            thread: thread.clone(),
            on_torque_sensor: true,
        }
    }

    /// Pose of the object in the state `turn`, for its pose `start` at angle 0.
    pub fn pose(&self, turn: &Turn, start: &Pose) -> Pose {
        let descent = self.thread.lead * turn.angle / TAU;
        let (sine, cosine) = sin_cos_of(turn.angle + turn.twist);
        let turned = DMat3::from_cols(
            DVec3::new(cosine, sine, 0.0),
            DVec3::new(-sine, cosine, 0.0),
            DVec3::Z,
        );
        Pose {
            position: start.position + turn.shift.extend(0.0) - descent * start.rotation.z_axis,
            rotation: start.rotation * turned,
        }
    }

    /// Motion of the object between two states with the same shift.
    #[inline(always)]
    pub(crate) fn screw(&self, from: &Turn, to: &Turn) -> Screw {
        let turned = to.angle - from.angle;
        let (sine, cosine) = sin_cos_of(turned + to.twist - from.twist);
        Screw {
            sine,
            cosine,
            advance: -self.thread.lead * turned / TAU,
        }
    }

    /// Turns the object and the torque sensor's shaft until they balance the fingers' `grip`.
    ///
    /// The object sticks while the grip's torque is below the resisting torque, times `static_factor` unless the object
    /// was already turning. Otherwise it turns until both are equal. The support turns against `shaft` (rad, N·m).
    ///
    /// The search starts at the state plus `ahead` (angle and twist, rad), a prediction that reduces iterations.
    pub fn turn(
        &self,
        state: &mut Turn,
        ahead: (f64, f64),
        shaft: &PlaySpring,
        grip: impl Fn(&Turn) -> FingerLoad,
    ) {
        let thread = &self.thread;
        let factor = if state.turning {
            1.0
        } else {
            thread.static_factor
        };
        let (start, breakaway) = (state.angle, factor * thread.resisting_torque(state.angle));
        // With play, the twist is not predicted: within the play it stays where the fingers left it.
        if !shaft.has_play() {
            state.twist += ahead.1;
        }
        state.angle += ahead.0;
        // Direction of the turn, once the object breaks away.
        let mut direction = None;
        for _ in 0..MAX_ITERATIONS {
            let grip = grip(state);
            let torque = grip.load;
            let held = !self.on_torque_sensor || shaft.holds(state.twist, torque);
            if direction.is_none() {
                // Breakaway depends on the torque at the start angle, which can be extrapolated only within `room`.
                let ahead = state.angle - start;
                let pulled = torque + grip.stiffness * ahead;
                let is_known = ahead.abs() < grip.room || ahead == 0.0;
                if is_known && held && pulled.abs() > breakaway + TORQUE_TOLERANCE {
                    direction = Some(pulled.signum());
                } else if ahead != 0.0 {
                    state.angle = start;
                    continue;
                }
            }
            let was_turning = state.turning;
            state.turning = direction.is_some();
            let onward = direction.map(|direction| (start, direction));
            let mut step = self.newton(state, onward, shaft, torque, grip.stiffness);
            // Beyond `room`, slipping feelers may stick. The stiffness of sticking feelers prevents overshoot.
            let is_exact = step.way(state).abs() < grip.room;
            if !is_exact {
                step = self.newton(state, onward, shaft, torque, grip.firm);
            }
            let way = step.way(state).abs();
            (state.angle, state.twist, state.torque) = (step.angle, step.twist, step.torque);
            // Bound of the remaining unbalance: second order in the step, unless the thread's resistance has a kink.
            let left = grip.firm * way * (STIFFNESS_ERROR + way) + step.bend;
            let is_known = is_exact && was_turning == state.turning && !shaft.has_play();
            if step.unbalance <= TORQUE_TOLERANCE || is_known && left <= TORQUE_TOLERANCE {
                break;
            }
        }
    }

    /// Computes the Newton step of an object in `state`, for the fingers' `torque` (N·m) and its decrease per rotation,
    /// `stiffness` (N·m/rad). `onward` is the start angle (rad) and direction (±1) of a turning object, or `None` if it
    /// sticks.
    fn newton(
        &self,
        state: &Turn,
        onward: Option<(f64, f64)>,
        shaft: &PlaySpring,
        torque: f64,
        stiffness: f64,
    ) -> Step {
        let mut step = Step {
            angle: state.angle,
            twist: state.twist,
            torque,
            unbalance: 0.0,
            bend: 0.0,
        };
        let twist = match onward {
            Some(onward) => {
                self.turn_further(&mut step, onward, shaft, stiffness);
                shaft.way(onward.1 * self.thread.resisting_torque(step.angle))
            }
            // Without turning, the object moves only with the shaft.
            None => shaft.give(state.twist, torque, stiffness),
        };
        if self.on_torque_sensor {
            step.unbalance = step.unbalance.max(shaft.load_over(twist - state.twist));
            step.twist = twist;
        }
        step.torque = torque - stiffness * step.way(state);
        step
    }

    /// Newton step of the angle of an object that turns from `start` in `direction`.
    fn turn_further(
        &self,
        step: &mut Step,
        (start, direction): (f64, f64),
        shaft: &PlaySpring,
        stiffness: f64,
    ) {
        let (thread, torque, before) = (&self.thread, step.torque, step.angle);
        let resisting = thread.resisting_torque(before);
        let rise = thread.resistance_slope(before, torque);
        // The thread's resistance twists the support, which reduces the torque of the grip.
        let (lag, follows) = match self.on_torque_sensor {
            true => {
                let lag = shaft.way(direction * resisting) - step.twist;
                (lag, 1.0 + shaft.way_over(rise))
            }
            false => (0.0, 1.0),
        };
        let slope = stiffness * follows + rise;
        let excess = direction * (torque - stiffness * lag) - resisting;
        let turned = direction * (before - start) + excess / slope.max(f64::MIN_POSITIVE);
        // Friction holds the object: it never turns back.
        step.angle = start + direction * turned.max(0.0);
        let resists = thread.resisting_torque(step.angle);
        let straight = rise * direction * (step.angle - before);
        step.bend = (resists - resisting - straight).abs();
        step.unbalance = (direction * torque - resisting).abs();
    }
}

/// Result of a Newton step.
struct Step {
    /// Angle of the cap after the step (rad).
    angle: f64,
    /// New twist (rad).
    twist: f64,
    /// Torque of the fingers at the new angle (N·m).
    torque: f64,
    /// Unbalance of the torques before the step (N·m).
    unbalance: f64,
    /// Deviation of the thread's resistance from its linearization over the step (N·m).
    bend: f64,
}

impl Step {
    /// Rotation of the object in this step (rad).
    fn way(&self, from: &Turn) -> f64 {
        self.angle - from.angle + self.twist - from.twist
    }
}

#[cfg(test)]
mod tests {
    use super::super::thread_config::ThreadFault;
    use super::*;

    fn cap() -> Hinge {
        Hinge::on_thread(&ThreadConfig {
            running_torque: 0.003,
            seat_angle: 0.35,
            seat_stiffness: 0.5,
            static_factor: 1.05,
            lead: 0.003,
            fault: None,
        })
    }

    /// Load of a torsion spring of `stiffness` (N·m/rad) between the object and a drive at the angle `drive` (rad).
    fn spring(stiffness: f64, drive: f64) -> impl Fn(&Turn) -> FingerLoad {
        move |state| FingerLoad {
            load: stiffness * (drive - state.angle - state.twist),
            stiffness,
            firm: stiffness,
            room: f64::INFINITY,
        }
    }

    #[test]
    fn a_seated_cap_stops_in_balance_with_the_spring() {
        let (cap, mut state, spring_stiffness) = (cap(), Turn::default(), 0.3);
        for drive in 1..=600 {
            cap.turn(
                &mut state,
                (0.0, 0.0),
                &PlaySpring::new(1e9, 0.0),
                spring(spring_stiffness, 1e-3 * f64::from(drive)),
            );
        }
        let thread = &cap.thread;
        // k (drive - angle) = T_run + k_seat (angle - seat)
        let expected = (spring_stiffness * 0.6 - thread.running_torque
            + thread.seat_stiffness * thread.seat_angle)
            / (spring_stiffness + thread.seat_stiffness);
        assert!((state.angle - expected).abs() < 1e-6);
        assert!((state.torque - thread.resisting_torque(state.angle)).abs() < 1e-6);
    }

    #[test]
    fn a_cap_sticks_until_the_static_torque_is_reached() {
        let (cap, mut state) = (cap(), Turn::default());
        cap.turn(
            &mut state,
            (0.0, 0.0),
            &PlaySpring::new(1e9, 0.0),
            spring(1.0, 0.00314),
        );
        assert_eq!((state.angle, state.turning), (0.0, false));
        cap.turn(
            &mut state,
            (0.0, 0.0),
            &PlaySpring::new(1e9, 0.0),
            spring(1.0, 0.00316),
        );
        assert!((state.angle - 0.00016).abs() < 1e-6, "{}", state.angle);
    }

    #[test]
    fn the_bottle_twists_by_torque_over_shaft_stiffness() {
        let (cap, mut state) = (cap(), Turn::default());
        cap.turn(
            &mut state,
            (0.0, 0.0),
            &PlaySpring::new(10.0, 0.0),
            spring(1.0, 0.002),
        );
        assert!((state.twist - state.torque / 10.0).abs() < 1e-9);
        assert!((state.torque - 0.002 / 1.1).abs() < 1e-8);
    }

    #[test]
    fn balance_is_independent_of_the_initial_guess() {
        // The cap sticks, turns, and is on its seat.
        for drive in [0.002, 0.2, 0.6] {
            let turned = |ahead| {
                let mut state = Turn::default();
                let shaft = PlaySpring::new(10.0, 0.0);
                cap().turn(&mut state, ahead, &shaft, spring(1.0, drive));
                state
            };
            let expected = turned((0.0, 0.0));
            for ahead in [(0.1, 0.0), (0.0, -1e-3), (0.5, 1e-3), (-0.3, 2e-4)] {
                let found = turned(ahead);
                let off = (found.torque - expected.torque).abs();
                // Each is balanced to 1e-9 N·m.
                assert!(off < 2e-9, "{found:?} from {ahead:?}, not {expected:?}");
                assert!((found.angle - expected.angle).abs() < 1e-8, "{found:?}");
                assert_eq!(found.turning, expected.turning);
            }
        }
    }

    #[test]
    fn a_hinge_without_friction_follows_the_spring() {
        let hinge = Hinge::plain(&HingeConfig {
            running_torque: 0.0,
            static_factor: 1.0,
        });
        let mut state = Turn::default();
        hinge.turn(
            &mut state,
            (0.0, 0.0),
            &PlaySpring::new(50.0, 0.0),
            spring(0.2, 1.5),
        );
        assert!((state.angle - 1.5).abs() < 1e-8, "{}", state.angle);
        assert_eq!(state.twist, 0.0);
    }

    #[test]
    fn crossed_threads_resist_before_the_seat_and_stripped_threads_never() {
        let Hinge { thread, .. } = cap();
        let crossed = ThreadConfig {
            fault: Some(ThreadFault::CrossThreaded {
                angle: 0.1,
                stiffness: 0.04,
            }),
            ..thread.clone()
        };
        // Computed by hand: 3 mN·m, 0.04 * 0.2, and on the seat 0.04 * 0.3 + 0.5 * 0.05.
        assert!((crossed.resisting_torque(0.3) - 0.011).abs() < 1e-12);
        assert!((crossed.resisting_torque(0.4) - 0.040).abs() < 1e-12);
        let stripped = ThreadConfig {
            fault: Some(ThreadFault::Stripped),
            ..thread
        };
        assert_eq!(stripped.resisting_torque(20.0), 0.003);
    }
}
