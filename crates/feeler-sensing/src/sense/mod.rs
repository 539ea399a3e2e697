//! `feeler sense`: reads images or taxels, and writes tables or recordings, or publishes tactile data.

mod assumed;
mod beside;
mod contact;
mod frames;
mod output;
mod publish;
mod queued;
mod recorded;
mod sensor;
mod source;
mod tally;
mod taxels;
mod track;
mod wrench;

use crate::camera::CameraOptions;
pub use contact::ContactOptions;
use feeler_console::{CommandError, Outcome, Outputs, is_raised, watch_for_interrupt};
use feeler_lab::config::Experiment;
use feeler_report::run::make::RECORDING;
use feeler_rig::LinkOptions;
use output::{Format, ImageFormat, Output};
use queued::{BackgroundOutput, Backpressure};
pub use sensor::named_sensor;
use source::Source;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use tally::SensingStats;
pub use taxels::{TaxelOptions, read_taxel_layout, taxel_layout_text};
pub use track::Track;

/// Experiment whose fingertip is assumed by default.
const EXPERIMENT: &str = "cap-closing";

/// Default frame rate (Hz).
const DEFAULT_RATE: f64 = 30.0;

/// Source, sensor and output of the readings.
#[derive(Debug, Clone, Default)]
pub struct SenseOptions {
    /// Images, folders, a video, a recording, a camera, `rig:`, or `-` for standard input.
    pub sources: Vec<PathBuf>,
    /// Located layout in place of an experiment's fingertip.
    pub layout: Option<PathBuf>,
    /// Options of the contact output, or `None` to write forces or moments.
    pub contact: Option<ContactOptions>,
    /// Experiment that defines the fingertip: a file or a built-in name.
    pub experiment: Option<String>,
    /// Calibration file.
    pub calibration: Option<PathBuf>,
    /// Maximum age of the wrench calibration's verification, days, or `None` if it need not be verified.
    pub verified_within: Option<u32>,
    /// `true` to correct for a drifting lamp.
    pub drift_correction: bool,
    /// Output file (.csv, .jsonl or .mcap), or `None` for a table on standard output.
    pub output: Option<PathBuf>,
    /// `true` to replace an existing output.
    pub force: bool,
    /// `true` to store the images in the recording.
    pub record_frames: bool,
    /// Size of raw frames on standard input (columns, rows).
    pub raw: Option<(usize, usize)>,
    /// Size of a camera's images (columns, rows), or `None` for the size of the fingertip's images.
    pub size: Option<(usize, usize)>,
    /// Frame rate (Hz): requested from a camera, assumed for images.
    pub rate: Option<f64>,
    /// Camera settings.
    pub camera: CameraOptions,
    /// Mode of tracking markers by identity, or `None` to measure moments.
    pub track: Option<Track>,
    /// Image without load from which displacements are measured.
    pub reference: Option<PathBuf>,
    /// Number of initial frames without load; displacements are measured from their mean.
    pub unloaded: Option<u32>,
    /// Maximum share of saturated pixels in a sub-region, 0 to 1.
    pub max_saturated: Option<f64>,
    /// Index of the finger in the recording or experiment.
    pub finger: Option<usize>,
    /// `true` to publish the readings for a hand.
    pub publish: bool,
    /// Layout of a taxel array, if the source is one.
    pub taxels: TaxelOptions,
    /// Settings of the experiment, as in `control.slip_threshold=2.5`.
    pub settings: Vec<String>,
    /// Name of the rig, or `None` for the experiment's name.
    pub rig: Option<String>,
    /// Connection to the rig.
    pub link: LinkOptions,
    /// First given option that only affects publishing, if any.
    pub publishing_option: Option<&'static str>,
}

impl SenseOptions {
    /// Rejects options that have no effect.
    fn check_options(&self) -> Result<(), CommandError> {
        if let Some(option) = self.publishing_option.filter(|_| !self.publish) {
            return Err(format!(
                "{option}: has no effect without --publish; add --publish, or edit the experiment file \
                 instead"
            )
            .into());
        }
        let without = [
            ("--reference", self.reference.is_some()),
            ("--unloaded", self.unloaded.is_some()),
        ];
        let given = without
            .into_iter()
            .find(|&(_, given)| given && self.publish);
        match given {
            Some((option, _)) => Err(format!(
                "{option}: has no effect with --publish, because the calibration defines the unloaded state"
            )
            .into()),
            None => Ok(()),
        }
    }

    /// Name of the rig that runs `experiment`.
    fn rig_name(&self, experiment: &Experiment) -> String {
        let name = || experiment.config.name.clone();
        self.rig.clone().unwrap_or_else(name)
    }

    /// Frame rate of the images (frames per second).
    fn rate(&self) -> f64 {
        self.rate.unwrap_or(DEFAULT_RATE)
    }

    /// Name or path of the experiment whose fingertip is used.
    fn experiment(&self) -> &str {
        self.experiment.as_deref().unwrap_or(EXPERIMENT)
    }

    /// Returns `true` if no option identifies the fingertip.
    fn assumes_fingertip(&self) -> bool {
        self.experiment.is_none() && self.layout.is_none() && self.calibration.is_none()
    }

    /// Finger whose images are recorded, or `None` if images are not recorded.
    fn recorded_finger(&self) -> Option<usize> {
        self.record_frames.then(|| self.finger.unwrap_or(0))
    }

