//! The carry task: one or more fingers grasp an object, move it along a path by touch, and release it.
//!
//! A single finger presses on the object from above and slides it over a table; several fingers grasp it and may lift
//! it. The grip follows the load and slip ([`grip`]). The object's position is estimated from the tips that stick to
//! it (`odometry`) and controlled along the path.

mod config;
pub mod grip;
mod odometry;
mod way;

pub use config::{CarryConfig, CarryFinger, Waypoint};

use super::homing::homeward;
use super::search::check_search;
use super::surface::touching;
use super::{Finding, Task};
use crate::control::phase::Phase;
use crate::control::plan::Plan;
use crate::control::sense::{FingerReadings, HandReadings};
use crate::control::stop_reason::StopReason;
use crate::hand::MAX_FINGERS;
use glam::DVec3;
use grip::Grip;
use odometry::Odometry;
use way::Way;

/// State of one finger.
#[derive(Debug, Clone, Copy, Default)]
struct Holder {
    home: DVec3,
    approach: DVec3,
    /// Positions at which it grasped and released the object (m, in W).
    took: DVec3,
    let_go: DVec3,
    /// Magnitude of the force on the finger, its component across the approach, and the pressing force (N).
    force: f64,
    shear: f64,
    pressing: f64,
    /// Time of the last touch (s).
    touched: f64,
}

/// State machine of the task.
#[derive(Debug, Clone)]
pub struct Carry {
    config: CarryConfig,
    holders: Vec<Holder>,
    grip: Grip,
    odometry: Odometry,
    phase: Phase,
    way: Way,
    previous: f64,
    findings: [Finding; 6],
    outcome: Option<&'static str>,
}

impl Carry {
    /// Creates the task in its initial state.
    pub fn new(config: &CarryConfig) -> Self {
        let holder = |finger: &CarryFinger| Holder {
            home: finger.home.into(),
            approach: DVec3::from_array(finger.approach).normalize_or_zero(),
            ..Holder::default()
        };
        Self {
            holders: config.finger.iter().take(MAX_FINGERS).map(holder).collect(),
            grip: Grip::new(
                config.friction,
                config.margin,
                config.grip_force,
                RESERVE * config.crush_force,
            ),
            config: config.clone(),
            odometry: Odometry::new(),
            phase: Phase::Search,
            way: Way::new(&config.waypoint, config.carry_speed),
            previous: f64::NAN,
            findings: [
                "moved_x_m",
                "moved_y_m",
                "moved_z_m",
                "turned_rad",
                "pressing_n",
                "friction",
            ]
            .map(Finding::unknown),
            outcome: None,
        }
    }

    /// Updates the forces of each finger and the grip.
    fn feel(&mut self, hand: &HandReadings<'_>) {
        for (holder, finger) in self.holders.iter_mut().zip(hand.fingers()) {
            let forces = touching(&finger, self.config.touch_force);
            let force: DVec3 = forces.map(|(_, force)| force).sum();
            holder.force = force.length();
            holder.pressing = -force.dot(holder.approach);
            holder.shear = force.reject_from_normalized(holder.approach).length();
            if force != DVec3::ZERO {
                holder.touched = hand.stamp;
            }
        }
        if self.phase != Phase::Move {
            return;
        }
        let changes = hand.fingers().any(|finger| finger.flags().slip);
        let (shear, pressing) = (self.mean(|h| h.shear), self.mean(|h| h.pressing));
        self.grip.feel(shear, pressing, changes);
    }

    fn mean(&self, of: impl Fn(&Holder) -> f64) -> f64 {
        self.holders.iter().map(of).sum::<f64>() / self.count()
    }

    fn count(&self) -> f64 {
        self.holders.len().max(1) as f64
    }

    /// Advances along the path if the grip is firm enough. Returns `true` at the end of the path.
    fn go_on(&mut self, stamp: f64) -> bool {
        let firm = FIRM * self.grip.pressing();
        let firm = self.holders.iter().all(|h| h.pressing >= firm);
        self.way.go_on(stamp, stamp - self.previous, firm)
    }

    fn carry(&mut self, hand: &HandReadings<'_>) {
        let config = &self.config;
        self.odometry.follow(
            hand,
            &config.feeler,
            config.touch_force,
            config.slip_threshold,
        );
        let untouched = |h: &Holder| hand.stamp - h.touched > config.lost_time;
        let blocked = |h: &Holder| h.force > BLOCKED * config.crush_force;
        if self.holders.iter().any(untouched) || self.sunk(hand) > config.give {
            self.let_go(hand, "lost");
        } else if self.holders.iter().any(blocked) {
            self.let_go(hand, "blocked");
        } else if self.go_on(hand.stamp) {
            self.let_go(hand, "carried");
        }
        let Odometry { moved, turned, .. } = self.odometry;
        let pressing = self.mean(|h| h.pressing);
        let friction = self.grip.friction();
        // The tips of a single finger are too close together to measure a rotation.
        let turned = if self.holders.len() > 1 {
            turned
        } else {
            f64::NAN
        };
        let values = [moved.x, moved.y, moved.z, turned, pressing, friction];
        for (finding, value) in self.findings.iter_mut().zip(values) {
            finding.value = value;
        }
    }

