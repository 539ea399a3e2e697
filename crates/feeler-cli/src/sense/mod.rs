//! `feeler sense`

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

use super::camera::CameraArguments;
use super::link::{ExperimentArguments, LinkArguments};
use super::{CommandError, Outcome};
use crate::options::Overwrite;
use crate::options::{parse_between, parse_rate};
use feeler_console::Outputs;
use feeler_console::watch_for_interrupt;
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

/// The experiment whose fingertip it is where nobody says otherwise.
const EXPERIMENT: &str = "cap-closing";

/// Frames per second where nobody says otherwise.
const DEFAULT_RATE: f64 = 30.0;

const DETAILS: &str = "\
Pictures are PNG, JPEG, PNM, TIFF, BMP or WebP, of 8 bits or 16 (scaled to 8), turned as their EXIF orientation says; colours become grey. They must have the size of the sensor's. Of a video, frames are rotated as the file says, turned to grey (luma), and stamped with their times from the beginning of the file. Where nothing says whose they are, the first must be such as the fingertip of cap-closing gives.

One row for each element and frame: frame, stamp (s), element, integrated_gray (G, grey levels times m²), u_x and u_y (displacement of the centroid, m), and with --calibration f_x, f_y, f_z (N; frame, sign: the element's, z is compression; x and y are those of the picture where the layout has no dome). A field is empty where there is nothing to say: u in the dark, forces where a sub-region is dark or saturated, G and u of a recorded run.

With --taxels, the source is a table with a row for each sample of a taxel array, or - for rows on standard input as they come. One row for each taxel and frame: frame, stamp (s), element, and f_x, f_y, f_z (N), or f_x_counts, f_y_counts, f_z_counts where the layout does not know how many counts make a newton; sequence before them, with --sequence.

With the calibration of a wrench (feeler calibrate --wrench), one row for each frame instead: frame, stamp, f_x, f_y, f_z (N), m_x, m_y, m_z (N m) in the frame and of the sign in which they were measured, empty where not calibrated; valid: whether the picture is like those of the calibration; and novelty: how far it is from them, as a share of what is still valid. In MCAP, geometry_msgs/WrenchStamped, not a number where not calibrated or not valid.

u counts from where the centroids are without load: as the calibration says; without one, the mean over the first frames (--unloaded), or --reference.";

#[derive(Debug, clap::Args)]
#[command(after_long_help = DETAILS)]
pub struct Arguments {
    /// Folder or files of pictures (in the natural order of names), a video file (.avi, .mp4, .mkv, .mov, .webm, .m4v; needs
    /// ffmpeg), a recorded run, a recording made by `feeler sense --record-frames`, a camera (/dev/video0, genicam:ID as `feeler cameras` lists it, genicam: for the first), rig: for what `feeler
    /// world` or `feeler rig --drives emulated` plays, or - for raw grey frames on standard input.
    #[arg(required = true, value_name = "SOURCE")]
    sources: Vec<PathBuf>,
    /// The sensing elements as `feeler locate` found them, instead of an experiment's; without the
    /// dome's geometry in it, G is in grey levels px² and u in px.
    #[arg(long, value_name = "LAYOUT.toml", conflicts_with = "experiment")]
    pub(super) layout: Option<PathBuf>,
    /// The experiment whose fingertip the pictures are of: a file, or a built-in one.
    /// [default: cap-closing, if the first picture may be of its fingertip]
    #[arg(long)]
    pub(super) experiment: Option<String>,
    /// Calibration of the fingertip, as `feeler calibrate` writes it.
    #[arg(long, value_name = "FILE")]
    pub(super) calibration: Option<PathBuf>,
    /// Correct for a lamp that dims or brightens: the quarter of the elements that have brightened least are
    /// taken as untouched, if they agree and have not moved, and their change is applied to all. While less than
    /// a quarter of the elements is untouched, the last correction is kept.
    #[arg(long, requires = "calibration")]
    pub(super) drift_correction: bool,
    /// Output file: .csv, .jsonl or .mcap [default: a table on standard output]. It is called FILE.part until it is
    /// whole; Ctrl-C completes a camera's or a stream's.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Keep each frame's picture beside its readings in the MCAP file (PNG, 0.1 to 0.2 MB for 640x480 px), so that
    /// `feeler sense FILE.mcap` and `feeler calibrate` can sense it anew.
    #[arg(long)]
    pub(super) record_frames: bool,
    /// Size of the raw frames on standard input, px.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    raw: Option<(usize, usize)>,
    /// Size of the camera's pictures, px [default: that of the fingertip's pictures]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    size: Option<(usize, usize)>,
    /// Frames per second: requested from a camera; assumed for pictures and raw frames [default: 30], for a video [default: the
    /// file's own times], and for the rows of taxels [default: by their column of time, or as their layout says]
    #[arg(long, value_name = "HZ", value_parser = parse_rate)]
    rate: Option<f64>,
    #[command(flatten)]
    camera: CameraArguments,
    /// Follow every marker of the layout by identity, beyond its neighbours' places: through a video, or in single
    /// pictures, each matched against the layout alone. u counts from the layout's places, px, with a confidence from
    /// 0 (lost: the place is foretold by the neighbours) to 1.
    #[arg(long, value_name = "HOW", num_args = 0..=1, default_missing_value = "video", require_equals = true,
        conflicts_with_all = ["calibration", "reference", "unloaded", "publish"])]
    track: Option<Track>,
    /// Picture without load, from which u is measured.
    #[arg(long, value_name = "PICTURE", conflicts_with = "calibration")]
    reference: Option<PathBuf>,
    /// Number of frames without load at the start, from whose mean u is measured [default: 1], or the forces of taxels
    /// [default: as their layout says]
    #[arg(long, value_name = "FRAMES", conflicts_with_all = ["calibration", "reference"],
        value_parser = clap::value_parser!(u32).range(1..=10_000))]
    unloaded: Option<u32>,
    /// Share of a sub-region's pixels that may be saturated (of dark markers: black) before its force is left out
    /// [default: 0.01; of dark markers 0.9, in pictures of two gray levels 0.98]
    #[arg(long, value_name = "PART", value_parser = parse_part)]
    max_saturated: Option<f64>,
    /// Finger of a recorded run, from 0 [default: 0]; of pictures, the finger of the experiment whose
    /// fingertip they are of [default: what fingers have without one of their own]
    #[arg(long, value_name = "NUMBER")]
    pub(super) finger: Option<usize>,
    /// Publish what the finger feels, for `feeler hand`. Without --calibration, by the experiment's own.
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
    /// Refuses what would change nothing.
    fn refuse_without_effect(&self) -> Result<(), CommandError> {
        let for_the_hand = self.values.given().or(self.link.given());
        if let Some(option) = for_the_hand.filter(|_| !self.publish) {
            return Err(format!(
                "{option}: changes nothing without --publish; expected --publish beside it, or an experiment file \
                 that says so"
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
                "{option}: changes nothing with --publish, where the calibration says what is without load"
            )
            .into()),
            None => Ok(()),
        }
    }

    /// Frames per second of pictures.
    fn rate(&self) -> f64 {
        self.rate.unwrap_or(DEFAULT_RATE)
    }

    /// The experiment whose fingertip it is.
    pub(super) fn experiment(&self) -> &str {
        self.experiment.as_deref().unwrap_or(EXPERIMENT)
    }

    /// Whether nobody has said whose elements are looked at.
    fn assumes_fingertip(&self) -> bool {
        self.experiment.is_none() && self.layout.is_none() && self.calibration.is_none()
    }

    /// The finger under whose name pictures are kept, if they are.
    pub(super) fn recorded_finger(&self) -> Option<usize> {
        self.record_frames.then(|| self.finger.unwrap_or(0))
    }

    /// Refuses to keep pictures where there is no place for them.
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
            "--record-frames: only MCAP holds pictures; expected -o FILE.mcap, got {actual}"
        )
        .into())
    }

    /// Opens the output for what pictures say.
    pub(super) fn open_output(&self, forces: bool) -> Result<Box<dyn Output>, CommandError> {
        let pictures = self.recorded_finger();
        self.open_output_as(&OfPictures { forces, pictures })
    }

    /// Lets a thread of its own write `output` where it is pictures, so that they hold up no sensor.
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

    /// Opens the output in this format.
    fn open_output_as(&self, format: &dyn Format) -> Result<Box<dyn Output>, CommandError> {
        output::open(self.output.as_deref(), self.outputs(), format)
    }

    /// What may be written to: none of the files that are read.
    fn outputs(&self) -> Outputs {
        let recordings: Vec<_> = self.sources.iter().map(|s| s.join(RECORDING)).collect();
        let named = [&self.layout, &self.calibration, &self.reference];
        let sources = self.sources.iter().chain(&recordings).map(PathBuf::as_path);
        let inputs = sources.map(Some).chain(named.map(|path| path.as_deref()));
        let taxels = self.taxels.taxels.as_deref().map(Path::new);
        let experiment = self.experiment.as_deref().map(Path::new);
        Outputs::new(self.overwrite.force, inputs.chain([experiment, taxels]))
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
                return Err("--record-frames: taxels have no pictures".into());
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

/// Senses what is not a table.
fn sense_source(
    arguments: &Arguments,
    tally: &mut Tally,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    let source = Source::of(arguments)?;
    arguments.refuse_without_effect()?;
    match source {
        Source::Recording(_) if arguments.publish => {
            let message = "--publish: expected pictures, a camera or rig:, not a recorded run";
            Err(message.into())
        }
        Source::Rig if !arguments.publish => {
            Err("rig: is sensed for the hand; expected --publish beside it".into())
        }
        Source::Recording(path) => recorded::sense(arguments, &path, tally, interrupted),
        source if arguments.publish => publish::publish(arguments, &source, tally, interrupted),
        source => match arguments.track {
            Some(track) => track::sense(arguments, track, &source, tally, interrupted),
            None => frames::sense(arguments, &source, tally, interrupted),
        },
    }
}

/// Closes `output` however sensing `ended`, and says how it went. What is not `whole` stays a partial file.
///
/// A reader that has had enough is no error.
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

/// Whether to stop.
pub(super) fn is_raised(flag: &AtomicBool) -> bool {
    flag.load(Ordering::Relaxed)
}

pub(super) fn parse_size(text: &str) -> Result<(usize, usize), String> {
    let side = |side: &str| side.parse().ok().filter(|side| (1..=16_384).contains(side));
    let size = text.split_once('x');
    size.and_then(|(width, height)| Some((side(width)?, side(height)?)))
        .ok_or_else(|| "expected WIDTHxHEIGHT of 1 to 16384 px each, as in 640x480".into())
}

fn parse_part(text: &str) -> Result<f64, String> {
    parse_between(text, 0.0, 1.0, "of the pixels")
}
