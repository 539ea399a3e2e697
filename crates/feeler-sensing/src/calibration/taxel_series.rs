//! Recordings of a taxel array with measured wrenches.

use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use feeler::sensor::taxel::{TaxelLayout, TaxelSensor};
use feeler::sensor::wrench::taxels::{
    MeasuredAt, Memory, TaxelInput, TaxelSample, TaxelSeries, estimate_delay, join,
};
use feeler_console::{CommandError, open_table};
use feeler_lab::sensor::ForcesFile;
use std::path::Path;

/// Maximum time by which rows may be out of order, s.
const MAX_BACK: f64 = 1.0;

/// Samples of all recordings.
pub struct TaxelRecordings {
    /// Rows of taxels with the wrench at the same time.
    pub samples: Vec<TaxelSample>,
    /// Estimated delay of the measured wrenches after the rows of taxels, s.
    pub delay: f64,
    /// Problems in the tables.
    pub problems: Vec<String>,
}

/// Reads the taxel tables listed in `forces`, and interpolates the measured wrenches at the times of their rows. Calls
/// `read` after each table.
///
/// # Errors
/// If a table cannot be read, or if no wrench was measured between its first and last row.
pub fn read_taxel_recordings(
    forces: &ForcesFile,
    layout: &TaxelLayout,
    mut read: impl FnMut(),
) -> Result<TaxelRecordings, CommandError> {
    let mut all = Vec::new();
    let mut problems = Vec::new();
    for (index, name) in forces.recordings().iter().enumerate() {
        let measured = forces.measured_in(index).ok_or_else(|| {
            format!(
                "{}: --taxels requires the columns recording (a table of taxels) and time (s) instead of picture",
                forces.name()
            )
        })?;
        let path = forces.path_of(name);
        let series = read_series(&path, layout, measured, &mut problems)
            .map_err(|e| format!("{}: {e}", path.display()))?;
        check_times(&path, &series)?;
        all.push(series);
        read();
    }
    let delay = estimate_delay(&all);
    Ok(TaxelRecordings {
        samples: join(&all, delay),
        delay,
        problems,
    })
}

/// Reads the rows of the table at `path`, and the wrenches `measured` during them.
fn read_series(
    path: &Path,
    layout: &TaxelLayout,
    measured: Vec<MeasuredAt>,
    problems: &mut Vec<String>,
) -> Result<TaxelSeries, CommandError> {
    let mut sensor = TaxelSensor::open(open_table(path)?, layout, None)?;
    let mut frame = TactileFrame::unloaded(sensor.element_count());
    let mut memory = Memory::new(sensor.element_count());
    let mut series = TaxelSeries {
        measured,
        ..TaxelSeries::default()
    };
    loop {
        match sensor.read(&mut frame) {
            Ok(()) => {}
            Err(SensorError::Ended { .. }) => break,
            Err(error) => return Err(error.into()),
        }
        if sensor.starts_sequence() {
            memory.restart();
        }
        let mut input = TaxelInput::default();
        memory.update(frame.stamp, &frame.forces, &mut input);
        series.stamps.push(frame.stamp);
        series.inputs.push(input);
    }
    series.forget_if_sparse();
    for problem in sensor.problems().iter() {
        let column = problem.first.column.and_then(|c| sensor.columns().get(c));
        let words = problem.in_words(column.map(String::as_str));
        problems.push(format!("{}: {words}", path.display()));
    }
    Ok(series)
}

/// Rejects a recording whose time jumps back, or during which no wrench was measured, e.g. because the clocks differ.
fn check_times(path: &Path, series: &TaxelSeries) -> Result<(), CommandError> {
    if let Some(back) = series
        .stamps
        .windows(2)
        .find(|pair| pair[1] < pair[0] - MAX_BACK)
    {
        let ([before, after], path) = ([back[0], back[1]], path.display());
        return Err(format!(
            "{path}: expected one recording, but time goes back from {before} to {after} s; split it into one table for each"
        )
        .into());
    }
    let (start, end) = (series.stamps.first(), series.stamps.last());
    let (first, last) = (series.measured.first(), series.measured.last());
    let times = first.zip(last).map(|(first, last)| [first.time, last.time]);
    match (start.zip(end), times) {
        (Some((&start, &end)), Some([first, last])) if first <= end && last >= start => Ok(()),
        (Some((start, end)), Some([first, last])) => Err(format!(
            "{}: expected forces measured during its rows ({start} to {end} s), got times from {first} to {last} s; use \
             one clock for both",
            path.display()
        )
        .into()),
        _ => Err(format!("{}: no rows of taxels", path.display()).into()),
    }
}