    /// Rejects `--record-frames` if the output is not MCAP.
    fn check_record_frames(&self) -> Result<(), CommandError> {
        let is_mcap = |path: &Path| path.extension().is_some_and(|e| e == "mcap");
        if !self.record_frames || self.output.as_deref().is_some_and(is_mcap) {
            return Ok(());
        }
        let actual = match &self.output {
            Some(path) => path.display().to_string(),
            None => "a table on standard output".into(),
        };
        Err(format!(
            "--record-frames: only MCAP files can contain images; expected -o FILE.mcap, got {actual}"
        )
        .into())
    }

    /// Opens the output for readings from images.
    fn open_output(&self, forces: bool) -> Result<Box<dyn Output>, CommandError> {
        let pictures = self.recorded_finger();
        self.open_output_as(ImageFormat { forces, pictures })
    }

    /// Moves `output` to a background thread if images are recorded, so that writing them does not block sensing.
    fn beside_the_sensor(
        &self,
        output: Box<dyn Output>,
        source: &Source,
        tally: &SensingStats,
    ) -> Result<Box<dyn Output>, CommandError> {
        if !self.record_frames {
            return Ok(output);
        }
        let full = match source {
            Source::Camera(_) => Backpressure::Drop,
            _ => Backpressure::Block,
        };
        Ok(Box::new(BackgroundOutput::start(
            output,
            full,
            true,
            tally.warner(),
        )?))
    }

    /// Opens the output for rows or messages of this format.
    fn open_output_as(
        &self,
        format: impl Format + 'static,
    ) -> Result<Box<dyn Output>, CommandError> {
        output::open(self.output.as_deref(), self.outputs(), Box::new(format))
    }

    /// Returns the set of output files, which rejects input files as outputs.
    fn outputs(&self) -> Outputs {
        let recordings: Vec<_> = self.sources.iter().map(|s| s.join(RECORDING)).collect();
        let named = [&self.layout, &self.calibration, &self.reference];
        let sources = self.sources.iter().chain(&recordings).map(PathBuf::as_path);
        let inputs = sources.map(Some).chain(named.map(|path| path.as_deref()));
        let taxels = self.taxels.taxels.as_deref().map(Path::new);
        let experiment = self.experiment.as_deref().map(Path::new);
        Outputs::new(self.force, inputs.chain([experiment, taxels]))
    }
}

/// Reads the sources of `options`, and writes their readings to a table or recording, or publishes them on the link.
///
/// # Errors
/// If options contradict each other, or a source, the calibration or the output fails.
pub fn sense(options: &SenseOptions) -> Result<Outcome, CommandError> {
    options.check_record_frames()?;
    let mut tally = SensingStats::new(!options.publish);
    let interrupted = watch_for_interrupt()?;
    match &options.taxels.taxels {
        Some(layout) => {
            options.check_options()?;
            if options.record_frames {
                return Err("--record-frames: taxels have no images".into());
            }
            taxels::sense(options, layout, &mut tally, &interrupted)?;
        }
        None => sense_source(options, &mut tally, &interrupted)?,
    }
    if is_raised(&interrupted) {
        return Ok(Outcome::GivenUp);
    }
    if tally.frames() == 0 {
        return Err(tally.nothing().into());
    }
    Ok(Outcome::Done)
}

/// Processes a source other than a taxel table.
fn sense_source(
    options: &SenseOptions,
    tally: &mut SensingStats,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    let source = Source::of(options)?;
    options.check_options()?;
    match source {
        Source::Recording(_) if options.publish => {
            let message = "--publish: expected images, a camera or rig:, got a recorded run";
            Err(message.into())
        }
        Source::Rig if !options.publish => {
            Err("rig: requires --publish, because it is sensed for the hand".into())
        }
        Source::Recording(path) => recorded::sense(options, &path, tally, interrupted),
        source if options.publish => publish::publish(options, &source, tally, interrupted),
        source => match options.track {
            Some(track) => track::sense(options, track, &source, tally, interrupted),
            None => frames::sense(options, &source, tally, interrupted),
        },
    }
}

/// Closes `output` and reports the result, also if sensing `ended` with an error.
///
/// The file remains a partial file unless it is `whole`. A closed pipe (a reader that stops early) is not an error.
fn close(
    output: Box<dyn Output>,
    tally: &SensingStats,
    ended: Result<(), CommandError>,
    whole: bool,
) -> Result<(), CommandError> {
    if let Some(warning) = output.warning() {
        tally.warn(&warning);
    }
    let left = output.finish(whole && ended.is_ok());
    tally.close();
    let written = match (ended, left) {
        (Ok(()), Ok(Some(part))) => {
            tally.warn(&format!("{} is partial", part.display()));
            Ok(())
        }
        (Ok(()), left) => left.map(|_| ()),
        (Err(error), Ok(Some(part))) => Err(output::partial(&error, &part)),
        (ended, _) => ended,
    };
    match written {
        Err(error) if is_closed_pipe(&error) => Ok(()),
        written => written,
    }
}

fn is_closed_pipe(error: &CommandError) -> bool {
    let of_table = error.downcast_ref::<csv::Error>();
    let of_table = of_table.and_then(|error| match error.kind() {
        csv::ErrorKind::Io(error) => Some(error),
        _ => None,
    });
    let error = of_table.or_else(|| error.downcast_ref());
    error.is_some_and(|error| error.kind() == ErrorKind::BrokenPipe)
}
