//! `feeler sense`: moments, forces or wrenches from images, cameras, recordings and taxel tables.

mod assumed;
mod beside;
mod frames;
pub(super) mod output;
mod prompt;
mod publish;
mod queued;
mod recorded;
mod row_file;
pub(super) mod sensor;
pub(super) mod source;
pub(super) mod tally;
pub(super) mod taxels;
mod track;
mod whole_rows;
mod wrench;

use super::bounded::{parse_between, parse_rate};
use super::camera::CameraArguments;
use super::interrupt::watch_for_interrupt;
use super::link::{ExperimentArguments, LinkArguments};
use super::part_file::{Outputs, Overwrite};
use super::{CommandError, Outcome};
use feeler_report::make::RECORDING;
use output::{Format, OfPictures, Output};
use queued::{Full, Queued};
use source::Source;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use tally::Tally;
use taxels::TaxelArguments;
use track::Track;

/// Experiment whose fingertip is assumed by default.
const EXPERIMENT: &str = "cap-closing";

/// Default frame rate (Hz).
const DEFAULT_RATE: f64 = 30.0;

const DETAILS: &str = "\
Images are PNG, JPEG, PNM, TIFF, BMP or WebP with 8 or 16 bits (scaled to 8). They are rotated by their EXIF orientation, converted to grey, and must have the size of the sensor's images. Video frames are rotated as the file states, converted to grey (luma), and stamped with their time from the start of the file. Without --layout, --experiment and --calibration, the first image must look like one of the cap-closing fingertip.

Output is one row per element and frame: frame, stamp (s), element, integrated_gray (G, grey levels times m²), u_x and u_y (displacement of the centroid, m), and with --calibration f_x, f_y, f_z (N). Forces are in the element's frame with the element's sign: z is compression; x and y are the image axes if the layout has no dome. A field is empty if it has no value: u of dark elements, forces of dark or saturated sub-regions, G and u of a recorded run.

With --taxels, the source is a table with one row per sample of a taxel array, or - for rows on standard input. Output is one row per taxel and frame: frame, stamp (s), element, and f_x, f_y, f_z (N), or f_x_counts, f_y_counts, f_z_counts if the layout does not define counts per newton. With --sequence, a column sequence comes first.

With a wrench calibration (feeler calibrate --wrench), output is one row per frame: frame, stamp, f_x, f_y, f_z (N), m_x, m_y, m_z (N m) in the frame and with the sign of the calibration's measurements, empty if not calibrated; valid: whether the image is similar to those of the calibration; and novelty: its distance from them, as a fraction of the largest valid distance. MCAP files contain geometry_msgs/WrenchStamped, with NaN for components that are not calibrated or not valid.

u is measured from the unloaded centroids of the calibration. Without a calibration, it is measured from their mean over the first frames (--unloaded), or from --reference.";

