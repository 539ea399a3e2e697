//! Fast detection of blobs of known size.

use super::{
    Polarity, quantile,
    scale_space::{ScaleSpace, blurred_response},
    spots::refined,
};
use crate::sensor::image::frame::Picture;
use glam::DVec2;
use std::f64::consts::SQRT_2;

/// Minimum diameter of a blob after binning, px. Images with larger blobs are binned.
const MIN_DIAMETER: f64 = 4.0;
/// Minimum response of a blob, relative to the median response of the strongest blobs.
const MIN_RESPONSE: f64 = 0.3;

/// Returns columns and rows (px) of blobs of about `diameter` px in `picture`, in no particular order. A blob is
/// returned if its response is at least [`MIN_RESPONSE`] of the median of the `count` strongest. Unlike
/// [`locate`](super::locate), it does not check that blobs are spots of a pattern.
pub(in crate::sensor) fn blobs_of_size<P: AsRef<[u8]>>(
    picture: &Picture<P>,
    polarity: Polarity,
    diameter: f64,
    count: usize,
) -> Vec<DVec2> {
    let factor = ((diameter / MIN_DIAMETER) as usize).max(1);
    let size = (picture.width / factor, picture.height / factor);
    if size.0.min(size.1) < 3 {
        return Vec::new();
    }
    let binned = binned(picture, polarity, factor, size);
    let sigma = diameter / (2.0 * SQRT_2 * factor as f64);
    let space = ScaleSpace {
        layers: vec![blurred_response(&binned, size, sigma)],
    };
    let maxima = space.maxima(0, 1.0).into_iter();
    let blobs: Vec<_> = maxima
        .filter_map(|index| refined(&space, 0, index))
        .collect();
    let mut responses: Vec<f64> = blobs.iter().map(|blob| blob.response).collect();
    responses.sort_unstable_by(|a, b| b.total_cmp(a));
    responses.truncate(count);
    let least = MIN_RESPONSE * quantile(&mut responses, 0.5);
    let blobs = blobs.into_iter().filter(|blob| blob.response >= least);
    let factor = factor as f64;
    blobs
        .map(|blob| (blob.centre + 0.5) * factor - 0.5)
        .collect()
}

/// Bins `factor` x `factor` pixels into their mean, negated if blobs are dark. The last argument is the binned size.
fn binned<P: AsRef<[u8]>>(
    picture: &Picture<P>,
    polarity: Polarity,
    factor: usize,
    (width, height): (usize, usize),
) -> Vec<f32> {
    let scale = match polarity {
        Polarity::Bright => 1.0,
        Polarity::Dark => -1.0,
    } / (factor * factor) as f32;
    let mut sums = vec![0_u32; width];
    let mut binned = Vec::with_capacity(width * height);
    let rows = picture.pixels.as_ref().chunks_exact(picture.width);
    for (row, pixels) in rows.take(height * factor).enumerate() {
        for (sum, pixels) in sums.iter_mut().zip(pixels.chunks_exact(factor)) {
            *sum += pixels.iter().map(|&pixel| u32::from(pixel)).sum::<u32>();
        }
        if (row + 1) % factor == 0 {
            binned.extend(sums.iter().map(|&sum| scale * sum as f32));
            sums.fill(0);
        }
    }
    binned
}
