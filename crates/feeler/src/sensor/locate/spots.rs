//! Detects bright spots: blobs of the most common size.

use super::{
    LocateError, MAX_SPOTS,
    centroid::{self, measure},
    crowding::{with_merged_pairs, without_crowding, without_overlaps},
    outline::Outline,
    quantile,
    reference::ReferencePicture,
    regions::bounding_box,
    scale_space::{Layer, ScaleSpace},
    spot::{FoundSpots, Spot},
    strays::{as_strong_as_their_neighbours, without_specks, without_strays, without_surroundings},
};
use crate::sensor::image::cells::Cells;
use glam::{DMat2, DVec2};
use std::f64::consts::SQRT_2;
use std::ops::Range;

/// Maximum number of layers by which the scale of a spot may differ from the typical scale: a factor of two in
/// diameter, to allow for perspective and load.
const LAYERS_BESIDE: usize = 4;

/// An image in which spots are bright, and the search parameters.
pub(super) struct Search<'a> {
    /// The image at full resolution.
    pub picture: &'a ReferencePicture,
    /// The image in which spots are searched, binned by `factor`.
    pub binned: &'a ReferencePicture,
    /// Binning factor.
    pub factor: usize,
    /// Scale space of the binned image.
    pub space: &'a ScaleSpace,
    /// Noise of a single image before averaging, gray levels: at full resolution and binned.
    pub noise: [f64; 2],
    /// Diameter of spots at full resolution, px, or `None` if unknown.
    pub diameter: Option<f64>,
}

/// Coarsest scale to search, px, in an image of the given size (px) for spots of `diameter` (px), or of any size if
/// `None`.
pub(super) fn coarsest((width, height): (usize, usize), diameter: Option<f64>) -> f64 {
    diameter.map_or(width.min(height) as f64 / 16.0, |diameter| {
        diameter / SQRT_2
    })
}

/// Detects the spots of an image.
pub(super) fn find(search: &Search) -> Result<FoundSpots, LocateError> {
    let Search { picture, space, .. } = *search;
    let [noise, noise_searched] = search.noise;
    let octaves = Octaves::new(search.binned, space);
    let noise_of_mean = noise_searched / (picture.pictures as f64).sqrt();
    let of_layer = |layer: usize| blobs(&octaves, space, layer, noise_of_mean);
    let diameter = search
        .diameter
        .map(|diameter| diameter / search.factor as f64);
    let candidates: Vec<Spot> = match diameter {
        Some(diameter) => {
            let own = layer_of(space, diameter / (2.0 * SQRT_2));
            beside(own, space).flat_map(of_layer).collect()
        }
        None => {
            let layers: Vec<Vec<Spot>> = (0..space.layers.len()).map(of_layer).collect();
            layers[beside(dominant_layer(&layers), space)].concat()
        }
    };
    let (darkest, brightest) = range(&search.binned.gray);
    if candidates.len() > 4 * MAX_SPOTS {
        return Err(LocateError::TooManySpots {
            actual: candidates.len(),
        });
    }
    let blobs = without_overlaps(candidates).into_iter();
    let blobs: Vec<Spot> = blobs.map(|blob| blob.enlarged(search.factor)).collect();
    let blobs = with_merged_pairs(blobs, |a, b| is_joined(picture, a, b));
    let (spots, surroundings) = without_surroundings(as_strong_as_their_neighbours(blobs.clone()));
    let spots = measured(picture, without_crowding(spots), &blobs);
    let (spots, specks) = without_specks(spots);
    let (spots, strays) = without_strays(spots);
    let left_out = [surroundings, specks, strays].concat();
    let (cut, spots): (Vec<Spot>, Vec<Spot>) = spots.into_iter().partition(|spot| spot.cut);
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
            cut: cut.iter().map(|spot| spot.centre).collect(),
            noise,
        }),
    }
}

/// Measures the spots from their pixels, excluding pixels that are closer to other `blobs`.
fn measured(picture: &ReferencePicture, mut spots: Vec<Spot>, blobs: &[Spot]) -> Vec<Spot> {
    /// Minimum response of another blob whose pixels are excluded, relative to the response of the spot.
    const FAINT: f64 = 0.25;
    let centres: Vec<DVec2> = blobs.iter().map(|blob| blob.centre).collect();
    let cells = Cells::new(&centres);
    for spot in &mut spots {
        let others = cells
            .within(spot.centre, centroid::surroundings(spot))
            .filter(|&blob| blobs[blob].response > FAINT * spot.response);
        let others: Vec<DVec2> = others.map(|blob| centres[blob]).collect();
        let measured = measure(picture, spot, &others);
        spot.centre = measured.centre;
        spot.diameter = measured.diameter;
        spot.contrast = measured.contrast;
        spot.cut = measured.cut;
    }
    spots
}

/// Returns `true` if two blobs are not separated by background: at all sampled points between their centres, the gray
/// level is closer to that of the fainter centre than to the background.
fn is_joined(picture: &ReferencePicture, a: &Spot, b: &Spot) -> bool {
    let middle = 0.5 * (a.centre + b.centre);
    let reach = 1.5 * a.diameter.max(b.diameter);
    let size = (picture.width, picture.height);
    let (columns, rows) = bounding_box(size, middle, reach);
    let around = rows.flat_map(|row| &picture.gray[row * picture.width..][columns.clone()]);
    let mut around: Vec<f64> = around.map(|&gray| f64::from(gray)).collect();
    let background = quantile(&mut around, 0.3);
    let at = |part: f64| picture.gray_at(a.centre.lerp(b.centre, part));
    let fainter = at(0.0).min(at(1.0));
    let between = [0.25, 0.375, 0.5, 0.625, 0.75].map(at);
    let least = between.into_iter().fold(f64::INFINITY, f64::min);
    least - background > 0.5 * (fainter - background)
}