#[derive(Debug, clap::Args)]
#[command(after_long_help = DETAILS)]
pub struct Arguments {
    /// Source of images or readings.
    ///
    /// A folder or files of images (in natural order of their names), a video file (.avi, .mp4, .mkv, .mov, .webm,
    /// .m4v; requires ffmpeg), a recorded run, a recording made by `feeler sense --record-frames`, a camera
    /// (/dev/video0, genicam:ID as listed by `feeler cameras`, or genicam: for the first one), rig: for the images of
    /// `feeler world` or `feeler rig --drives emulated`, or - for raw grey frames on standard input.
    #[arg(required = true, value_name = "SOURCE")]
    sources: Vec<PathBuf>,
    /// Use the sensing elements found by `feeler locate` instead of an experiment's.
    ///
    /// If the layout lacks the dome's geometry, G is in grey levels px² and u in px.
    #[arg(long, value_name = "LAYOUT.toml", conflicts_with = "experiment")]
    pub(super) layout: Option<PathBuf>,
    /// Experiment whose fingertip the images show: a file or a built-in one [default: cap-closing, if the first image
    /// matches its fingertip]
    #[arg(long)]
    pub(super) experiment: Option<String>,
    /// Use this calibration of the fingertip, written by `feeler calibrate`.
    #[arg(long, value_name = "FILE")]
    pub(super) calibration: Option<PathBuf>,
    /// Correct for a lamp that dims or brightens.
    ///
    /// The quarter of the elements that brightened least is assumed to be untouched, if these elements agree and have
    /// not moved. Their change is applied to all elements. While less than a quarter of the elements is untouched, the
    /// last correction remains in effect.
    #[arg(long, requires = "calibration")]
    pub(super) drift_correction: bool,
    /// Output file: .csv, .jsonl or .mcap [default: a table on standard output]
    ///
    /// Written to FILE.part and renamed when complete. Ctrl-C completes the file if the source is a camera or a stream.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Record each frame's image next to its readings in the MCAP file.
    ///
    /// `feeler sense FILE.mcap` and `feeler calibrate` can then process the images again. A PNG image of 640x480 px
    /// takes 0.1 to 0.2 MB.
    #[arg(long)]
    pub(super) record_frames: bool,
    /// Size of the raw frames on standard input, px.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    raw: Option<(usize, usize)>,
    /// Size of the camera's images, px [default: the size of the fingertip's images]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    size: Option<(usize, usize)>,
    /// Frames per second [default: 30; for a video, the times in the file; for taxels, the time column or the layout's
    /// rate]
    ///
    /// Requested from a camera; assumed for images, raw frames, videos and the rows of taxels.
    #[arg(long, value_name = "HZ", value_parser = parse_rate)]
    rate: Option<f64>,
    #[command(flatten)]
    camera: CameraArguments,
    /// Track the identity of every marker of the layout, even if markers move past their neighbours' positions.
    ///
    /// u is measured from the layout's positions (px). Each marker has a confidence from 0 (lost: the position is
    /// predicted from the neighbours) to 1.
    #[arg(long, value_name = "HOW", num_args = 0..=1, default_missing_value = "video", require_equals = true,
        conflicts_with_all = ["calibration", "reference", "unloaded", "publish"])]
    track: Option<Track>,
    /// Unloaded image from which u is measured.
    #[arg(long, value_name = "PICTURE", conflicts_with = "calibration")]
    reference: Option<PathBuf>,
    /// Number of unloaded frames at the start [default: 1; for taxels, as in the layout]
    ///
    /// u, or the force of each taxel, is measured from their mean.
    #[arg(long, value_name = "FRAMES", conflicts_with_all = ["calibration", "reference"],
        value_parser = clap::value_parser!(u32).range(1..=10_000))]
    unloaded: Option<u32>,
    /// Maximum fraction of saturated pixels in a sub-region; above it, the force is omitted [default: 0.01; for dark
    /// markers 0.9, or 0.98 in images of two grey levels]
    ///
    /// For dark markers, black pixels count instead of saturated ones.
    #[arg(long, value_name = "PART", value_parser = parse_part)]
    max_saturated: Option<f64>,
    /// Finger, from 0: of a recorded run [default: 0], or of the experiment whose fingertip the images show [default:
    /// the fingertip shared by all fingers]
    #[arg(long, value_name = "NUMBER")]
    pub(super) finger: Option<usize>,
    /// Publish the readings of the finger for `feeler hand`.
    ///
    /// Without --calibration, the experiment's calibration is used.
    #[arg(long)]
    pub(super) publish: bool,
    #[command(flatten)]
    taxels: TaxelArguments,
    #[command(flatten)]
    pub(super) values: ExperimentArguments,
    #[command(flatten)]
    pub(super) link: LinkArguments,
}

