//! An upright cylinder with a knurled, slightly oval side: its nearest surface point, exactly.
//!
//! The solid is a plane region times a range of heights, so everything comes from the nearest point
//! of the region's edge, the curve `c(phi) = r(phi) (cos phi, sin phi)`. That has a local minimum of
//! distance on almost every knurl; the angles where the global one can be are bounded first, then
//! cut at the crests, the bottoms and between, and every minimum there is followed by Newton's method.

use super::object::SurfacePoint;
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Cells per knurl. The curvature falls steadily from a crest to the next bottom, so that the
/// distance has at most one minimum and one maximum between them.
const CELLS: i64 = 4;
/// Cells per knurl where there are less than [`FEW_KNURLS`].
const MANY_CELLS: i64 = 32;
const FEW_KNURLS: u32 = 4;
/// Newton's method ends with the first step below this, rad: the next would be below 1e-12, and the
/// sines of this one need no more than the square of its angle.
const LAST_STEP: f64 = 1e-7;
/// Bisection alone would end within so many steps.
const MAX_ITERATIONS: usize = 64;

/// An upright cylinder in its own frame (origin at its centre, z along its axis) whose side has the
/// radius `r(phi) = radius (1 + ovality cos 2 phi) + depth / 2 (cos(knurls phi) - 1)`.
#[derive(Debug, Clone)]
pub struct KnurledCylinder {
    radius: f64,
    half_height: f64,
    knurls: f64,
    depth: f64,
    ovality: f64,
    /// Angle of a cell, rad, and its cosine and sine.
    cell: f64,
    step: DVec2,
    /// Cells per knurl, a power of two.
    cells: i64,
    /// Cosine and sine of `knurls phi` at the cells' ends.
    phases: [DVec2; MANY_CELLS as usize],
    /// No point of the curve moves faster than this with its angle, m/rad.
    max_speed: f64,
}

/// A point of the curve as seen from a query point.
#[derive(Clone, Copy)]
struct Sample {
    /// Cosine and sine of `phi`.
    direction: DVec2,
    /// Cosine and sine of `knurls phi`.
    phase: DVec2,
    radius: f64,
    /// Derivative of the radius by `phi`.
    slope: f64,
    /// Squared distance from the query point, m^2.
    square: f64,
    /// Half of the first and of the second derivative of `square` by `phi`.
    first: f64,
    second: f64,
}

impl KnurledCylinder {
    /// A cylinder of `radius` (at the crests, where `ovality` is 0) and `height`, m, with `knurls`
    /// grooves of `depth`, m, around it. `radius (1 - |ovality|)` must exceed `depth`.
    pub fn new(radius: f64, height: f64, knurls: u32, depth: f64, ovality: f64) -> Self {
        let cells = if knurls < FEW_KNURLS {
            MANY_CELLS
        } else {
            CELLS
        };
        let cell = TAU / (f64::from(knurls.max(1)) * cells as f64);
        let phase = |k: usize| match knurls {
            0 => DVec2::X,
            _ => DVec2::from_angle(TAU * k as f64 / cells as f64),
        };
        let knurls = f64::from(knurls);
        let max_slope = 2.0 * radius * ovality.abs() + knurls * depth / 2.0;
        Self {
            radius,
            half_height: height / 2.0,
            knurls,
            depth: if knurls == 0.0 { 0.0 } else { depth },
            ovality,
            cell,
            step: DVec2::from_angle(cell),
            cells,
            phases: std::array::from_fn(phase),
            max_speed: max_slope.hypot(radius * (1.0 + ovality.abs())),
        }
    }

    /// The surface point nearest to `point` (m, object's frame), or `None` when `point` lies on the
    /// rim to within rounding, where there is no normal, or is not finite.
    pub fn nearest(&self, point: DVec3) -> Option<SurfacePoint> {
        if !point.is_finite() {
            return None;
        }
        let plane = point.truncate();
        let above = point.z.abs() - self.half_height;
        // Under an end the side cannot be nearer than the innermost radius.
        let inside = self.radius * (1.0 - self.ovality.abs()) - self.depth - plane.length();
        if inside > 0.0 && above > -inside {
            return Some(self.on_end(point, above));
        }
        let (edge, normal, side) = self.nearest_on_side(plane);
        if above > 0.0 && side > 0.0 || above.abs().max(side.abs()) <= f64::EPSILON {
            let position = edge.extend(self.half_height.copysign(point.z));
            let (normal, distance) = (point - position).normalize_and_length();
            return (distance > f64::EPSILON).then_some(SurfacePoint {
                position,
                normal,
                distance,
            });
        }
        if above > side {
            return Some(self.on_end(point, above));
        }
        Some(SurfacePoint {
            position: edge.extend(point.z),
            normal: normal.extend(0.0),
            distance: side,
        })
    }

