//! Bright spots: blobs of the size that most blobs share.

use super::{
    LocateError, MAX_SPOTS, median, nearest, quantile, reference::ReferencePicture,
    scale_space::ScaleSpace,
};
use glam::{DMat2, DVec2};
use std::f64::consts::SQRT_2;

/// Scales that differ from the spots' own by no more than this many layers are spots too: a factor
/// of two in diameter each way, as perspective and load make of one size.
const LAYERS_BESIDE: usize = 4;

/// A bright spot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spot {
    /// Column and row, px.
    pub centre: DVec2,
    /// Scale at which it is most blob-like, px: its radius over the root of two.
    pub sigma: f64,
    /// How strongly, grey levels.
    pub response: f64,
}

impl Spot {
    /// Diameter of the disc that is most blob-like at the spot's scale, px.
    pub fn diameter(&self) -> f64 {
        2.0 * SQRT_2 * self.sigma
    }
}

/// The spots of a picture.
#[derive(Debug, Clone)]
pub(super) struct FoundSpots {
    pub spots: Vec<Spot>,
    /// Spots that stand apart from all others.
    pub left_out: Vec<DVec2>,
    /// Noise of one picture, grey levels.
    pub noise: f64,
}

/// Finds the spots in `picture`, of about `diameter` if that is known, px.
pub(super) fn find(
    picture: &ReferencePicture,
    diameter: Option<f64>,
) -> Result<FoundSpots, LocateError> {
    let shorter = picture.width.min(picture.height) as f64;
    let coarsest = diameter.map_or(shorter / 16.0, |d| d / SQRT_2);
    let space = ScaleSpace::new(picture, coarsest);
    let noise = picture.noise();
    let noise_of_mean = noise / (picture.pictures as f64).sqrt();
    let layers: Vec<Vec<Spot>> = (0..space.layers.len())
        .map(|layer| blobs(picture, &space, layer, noise_of_mean))
        .collect();
    let own = match diameter {
        Some(diameter) => layer_of(&space, diameter / (2.0 * SQRT_2)),
        None => dominant_layer(&layers),
    };
    let beside = own.saturating_sub(LAYERS_BESIDE)..(own + LAYERS_BESIDE + 1).min(layers.len());
    let candidates: Vec<Spot> = layers[beside].concat();
    let (darkest, brightest) = range(&picture.gray);
    if candidates.len() > 4 * MAX_SPOTS {
        return Err(LocateError::TooManySpots {
            actual: candidates.len(),
        });
    }
    let spots = as_strong_as_their_neighbours(without_overlaps(candidates));
    let (spots, left_out) = without_strays(without_crowding(spots));
    match spots.len() {
        0 => Err(LocateError::NoElement {
            darkest,
            brightest,
            noise,
        }),
        actual if actual > MAX_SPOTS => Err(LocateError::TooManySpots { actual }),
        _ => Ok(FoundSpots {
            spots,
            left_out,
            noise,
        }),
    }
}

fn range(gray: &[f32]) -> (f32, f32) {
    gray.iter()
        .fold((f32::MAX, f32::MIN), |(a, b), &g| (a.min(g), b.max(g)))
}

fn layer_of(space: &ScaleSpace, sigma: f64) -> usize {
    let off = |layer: &usize| (space.layers[*layer].sigma / sigma).ln().abs();
    (0..space.layers.len())
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .unwrap_or(0)
}

/// The layer about which blobs are strongest, all taken together.
fn dominant_layer(layers: &[Vec<Spot>]) -> usize {
    let strength = |layer: usize| -> f64 {
        let window = layer.saturating_sub(2)..(layer + 3).min(layers.len());
        layers[window].iter().flatten().map(|s| s.response).sum()
    };
    (0..layers.len())
        .max_by(|&a, &b| strength(a).total_cmp(&strength(b)))
        .unwrap_or(0)
}

/// Blobs of one scale that rise above the noise and are round.
fn blobs(
    picture: &ReferencePicture,
    space: &ScaleSpace,
    layer: usize,
    noise_of_mean: f64,
) -> Vec<Spot> {
    let sigma = space.layers[layer].sigma;
    // White noise of deviation n has a response of deviation n / (sqrt(2 pi) sigma); six of them
    // are not reached by chance in a picture of a million pixels. A grey level is not a spot.
    let floor = (6.0 * noise_of_mean * 0.4 / sigma).max(1.0);
    space
        .maxima(layer, floor as f32)
        .into_iter()
        .filter(|&index| !part_of_something_larger(picture, index, sigma))
        .filter_map(|index| refined(space, layer, index))
        .collect()
}