fn range(gray: &[f32]) -> (f32, f32) {
    gray.iter()
        .fold((f32::MAX, f32::MIN), |(a, b), &g| (a.min(g), b.max(g)))
}

/// Range of scale-space layers to search for spots whose typical scale is that of layer `own`.
fn beside(own: usize, space: &ScaleSpace) -> Range<usize> {
    own.saturating_sub(LAYERS_BESIDE)..(own + LAYERS_BESIDE + 1).min(space.layers.len())
}

fn layer_of(space: &ScaleSpace, sigma: f64) -> usize {
    let off = |layer: &usize| libm::log(space.layers[*layer].sigma / sigma).abs();
    (0..space.layers.len())
        .min_by(|a, b| off(a).total_cmp(&off(b)))
        .unwrap_or(0)
}

/// Layer around which the sum of squared blob responses is largest. Squares are used because a texture of many faint
/// blobs could have the larger sum of responses.
fn dominant_layer(layers: &[Vec<Spot>]) -> usize {
    let strength = |layer: usize| -> f64 {
        let window = layer.saturating_sub(2)..(layer + 3).min(layers.len());
        let blobs = layers[window].iter().flatten();
        blobs.map(|spot| spot.response * spot.response).sum()
    };
    (0..layers.len())
        .max_by(|&a, &b| strength(a).total_cmp(&strength(b)))
        .unwrap_or(0)
}

/// An image at the resolution of each layer of a scale space.
struct Octaves<'a> {
    whole: &'a ReferencePicture,
    /// The image binned by 2, 4, 8, ...
    halved: Vec<ReferencePicture>,
}

impl<'a> Octaves<'a> {
    fn new(whole: &'a ReferencePicture, space: &ScaleSpace) -> Self {
        let mut octaves = Self {
            whole,
            halved: Vec::new(),
        };
        for layer in &space.layers {
            if layer.step > 1 << octaves.halved.len() {
                let half = octaves.of_step(layer.step / 2).binned(2);
                octaves.halved.push(half);
            }
        }
        octaves
    }

    fn of_step(&self, step: usize) -> &ReferencePicture {
        let octave = (step.trailing_zeros() as usize).checked_sub(1);
        octave.map_or(self.whole, |octave| &self.halved[octave])
    }
}

/// Returns the round blobs of one layer that exceed the noise.
fn blobs(octaves: &Octaves, space: &ScaleSpace, layer: usize, noise_of_mean: f64) -> Vec<Spot> {
    let mut outline = Outline::default();
    let Layer { sigma, step, .. } = space.layers[layer];
    let picture = octaves.of_step(step);
    // White noise of deviation n has a response of deviation n / (sqrt(2 pi) sigma). Six deviations are not exceeded by
    // chance in an image of a million pixels. A spot must also rise by more than one gray level.
    let floor = (6.0 * noise_of_mean * 0.4 / sigma).max(1.0);
    space
        .maxima(layer, floor as f32)
        .into_iter()
        .filter_map(|index| Some((index, refined(space, layer, index)?)))
        .filter(|&(index, _)| !outline.exceeds(picture, index, sigma / step as f64))
        .map(|(_, spot)| spot)
        .collect()
}

/// Fits a paraboloid to a maximum and its eight neighbours. Returns `None` if the maximum is not round enough.
pub(super) fn refined(space: &ScaleSpace, layer: usize, index: usize) -> Option<Spot> {
    /// Minimum ratio of the smaller to the larger curvature; a more elongated maximum is a line. A marker compressed to
    /// less than half its width by contact is still above it.
    const ROUND: f64 = 0.08;
    let Layer {
        sigma,
        step,
        size: (width, _),
        response: ref values,
    } = space.layers[layer];
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
        centre: step as f64 * (pixel + offset),
        sigma,
        response: middle,
        diameter: 2.0 * SQRT_2 * sigma,
        contrast: middle,
        cut: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Response of one layer in the form of a paraboloid with the given second derivatives and `vertex`.
    fn paraboloid(vertex: DVec2, [xx, yy, xy]: [f64; 3]) -> ScaleSpace {
        let value = |index: usize| {
            let pixel = DVec2::new((index % 5) as f64, (index / 5) as f64);
            let DVec2 { x, y } = pixel - vertex;
            (100.0 + 0.5 * (xx * x * x + yy * y * y) + xy * x * y) as f32
        };
        ScaleSpace {
            layers: vec![Layer {
                sigma: 2.0,
                step: 1,
                size: (5, 5),
                response: (0..25).map(value).collect(),
            }],
        }
    }

    #[test]
    fn finds_the_vertex_of_a_paraboloid_of_any_orientation() {
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
                // Rounding error of values near 100 in single precision (24 bits), divided by the least curvature, 2.
                let error = spot.centre.distance(vertex);
                assert!(
                    error < 3e-5,
                    "{error} px off with {curvature:?} at {offset:?}"
                );
            }
        }
    }

    #[test]
    fn rejects_elongated_maxima_of_any_orientation() {
        let vertex = DVec2::splat(2.0);
        // The ratio of the curvatures along the axes of the ellipse is 0.08 at the limit.
        for (flat, is_spot) in [(-0.7, false), (-0.9, true)] {
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
