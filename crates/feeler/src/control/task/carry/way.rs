//! Path of a carried object: from waypoint to waypoint at constant speed, with a stop at each waypoint.

use super::config::Waypoint;
use glam::DVec3;

/// Reference position of an object that moves along a path.
#[derive(Debug, Clone)]
pub struct Way {
    waypoints: Vec<Waypoint>,
    /// Speed along the path (m/s).
    speed: f64,
    /// Index of the next waypoint.
    next: usize,
    /// Time of arrival at that waypoint (s); `None` before.
    arrived: Option<f64>,
    /// Reference position relative to the grasp position (m, in W).
    pub wanted: DVec3,
    /// Reference velocity (m/s, in W).
    pub pace: DVec3,
}

impl Way {
    /// Creates the path in its initial state.
    pub fn new(waypoints: &[Waypoint], speed: f64) -> Self {
        Self {
            waypoints: waypoints.to_vec(),
            speed,
            next: 0,
            arrived: None,
            wanted: DVec3::ZERO,
            pace: DVec3::ZERO,
        }
    }

    /// Advances the reference position by `elapsed` seconds to the time `stamp`; waits unless `ready`. Returns `true`
    /// at the end of the path.
    pub fn go_on(&mut self, stamp: f64, elapsed: f64, ready: bool) -> bool {
        let Some(waypoint) = self.waypoints.get(self.next) else {
            return true;
        };
        let way = DVec3::from_array(waypoint.to) - self.wanted;
        if way.length() > self.speed * elapsed {
            self.pace = if ready {
                self.speed * way.normalize_or_zero()
            } else {
                DVec3::ZERO
            };
            self.wanted += elapsed * self.pace;
            return false;
        }
        self.wanted = waypoint.to.into();
        self.pace = DVec3::ZERO;
        let since = *self.arrived.get_or_insert(stamp);
        if stamp - since >= waypoint.hold {
            self.next += 1;
            self.arrived = None;
        }
        false
    }
}
