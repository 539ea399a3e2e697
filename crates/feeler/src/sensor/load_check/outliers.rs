//! Single loads.

use super::{COLUMNS, LoadCheckError, TakenPicture};
use crate::sensor::{calibration::Calibration, calibration_fit::outlier, loads::records};
use glam::DVec3;

/// Rejects a load that is twice as large as any other, in `pictures` called `names` to which `calibration` was fitted, and that all others of its
/// element contradict. One that they contradict although it is of their size is returned: it may be mistyped, or its picture be unlike the others.
///
/// # Errors
/// Names picture, element and column, with the force that the others predict.
pub fn check_outliers<'a>(
    calibration: &Calibration,
    pictures: &[TakenPicture],
    names: impl Iterator<Item = &'a str>,
) -> Result<Option<LoadCheckError>, LoadCheckError> {
    let records = records(pictures);
    let Some(found) = outlier(calibration, &records) else {
        return Ok(None);
    };
    let is_loaded = |picture: &TakenPicture| {
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
