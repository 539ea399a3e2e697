//! The path of what is carried: from waypoint to waypoint at an even speed, with a stay at each.

use super::Waypoint;
use glam::DVec3;

/// Where on its path an object should be.
#[derive(Debug, Clone)]
pub struct Way {
    waypoints: Vec<Waypoint>,
    /// Speed along the path, m/s.
    speed: f64,
    /// The waypoint that it is on its way to, and since when it has been there, s.
    next: usize,
    arrived: Option<f64>,
    /// Where it should be, m from where it was taken, in W.
    pub wanted: DVec3,
    /// How fast that moves, m/s.
    pub pace: DVec3,
}

impl Way {
    /// The path at its beginning.
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

    /// Goes on for `elapsed` seconds until `stamp`, or waits there unless `ready`; whether it is at the path's end.
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
