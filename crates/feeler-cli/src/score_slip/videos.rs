//! Videos of a marker gel, decoded by ffmpeg.
//!
//! Markers are located in single frames and not followed from one to the next: what is lost for a moment, or jumps, does no
//! harm. So there are places, of which [`ContactLoss`](feeler::control::grasp_slip::ContactLoss) can say whether they are
//! a pattern, and no displacements.

use super::CommandError;
use super::collected::Read;
use super::notes::Notes;
use super::recorded::RecordedArguments;
use super::sources::Source;
use feeler::sensor::frame::Picture as Grey;
use feeler::sensor::locate::{LocateConfig, Located, ReferencePicture, locate, locate_again};
use feeler_lab::grasps::{GraspFrame, GraspRecording, Picture, Untouched};
use glam::DVec2;
use std::ffi::OsString;
use std::io::{BufRead, BufReader, Read as _};
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};

/// The variable that names ffmpeg.
const FFMPEG: &str = "FEELER_FFMPEG";
/// How often markers are located, Hz: several times within the half second that a loss takes to be told.
const LOOKS: f64 = 10.0;
/// Largest side of a picture, px, and longest line that ffmpeg writes before one, bytes.
const LARGEST: usize = 16_384;
const LONGEST: u64 = 1024;

/// Reads videos.
pub struct Videos {
    rate: Option<f64>,
}

impl Videos {
    /// As the arguments say.
    ///
    /// # Errors
    /// When there is no ffmpeg.
    pub fn new(arguments: &RecordedArguments) -> Result<Self, CommandError> {
        let program = program();
        let mut version = Command::new(&program);
        version
            .arg("-version")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        version.status().map_err(|error| {
            let program = program.display();
            format!(
                "{program}: {error}; expected ffmpeg, which reads videos: apt-get install ffmpeg, or pip install imageio-ffmpeg \
                 and {FFMPEG}=$(python3 -c 'import imageio_ffmpeg as f; print(f.get_ffmpeg_exe())'); or tables of `feeler sense`"
            )
        })?;
        Ok(Self {
            rate: arguments.rate,
        })
    }

    /// The recording in the video of `source`.
    ///
    /// # Errors
    /// When it cannot be decoded, or markers were located in none of its frames.
    pub fn read(&self, source: &Source, notes: &mut Notes) -> Result<Vec<Read>, CommandError> {
        let Some(path) = source.tables.first() else {
            return Ok(Vec::new());
        };
        let refused = |what: &dyn std::fmt::Display| -> CommandError {
            format!(
                "{}: {what}; expected a video that ffmpeg decodes",
                path.display()
            )
            .into()
        };
        let mut video = Video::open(path).map_err(|e| refused(&e))?;
        let rate = self.rate.unwrap_or(video.rate);
        let every = (rate / LOOKS).floor().max(1.0) as u64;
        let mut picture = Grey::black(video.width, video.height);
        let mut locator = Locator::default();
        let (mut frames, mut number, mut failed) = (Vec::new(), 0_u64, None);
        while video.next(&mut picture).map_err(|e| refused(&e))? {
            if number % every == 0 {
                let places = locator.places(&picture);
                let found = places.unwrap_or_else(|error| {
                    failed.get_or_insert(error);
                    Vec::new()
                });
                frames.push(GraspFrame {
                    stamp: number as f64 / rate,
                    shear: found,
                    normal: Vec::new(),
                });
            }
            number += 1;
        }
        if let Some(said) = video.close() {
            if frames.is_empty() {
                return Err(refused(&said));
            }
            notes.add("ffmpeg", || {
                format!("{}: {said}; what was decoded counts", path.display())
            });
        }
        let empty = frames.iter().filter(|frame| frame.shear.is_empty()).count();
        if let Some(error) = failed {
            let (name, all) = (&source.name, frames.len());
            notes.add("markers", || format!("{name}: in {empty} of {all} frames no markers were located, the first because of: {error}"));
        }
        if empty == frames.len() {
            return Err(refused(&"no markers located in any frame"));
        }
        Ok(vec![Read {
            names: vec![source.stem().to_owned(), source.name.clone()],
            recording: GraspRecording {
                untouched: Untouched::Afresh(Picture::of_size(video.width, video.height)),
                origins: Vec::new(),
                frames,
            },
        }])
    }
}

