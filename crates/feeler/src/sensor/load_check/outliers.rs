//! Single loads.

use super::{COLUMNS, LoadCheckError, TakenPicture};
use crate::sensor::{calibration::Calibration, calibration_fit::outlier, loads::records};
use glam::DVec3;

/// Rejects a load that all others of its element contradict, in `pictures` called `names` to which `calibration` was fitted.
///
/// # Errors
/// Names picture, element and column, with the force that the others predict.
pub fn check_outliers<'a>(
    calibration: &Calibration,
    pictures: &[TakenPicture],
    names: impl Iterator<Item = &'a str>,
) -> Result<(), LoadCheckError> {
    let Some(found) = outlier(calibration, &records(pictures)) else {
        return Ok(());
    };
    let is_loaded = |picture: &TakenPicture| {
        picture.forces[found.element].is_some_and(|force| force != DVec3::ZERO)
    };
    let loaded = pictures
        .iter()
        .zip(names)
        .filter(|(picture, _)| is_loaded(picture));
    let name = loaded.map(|(_, name)| name).nth(found.load);
    Err(LoadCheckError::Outlier {
        picture: name.unwrap_or_default().to_owned(),
        element: found.element,
        column: COLUMNS[found.axis],
        given: found.given,
        predicted: found.predicted,
        usual: found.usual,
    })
}
