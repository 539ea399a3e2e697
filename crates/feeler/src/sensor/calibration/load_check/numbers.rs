//! Checks the element numbers of loads: an element's gray value must follow the loads assigned to it.

use super::{CapturedImage, LoadCheckError};
use glam::DVec3;

/// Minimum number of loads for an element to be checked.
const MIN_LOADS: usize = 8;
/// Correlation of loads and gray value above which an element counts as loaded.
const IS_LOADED: f64 = 0.8;
/// Correlation of loads and gray value below which an element counts as not loaded.
const IS_NOT_LOADED: f64 = 0.4;

/// Rejects loads assigned to the wrong element: its gray value does not follow them, but that of another element does.
///
/// # Errors
/// Returns [`LoadCheckError::Number`] with both elements.
pub fn check_numbers(pictures: &[CapturedImage]) -> Result<(), LoadCheckError> {
    let elements = pictures.first().map_or(0, |picture| picture.moments.len());
    for element in 0..elements {
        // Images without load belong to all elements.
        let is_loaded = |force: &DVec3| *force != DVec3::ZERO;
        let loads: Vec<_> = pictures
            .iter()
            .filter_map(|picture| Some((picture.forces[element].filter(is_loaded)?.z, picture)))
            .collect();
        if loads.len() < MIN_LOADS {
            continue;
        }
        let compressions: Vec<_> = loads.iter().map(|(compression, _)| *compression).collect();
        let correlation = |other: usize| {
            let grays = loads
                .iter()
                .map(|(_, picture)| picture.moments[other].integrated_gray);
            correlation(&compressions, &grays.collect::<Vec<_>>())
        };
        let own = correlation(element);
        // A negative correlation indicates wrong signs, not wrong numbers.
        if own.abs() > IS_NOT_LOADED {
            continue;
        }
        let others = (0..elements).map(|other| (other, correlation(other)));
        let follows = others.max_by(|(_, a), (_, b)| a.abs().total_cmp(&b.abs()));
        if let Some((shown, other)) = follows.filter(|(_, other)| other.abs() > IS_LOADED) {
            return Err(LoadCheckError::Number {
                element,
                own,
                shown,
                other,
            });
        }
    }
    Ok(())
}

/// Pearson correlation, or 0 if one of the inputs is constant.
fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let count = a.len() as f64;
    let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
    let (mean_a, mean_b) = (mean(a), mean(b));
    let sums = a.iter().zip(b).map(|(a, b)| {
        DVec3::new(
            (a - mean_a) * (b - mean_b),
            (a - mean_a).powi(2),
            (b - mean_b).powi(2),
        )
    });
    let DVec3 {
        x: both,
        y: of_a,
        z: of_b,
    } = sums.sum();
    match (of_a * of_b).sqrt() {
        spread if spread > 0.0 => both / spread,
        _ => 0.0,
    }
}
