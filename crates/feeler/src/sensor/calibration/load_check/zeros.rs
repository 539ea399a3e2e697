//! Checks that all recordings have the same zero.

use super::{COLUMNS, CapturedImage, LoadCheckError, named, unloaded_mean};
use crate::sensor::calibration::model::Calibration;
use crate::sensor::moments::kernel::ElementMoments;
use crate::sensor::wrench::recordings::recordings;
use glam::DVec3;

/// Maximum difference of unloaded moments between two recordings (median over the elements), relative to their range
/// under load.
const LARGEST_OF_PICTURES: f64 = 0.1;
/// Maximum difference of mean force errors between two recordings, as a fraction of full scale.
const LARGEST_OF_FORCES: f64 = 0.03;
/// Maximum difference of mean force errors between two recordings, as a multiple of the RMS error. If the error is
/// entirely due to two different zeros, their difference is twice the RMS error.
const LARGEST_OF_ERRORS: f64 = 1.5;

/// Rejects recordings whose unloaded images differ by more than a tenth of the range under load, in more than half of
/// the common elements. Recordings are distinguished by the `names` of the images.
///
/// # Errors
/// Returns [`LoadCheckError::Unloaded`] with two recordings.
pub fn check_unloaded<'a>(
    pictures: &[CapturedImage],
    names: impl Iterator<Item = &'a str>,
) -> Result<(), LoadCheckError> {
    let (recordings, of) = recordings(names);
    let elements = pictures.first().map_or(0, |picture| picture.moments.len());
    let zero = |recording: usize, element: usize| {
        let own = pictures.iter().zip(&of).filter(|(picture, (of, _))| {
            *of == recording && picture.forces[element] == Some(DVec3::ZERO)
        });
        unloaded_mean(own.map(|(picture, _)| &picture.moments[element]))
    };
    let ranges: Vec<_> = (0..elements)
        .map(|element| range(pictures, element))
        .collect();
    let zeros: Vec<Vec<_>> = (0..recordings.len())
        .map(|recording| {
            (0..elements)
                .map(|element| zero(recording, element))
                .collect()
        })
        .collect();
    for (other, later) in zeros.iter().enumerate().skip(1) {
        let both = zeros[0].iter().zip(later).zip(&ranges);
        let mut shares: Vec<_> = both
            .filter_map(|((one, other), range)| {
                share(one.as_ref()?, other.as_ref()?, range.as_ref()?)
            })
            .collect();
        shares.sort_by(f64::total_cmp);
        if let Some(&median) = shares.get(shares.len() / 2)
            && median > LARGEST_OF_PICTURES
        {
            return Err(LoadCheckError::Unloaded {
                one: named(&recordings[0]),
                other: named(&recordings[other]),
                percent: 100.0 * median,
            });
        }
    }
    Ok(())
}

/// Ranges of an element's gray value and centroid over all images in which it is loaded; `None` if there are no such
/// images.
fn range(pictures: &[CapturedImage], element: usize) -> Option<[f64; 3]> {
    let loaded = pictures
        .iter()
        .filter(|picture| picture.forces[element].is_some_and(|force| force != DVec3::ZERO));
    let values = loaded.map(|picture| values(&picture.moments[element]));
    let ends = values
        .map(|values| (values, values))
        .reduce(|(low, high), (a, b)| (low.min(a), high.max(b)));
    ends.map(|(low, high)| (high - low).to_array())
}

fn values(moments: &ElementMoments) -> DVec3 {
    moments.centroid.extend(moments.integrated_gray)
}

/// Largest difference between two zeros, as a fraction of the range; `None` if the range is empty.
fn share(one: &ElementMoments, other: &ElementMoments, range: &[f64; 3]) -> Option<f64> {
    let difference = (values(one) - values(other)).abs().to_array();
    let shares = difference
        .into_iter()
        .zip(range)
        .filter(|(_, range)| **range > 0.0);
    shares
        .map(|(difference, range)| difference / range)
        .reduce(f64::max)
}

/// Rejects recordings whose mean errors against the predictions of `calibration` differ by more than 3 % of full scale
/// and by more than random errors would.
///
/// # Errors
/// Returns [`LoadCheckError::Offset`] with column, recordings and difference.
pub fn check_offsets<'a>(
    calibration: &Calibration,
    pictures: &[CapturedImage],
    names: impl Iterator<Item = &'a str>,
) -> Result<(), LoadCheckError> {
    let (recordings, of) = recordings(names);
    let mut errors = vec![Errors::default(); recordings.len()];
    for (picture, &(recording, _)) in pictures.iter().zip(&of) {
        let elements = calibration
            .elements
            .iter()
            .zip(&picture.forces)
            .zip(&picture.moments);
        for ((element, force), moments) in elements {
            if let Some(force) = force.filter(|&force| force != DVec3::ZERO) {
                errors[recording].add(force - element.force(moments));
            }
        }
    }
    let all = errors
        .iter()
        .fold(Errors::default(), |all, own| all.with(own));
    let rms = all.squares / all.count.max(1.0);
    let means = errors
        .iter()
        .enumerate()
        .filter(|(_, errors)| errors.count > 0.0);
    let means: Vec<_> = means
        .map(|(recording, errors)| (recording, errors.sum / errors.count))
        .collect();
    for (axis, column) in COLUMNS.into_iter().enumerate() {
        let full_scale = calibration.full_scale.components()[axis];
        let limit = (LARGEST_OF_FORCES * full_scale).max(LARGEST_OF_ERRORS * rms[axis].sqrt());
        let by_mean = |a: &&(usize, DVec3), b: &&(usize, DVec3)| a.1[axis].total_cmp(&b.1[axis]);
        let ends = means
            .iter()
            .max_by(by_mean)
            .zip(means.iter().min_by(by_mean));
        let Some((&(one, high), &(other, low))) = ends else {
            continue;
        };
        let offset = high[axis] - low[axis];
        if offset > limit {
            return Err(LoadCheckError::Offset {
                column,
                one: named(&recordings[one]),
                other: named(&recordings[other]),
                offset,
                limit,
            });
        }
    }
    Ok(())
}

/// Sums of force errors for their mean and RMS, N.
#[derive(Debug, Clone, Copy, Default)]
struct Errors {
    sum: DVec3,
    squares: DVec3,
    count: f64,
}

impl Errors {
    fn add(&mut self, error: DVec3) {
        *self = self.with(&Self {
            sum: error,
            squares: error * error,
            count: 1.0,
        });
    }

    fn with(self, other: &Self) -> Self {
        Self {
            sum: self.sum + other.sum,
            squares: self.squares + other.squares,
            count: self.count + other.count,
        }
    }
}
