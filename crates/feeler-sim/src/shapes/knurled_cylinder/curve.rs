//! Edge of a knurled, slightly oval disc: `c(phi) = r(phi) (cos phi, sin phi)` with
//! `r(phi) = radius (1 + ovality cos 2 phi) + depth / 2 (cos(knurls phi) - 1)`.
//!
//! The distance from a point has a local minimum at almost every knurl. The search first bounds the angles of the
//! global minimum, then divides them into cells at the crests, the bottoms and halfway between. Newton's method finds
//! the minimum in every cell that can contain the global one.

mod minimum;

use feeler::math::direction_at;
use glam::DVec2;
use std::f64::consts::{PI, TAU};

/// Number of cells per knurl. The curvature is monotonic between a crest and the next bottom, so the distance has at
/// most one minimum and one maximum there.
const CELLS: i64 = 4;
/// Number of cells per knurl if there are fewer than [`FEW_KNURLS`].
const MANY_CELLS: i64 = 32;
const FEW_KNURLS: u32 = 4;

/// Cross-section curve of a knurled cylinder, with precomputed values.
#[derive(Debug, Clone)]
pub struct Curve {
    radius: f64,
    knurls: f64,
    depth: f64,
    ovality: f64,
    /// Angle of a cell (rad).
    cell: f64,
    /// Cosine and sine of the angle of a cell.
    step: DVec2,
    /// Number of cells per knurl, a power of two.
    cells: i64,
    /// Cosine and sine of `knurls phi` at the boundaries of cells.
    phases: [DVec2; MANY_CELLS as usize],
    /// Upper bound of the curve's speed `|dc/dphi|` (m/rad).
    max_speed: f64,
}

/// A point of the curve, relative to a query point.
#[derive(Clone, Copy)]
struct Sample {
    /// Cosine and sine of `phi`.
    direction: DVec2,
    /// Cosine and sine of `knurls phi`.
    phase: DVec2,
    radius: f64,
    /// Derivative of the radius with respect to `phi`.
    slope: f64,
    /// Squared distance from the query point (m^2).
    square: f64,
    /// Half of the first derivative of `square` with respect to `phi`.
    first: f64,
    /// Half of the second derivative of `square` with respect to `phi`.
    second: f64,
}

impl Curve {
    /// Creates a curve of `radius` and `depth` (m).
    pub fn new(radius: f64, knurls: u32, depth: f64, ovality: f64) -> Self {
        let cells = if knurls < FEW_KNURLS {
            MANY_CELLS
        } else {
            CELLS
        };
        let cell = TAU / (f64::from(knurls.max(1)) * cells as f64);
        let phase = |k: usize| match knurls {
            0 => DVec2::X,
            _ => direction_at(TAU * k as f64 / cells as f64),
        };
        let knurls = f64::from(knurls);
        let max_slope = 2.0 * radius * ovality.abs() + knurls * depth / 2.0;
        Self {
            radius,
            knurls,
            depth: if knurls == 0.0 { 0.0 } else { depth },
            ovality,
            cell,
            step: direction_at(cell),
            cells,
            phases: std::array::from_fn(phase),
            max_speed: libm::hypot(max_slope, radius * (1.0 + ovality.abs())),
        }
    }

    /// Lower bound of the radius (m).
    pub fn innermost_radius(&self) -> f64 {
        self.radius * (1.0 - self.ovality.abs()) - self.depth
    }

    /// Nearest point of the curve, its outward normal, and the signed distance from it.
    pub fn nearest(&self, point: DVec2) -> (DVec2, DVec2, f64) {
        if self.depth == 0.0 && self.ovality == 0.0 {
            let (normal, length) = point.normalize_and_length();
            let normal = if length > 0.0 { normal } else { DVec2::X };
            return (self.radius * normal, normal, length - self.radius);
        }
        let nearest = self.nearest_sample(point);
        let (radial, tangential) = (nearest.direction, nearest.direction.perp());
        let normal = (nearest.radius * radial - nearest.slope * tangential).normalize_or(radial);
        let position = nearest.radius * radial;
        let distance = nearest.square.sqrt();
        let outside = (point - position).dot(normal) >= 0.0;
        (position, normal, if outside { distance } else { -distance })
    }

