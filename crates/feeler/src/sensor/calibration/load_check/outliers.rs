//! Checks single loads for outliers.

use super::{COLUMNS, CapturedImage, LoadCheckError};
use crate::sensor::calibration::loads::records;
use crate::sensor::calibration::model::Calibration;
use crate::sensor::calibration::outlier::outlier;
use glam::DVec3;

/// Checks for a load that contradicts all other loads of its element, given the `calibration` fitted to `pictures`.
///
/// Such a load is an error if it is also twice as large as any other. Otherwise it is returned as a warning: it may be
/// mistyped, or its image may be unusual. `names` are the names of the images.
///
/// # Errors
/// Returns [`LoadCheckError::Outlier`] with image, element, column and the force predicted by the other loads.
pub fn check_outliers<'a>(
    calibration: &Calibration,
    pictures: &[CapturedImage],
    names: impl Iterator<Item = &'a str>,
) -> Result<Option<LoadCheckError>, LoadCheckError> {
    let records = records(pictures);
    let Some(found) = outlier(calibration, &records) else {
        return Ok(None);
    };
    let is_loaded = |picture: &CapturedImage| {
        picture.forces[found.element].is_some_and(|force| force != DVec3::ZERO)
    };
    let mut loaded = pictures
        .iter()
        .zip(names)
        .filter(|(picture, _)| is_loaded(picture));
    let named = loaded.nth(found.load).map(|(_, name)| name);
    let load = LoadCheckError::Outlier {
        picture: named.unwrap_or_default().to_owned(),
        element: found.element,
        column: COLUMNS[found.axis],
        given: found.given,
        predicted: found.predicted,
        usual: found.usual,
    };
    match found.is_beyond_all(&records) {
        true => Err(load),
        false => Ok(Some(load)),
    }
}
