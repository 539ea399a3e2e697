//! Plausibility checks of loads and fits. The messages name the options that convert or accept the loads.

use feeler::sensor::calibration::{
    Calibration, ElementRecord, ForceAxes, LoadCheckError, RecordBuilder, explained,
};
use feeler_console::{CommandError, warn};
use feeler_lab::sensor::{LoadsFile, LoadsFileError};

/// Rejects loads outside the range that a soft element can bear and a camera can resolve.
pub fn magnitude(loads: &LoadsFile) -> Result<(), CommandError> {
    loads
        .check_magnitude()
        .map_err(|error| format!("{error}{CONFIRM}").into())
}

/// Advice appended to messages about loads that are out of range.
pub const CONFIRM: &str = " (add the unit to the header, as in f_z [mN], to convert them, or use --confirm-loads to accept them)";

/// Rejects loads (converted by `axes`) whose elements, axes, signs or zero offsets contradict the images.
pub fn before_fitting(
    loads: &LoadsFile,
    measured: &RecordBuilder,
    axes: ForceAxes,
) -> Result<(), CommandError> {
    loads.check(measured).map_err(|error| {
        let advice = advice(&error, axes);
        format!("{error}{advice}").into()
    })
}

/// Rejects loads that contradict the calibration fitted to them, including zero offsets of recordings; warns of a
/// doubtful load.
pub fn after_fitting(
    loads: &LoadsFile,
    measured: &RecordBuilder,
    calibration: &Calibration,
) -> Result<(), CommandError> {
    let checked = loads.check_fit(measured, calibration);
    let doubtful = checked.map_err(|error| format!("{error}{}", keeping(&error)))?;
    if let Some(load) = doubtful {
        warn(&format!(
            "{load} (its image may also differ from the others)"
        ));
    }
    Ok(())
}

/// Returns the advice for an error.
fn advice(error: &LoadsFileError, axes: ForceAxes) -> String {
    let LoadsFileError::Contradicted {
        source: LoadCheckError::Axes {
            axes: Some(seen), ..
        },
        ..
    } = error
    else {
        return keeping(error);
    };
    let converting = seen.after(axes);
    if converting == ForceAxes::default() {
        return " (without --force-on and --force-axes, the forces agree with the images)".into();
    }
    let option = match converting == ForceAxes::default().reversed() {
        true => "--force-on object".into(),
        false => format!("--force-axes {converting}"),
    };
    let instead = if axes == ForceAxes::default() {
        ""
    } else {
        " instead"
    };
    format!(" (if the table was measured in these axes, use {option}{instead} to convert it)")
}

/// Returns the advice on which option accepts the rejected loads.
fn keeping(error: &LoadsFileError) -> String {
    let what = error.to_string();
    let separator = if what.ends_with('?') { "" } else { ";" };
    format!("{separator} --force-fit accepts them anyway")
}

/// Rejects a calibration that fits noise.
pub fn noise(calibration: &Calibration, records: &[ElementRecord]) -> Result<(), CommandError> {
    /// Minimum fraction of the loads' variance that must be explained.
    const LEAST: f64 = 0.2;
    let explained = explained(calibration, records);
    let axes = ["f_x", "f_y", "f_z"].into_iter().zip(explained.to_array());
    let unexplained: Vec<String> = axes
        .filter(|(_, part)| *part < LEAST)
        .map(|(axis, part)| format!("{axis} (held-out R² {part:.2})"))
        .collect();
    if unexplained.is_empty() {
        return Ok(());
    }
    Err(format!(
        "the images explain too little of {}; expected at least {LEAST}. Check that the elements are numbered as in the layout \
         (`feeler locate --preview` draws the numbers), or identify them by position (columns column, row); --force-fit \
         accepts the fit anyway",
        unexplained.join(", ")
    )
    .into())
}
