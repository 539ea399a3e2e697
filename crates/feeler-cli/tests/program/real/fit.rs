//! Least-squares fit of a spot to an image: elliptical, flat-topped or Gaussian, on a sloping background.

use super::blobs::Blob;
use feeler::sensor::image::Picture;
use nalgebra::{SMatrix, SVector};

/// Centre (column, row), background and its two slopes, depth, logarithms of two inverse widths, and correlation.
type Parameters = SVector<f64, 9>;

/// Radius of the fitted region, in radii of the blob. A smaller region leaves background and depth undetermined, a
/// larger one reaches the next marker.
const REACH: f64 = 2.2;
const MAX_STEPS: usize = 40;

/// Depth of a spot as a function of the squared scaled distance from its centre.
#[derive(Clone, Copy)]
pub enum Profile {
    /// `exp(-square / 2)`.
    Gaussian,
    /// `exp(-square² / 2)`: nearly a disc, like a real marker.
    Flat,
}

impl Profile {
    fn depth(self, square: f64) -> f64 {
        match self {
            Self::Gaussian => (-0.5 * square).exp(),
            Self::Flat => (-0.5 * square * square).exp(),
        }
    }
}

/// Fits the spot `blob` of `picture`, and returns its centre (column and row, px).
pub fn centre(picture: &Picture, blob: &Blob, profile: Profile) -> [f64; 2] {
    let pixels = pixels(picture, blob);
    let light: Vec<f64> = pixels.iter().map(|pixel| pixel[2]).collect();
    let most = light.iter().copied().fold(f64::MIN, f64::max);
    let least = light.iter().copied().fold(f64::MAX, f64::min);
    let width = -(blob.radius() / 1.3).ln();
    let start = [0.0, 0.0, most, 0.0, 0.0, most - least, width, width, 0.0];
    let residuals = |p: &Parameters| -> Vec<f64> {
        let all = pixels
            .iter()
            .map(|&[x, y, light]| value(p, [x, y], profile) - light);
        all.collect()
    };
    let fitted = least_squares(Parameters::from(start), &residuals);
    [blob.centre[0] + fitted[0], blob.centre[1] + fitted[1]]
}

/// Pixels near a blob: column and row relative to its centre (px), and gray level.
fn pixels(picture: &Picture, blob: &Blob) -> Vec<[f64; 3]> {
    let reach = REACH * blob.radius();
    let places = (0..picture.height).flat_map(|row| (0..picture.width).map(move |c| (c, row)));
    let near = places.filter_map(|(column, row)| {
        let place = [column as f64, row as f64];
        let light = f64::from(picture.pixels[row * picture.width + column]);
        let [x, y] = [place[0] - blob.centre[0], place[1] - blob.centre[1]];
        (blob.distance(place) <= reach).then_some([x, y, light])
    });
    near.collect()
}

fn value(p: &Parameters, [x, y]: [f64; 2], profile: Profile) -> f64 {
    let (u, v) = ((x - p[0]) * p[6].exp(), (y - p[1]) * p[7].exp());
    let square = (u * u + v * v + 2.0 * p[8] * u * v).max(0.0);
    p[2] + p[3] * x + p[4] * y - p[5] * profile.depth(square)
}

/// Levenberg-Marquardt method.
fn least_squares(start: Parameters, residuals: &dyn Fn(&Parameters) -> Vec<f64>) -> Parameters {
    let cost = |errors: &[f64]| errors.iter().map(|e| e * e).sum::<f64>();
    let (mut at, mut damping) = (start, 1e-3);
    let mut errors = residuals(&at);
    for _ in 0..MAX_STEPS {
        let (mut normal, mut gradient) = (SMatrix::<f64, 9, 9>::zeros(), Parameters::zeros());
        let slopes: Vec<Vec<f64>> = (0..9)
            .map(|k| {
                let mut beside = at;
                let step = 1e-4 * at[k].abs().max(1.0);
                beside[k] += step;
                let moved = residuals(&beside);
                moved
                    .iter()
                    .zip(&errors)
                    .map(|(b, a)| (b - a) / step)
                    .collect()
            })
            .collect();
        for (i, own) in slopes.iter().enumerate() {
            let product = |other: &[f64]| own.iter().zip(other).map(|(a, b)| a * b).sum::<f64>();
            gradient[i] = product(&errors);
            for (j, other) in slopes.iter().enumerate() {
                normal[(i, j)] = product(other);
            }
        }
        let before = cost(&errors);
        let step = (0..20).find_map(|_| {
            let mut damped = normal;
            for i in 0..9 {
                damped[(i, i)] += damping * normal[(i, i)] + 1e-9;
            }
            let found = damped.cholesky().map(|damped| {
                let next = at - damped.solve(&gradient);
                (next, residuals(&next))
            });
            let found = found.filter(|(_, errors)| cost(errors) < before);
            damping *= if found.is_some() { 0.25 } else { 4.0 };
            found
        });
        let Some((next, found)) = step else { break };
        let done = before - cost(&found) < 1e-7 * before;
        (at, errors) = (next, found);
        if done {
            break;
        }
    }
    at
}
