//! `feeler sense TABLE --taxels LAYOUT`: three-axis taxel arrays of other manufacturers, as tables or on serial ports.

mod layout;
mod output;
mod publish;
mod pump;
mod skin;
mod table;

pub use layout::{TaxelOptions, read_taxel_layout, taxel_layout_text};

use super::contact::ContactFormat;
use super::frames::WAIT;
use super::output::{FrameReadings, Output};
use super::queued::{BackgroundOutput, Backpressure};
use super::tally::SensingStats;
use super::{SenseOptions, close};
use feeler::sensor::forces::{ElementReading, TactileFrame};
use feeler::sensor::taxel::{TaxelLayout, TaxelUnit};
use feeler::sensor::wrench::taxels::TaxelWrenchEstimator;
use feeler_console::{CommandError, is_raised};
use output::TaxelFormat;
use publish::Publisher;
use pump::{Event, RowPump};
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};
use table::Table;

/// Processes the rows of the table in `options` until it ends or `interrupted` is set.
pub fn sense(
    options: &SenseOptions,
    layout: &str,
    tally: &mut SensingStats,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    if options.finger.is_some() && !options.publish {
        return Err("--finger: has no effect for taxels without --publish".into());
    }
    if options.publish && options.calibration.is_some() {
        return Err("--calibration: has no effect for taxels with --publish, because the hand needs the force on each taxel".into());
    }
    let layout = read_taxel_layout(layout, &options.taxels, options.unloaded)?;
    let calibration = options.calibration.as_deref();
    let estimator =
        calibration.map(|path| layout::read_estimator(path, &layout, options.verified_within));
    let estimator = estimator.transpose()?;
    let is_calibrated = estimator.is_some();
    let table = Table::of(options)?;
    let start = table.open(&layout, options.rate)?;
    let publisher = match options.publish {
        true => Some(Publisher::new(options, &layout, tally.warner())?),
        false => None,
    };
    let output = open_output(options, &layout, estimator, tally)?;
    if layout.force_unit() == TaxelUnit::Counts && !is_calibrated {
        tally.warn(
            "forces are in counts, because the layout has no counts_per_newton; thresholds must be in counts, too",
        );
    }
    if layout
        .serial
        .as_ref()
        .is_some_and(|serial| !serial.protocol.has_shear())
    {
        tally.warn(
            "the array measures no shear: f_x and f_y are 0, so slip is not detected by shear",
        );
    }
    let is_stream = !matches!(table, Table::File(_));
    let mut stage = Stage {
        readings: vec![ElementReading::default(); layout.taxels.len()],
        output,
        publisher,
        tally,
        name: table.name(),
        is_stream,
    };
    let (pump, counters) = start()?;
    let ended = sense_all(&pump, &mut stage, interrupted);
    if let Some(counters) = counters {
        stage.tally.note(&format!("{}: {counters}", stage.name));
    }
    let whole = is_stream || !is_raised(interrupted);
    match stage.output {
        Some(output) => close(output, stage.tally, ended, whole),
        None => {
            stage.tally.close();
            ended
        }
    }
}

/// Opens the output, or returns `None` if forces are only published. While publishing, writing never blocks.
fn open_output(
    options: &SenseOptions,
    layout: &TaxelLayout,
    estimator: Option<TaxelWrenchEstimator>,
    tally: &SensingStats,
) -> Result<Option<Box<dyn Output>>, CommandError> {
    if options.publish && options.output.is_none() {
        return Ok(None);
    }
    let output = match options.contact {
        Some(_) if estimator.is_some() => {
            return Err("--contact: has no effect with a wrench calibration, which gives the place of contact itself".into());
        }
        Some(contact) => options.open_output_as(ContactFormat::of_taxels(contact, layout)?)?,
        None => options.open_output_as(TaxelFormat::of(layout, estimator)?)?,
    };
    match options.publish {
        true => Ok(Some(Box::new(BackgroundOutput::start(
            output,
            Backpressure::DropAndIgnoreErrors,
            false,
            tally.warner(),
        )?))),
        false => Ok(Some(output)),
    }
}

fn sense_all(
    pump: &RowPump,
    stage: &mut Stage,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    while !is_raised(interrupted) {
        // Flush as soon as no row is waiting.
        let mut event = pump.next(Duration::ZERO);
        if event.is_none() {
            stage.settle()?;
            event = pump.next(WAIT);
        }
        match event {
            None => {}
            Some(Event::Sequence(name)) => stage.begin_sequence(&name)?,
            Some(Event::Frame { frame, at }) => {
                stage.take(&frame, at)?;
                pump.give_back(frame);
            }
            Some(Event::Note(words)) => stage.tally.note(&words),
            Some(Event::TableProblem(words)) if stage.is_stream => stage.tally.warn(&words),
            Some(Event::TableProblem(_)) => {}
            Some(Event::Ended { problems, skipped }) => {
                stage.tally.skip_lines(skipped);
                // On a stream, a single occurrence was reported immediately.
                let told = |count| stage.is_stream && count == 1;
                let left = problems.iter().filter(|&&(count, _)| !told(count));
                left.for_each(|(_, words)| stage.tally.warn(words));
                return Ok(());
            }
            Some(Event::Failed(error)) => {
                return Err(format!("{}: {error}", stage.name).into());
            }
        }
    }
    Ok(())
}

/// Processes the rows of a source.
struct Stage<'a> {
    readings: Vec<ElementReading>,
    output: Option<Box<dyn Output>>,
    publisher: Option<Publisher>,
    tally: &'a mut SensingStats,
    /// Name of the source.
    name: String,
    /// `true` if rows arrive live, so that problems are reported immediately.
    is_stream: bool,
}

impl Stage<'_> {
    /// Publishes, writes and counts a frame whose row was received at `at`.
    fn take(&mut self, frame: &TactileFrame, at: Instant) -> Result<(), CommandError> {
        if let Some(publisher) = &mut self.publisher {
            publisher.publish(frame, at)?;
        }
        for (reading, &force) in self.readings.iter_mut().zip(&frame.forces) {
            reading.force = Some(force).filter(|force| !force.is_nan());
        }
        if let Some(output) = &mut self.output {
            output.write(&FrameReadings {
                sequence: frame.sequence,
                stamp: frame.stamp,
                readings: &self.readings,
                markers: &[],
            })?;
        }
        self.tally.frame(frame.sequence, at, &self.readings);
        Ok(())
    }

    fn begin_sequence(&mut self, name: &str) -> Result<(), CommandError> {
        self.output
            .as_mut()
            .map_or(Ok(()), |output| output.begin_sequence(name))
    }

    /// Performs periodic work while no row is available.
    fn settle(&mut self) -> Result<(), CommandError> {
        if let Some(publisher) = &mut self.publisher {
            publisher.check_peers();
        }
        self.output.as_mut().map_or(Ok(()), |output| output.flush())
    }
}