    /// Finds the nearest point of the curve: searches the cells on both sides of a first guess, as far as
    /// [`Self::reach`].
    fn nearest_sample(&self, point: DVec2) -> Sample {
        let angle = point.to_angle();
        let (guess, at) = self.first_guess(point, angle);
        let reach = self.reach(point, guess.square);
        let up = ((angle + reach) / self.cell).ceil() as i64;
        let down = ((angle - reach) / self.cell).floor() as i64;
        let mut best = guess;
        let mut low = guess;
        for k in at + 1..=up.max(at + 1) {
            let high = self.sample(point, low.direction.rotate(self.step), self.phase(k));
            self.improve(&mut best, point, &low, &high);
            low = high;
        }
        let back = DVec2::new(self.step.x, -self.step.y);
        let mut high = guess;
        for k in (down.min(at - 1)..at).rev() {
            let low = self.sample(point, high.direction.rotate(back), self.phase(k));
            self.improve(&mut best, point, &low, &high);
            high = low;
        }
        best
    }

    /// Initial guess of the nearest point, with the index of its cell boundary: the crest nearest in angle if `point`
    /// is outside, otherwise the nearest groove bottom.
    fn first_guess(&self, point: DVec2, angle: f64) -> (Sample, i64) {
        let knurl = angle / (self.cell * self.cells as f64);
        let outside = point.length() > self.oval_radius(point) - self.depth / 2.0;
        let k = if outside {
            knurl.round() as i64 * self.cells
        } else {
            knurl.floor() as i64 * self.cells + self.cells / 2
        };
        let direction = direction_at(k as f64 * self.cell);
        (self.sample(point, direction, self.phase(k)), k)
    }

    /// Upper bound of the polar angle (rad) between `point` and its nearest point on the curve, if some point of the
    /// curve is at the squared distance `square` (m²). The nearest point is in the circle of that radius around
    /// `point`, and within the curve's range of radii.
    fn reach(&self, point: DVec2, square: f64) -> f64 {
        let length = point.length();
        if square >= length * length {
            return PI;
        }
        // The curve at an angle psi from `point` is at least `length sin(psi)` away.
        let sine = square.sqrt() / length;
        let oval = self.oval_radius(point);
        let change = PI * self.radius * self.ovality.abs() * sine;
        let (inner, outer) = (oval - change - self.depth, oval + change);
        let radius = length.max(inner).min(outer);
        // Tighter bound: the distance to (radius, psi), if the foot of `point` on that ray is on the same side of
        // `radius` as `point`.
        let rest = square - (length - radius).powi(2);
        let half_sine_squared = (rest / (4.0 * length * radius)).clamp(0.0, 1.0);
        let foot = length * (1.0 - 2.0 * half_sine_squared);
        if radius > 0.0 && (length < radius || length > radius && foot >= radius) {
            2.0 * libm::asin(half_sine_squared.sqrt())
        } else {
            libm::asin(sine)
        }
    }

    /// Radius of the curve without knurls at the angle of `point` (m).
    fn oval_radius(&self, point: DVec2) -> f64 {
        let square = point.length_squared();
        let cosine = (point.x * point.x - point.y * point.y) / square.max(f64::MIN_POSITIVE);
        self.radius * (1.0 + self.ovality * cosine)
    }

    fn radius_at(&self, direction: DVec2, cosine_of_phase: f64) -> f64 {
        let cosine = direction.x * direction.x - direction.y * direction.y;
        self.radius * (1.0 + self.ovality * cosine) + self.depth / 2.0 * (cosine_of_phase - 1.0)
    }

    fn phase(&self, k: i64) -> DVec2 {
        self.phases[(k & (self.cells - 1)) as usize]
    }

    fn sample_after(&self, point: DVec2, from: &Sample, angle: f64) -> Sample {
        let direction = from.direction.rotate(direction_at(angle));
        let phase = from.phase.rotate(direction_at(self.knurls * angle));
        self.sample(point, direction, phase)
    }

    #[inline]
    fn sample(&self, point: DVec2, direction: DVec2, phase: DVec2) -> Sample {
        let radius = self.radius_at(direction, phase.x);
        let oval = 2.0 * self.radius * self.ovality;
        let wave = self.depth / 2.0 * self.knurls;
        let slope = -2.0 * oval * direction.x * direction.y - wave * phase.y;
        let cosine = direction.x * direction.x - direction.y * direction.y;
        let bend = -2.0 * oval * cosine - wave * self.knurls * phase.x;
        let (along, across) = (point.dot(direction), direction.perp_dot(point));
        let short = radius - along;
        Sample {
            direction,
            phase,
            radius,
            slope,
            square: short * short + across * across,
            first: slope * short - radius * across,
            second: bend * short + slope * (slope - 2.0 * across) + radius * along,
        }
    }
}
