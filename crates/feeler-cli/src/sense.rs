//! `feeler sense`: moments, forces or wrenches from images, cameras, recordings and taxel tables.

use super::camera::{CameraArguments, parse_size};
use super::link::{ExperimentArguments, LinkArguments};
use super::{CommandError, Outcome};
use crate::options::{Overwrite, parse_between, parse_positive, parse_rate};
use feeler_sensing::{ContactOptions, SenseOptions, TaxelOptions, Track};
use std::path::PathBuf;

const DETAILS: &str = "\
Images are PNG, JPEG, PNM, TIFF, BMP or WebP with 8 or 16 bits (scaled to 8). They are rotated by their EXIF orientation, converted to grey, and must have the size of the sensor's images. Video frames are rotated as the file states, converted to grey (luma), and stamped with their time from the start of the file. Without --layout, --experiment and --calibration, the first image must look like one of the cap-closing fingertip.

Output is one row per element and frame: frame, stamp (s), element, integrated_gray (G, grey levels times m²), u_x and u_y (displacement of the centroid, m), and with --calibration f_x, f_y, f_z (N). Forces are in the element's frame with the element's sign: z is compression; x and y are the image axes if the layout has no dome. A field is empty if it has no value: u of dark elements, forces of dark or saturated sub-regions, G and u of a recorded run.

With --taxels, the source is a table with one row per sample of a taxel array, - for rows on standard input, or serial:PORT for a skin on a serial port (see `feeler skins`), whose zero is measured again when you press Enter. Without --calibration, output is one row per taxel and frame: frame, stamp (s), element, and f_x, f_y, f_z (N), or f_x_counts, f_y_counts, f_z_counts if the layout does not define counts per newton. With --sequence, a column sequence comes first.

With a wrench calibration (feeler calibrate --wrench), output is one row per frame: frame, stamp, f_x, f_y, f_z (N), m_x, m_y, m_z (N m), p_x, p_y (place of contact, m) in the frame and with the sign of the calibration's measurements, empty if not calibrated; valid: whether the image or row is similar to those of the calibration; and novelty: its distance from them, divided by the largest valid distance. MCAP files contain geometry_msgs/WrenchStamped without places, with NaN for components that are not calibrated or not valid.

With --contact, output is one row per frame: frame, stamp, invalid (elements without a force), touching (elements), and in the fingertip's frame T the centre of pressure c_x, c_y, c_z with its standard error along each tangent c_error (m), the fingertip's outward normal n_x, n_y, n_z, the force on the fingertip by the object f_x, f_y, f_z with f_error (N), torsion about the normal with torsion_error (N m), area with area_error (m²), long_axis and short_axis of the contact ellipse with errors (semi-axes, m), direction of the long axis long_x, long_y, long_z, coefficient of friction, and sliding: the fraction of the elements pressed with three times TOUCH or more that slide. Columns of forces in counts end in _counts or _counts_m. MCAP files contain the forces and messages of type Contact.

u is measured from the unloaded centroids of the calibration. Without a calibration, it is measured from their mean over the first frames (--unloaded), or from --reference.";

