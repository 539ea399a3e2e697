//! Reads data sets of taxel arrays with measured values.

use super::targets::{Measured, read_targets};
use crate::league::data::{DataSet, Recording, Truth};
use crate::league::definition::{Layout, Target, TaxelData};
use crate::sense::taxel_layout_text;
use feeler::sensor::forces::{SensorError, TactileFrame, TactileSensor};
use feeler::sensor::taxel::{TaxelLayout, TaxelSensor};
use feeler::sensor::wrench::taxels::MeasuredSeries;
use feeler_console::{CommandError, open_table};
use std::fs;
use std::path::{Path, PathBuf};

/// Reads the data set in `folder`. Adds the files to `files`.
///
/// # Errors
/// If there is no recording, or a file cannot be read.
pub fn read(
    data: &TaxelData,
    targets: &[Target],
    folder: &Path,
    files: &mut Vec<PathBuf>,
) -> Result<DataSet, CommandError> {
    let layout = layout(data, folder)?;
    let mut set = DataSet {
        columns: &["x", "y", "z"],
        unit: layout.force_unit().name().into(),
        recordings: Vec::new(),
        groups: Vec::new(),
        slips: Vec::new(),
        digest: String::new(),
        notes: Vec::new(),
    };
    for name in matching(folder, &data.tables)? {
        let table = folder.join(data.tables.replacen('*', &name, 1));
        let measured = folder.join(data.targets.replacen('*', &name, 1));
        let header = data.without_header.as_deref();
        let measured_at = read_targets(&measured, &data.time, targets, header)?;
        let (times, rows) = read_rows(&table, &layout)?;
        let values = at_times(&measured_at, &times, targets.len());
        if values.iter().flatten().all(|value| value.is_nan()) {
            let (table, measured) = (table.display(), measured.display());
            return Err(format!("{measured}: no value measured during the rows of {table}; expected one clock in both").into());
        }
        if measured_at.skipped > 0 {
            let skipped = measured_at.skipped;
            let note = format!("{}: {skipped} rows cannot be read", measured.display());
            set.notes.push(note);
        }
        files.extend([table, measured]);
        set.recordings.push(Recording {
            group: set.groups.len(),
            times,
            rows,
            truth: Truth::Values(values),
            name: name.clone(),
        });
        set.groups.push(name);
    }
    Ok(set)
}

fn layout(data: &TaxelData, folder: &Path) -> Result<TaxelLayout, CommandError> {
    let text = match &data.layout {
        Layout::Given(table) => table.to_string(),
        Layout::Named(name) => match folder.join(name) {
            path if path.is_file() => fs::read_to_string(path)?,
            _ => taxel_layout_text(name)?,
        },
    };
    let mut layout = TaxelLayout::from_toml(&text).map_err(|e| format!("layout: {e}"))?;
    if let Some(prefix) = &data.prefix {
        layout.columns.prefix.clone_from(prefix);
    }
    layout.check().map_err(|e| format!("layout: {e}"))?;
    Ok(layout)
}

/// Returns the texts that replace the `*` of `pattern` in the names of files in `folder`, sorted. Without `*`, returns
/// the name itself.
fn matching(folder: &Path, pattern: &str) -> Result<Vec<String>, CommandError> {
    let Some((start, end)) = pattern.split_once('*') else {
        return Ok(vec![pattern.to_owned()]);
    };
    let refused = |e: &dyn std::fmt::Display| format!("{}: {e}", folder.display());
    let entries = fs::read_dir(folder).map_err(|e| refused(&e))?;
    let names = entries.filter_map(|entry| {
        let name = entry.ok()?.file_name().into_string().ok()?;
        let name = name.strip_prefix(start)?.strip_suffix(end)?;
        Some(name.to_owned())
    });
    let mut names: Vec<_> = names.collect();
    names.sort();
    match names.is_empty() {
        true => Err(refused(&format_args!("no file {pattern}")).into()),
        false => Ok(names),
    }
}

/// Times and rows of a recording.
type Rows = (Vec<f64>, Vec<Vec<f64>>);

fn read_rows(path: &Path, layout: &TaxelLayout) -> Result<Rows, CommandError> {
    let refused = |e: &dyn std::fmt::Display| format!("{}: {e}", path.display());
    let stream = open_table(path).map_err(|e| refused(&e))?;
    let mut sensor = TaxelSensor::open(stream, layout, None).map_err(|e| refused(&e))?;
    let mut frame = TactileFrame::unloaded(sensor.element_count());
    let (mut times, mut rows) = Rows::default();
    loop {
        match sensor.read(&mut frame) {
            Ok(()) => {}
            Err(SensorError::Ended { .. }) => return Ok((times, rows)),
            Err(error) => return Err(refused(&error).into()),
        }
        times.push(frame.stamp);
        let values = frame.forces.iter().flat_map(|force| force.to_array());
        rows.push(values.collect());
    }
}

/// Interpolates measured values at `times`; NaN outside the measurements and in gaps.
fn at_times(measured: &Measured, times: &[f64], targets: usize) -> Vec<Vec<f64>> {
    let of_target = |target: usize| {
        let rows = measured.keys.iter().zip(&measured.values);
        let known = rows.filter_map(|(key, values)| {
            let time = key
                .trim()
                .parse::<f64>()
                .ok()
                .filter(|time| time.is_finite())?;
            let value = values
                .get(target)
                .copied()
                .filter(|value| value.is_finite())?;
            Some((time, value))
        });
        let mut known: Vec<_> = known.collect();
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (times, values) = known.into_iter().unzip();
        MeasuredSeries::new(times, values)
    };
    let series: Vec<_> = (0..targets).map(of_target).collect();
    let at = |&time: &f64| {
        let values = series.iter();
        values
            .map(|series| series.at(time).unwrap_or(f64::NAN))
            .collect()
    };
    times.iter().map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_and_ends_are_unknown() {
        let measured = Measured {
            keys: ["0", "0.5", "1", "9"].map(String::from).to_vec(),
            values: [1.0, 2.0, 3.0, 5.0].map(|value| vec![value]).to_vec(),
            skipped: 0,
        };
        let at = |time| at_times(&measured, &[time], 1)[0][0];
        assert_eq!((at(0.0), at(0.5), at(1.0), at(9.0)), (1.0, 2.0, 3.0, 5.0));
        assert!([-0.1, 5.0, 9.1].map(at).iter().all(|value| value.is_nan()));
    }
}
