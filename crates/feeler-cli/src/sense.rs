//! `feeler sense`

use super::camera::{CameraArguments, parse_size};
use super::link::{ExperimentArguments, LinkArguments};
use super::{CommandError, Outcome};
use crate::options::{Overwrite, parse_between, parse_rate};
use feeler_sensing::{SenseOptions, TaxelOptions, Track};
use std::path::PathBuf;

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
    layout: Option<PathBuf>,
    /// The experiment whose fingertip the pictures are of: a file, or a built-in one.
    /// [default: cap-closing, if the first picture may be of its fingertip]
    #[arg(long)]
    experiment: Option<String>,
    /// Calibration of the fingertip, as `feeler calibrate` writes it.
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// Correct for a lamp that dims or brightens: the quarter of the elements that have brightened least are
    /// taken as untouched, if they agree and have not moved, and their change is applied to all. While less than
    /// a quarter of the elements is untouched, the last correction is kept.
    #[arg(long, requires = "calibration")]
    drift_correction: bool,
    /// Output file: .csv, .jsonl or .mcap [default: a table on standard output]. It is called FILE.part until it is
    /// whole; Ctrl-C completes a camera's or a stream's.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Keep each frame's picture beside its readings in the MCAP file (PNG, 0.1 to 0.2 MB for 640x480 px), so that
    /// `feeler sense FILE.mcap` and `feeler calibrate` can sense it anew.
    #[arg(long)]
    record_frames: bool,
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
    track: Option<Tracking>,
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
    finger: Option<usize>,
    /// Publish what the finger feels, for `feeler hand`. Without --calibration, by the experiment's own.
    #[arg(long)]
    publish: bool,
    #[command(flatten)]
    taxels: TaxelArguments,
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    link: LinkArguments,
}

/// What is said of a taxel array.
#[derive(Debug, clap::Args)]
struct TaxelArguments {
    /// The source is the table of a three-axis taxel array, of this layout: a file, or a built-in one (`feeler list`).
    #[arg(long, value_name = "LAYOUT", conflicts_with_all = [
        "layout", "calibration", "drift_correction", "reference", "raw", "size", "exposure"])]
    taxels: Option<String>,
    /// What the columns of the array begin with, where a table has several arrays, as in left.
    #[arg(long, value_name = "PREFIX", requires = "taxels")]
    prefix: Option<String>,
    /// Column whose value changes where another sequence begins, without load again.
    #[arg(long, value_name = "COLUMN", requires = "taxels")]
    sequence: Option<String>,
}

/// How consecutive images are related.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
enum Tracking {
    /// Images follow each other in time.
    Video,
    /// Each image is independent.
    Single,
}

/// Senses the sources.
pub fn sense(arguments: &Arguments) -> Result<Outcome, CommandError> {
    feeler_sensing::sense(&arguments.options())
}

impl Arguments {
    fn options(&self) -> SenseOptions {
        SenseOptions {
            sources: self.sources.clone(),
            layout: self.layout.clone(),
            experiment: self.experiment.clone(),
            calibration: self.calibration.clone(),
            drift_correction: self.drift_correction,
            output: self.output.clone(),
            force: self.overwrite.force,
            record_frames: self.record_frames,
            raw: self.raw,
            size: self.size,
            rate: self.rate,
            camera: (&self.camera).into(),
            track: self.track.map(|track| match track {
                Tracking::Video => Track::Video,
                Tracking::Single => Track::Single,
            }),
            reference: self.reference.clone(),
            unloaded: self.unloaded,
            max_saturated: self.max_saturated,
            finger: self.finger,
            publish: self.publish,
            taxels: TaxelOptions {
                taxels: self.taxels.taxels.clone(),
                prefix: self.taxels.prefix.clone(),
                sequence: self.taxels.sequence.clone(),
            },
            settings: self.values.settings(),
            rig: self.values.rig.clone(),
            link: (&self.link).into(),
            publishing_option: self.values.given().or(self.link.given()),
        }
    }
}

fn parse_part(text: &str) -> Result<f64, String> {
    parse_between(text, 0.0, 1.0, "of the pixels")
}
