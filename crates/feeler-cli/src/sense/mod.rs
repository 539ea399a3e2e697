//! `feeler sense`

mod beside;
mod frames;
pub(super) mod output;
mod prompt;
mod publish;
mod queued;
mod recorded;
pub(super) mod sensor;
pub(super) mod source;
pub(super) mod tally;
mod whole_rows;

use super::interrupt::watch_for_interrupt;
use super::link::{ExperimentArguments, LinkArguments};
use super::part_file::{Outputs, Overwrite};
use super::{CommandError, Outcome};
use feeler::sensor::exposure::DEFAULT_MAX_SATURATED;
use feeler_report::make::RECORDING;
use output::Output;
use source::Source;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use tally::Tally;

const DETAILS: &str = "\
Pictures are PNG, JPEG, PNM or TIFF, of 8 bits or 16 (scaled to 8); colours become grey. They must have the size of the sensor's.

One row for each element and frame: frame, stamp (s), element, integrated_gray (G, grey levels times m²), u_x and u_y (displacement of the centroid, m), and with --calibration f_x, f_y, f_z (N; frame, sign: the element's, z is compression). A field is empty where there is nothing to say: u in the dark, forces where a sub-region is dark or saturated, G and u of a recorded run.

u counts from where the centroids are without load: as the calibration says; without one, the mean over the first frames (--unloaded), or --reference.";

#[derive(Debug, clap::Args)]
#[command(after_long_help = DETAILS)]
pub struct Arguments {
    /// Folder or files of pictures (in the natural order of names), a recorded run, a camera
    /// (/dev/video0), rig: for what `feeler world` plays, or - for raw grey frames on standard input.
    #[arg(required = true, value_name = "SOURCE")]
    sources: Vec<PathBuf>,
    /// The sensing elements as `feeler locate` found them, instead of an experiment's; without the
    /// dome's geometry in it, G is in grey levels px² and u in px.
    #[arg(long, value_name = "LAYOUT.toml", conflicts_with = "experiment")]
    pub(super) layout: Option<PathBuf>,
    /// The experiment whose fingertip the pictures are of: a file, or a built-in one.
    #[arg(long, default_value = "cap-closing")]
    pub(super) experiment: String,
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
    /// Size of the raw frames on standard input, px.
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    raw: Option<(usize, usize)>,
    /// Size of the camera's pictures, px [default: that of the fingertip's pictures]
    #[arg(long, value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    size: Option<(usize, usize)>,
    /// Frames per second: requested from a camera; assumed for pictures and raw frames.
    #[arg(long, value_name = "HZ", default_value = "30", value_parser = parse_rate)]
    rate: f64,
    /// Exposure time of the camera, s [default: as the camera is set]
    #[arg(long, value_name = "SECONDS", value_parser = parse_exposure)]
    exposure: Option<f64>,
    /// Picture without load, from which u is measured.
    #[arg(long, value_name = "PICTURE", conflicts_with = "calibration")]
    reference: Option<PathBuf>,
    /// Number of frames without load at the start, from whose mean u is measured [default: 1]
    #[arg(long, value_name = "FRAMES", conflicts_with_all = ["calibration", "reference"],
        value_parser = clap::value_parser!(u32).range(1..=10_000))]
    unloaded: Option<u32>,
    /// Share of a sub-region's pixels that may be saturated before its force is left out.
    #[arg(long, value_name = "PART", default_value_t = DEFAULT_MAX_SATURATED, value_parser = parse_part)]
    max_saturated: f64,
    /// Finger of a recorded run, from 0 [default: 0]; of pictures, the finger of the experiment whose
    /// fingertip they are of [default: what fingers have without one of their own]
    #[arg(long, value_name = "NUMBER")]
    pub(super) finger: Option<usize>,
    /// Publish what the finger feels, for `feeler hand`. Without --calibration, by the experiment's own.
    #[arg(long)]
    pub(super) publish: bool,
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

    /// Opens the output, which is none of the files that are read.
    pub(super) fn open_output(&self, forces: bool) -> Result<Box<dyn Output>, CommandError> {
        let recordings: Vec<_> = self.sources.iter().map(|s| s.join(RECORDING)).collect();
        let named = [&self.layout, &self.calibration, &self.reference];
        let sources = self.sources.iter().chain(&recordings).map(PathBuf::as_path);
        let inputs = sources.map(Some).chain(named.map(|path| path.as_deref()));
        let experiment = Some(Path::new(&self.experiment));
        let outputs = Outputs::new(self.overwrite, inputs.chain([experiment]));
        output::open(self.output.as_deref(), outputs, forces)
    }
}

pub fn sense(arguments: &Arguments) -> Result<Outcome, CommandError> {
    let source = Source::of(arguments)?;
    arguments.refuse_without_effect()?;
    let interrupted = watch_for_interrupt()?;
    let mut tally = Tally::new(!arguments.publish);
    match source {
        Source::Recording(_) if arguments.publish => {
            let message = "--publish: expected pictures, a camera or rig:, not a recorded run";
            return Err(message.into());
        }
        Source::Rig if !arguments.publish => {
            return Err("rig: is sensed for the hand; expected --publish beside it".into());
        }
        Source::Recording(path) => {
            recorded::sense(arguments, &path, &mut tally, &interrupted)?;
        }
        source if arguments.publish => {
            publish::publish(arguments, &source, &mut tally, &interrupted)?;
        }
        source => frames::sense(arguments, &source, &mut tally, &interrupted)?,
    }
    if interrupted.load(Ordering::Relaxed) {
        return Ok(Outcome::GivenUp);
    }
    if tally.frames() == 0 {
        let skipped = tally.skipped();
        return Err(format!(
            "there was no frame to sense ({skipped} skipped); expected at least 1"
        )
        .into());
    }
    Ok(Outcome::Done)
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

fn parse_size(text: &str) -> Result<(usize, usize), String> {
    let side = |side: &str| side.parse().ok().filter(|side| (1..=16_384).contains(side));
    let size = text.split_once('x');
    size.and_then(|(width, height)| Some((side(width)?, side(height)?)))
        .ok_or_else(|| "expected WIDTHxHEIGHT of 1 to 16384 px each, as in 640x480".into())
}

fn parse_rate(text: &str) -> Result<f64, String> {
    parse_between(text, 1e-3, 1e5, "Hz")
}

fn parse_exposure(text: &str) -> Result<f64, String> {
    parse_between(text, 1e-6, 1e3, "s")
}

fn parse_part(text: &str) -> Result<f64, String> {
    parse_between(text, 0.0, 1.0, "of the pixels")
}

fn parse_between(text: &str, low: f64, high: f64, unit: &str) -> Result<f64, String> {
    let number = text.parse().ok();
    number
        .filter(|number| (low..=high).contains(number))
        .ok_or_else(|| format!("expected {low} to {high} {unit}"))
}
