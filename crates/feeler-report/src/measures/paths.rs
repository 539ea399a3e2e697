//! Pure functions that measure paths and series for the claims.

use super::series::{correlation, finite, maximum, rms};
use glam::{DVec2, DVec3};

/// Metres to millimetres.
pub const MM: f64 = 1e3;

/// Largest inward deviation of a path from a straight line (m): the maximum component along `approach` of the path's
/// offset from the line through its first point along `direction`.
///
/// At least 0, because the first point lies on the line. `approach` and `direction` are unit vectors in the frame of
/// the path. `None` for an empty path.
pub fn inward_bend(path: &[DVec3], direction: DVec3, approach: DVec3) -> Option<f64> {
    let start = *path.first()?;
    maximum(path.iter().map(|point| {
        let along = *point - start;
        let offset = along - along.dot(direction) * direction;
        offset.dot(approach)
    }))
}

/// RMS distance between two paths as curves in the horizontal plane (m): from every point of each path to the nearest
/// point of the other, regardless of time. `None` if a path is empty.
pub fn distance_between_paths(a: &[DVec3], b: &[DVec3]) -> Option<f64> {
    if a.is_empty() || b.is_empty() {
        return None;
    }
    let [a, b] = [a, b].map(|path| path.iter().map(|p| p.truncate()).collect::<Vec<_>>());
    let [to_a, to_b] = [&a, &b].map(|path| Polyline::new(path));
    let there = a.iter().map(|&point| to_b.distance(point));
    let back = b.iter().map(|&point| to_a.distance(point));
    rms(there.chain(back))
}

/// A polyline (m).
pub struct Polyline {
    first: Option<DVec2>,
    pieces: Vec<Piece>,
}

struct Piece {
    start: DVec2,
    along: DVec2,
    /// Dot product with this vector gives the fraction of the piece at which a point projects; zero if the piece has no
    /// length.
    to_share: DVec2,
}

impl Polyline {
    /// Polyline through these points (m).
    pub fn new(path: &[DVec2]) -> Self {
        let piece = |ends: &[DVec2]| {
            let (start, along) = (ends[0], ends[1] - ends[0]);
            let length_squared = along.length_squared();
            let to_share = match length_squared > 0.0 {
                true => along / length_squared,
                false => DVec2::ZERO,
            };
            Piece {
                start,
                along,
                to_share,
            }
        };
        Self {
            first: path.first().copied(),
            pieces: path.windows(2).map(piece).collect(),
        }
    }

    /// Distance of a point (m) from the polyline (m); NaN if the polyline is empty.
    pub fn distance(&self, point: DVec2) -> f64 {
        let to_piece = |piece: &Piece| {
            let from_start = point - piece.start;
            let share = from_start.dot(piece.to_share).clamp(0.0, 1.0);
            (from_start - share * piece.along).length_squared()
        };
        let first = self
            .first
            .map_or(f64::NAN, |first| point.distance_squared(first));
        let squares = self.pieces.iter().map(to_piece);
        squares.fold(first, f64::min).sqrt()
    }
}

/// Maximum correlation of two series over a range of lags.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LaggedCorrelation {
    /// Pearson correlation coefficient.
    pub correlation: f64,
    /// Lag of the second series (samples).
    pub lag: i32,
}

/// Maximum correlation of `x` and `y` over pairs of stretches (no sample pair spans two stretches), with `y` delayed by
/// `-max_lag..=max_lag` samples.
pub fn lagged_correlation(
    stretches: &[(Vec<f64>, Vec<f64>)],
    max_lag: usize,
) -> Option<LaggedCorrelation> {
    let max_lag = i32::try_from(max_lag).ok()?;
    (-max_lag..=max_lag)
        .filter_map(|lag| {
            let pairs: Vec<_> = (stretches.iter())
                .flat_map(|(x, y)| lagged_pairs(x, y, lag))
                .collect();
            Some(LaggedCorrelation {
                correlation: finite(correlation(&pairs)?)?,
                lag,
            })
        })
        .max_by(|a, b| a.correlation.total_cmp(&b.correlation))
}

fn lagged_pairs<'a>(x: &'a [f64], y: &'a [f64], lag: i32) -> impl Iterator<Item = (f64, f64)> + 'a {
    let shift = lag.unsigned_abs() as usize;
    let (x_skip, y_skip) = if lag >= 0 { (0, shift) } else { (shift, 0) };
    (x.iter().skip(x_skip).copied()).zip(y.iter().skip(y_skip).copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(actual: Option<f64>, expected: f64) {
        let actual = actual.expect("a value");
        assert!((actual - expected).abs() < 1e-12, "{actual} != {expected}");
    }

    #[test]
    fn bend_is_the_largest_inward_offset_from_the_line() {
        let path = [
            DVec3::new(0.020, 0.0, 0.0),
            DVec3::new(0.019, 0.004, 0.0),
            DVec3::new(0.021, 0.008, 0.0),
        ];
        close(inward_bend(&path, DVec3::Y, DVec3::NEG_X), 0.001);
        close(inward_bend(&path[..1], DVec3::Y, DVec3::NEG_X), 0.0);
        assert_eq!(inward_bend(&[], DVec3::Y, DVec3::NEG_X), None);
    }

    #[test]
    fn motion_along_a_slanted_stroke_has_no_bend() {
        let direction = DVec3::new(0.6, 0.8, 0.0);
        let path: Vec<_> = (0..5).map(|i| 0.001 * f64::from(i) * direction).collect();
        close(inward_bend(&path, direction, DVec3::NEG_X), 0.0);
    }

    #[test]
    fn distance_of_parallel_paths_is_independent_of_speed() {
        let a: Vec<_> = (0..11)
            .map(|i| DVec3::new(0.0, f64::from(i), 0.0))
            .collect();
        let b = [DVec3::new(0.5, 0.0, 3.0), DVec3::new(0.5, 10.0, 3.0)];
        close(distance_between_paths(&a, &b), 0.5);
        close(distance_between_paths(&a, &a), 0.0);
        assert_eq!(distance_between_paths(&a, &[]), None);
    }

    #[test]
    fn a_delayed_copy_is_found_at_its_delay() {
        let wave = |i: i32| (f64::from(i) * 0.7).sin() + 0.3 * (f64::from(i) * 1.9).cos();
        let x: Vec<_> = (0..80).map(wave).collect();
        let later: Vec<_> = (0..80).map(|i| 2.0 * wave(i - 3) + 1.0).collect();
        let best = lagged_correlation(&[(x.clone(), later.clone())], 5).unwrap();
        assert_eq!(best.lag, 3);
        assert!((best.correlation - 1.0).abs() < 1e-12);
        let out_of_reach = lagged_correlation(&[(x, later)], 2).unwrap();
        assert!(out_of_reach.correlation < 0.99);
        assert_eq!(lagged_correlation(&[], 5), None);
    }
}