/// Vertex and roundness of the paraboloid through a maximum and its eight neighbours.
fn refined(space: &ScaleSpace, layer: usize, index: usize) -> Option<Spot> {
    /// Least curvature over greatest: what is longer than this is a line, not a spot.
    const ROUND: f64 = 0.15;
    let values = &space.layers[layer].response;
    let width = space.width;
    let at = |dx: isize, dy: isize| {
        let index = index as isize + dy * width as isize + dx;
        f64::from(values[index as usize])
    };
    let middle = at(0, 0);
    let gradient = 0.5 * DVec2::new(at(1, 0) - at(-1, 0), at(0, 1) - at(0, -1));
    let xx = at(1, 0) + at(-1, 0) - 2.0 * middle;
    let yy = at(0, 1) + at(0, -1) - 2.0 * middle;
    let xy = 0.25 * (at(1, 1) + at(-1, -1) - at(1, -1) - at(-1, 1));
    let half_trace = 0.5 * (xx + yy);
    let spread = (0.25 * (xx - yy).powi(2) + xy * xy).sqrt();
    let (flat, steep) = (half_trace + spread, half_trace - spread);
    if !(flat < 0.0 && flat / steep > ROUND) {
        return None;
    }
    let hessian = DMat2::from_cols(DVec2::new(xx, xy), DVec2::new(xy, yy));
    let offset = -(hessian.inverse() * gradient);
    let offset = offset.clamp(DVec2::splat(-0.75), DVec2::splat(0.75));
    let pixel = DVec2::new((index % width) as f64, (index / width) as f64);
    Some(Spot {
        centre: pixel + offset,
        sigma: space.layers[layer].sigma,
        response: middle,
    })
}

/// Whether the bright pixels about a maximum reach farther than a spot of its scale does: it is a
/// bump on a rim or a reflection.
fn part_of_something_larger(picture: &ReferencePicture, index: usize, sigma: f64) -> bool {
    let (width, height) = (picture.width, picture.height);
    let (column, row) = (index % width, index / width);
    let around = |reach: usize| {
        let columns = column.saturating_sub(reach)..(column + reach + 1).min(width);
        let rows = row.saturating_sub(reach)..(row + reach + 1).min(height);
        rows.flat_map(move |r| columns.clone().map(move |c| r * width + c))
    };
    let gray = |i: usize| picture.gray[i];
    let valley = around((3.0 * sigma).ceil() as usize)
        .map(gray)
        .fold(f32::MAX, f32::min);
    let level = valley + 0.7 * (picture.gray[index] - valley);
    // Three diameters across, or farther than that to one side.
    let reach = (6.0 * SQRT_2 * sigma).ceil() as usize;
    let side = 2 * reach + 1;
    let mut seen = vec![false; side * side];
    let mut open = vec![(column, row)];
    while let Some((c, r)) = open.pop() {
        let (dx, dy) = (c + reach - column, r + reach - row);
        if dx == 0 || dy == 0 || dx == side - 1 || dy == side - 1 {
            return true;
        }
        let place = &mut seen[dy * side + dx];
        if std::mem::replace(place, true) {
            continue;
        }
        let left = (c > 0).then(|| (c - 1, r));
        let up = (r > 0).then(|| (c, r - 1));
        let right = (c + 1 < width).then_some((c + 1, r));
        let down = (r + 1 < height).then_some((c, r + 1));
        let next = [left, up, right, down].into_iter().flatten();
        open.extend(next.filter(|&(c, r)| gray(r * width + c) >= level));
    }
    false
}

/// Of spots that lie within each other the strongest.
fn without_overlaps(mut spots: Vec<Spot>) -> Vec<Spot> {
    spots.sort_by(|a, b| b.response.total_cmp(&a.response));
    let mut kept: Vec<Spot> = Vec::new();
    for spot in spots {
        let overlaps = |k: &Spot| {
            let reach = 0.5 * k.diameter().max(spot.diameter());
            k.centre.distance_squared(spot.centre) < reach * reach
        };
        if !kept.iter().any(overlaps) {
            kept.push(spot);
        }
    }
    kept
}

fn centres(spots: &[Spot]) -> Vec<DVec2> {
    spots.iter().map(|s| s.centre).collect()
}

/// Leaves out what is faint against the spots about it and against all spots.
fn as_strong_as_their_neighbours(spots: Vec<Spot>) -> Vec<Spot> {
    let mut all: Vec<f64> = spots.iter().map(|s| s.response).collect();
    let floor = 0.03 * quantile(&mut all, 0.9);
    let neighbours = nearest(&centres(&spots), 12);
    let strong = |(spot, near): (&Spot, Vec<usize>)| {
        let mut near: Vec<f64> = near.iter().map(|&i| spots[i].response).collect();
        let strong = spot.response >= floor && spot.response >= 0.25 * median(&mut near);
        strong.then_some(*spot)
    };
    spots.iter().zip(neighbours).filter_map(strong).collect()
}

/// Distance of each spot to the nearest other.
fn gaps(spots: &[Spot], neighbours: &[Vec<usize>]) -> Vec<f64> {
    let gap = |(spot, near): (&Spot, &Vec<usize>)| {
        near.first()
            .map_or(0.0, |&i| spots[i].centre.distance(spot.centre))
    };
    spots.iter().zip(neighbours).map(gap).collect()
}

