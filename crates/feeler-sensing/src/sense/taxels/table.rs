//! Sources of a taxel array's readings.

use super::super::SenseOptions;
use super::super::source::SERIAL;
use super::pump::RowPump;
use super::skin;
use feeler::sensor::taxel::TaxelLayout;
use feeler_console::{CommandError, open_table};
use feeler_sources::skin::{SkinCounters, SkinSensor};
use std::io::{BufRead, BufReader, stdin};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A source of readings.
pub enum Table {
    /// Rows on standard input.
    Stream,
    /// A file with rows.
    File(PathBuf),
    /// A skin on the serial port at this path.
    Serial(String),
}

impl Table {
    /// Determines the source from the options.
    pub fn of(options: &SenseOptions) -> Result<Self, CommandError> {
        let [source] = &options.sources[..] else {
            return Err(format!(
                "expected one table for --taxels, serial:PORT, or - for rows on standard input, got {} sources",
                options.sources.len()
            )
            .into());
        };
        if source == Path::new("-") {
            return Ok(Self::Stream);
        }
        let Some(port) = source.to_str().and_then(|name| name.strip_prefix(SERIAL)) else {
            return Ok(Self::File(source.clone()));
        };
        let of_tables = [
            ("--rate", options.rate.is_some()),
            ("--prefix", options.taxels.prefix.is_some()),
            ("--sequence", options.taxels.sequence.is_some()),
        ];
        match of_tables.into_iter().find(|&(_, given)| given) {
            Some((flag, _)) => Err(format!("{flag}: has no effect on a serial port").into()),
            None if port.is_empty() => {
                Err("serial: expected a port, as in serial:/dev/ttyACM0; list the ports with `feeler skins`".into())
            }
            None => Ok(Self::Serial(port.to_owned())),
        }
    }

    /// Name of the source in messages.
    pub fn name(&self) -> String {
        match self {
            Self::Stream => "-".into(),
            Self::File(path) => path.display().to_string(),
            Self::Serial(port) => format!("{SERIAL}{port}"),
        }
    }

    /// Opens the source of an array with this `layout`. Call the result to start reading.
    pub fn open(&self, layout: &TaxelLayout, rate: Option<f64>) -> Result<Start, CommandError> {
        let stream: Box<dyn BufRead + Send> = match self {
            Self::Stream => Box::new(BufReader::new(stdin())),
            Self::File(path) => {
                let refused = |error| format!("{}: {error}; expected a table", path.display());
                Box::new(open_table(path).map_err(refused)?)
            }
            Self::Serial(port) => {
                let sensor = SkinSensor::open(port, layout)?;
                let counters = Some(sensor.counters());
                return Ok(Box::new(move || Ok((skin::start(sensor)?, counters))));
            }
        };
        let layout = layout.clone();
        Ok(Box::new(move || {
            Ok((RowPump::start(stream, layout, rate)?, None))
        }))
    }
}

/// Starts reading an open source on a background thread. Also returns the counters of the connection, if any.
pub type Start = Box<dyn FnOnce() -> Result<(RowPump, Option<Arc<SkinCounters>>), CommandError>>;