#[derive(Debug, clap::Args)]
#[command(after_long_help = DETAILS)]
pub struct Arguments {
    /// Source of images or readings.
    ///
    /// A folder or files of images (in natural order of their names), a video file (.avi, .mp4, .mkv, .mov, .webm,
    /// .m4v; requires ffmpeg), a recorded run, a recording made by `feeler sense --record-frames`, a camera
    /// (/dev/video0, genicam:ID as listed by `feeler cameras`, or genicam: for the first one), serial:PORT for a skin, rig: for the images of
    /// `feeler world` or `feeler rig --drives emulated`, or - for raw grey frames on standard input.
    #[arg(required = true, value_name = "SOURCE")]
    sources: Vec<PathBuf>,
    /// Use the sensing elements found by `feeler locate` instead of an experiment's.
    ///
    /// If the layout lacks the dome's geometry, G is in grey levels px² and u in px.
    #[arg(long, value_name = "LAYOUT.toml", conflicts_with = "experiment")]
    layout: Option<PathBuf>,
    /// Experiment whose fingertip the images show: a file or a built-in one [default: cap-closing, if the first image
    /// matches its fingertip]
    #[arg(long)]
    experiment: Option<String>,
    /// Use this calibration of the fingertip, written by `feeler calibrate`.
    #[arg(long, value_name = "FILE")]
    calibration: Option<PathBuf>,
    /// Write the contact of the fingertip with the object instead of the forces.
    ///
    /// TOUCH is the compression (N, or counts) above which an element touches [default: 0.1 N]; a third of it is assumed
    /// to be the standard error of a force. Requires forces: a calibration of elements, a recorded run, or taxels.
    #[arg(long, value_name = "TOUCH", num_args = 0..=1, require_equals = true, value_parser = parse_positive,
        conflicts_with_all = ["track", "publish", "record_frames"])]
    contact: Option<Option<f64>>,
    /// Coefficient of friction between fingertip and object [default: estimated while the contact begins to slide]
    #[arg(long, value_name = "NUMBER", requires = "contact", value_parser = parse_positive)]
    friction: Option<f64>,
    /// Require a wrench calibration that `feeler verify` found valid within this number of days.
    #[arg(long, value_name = "DAYS", requires = "calibration")]
    verified_within: Option<u32>,
    /// Correct for a lamp that dims or brightens.
    ///
    /// The quarter of the elements that brightened least is assumed to be untouched, if these elements agree and have
    /// not moved. Their change is applied to all elements. While less than a quarter of the elements is untouched, the
    /// last correction remains in effect.
    #[arg(long, requires = "calibration")]
    drift_correction: bool,
    /// Output file: .csv, .jsonl or .mcap [default: a table on standard output]
    ///
    /// Written to FILE.part and renamed when complete. Ctrl-C completes the file if the source is a camera or a stream.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    overwrite: Overwrite,
    /// Record each frame's image next to its readings in the MCAP file.
    ///
    /// `feeler sense FILE.mcap` and `feeler calibrate` can then process the images again. A PNG image of 640x480 px
    /// takes 0.1 to 0.2 MB.
    #[arg(long)]
    record_frames: bool,
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
    track: Option<Tracking>,
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
    /// Index of the finger, from 0: in a recorded run [default: 0], or in the experiment [default: the fingertip shared
    /// by all fingers]
    #[arg(long, value_name = "NUMBER")]
    finger: Option<usize>,
    /// Publish the readings of the finger for `feeler hand`.
    ///
    /// Without --calibration, the experiment's calibration is used.
    #[arg(long)]
    publish: bool,
    #[command(flatten)]
    taxels: TaxelArguments,
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    link: LinkArguments,
}

/// Options for taxel arrays.
#[derive(Debug, clap::Args)]
struct TaxelArguments {
    /// Read a table or skin of three-axis taxels with this layout: a file or a built-in one (see `feeler list`).
    #[arg(long, value_name = "LAYOUT", conflicts_with_all = [
        "layout", "drift_correction", "reference", "raw", "size", "exposure"])]
    taxels: Option<String>,
    /// Prefix of the array's columns if the table has several arrays, as in left.
    #[arg(long, value_name = "PREFIX", requires = "taxels")]
    prefix: Option<String>,
    /// Column whose value changes where a new sequence begins, which starts without load.
    #[arg(long, value_name = "COLUMN", requires = "taxels")]
    sequence: Option<String>,
}

/// Relation of consecutive images.
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
            contact: self.contact.map(|touch| ContactOptions {
                touch,
                friction: self.friction,
            }),
            verified_within: self.verified_within,
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
            settings: self.values.changes.settings(),
            rig: self.values.rig.clone(),
            link: (&self.link).into(),
            publishing_option: self.values.given().or(self.link.given()),
        }
    }
}

fn parse_part(text: &str) -> Result<f64, String> {
    parse_between(text, 0.0, 1.0, "of the pixels")
}
