//! Minima of the distance from a curve within one cell.

use super::{Curve, Sample};
use glam::DVec2;

/// Newton's method ends with the first step below this (rad). The next one would be below 1e-12, and second-order sine
/// and cosine suffice for this one.
const LAST_STEP: f64 = 1e-7;
/// Maximum number of iterations; enough for bisection alone.
const MAX_ITERATIONS: usize = 64;

impl Curve {
    /// Finds a minimum of the distance between two samples, if any, and stores it in `best` if it is nearer.
    #[inline]
    pub(super) fn improve(&self, best: &mut Sample, point: DVec2, low: &Sample, high: &Sample) {
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

    /// Minimum in a cell whose ends have derivatives of the same sign: the derivative changes sign twice, or not at
    /// all.
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
            // The tangents of the derivative intersect beyond its extremum.
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

    /// Finds the minimum of the distance between the angle `from`, where the distance decreases, and `to`, `width`
    /// (rad) farther, where it increases: Newton's method on the derivative with bisection as fallback. `None` if the
    /// minimum is clearly above `bound` (m^2).
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
            // Four times the drop to the minimum of a parabola.
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
        Some(self.sample_after(point, from, angle))
    }
}

/// Estimated zero of the derivative between two samples `width` (rad) apart: cubic interpolation of the angle as a
/// function of the derivative, or linear interpolation if the derivative is not monotonic.
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