/// Of two spots that are much nearer to each other than the spots about them are, the stronger: a
/// speck beside a pin.
fn without_crowding(spots: Vec<Spot>) -> Vec<Spot> {
    let neighbours = nearest(&centres(&spots), 9);
    let gaps = gaps(&spots, &neighbours);
    let crowded = |(own, near): (usize, &Vec<usize>)| {
        let mut about: Vec<f64> = near.iter().skip(1).map(|&i| gaps[i]).collect();
        let beside_stronger = near
            .first()
            .is_some_and(|&i| spots[i].response >= spots[own].response);
        beside_stronger && about.len() >= 8 && gaps[own] < 0.62 * median(&mut about)
    };
    let keep: Vec<bool> = neighbours.iter().enumerate().map(|n| !crowded(n)).collect();
    let kept = spots
        .iter()
        .zip(keep)
        .filter_map(|(s, keep)| keep.then_some(*s));
    kept.collect()
}

/// Parts the spots from those that stand apart: much farther from all others than the spots nearest
/// to them are from theirs, or unlike these and with hardly a neighbour where spots lie closely.
fn without_strays(spots: Vec<Spot>) -> (Vec<Spot>, Vec<DVec2>) {
    /// Fewer spots show no pattern that one could stand apart from.
    const PATTERN: usize = 20;
    if spots.len() < PATTERN {
        return (spots, Vec::new());
    }
    let neighbours = nearest(&centres(&spots), 6);
    let gaps = gaps(&spots, &neighbours);
    let about = |own: usize, value: &dyn Fn(usize) -> f64| {
        let mut values: Vec<f64> = neighbours[own].iter().map(|&i| value(i)).collect();
        median(&mut values)
    };
    let spacing: Vec<f64> = (0..spots.len()).map(|i| about(i, &|i| gaps[i])).collect();
    let close = |own: usize| {
        let near = |&&i: &&usize| spots[i].centre.distance(spots[own].centre) < 1.5 * spacing[own];
        neighbours[own].iter().filter(near).count()
    };
    let mut counts: Vec<f64> = (0..spots.len()).map(|i| close(i) as f64).collect();
    let closely = median(&mut counts) >= 5.0;
    let unlike = |own: usize| {
        let response = spots[own].response / about(own, &|i| spots[i].response);
        let sigma = spots[own].sigma / about(own, &|i| spots[i].sigma);
        !(0.7..1.4).contains(&response) || !(0.85..1.18).contains(&sigma)
    };
    let apart =
        |own: usize| gaps[own] > 1.42 * spacing[own] || (closely && close(own) < 3 && unlike(own));
    let (strays, kept): (Vec<usize>, Vec<usize>) = (0..spots.len()).partition(|&i| apart(i));
    (
        kept.iter().map(|&i| spots[i]).collect(),
        strays.iter().map(|&i| spots[i].centre).collect(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sensor::locate::scale_space::Layer;

    /// A paraboloid of these second derivatives, its vertex at `vertex`, as the response of one layer.
    fn paraboloid(vertex: DVec2, [xx, yy, xy]: [f64; 3]) -> ScaleSpace {
        let value = |index: usize| {
            let pixel = DVec2::new((index % 5) as f64, (index / 5) as f64);
            let DVec2 { x, y } = pixel - vertex;
            (100.0 + 0.5 * (xx * x * x + yy * y * y) + xy * x * y) as f32
        };
        ScaleSpace {
            width: 5,
            height: 5,
            layers: vec![Layer {
                sigma: 2.0,
                response: (0..25).map(value).collect(),
            }],
        }
    }

    #[test]
    fn the_vertex_of_a_paraboloid_is_found_whichever_way_it_lies() {
        for curvature in [
            [-8.0, -8.0, 0.0],
            [-9.0, -5.0, 0.0],
            [-9.0, -5.0, 3.0],
            [-5.0, -9.0, -3.0],
            [-6.0, -6.0, 4.0],
        ] {
            for offset in [[0.0, 0.0], [0.3, -0.2], [-0.4, -0.4], [0.1, 0.45]] {
                let vertex = DVec2::splat(2.0) + DVec2::from(offset);
                let spot = refined(&paraboloid(vertex, curvature), 0, 12).expect("a spot");
                // Differences of values near 100 with the 24 bits of single precision, over the least curvature of 2.
                let error = spot.centre.distance(vertex);
                assert!(
                    error < 3e-5,
                    "{error} px off with {curvature:?} at {offset:?}"
                );
            }
        }
    }

    #[test]
    fn what_is_much_longer_than_wide_is_no_spot_whichever_way_it_lies() {
        let vertex = DVec2::splat(2.0);
        // The ratio of the curvatures along the axes of the ellipse is 0.15 at the limit.
        for (flat, is_spot) in [(-1.4, false), (-1.6, true)] {
            for angle in [0.0_f64, 0.4, 0.785, 2.0] {
                let (sin, cos) = angle.sin_cos();
                let steep = -10.0;
                let curvature = [
                    flat * cos * cos + steep * sin * sin,
                    flat * sin * sin + steep * cos * cos,
                    (flat - steep) * sin * cos,
                ];
                let found = refined(&paraboloid(vertex, curvature), 0, 12).is_some();
                assert_eq!(found, is_spot, "{flat} at {angle} rad");
            }
        }
    }
}