    /// Volume, m^3, and the moments of inertia about the axes x, y, z of the object's frame,
    /// kg m^2, of the solid at `density`, kg/m^3. The products of inertia in the plane vanish.
    pub fn volume_and_inertia(&self, density: f64) -> (f64, DVec3) {
        // Equidistant samples integrate r^4, of at most 4 knurls + 2 periods per turn, exactly.
        let count = 16 * (self.knurls as u64).max(2);
        let weight = TAU / count as f64;
        let (mut area, mut second) = (0.0, DVec2::ZERO);
        for k in 0..count {
            let direction = DVec2::from_angle(k as f64 * weight);
            let phase = (self.knurls * k as f64 * weight).cos();
            let radius = self.radius_at(direction, phase);
            area += weight * radius.powi(2) / 2.0;
            second += weight * radius.powi(4) / 4.0 * direction * direction;
        }
        let height = 2.0 * self.half_height;
        let upright = area * height.powi(3) / 12.0;
        let inertia = DVec3::new(
            height * second.y + upright,
            height * second.x + upright,
            height * (second.x + second.y),
        );
        (area * height, density * inertia)
    }

    fn on_end(&self, point: DVec3, above: f64) -> SurfacePoint {
        SurfacePoint {
            position: DVec3::new(point.x, point.y, self.half_height.copysign(point.z)),
            normal: DVec3::Z * 1.0_f64.copysign(point.z),
            distance: above,
        }
    }

