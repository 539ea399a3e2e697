//! `feeler skins record`: raw readings of a skin as a table.

use crate::sense::TaxelOptions;
use crate::sense::read_taxel_layout;
use feeler::sensor::forces::{TactileFrame, TactileSensor};
use feeler::sensor::taxel::TaxelLayout;
use feeler_console::{CommandError, Outcome, Outputs, is_raised, watch_for_interrupt};
use feeler_sources::skin::{SkinNews, SkinSensor};
use std::io::{Write, stderr};
use std::path::{Path, PathBuf};

/// Skin and table of a recording.
#[derive(Debug, Clone)]
pub struct SkinRecordOptions {
    /// Path of the serial port.
    pub port: String,
    /// Layout: a file or a built-in name.
    pub taxels: String,
    /// Duration, s, or `None` to record until Ctrl-C.
    pub seconds: Option<f64>,
    /// Table to write.
    pub output: PathBuf,
    /// `true` to replace an existing table.
    pub force: bool,
}

/// Writes the raw readings of a skin, without subtracting its zero, to a table that `feeler sense` and `feeler
/// calibrate` read with the same layout. A lost frame leaves a gap in the time column.
///
/// # Errors
/// If the layout is invalid, the port cannot be opened, or writing fails.
pub fn record_skin(options: &SkinRecordOptions) -> Result<Outcome, CommandError> {
    let layout = read_taxel_layout(&options.taxels, &TaxelOptions::default(), None)?;
    let taxels = Some(Path::new(&options.taxels));
    let part = Outputs::new(options.force, [taxels]).create(&options.output, "--output")?;
    let mut sensor = SkinSensor::open(&options.port, &layout)?;
    let interrupted = watch_for_interrupt()?;
    let mut table = csv::WriterBuilder::new()
        .delimiter(delimiter(&layout))
        .from_writer(part.writer()?);
    table.write_record(layout.table_header())?;
    let unit = layout
        .columns
        .time
        .as_ref()
        .map_or(1.0, |time| time.unit.seconds());
    let mut frame = TactileFrame::unloaded(sensor.element_count());
    let mut first = None;
    while !is_raised(&interrupted) {
        sensor.read(&mut frame)?;
        if let Some(news) = sensor.take_news() {
            warn(&news);
        }
        if !sensor.has_frame() {
            continue;
        }
        let begin = *first.get_or_insert(frame.stamp);
        if options
            .seconds
            .is_some_and(|seconds| frame.stamp - begin > seconds)
        {
            break;
        }
        let values = sensor.values().iter().flat_map(|value| value.to_array());
        let cells = values.map(|value| {
            if value.is_nan() {
                String::new()
            } else {
                value.to_string()
            }
        });
        let time = format!("{:.6}", frame.stamp / unit);
        table.write_record(std::iter::once(time).chain(cells))?;
    }
    table.flush()?;
    drop(table);
    // If standard error is closed, the table is complete all the same.
    let _ = writeln!(stderr(), "serial:{}: {}", options.port, sensor.counters());
    if first.is_none() {
        part.discard();
        return Err(format!(
            "serial:{}: no frame was received; expected at least 1",
            options.port
        )
        .into());
    }
    part.rename()?;
    Ok(Outcome::Done)
}

fn delimiter(layout: &TaxelLayout) -> u8 {
    let delimiter = layout.columns.delimiter.unwrap_or(',');
    u8::try_from(delimiter).unwrap_or(b',')
}

/// Prints a change of the connection.
fn warn(news: &SkinNews) {
    let words = match news {
        SkinNews::Disconnected(reason) => format!("warning: the skin is disconnected ({reason})"),
        SkinNews::Reconnected => "the skin is connected again".into(),
        SkinNews::Silent => "warning: the skin sends no frames".into(),
    };
    // Ignore a closed standard error.
    let _ = writeln!(stderr(), "{words}");
}
