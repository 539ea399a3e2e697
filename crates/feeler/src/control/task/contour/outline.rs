//! Size and closure of an outline that is traced point by point.

use crate::math::angle_to;
use glam::DVec2;

/// Summary of a traced outline; the points themselves are not stored.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outline {
    first: Option<DVec2>,
    last: DVec2,
    lowest: DVec2,
    highest: DVec2,
    /// Accumulated rotation of the surface normal, counterclockwise (rad).
    turned: f64,
    normal: DVec2,
}

impl Outline {
    /// Creates an empty outline.
    pub fn new() -> Self {
        Self {
            first: None,
            last: DVec2::ZERO,
            lowest: DVec2::INFINITY,
            highest: DVec2::NEG_INFINITY,
            turned: 0.0,
            normal: DVec2::ZERO,
        }
    }

    /// Adds a point (m) with its outward unit normal.
    pub fn add(&mut self, point: DVec2, normal: DVec2) {
        if self.first.is_none() {
            self.first = Some(point);
        } else {
            self.turned += angle_to(self.normal, normal);
        }
        (self.lowest, self.highest) = (self.lowest.min(point), self.highest.max(point));
        (self.last, self.normal) = (point, normal);
    }

    /// Extent of the outline along x and y of W (m).
    pub fn size(&self) -> DVec2 {
        self.highest - self.lowest
    }

    /// Accumulated rotation of the normal (rad).
    pub fn turned(&self) -> f64 {
        self.turned
    }

    /// Distance between the first and the latest point (m).
    pub fn gap(&self) -> f64 {
        self.first
            .map_or(f64::INFINITY, |first| first.distance(self.last))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn an_ellipse_closes_after_one_turn_with_its_axes_as_its_size() {
        let mut outline = Outline::new();
        let axes = DVec2::new(0.012, 0.007);
        for i in 0..=1000 {
            let direction = DVec2::from_angle(TAU * f64::from(i) / 1000.0);
            let normal = (direction / axes).normalize();
            outline.add(DVec2::new(0.1, 0.2) + axes * direction, normal);
        }
        assert!((outline.turned() - TAU).abs() < 1e-9);
        assert!(outline.gap() < 1e-12);
        assert!(outline.size().distance(2.0 * axes) < 1e-12);
    }

    #[test]
    fn going_to_and_fro_does_not_turn() {
        let mut outline = Outline::new();
        assert_eq!(outline.gap(), f64::INFINITY);
        for x in [0.0, 1.0, 2.0, 1.0, 0.5] {
            outline.add(DVec2::new(x, 1.0), DVec2::Y);
        }
        assert_eq!((outline.turned(), outline.gap()), (0.0, 0.5));
        assert_eq!(outline.size(), DVec2::new(2.0, 0.0));
    }
}