    /// Mean distance by which the fingers are closer than when they grasped the object (m): the yield of the rubber,
    /// or more if the object is gone.
    fn sunk(&self, hand: &HandReadings<'_>) -> f64 {
        let moved = self.odometry.moved;
        let holders = self.holders.iter().zip(hand.poses);
        let sunk = holders.map(|(h, pose)| (pose.position - h.took - moved).dot(h.approach));
        sunk.sum::<f64>() / self.count()
    }

    fn let_go(&mut self, hand: &HandReadings<'_>, outcome: &'static str) {
        for (holder, pose) in self.holders.iter_mut().zip(hand.poses) {
            holder.let_go = pose.position;
        }
        self.outcome = Some(outcome);
        self.phase = Phase::Release;
    }

    fn all(
        &self,
        hand: &HandReadings<'_>,
        done: impl Fn(&Holder, &FingerReadings<'_>) -> bool,
    ) -> bool {
        let mut fingers = self.holders.iter().zip(hand.fingers());
        fingers.all(|(holder, finger)| done(holder, &finger))
    }

    /// Velocity of a finger that holds the object (m/s, in W).
    fn holding(&self, holder: &Holder, position: DVec3, hand: &HandReadings<'_>) -> DVec3 {
        let config = &self.config;
        let error = self.way.wanted - self.odometry.moved;
        let mut place = self.way.pace + config.place_gain * error;
        if self.holders.len() == 1 {
            // The table supports the object: along the approach only the force is controlled.
            place = place.reject_from_normalized(holder.approach);
        }
        // External forces on the object load the fingers unequally, so the mean is controlled.
        let missing = self.grip.pressing() - self.mean(|h| h.pressing);
        // While an element is over its limit, the finger does not press further.
        let over = hand.fingers().any(|finger| finger.flags().over);
        let most = if over { 0.0 } else { config.press_speed };
        let press = (config.force_gain * missing).clamp(-config.press_speed, most);
        let middle = hand.poses.iter().map(|pose| pose.position).sum::<DVec3>() / self.count();
        let turn_back = DVec3::Z * (-config.place_gain * self.odometry.turned);
        place.clamp_length_max(2.0 * config.carry_speed)
            + press * holder.approach
            + turn_back.cross(position - middle)
    }
}

impl Task for Carry {
    fn advance(&mut self, hand: &HandReadings<'_>) -> Result<(), StopReason> {
        self.feel(hand);
        let config = &self.config;
        match self.phase {
            Phase::Search => {
                for (index, (holder, pose)) in self.holders.iter().zip(hand.poses).enumerate() {
                    if holder.pressing < config.grip_force {
                        let travel = (pose.position - holder.home).dot(holder.approach);
                        check_search(index, travel, config.search_limit)?;
                    }
                }
                if self.all(hand, |h, _| h.pressing >= config.grip_force) {
                    for (holder, pose) in self.holders.iter_mut().zip(hand.poses) {
                        holder.took = pose.position;
                    }
                    self.odometry.reset();
                    self.phase = Phase::Move;
                }
            }
            Phase::Move => self.carry(hand),
            Phase::Release => {
                let clear = |h: &Holder, f: &FingerReadings<'_>| {
                    (f.pose.position - h.let_go).dot(h.approach) <= -CLEARANCE
                };
                if self.all(hand, clear) {
                    self.phase = Phase::Return;
                }
            }
            Phase::Return => {
                let home = |h: &Holder, f: &FingerReadings<'_>| {
                    h.home.distance(f.pose.position) <= config.home_tolerance
                };
                if self.all(hand, home) {
                    self.phase = Phase::Done;
                }
            }
            Phase::Done | Phase::Stopped => {}
        }
        self.previous = hand.stamp;
        Ok(())
    }

    fn plan(&self, finger: usize, hand: &HandReadings<'_>) -> Plan {
        let (Some(holder), Some(sense)) = (self.holders.get(finger), hand.finger(finger)) else {
            return Plan::default();
        };
        let config = &self.config;
        let position = sense.pose.position;
        let velocity = match self.phase {
            Phase::Search if holder.pressing < config.grip_force => {
                config.search_speed * holder.approach
            }
            Phase::Move => self.holding(holder, position, hand),
            Phase::Release => -config.return_speed * holder.approach,
            Phase::Return => homeward(holder.home - position, config.return_speed),
            _ => DVec3::ZERO,
        };
        Plan {
            velocity,
            towards_object: holder.approach,
            ..Plan::default()
        }
    }

    accessors!(phase, findings, outcome);

    fn failed(&self) -> bool {
        self.outcome.is_some_and(|outcome| outcome != "carried")
    }
}

/// Share of the crushing force that the grip may reach. The sum of the elements' compressions exceeds their
/// resultant, and force control is never exact.
const RESERVE: f64 = 0.85;

/// Share of the requested grip that each finger must have before the object is moved.
const FIRM: f64 = 0.8;

/// Multiple of the crushing force at which the object counts as blocked: it rests on another object or is caught.
const BLOCKED: f64 = 1.5;

/// Distance by which a finger leaves the object before it returns (m).
const CLEARANCE: f64 = 0.004;