/// Locates the markers in one picture of a video after the other.
#[derive(Default)]
struct Locator {
    /// What was found in the first picture that shows markers; all others are searched for the same.
    first: Option<Located>,
}

impl Locator {
    /// Where the markers are in a picture, px.
    fn places(&mut self, picture: &Grey) -> Result<Vec<DVec2>, CommandError> {
        let picture = ReferencePicture::mean([picture])?;
        let config = LocateConfig::default();
        let located = match &self.first {
            Some(first) => locate_again(&picture, &config, first)?,
            None => locate(&picture, &config)?,
        };
        let places = located.elements.iter().map(|element| element.centre_px);
        let places = places.collect();
        self.first.get_or_insert(located);
        Ok(places)
    }
}

fn program() -> OsString {
    std::env::var_os(FFMPEG).unwrap_or_else(|| "ffmpeg".into())
}

/// A video as ffmpeg decodes it: YUV4MPEG2, which tells size and rate, of grey frames.
struct Video {
    child: Child,
    stream: BufReader<ChildStdout>,
    width: usize,
    height: usize,
    rate: f64,
    torn: bool,
}

impl Video {
    fn open(path: &Path) -> Result<Self, CommandError> {
        let mut command = Command::new(program());
        command.args(["-nostdin", "-v", "fatal", "-i"]).arg(path);
        command.args([
            "-an",
            "-f",
            "yuv4mpegpipe",
            "-strict",
            "-1",
            "-pix_fmt",
            "gray",
            "-",
        ]);
        command
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut child = command.spawn()?;
        let stream = child.stdout.take().ok_or("ffmpeg writes nothing")?;
        let mut video = Self {
            child,
            stream: BufReader::new(stream),
            width: 0,
            height: 0,
            rate: 0.0,
            torn: false,
        };
        let header = video.line()?;
        let rest = header
            .strip_prefix("YUV4MPEG2 ")
            .ok_or("ffmpeg decodes nothing of it")?;
        for field in rest.split_ascii_whitespace() {
            let (kind, value) = field.split_at_checked(1).unwrap_or(("", ""));
            match kind {
                "W" => video.width = value.parse()?,
                "H" => video.height = value.parse()?,
                "F" => {
                    let (frames, seconds) = value.split_once(':').ok_or("a rate that is none")?;
                    video.rate = frames.parse::<f64>()? / seconds.parse::<f64>()?;
                }
                _ => {}
            }
        }
        let sizes = 1..=LARGEST;
        if !sizes.contains(&video.width) || !sizes.contains(&video.height) {
            return Err(format!("pictures of {} x {} px", video.width, video.height).into());
        }
        if !(1e-3..=1e5).contains(&video.rate) {
            return Err(format!("{} frames per second", video.rate).into());
        }
        Ok(video)
    }

    /// The next line of the stream, without its end; empty at the end of the stream.
    fn line(&mut self) -> Result<String, CommandError> {
        let mut line = Vec::new();
        (&mut self.stream)
            .take(LONGEST)
            .read_until(b'\n', &mut line)?;
        Ok(String::from_utf8_lossy(&line).trim_end().to_owned())
    }

    /// Fills `picture` with the next frame; whether there is one.
    fn next(&mut self, picture: &mut Grey) -> Result<bool, CommandError> {
        let line = self.line()?;
        if line.is_empty() {
            return Ok(false);
        }
        if !line.starts_with("FRAME") {
            return Err("what ffmpeg writes is no frame".into());
        }
        // The last may have been cut off.
        self.torn = self.stream.read_exact(&mut picture.pixels).is_err();
        Ok(!self.torn)
    }

    /// Waits for ffmpeg to end; what went wrong, if anything did.
    fn close(&mut self) -> Option<String> {
        let ended = self.child.wait();
        match ended {
            Ok(status) if status.success() && !self.torn => None,
            Ok(status) => Some(format!("ffmpeg ended with {status}")),
            Err(error) => Some(error.to_string()),
        }
    }
}

impl Drop for Video {
    fn drop(&mut self) {
        // It may have ended long ago.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