    /// The nearest point of the curve, its outward normal, and the signed distance from it.
    fn nearest_on_side(&self, point: DVec2) -> (DVec2, DVec2, f64) {
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

    /// The nearest point of the curve: cell by cell to both sides of a first guess, as far as it
    /// can be.
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

    /// The crest nearest by angle to a `point` outside, else the nearest bottom; and its cell.
    fn first_guess(&self, point: DVec2, angle: f64) -> (Sample, i64) {
        let knurl = angle / (self.cell * self.cells as f64);
        let outside = point.length() > self.oval_radius(point) - self.depth / 2.0;
        let k = if outside {
            knurl.round() as i64 * self.cells
        } else {
            knurl.floor() as i64 * self.cells + self.cells / 2
        };
        let direction = DVec2::from_angle(k as f64 * self.cell);
        (self.sample(point, direction, self.phase(k)), k)
    }

    /// How far by angle, rad, the nearest point can be from `point`, if some point of the curve is
    /// at the squared distance `square`: as far as a circle about `point` through that reaches
    /// within the radii that the curve has there.
    fn reach(&self, point: DVec2, square: f64) -> f64 {
        let length = point.length();
        if square >= length * length {
            return PI;
        }
        // The curve at an angle psi from the point is at least `length sin(psi)` away.
        let sine = square.sqrt() / length;
        let oval = self.oval_radius(point);
        let change = PI * self.radius * self.ovality.abs() * sine;
        let (inner, outer) = (oval - change - self.depth, oval + change);
        let radius = length.clamp(inner.min(outer), outer);
        // Beside the curve it is at least as far as (radius, psi) too, if the foot of the point on
        // that ray is on the point's side of `radius`.
        let rest = square - (length - radius).powi(2);
        let half_sine_squared = (rest / (4.0 * length * radius)).clamp(0.0, 1.0);
        let foot = length * (1.0 - 2.0 * half_sine_squared);
        if radius > 0.0 && (length < radius || length > radius && foot >= radius) {
            2.0 * half_sine_squared.sqrt().asin()
        } else {
            sine.asin()
        }
    }

    /// The radius of the side at `point`'s angle, were there no knurls.
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
        let direction = from.direction.rotate(DVec2::from_angle(angle));
        let phase = from.phase.rotate(DVec2::from_angle(self.knurls * angle));
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

    /// Puts in place of `best` the minimum of the distance in the cell between two samples, if there
    /// is one and it is nearer.
    #[inline]
    fn improve(&self, best: &mut Sample, point: DVec2, low: &Sample, high: &Sample) {
        let falls = low.first <= 0.0;
        let turns = falls && high.first > 0.0;
        // The derivative may change its sign twice.
        let may_turn = falls == (high.first <= 0.0)
            && (low.second > 0.0) == falls
            && (high.second > 0.0) != falls;
        if !turns && !may_turn {
            return;
        }
        let least = (low.square.sqrt() + high.square.sqrt() - self.max_speed * self.cell) / 2.0;
        if least > 0.0 && least * least > best.square {
            return;
        }
        let found = if turns {
            self.descend(point, low, high, self.cell, best.square)
        } else {
            self.hidden_minimum(point, *low, *high, best.square)
        };
        if let Some(minimum) = found
            && minimum.square < best.square
        {
            *best = minimum;
        }
    }

    /// The minimum in a cell at whose ends the distance falls, or rises, alike: where its
    /// derivative changes sign twice.
    #[cold]
    fn hidden_minimum(
        &self,
        point: DVec2,
        mut a: Sample,
        mut b: Sample,
        bound: f64,
    ) -> Option<Sample> {
        let mut width = self.cell;
        let falls = a.first <= 0.0;
        for _ in 0..MAX_ITERATIONS {
            // The tangents of the derivative meet beyond its extremum.
            let at = (b.first - a.first - b.second * width) / (a.second - b.second);
            let extreme = a.first + a.second * at;
            if (extreme > 0.0) != falls {
                return None;
            }
            width /= 2.0;
            let middle = self.sample_after(point, &a, width);
            if (middle.first > 0.0) == falls {
                let (from, to) = if falls { (a, middle) } else { (middle, b) };
                return self.descend(point, &from, &to, width, bound);
            }
            if (middle.second > 0.0) == falls {
                a = middle;
            } else {
                b = middle;
            }
        }
        None
    }

    /// The minimum between `from`, where the distance falls, and `to`, `width` rad farther, where it
    /// rises: Newton's method on the derivative, kept within the bracket; none if it is clearly above
    /// `bound`, m^2.
    #[inline(never)]
    fn descend(
        &self,
        point: DVec2,
        from: &Sample,
        to: &Sample,
        width: f64,
        bound: f64,
    ) -> Option<Sample> {
        let (mut low, mut high) = (0.0, width);
        let mut angle = first_angle(from, to, width);
        for _ in 0..MAX_ITERATIONS {
            let here = self.sample_after(point, from, angle);
            if here.first <= 0.0 {
                low = angle;
            } else {
                high = angle;
            }
            // Four times as far down as a parabola's bottom.
            let drop = 4.0 * here.first * here.first;
            if here.second > 0.0 && (here.square - bound) * here.second > drop {
                return None;
            }
            let newton = angle - here.first / here.second;
            let next = if here.second > 0.0 && newton >= low && newton <= high {
                newton
            } else {
                (low + high) / 2.0
            };
            let step = next - angle;
            if step.abs() < LAST_STEP {
                let small = |x: f64| DVec2::new(1.0 - x * x / 2.0, x);
                let direction = here.direction.rotate(small(step));
                let phase = here.phase.rotate(small(self.knurls * step));
                return Some(self.sample(point, direction, phase));
            }
            angle = next;
        }
        None
    }
}

/// Where the derivative's sign changes between two samples `width` apart, rad, by the cubic through
/// the angle as a function of the derivative; by the straight line where that is no function.
fn first_angle(from: &Sample, to: &Sample, width: f64) -> f64 {
    let rise = to.first - from.first;
    let at = -from.first / rise;
    let (begin, end) = (rise / from.second, rise / to.second);
    let straight = width * at;
    if begin > 0.0 && end > 0.0 {
        let rest = 1.0 - at;
        let cubic = at * at * (3.0 - 2.0 * at) * width + at * rest * (rest * begin - at * end);
        if cubic > 0.0 && cubic < width {
            return cubic;
        }
    }
    straight
}
