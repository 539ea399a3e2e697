//! Refuses loads that cannot be what the pictures show, with the options that convert or keep them.

use feeler::sensor::calibration::{Calibration, explained};
use feeler::sensor::calibration_fit::ElementRecord;
use feeler::sensor::live_calibration::ForceAxes;
use feeler::sensor::load_check::LoadCheckError;
use feeler::sensor::loads::RecordBuilder;
use feeler_console::CommandError;
use feeler_console::warn;
use feeler_lab::sensor::{LoadsFile, LoadsFileError};

/// Refuses loads that no soft element bears, or that no picture shows.
pub fn magnitude(loads: &LoadsFile) -> Result<(), CommandError> {
    loads
        .check_magnitude()
        .map_err(|error| format!("{error}{CONFIRM}").into())
}

/// What can be done about loads that are out of range.
pub const CONFIRM: &str =
    " A unit in the header, such as f_z [mN] or [kN], converts them; --confirm-loads keeps them";

/// Refuses loads, turned by `axes`, whose elements, axes, signs or zeros the pictures contradict.
pub fn before_fitting(
    loads: &LoadsFile,
    measured: &RecordBuilder,
    axes: ForceAxes,
) -> Result<(), CommandError> {
    loads.check(measured).map_err(|error| {
        let way_out = way_out(&error, axes);
        format!("{error}{way_out}").into()
    })
}

/// Refuses loads that contradict the calibration fitted to them, zeros of recordings included, and warns of a doubtful one.
pub fn after_fitting(
    loads: &LoadsFile,
    measured: &RecordBuilder,
    calibration: &Calibration,
) -> Result<(), CommandError> {
    let checked = loads.check_fit(measured, calibration);
    let doubtful = checked.map_err(|error| format!("{error}{}", keeping(&error)))?;
    if let Some(load) = doubtful {
        warn(&format!("{load} Or is its picture unlike the others?"));
    }
    Ok(())
}

/// What can be done about an error.
fn way_out(error: &LoadsFileError, axes: ForceAxes) -> String {
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
        return " Without --force-on and --force-axes, the forces are what the pictures show"
            .into();
    }
    let option = match converting == ForceAxes::default().reversed() {
        true => "--force-on object".into(),
        false => format!("--force-axes {converting}"),
    };
    let instead = if axes == ForceAxes::default() {
        ""
    } else {
        " alone"
    };
    format!(" If the table is so, {option}{instead} converts it")
}

/// Names the option that accepts loads which are refused.
fn keeping(error: &LoadsFileError) -> String {
    let what = error.to_string();
    let separator = if what.ends_with('?') { "" } else { ";" };
    format!("{separator} --force-fit keeps them all the same")
}

/// Refuses a calibration that is fitted to noise.
pub fn noise(calibration: &Calibration, records: &[ElementRecord]) -> Result<(), CommandError> {
    /// Part of the variance of loads that must be explained.
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
        "the pictures explain nothing of {}, at least {LEAST} expected: are the elements numbered as in the layout, \
         where `feeler locate --preview` draws the numbers, or named by their places (columns column, row)? --force-fit keeps \
         it all the same",
        unexplained.join(", ")
    )
    .into())
}
