//! Least squares: a calibration from known loads and the moments they cause.

use super::{
    calibration::{
        CALIBRATION_VERSION, CURVE_TERMS, Calibration, CalibrationError, ElementCalibration,
        ForceCurve, HeldOutError,
    },
    fingertip::FingertipConfig,
    moments::ElementMoments,
};
use glam::{DVec2, DVec3};
use nalgebra::{DMatrix, DVector};

/// A known load on one element and what the picture says under it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoadSample {
    /// The load in the element's frame `E_i`, N (sign as in
    /// [`TactileFrame`](super::reading::TactileFrame)).
    pub force: DVec3,
    /// Moments of the element under it.
    pub moments: ElementMoments,
}

/// What was recorded of one element to calibrate it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ElementRecord {
    /// Moments without load; their mean becomes the reference.
    pub unloaded: Vec<ElementMoments>,
    /// Loads to fit.
    pub fitted: Vec<LoadSample>,
    /// Loads to find the error on, kept from the fit.
    pub held_out: Vec<LoadSample>,
}

/// Fits the separable calibration of `fingertip` to `records`, one for each element.
///
/// # Errors
/// When a record is missing or empty, an element is dark, or its loads do not determine a curve.
pub fn fit(
    fingertip: &FingertipConfig,
    records: &[ElementRecord],
) -> Result<Calibration, CalibrationError> {
    let expected = fingertip.layout.element_count();
    if records.len() != expected {
        return Err(CalibrationError::ElementCount {
            what: "records of loads",
            expected,
            actual: records.len(),
        });
    }
    let calibration = Calibration {
        version: CALIBRATION_VERSION,
        fingertip: fingertip.clone(),
        elements: records
            .iter()
            .enumerate()
            .map(|(element, record)| {
                fit_element(record).map_err(|what| CalibrationError::Unusable { element, what })
            })
            .collect::<Result<_, _>>()?,
    };
    calibration.check()?;
    Ok(calibration)
}

fn fit_element(record: &ElementRecord) -> Result<ElementCalibration, String> {
    for (name, count) in [
        ("unloaded", record.unloaded.len()),
        ("held-out", record.held_out.len()),
    ] {
        if count == 0 {
            return Err(format!("at least 1 {name} picture expected, got none"));
        }
    }
    let pictures = record.unloaded.len() as f64;
    let unloaded_gray = record
        .unloaded
        .iter()
        .map(|m| m.integrated_gray)
        .sum::<f64>()
        / pictures;
    let unloaded_centroid = record.unloaded.iter().map(|m| m.centroid).sum::<DVec2>() / pictures;
    let curve = |input: &dyn Fn(&ElementMoments) -> f64, force: fn(DVec3) -> f64| {
        let (inputs, forces): (Vec<f64>, Vec<f64>) = record
            .fitted
            .iter()
            .map(|sample| (input(&sample.moments), force(sample.force)))
            .unzip();
        fit_curve(&inputs, &forces)
    };
    let mut element = ElementCalibration {
        unloaded_gray,
        unloaded_centroid,
        normal: curve(&|m| m.integrated_gray / unloaded_gray - 1.0, |f| f.z)?,
        shear_x: curve(&|m| m.centroid.x - unloaded_centroid.x, |f| f.x)?,
        shear_y: curve(&|m| m.centroid.y - unloaded_centroid.y, |f| f.y)?,
        held_out: HeldOutError {
            rms: DVec3::ZERO,
            worst: DVec3::ZERO,
        },
    };
    element.held_out = held_out_error(&element, &record.held_out);
    Ok(element)
}

fn held_out_error(element: &ElementCalibration, samples: &[LoadSample]) -> HeldOutError {
    let (mut squares, mut worst) = (DVec3::ZERO, DVec3::ZERO);
    for sample in samples {
        let error = element.force(&sample.moments) - sample.force;
        squares += error * error;
        worst = worst.max(error.abs());
    }
    let mean = squares / samples.len() as f64;
    HeldOutError {
        rms: DVec3::new(mean.x.sqrt(), mean.y.sqrt(), mean.z.sqrt()),
        worst,
    }
}

/// The polynomial without a constant term that is nearest to `forces` at `inputs`.
fn fit_curve(inputs: &[f64], forces: &[f64]) -> Result<ForceCurve, String> {
    if inputs.len() <= CURVE_TERMS {
        let loads = inputs.len();
        return Err(format!(
            "more than {CURVE_TERMS} loads expected, got {loads}"
        ));
    }
    // No load is a known load too: the range reaches to 0, where the curve is exactly 0.
    let low = inputs.iter().copied().fold(0.0, f64::min);
    let high = inputs.iter().copied().fold(0.0, f64::max);
    let scale = low.abs().max(high.abs());
    let all_finite = inputs.iter().chain(forces).all(|v| v.is_finite());
    if !(all_finite && low < high) {
        return Err(format!(
            "loads that change a finite picture expected, got inputs from {low} to {high}"
        ));
    }
    // Inputs are scaled to at most 1 so that the columns are of one size.
    let columns = DMatrix::from_fn(inputs.len(), CURVE_TERMS, |row, term| {
        (inputs[row] / scale).powi(term as i32 + 1)
    });
    let decomposition = columns.svd(true, true);
    if decomposition.rank(1e-9) < CURVE_TERMS {
        return Err(format!("at least {CURVE_TERMS} different loads expected"));
    }
    let solution = decomposition
        .solve(&DVector::from_column_slice(forces), 0.0)
        .map_err(str::to_owned)?;
    let coefficients = std::array::from_fn(|term| solution[term] / scale.powi(term as i32 + 1));
    Ok(ForceCurve {
        range: [low, high],
        coefficients,
    })
}