impl Arguments {
    /// Rejects options that have no effect.
    fn refuse_without_effect(&self) -> Result<(), CommandError> {
        let for_the_hand = self.values.given().or(self.link.given());
        if let Some(option) = for_the_hand.filter(|_| !self.publish) {
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

    /// Frame rate assumed for images, or requested from a camera (Hz).
    fn rate(&self) -> f64 {
        self.rate.unwrap_or(DEFAULT_RATE)
    }

    /// Name or path of the experiment whose fingertip is used.
    pub(super) fn experiment(&self) -> &str {
        self.experiment.as_deref().unwrap_or(EXPERIMENT)
    }

    /// Returns `true` if no option identifies the fingertip.
    fn assumes_fingertip(&self) -> bool {
        self.experiment.is_none() && self.layout.is_none() && self.calibration.is_none()
    }

    /// Finger whose images are recorded, or `None` if images are not recorded.
    pub(super) fn recorded_finger(&self) -> Option<usize> {
        self.record_frames.then(|| self.finger.unwrap_or(0))
    }

    /// Rejects `--record-frames` if the output is not MCAP.
    fn refuse_pictures_elsewhere(&self) -> Result<(), CommandError> {
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

    /// Opens the output for readings of images.
    pub(super) fn open_output(&self, forces: bool) -> Result<Box<dyn Output>, CommandError> {
        let pictures = self.recorded_finger();
        self.open_output_as(&OfPictures { forces, pictures })
    }

    /// Moves `output` to a background thread if images are recorded, so that writing them does not block sensing.
    fn beside_the_sensor(
        &self,
        output: Box<dyn Output>,
        source: &Source,
        tally: &Tally,
    ) -> Result<Box<dyn Output>, CommandError> {
        if !self.record_frames {
            return Ok(output);
        }
        let full = match source {
            Source::Camera(_) => Full::Drop,
            _ => Full::Wait,
        };
        Ok(Box::new(Queued::start(output, full, true, tally.warner())?))
    }

    /// Opens the output for rows or messages of this format.
    fn open_output_as(&self, format: &dyn Format) -> Result<Box<dyn Output>, CommandError> {
        output::open(self.output.as_deref(), self.outputs(), format)
    }

    /// Returns the set of output files, which rejects input files as outputs.
    fn outputs(&self) -> Outputs {
        let recordings: Vec<_> = self.sources.iter().map(|s| s.join(RECORDING)).collect();
        let named = [&self.layout, &self.calibration, &self.reference];
        let sources = self.sources.iter().chain(&recordings).map(PathBuf::as_path);
        let inputs = sources.map(Some).chain(named.map(|path| path.as_deref()));
        let taxels = self.taxels.taxels.as_deref().map(Path::new);
        let experiment = self.experiment.as_deref().map(Path::new);
        Outputs::new(self.overwrite, inputs.chain([experiment, taxels]))
    }
}

pub fn sense(arguments: &Arguments) -> Result<Outcome, CommandError> {
    arguments.refuse_pictures_elsewhere()?;
    let mut tally = Tally::new(!arguments.publish);
    let interrupted = watch_for_interrupt()?;
    match &arguments.taxels.taxels {
        Some(layout) => {
            arguments.refuse_without_effect()?;
            if arguments.record_frames {
                return Err("--record-frames: taxels have no images".into());
            }
            taxels::sense(arguments, layout, &mut tally, &interrupted)?;
        }
        None => sense_source(arguments, &mut tally, &interrupted)?,
    }
    if is_raised(&interrupted) {
        return Ok(Outcome::GivenUp);
    }
    if tally.frames() == 0 {
        return Err(tally.nothing().into());
    }
    Ok(Outcome::Done)
}

/// Senses a source other than a taxel table.
fn sense_source(
    arguments: &Arguments,
    tally: &mut Tally,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    let source = Source::of(arguments)?;
    arguments.refuse_without_effect()?;
    match source {
        Source::Recording(_) if arguments.publish => {
            let message = "--publish: expected images, a camera or rig:, got a recorded run";
            Err(message.into())
        }
        Source::Rig if !arguments.publish => {
            Err("rig: requires --publish, because it is sensed for the hand".into())
        }
        Source::Recording(path) => recorded::sense(arguments, &path, tally, interrupted),
        source if arguments.publish => publish::publish(arguments, &source, tally, interrupted),
        source => match arguments.track {
            Some(track) => track::sense(arguments, track, &source, tally, interrupted),
            None => frames::sense(arguments, &source, tally, interrupted),
        },
    }
}

/// Closes `output` and reports the result, also if sensing `ended` with an error.
///
/// The file remains a partial file unless it is `whole`. A closed pipe (a reader that stops early) is not an error.
pub(super) fn close(
    output: Box<dyn Output>,
    tally: &Tally,
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

/// Returns `true` if the program was interrupted.
pub(super) fn is_raised(flag: &AtomicBool) -> bool {
    flag.load(Ordering::Relaxed)
}

pub(super) fn parse_size(text: &str) -> Result<(usize, usize), String> {
    let side = |side: &str| side.parse().ok().filter(|side| (1..=16_384).contains(side));
    let size = text.split_once('x');
    size.and_then(|(width, height)| Some((side(width)?, side(height)?)))
        .ok_or_else(|| "expected WIDTHxHEIGHT, each from 1 to 16384 px, as in 640x480".into())
}

fn parse_part(text: &str) -> Result<f64, String> {
    parse_between(text, 0.0, 1.0, "of the pixels")
}
