//! The pictures of one camera over an episode, as a video.

use super::data_set::Run;
use super::mp4::Mp4;
use super::stats::Stats;
use crate::error::ExportError;
use feeler::sensor::camera::Camera as _;
use feeler::sensor::frame::Frame;
use feeler_record::Step;
use feeler_record::{RecordedCamera, Tactile};
use rav1e::prelude::{
    ChromaSampling, Config, Context, EncoderConfig, EncoderStatus, PixelRange, Rational,
    SceneDetectionSpeed,
};
use serde_json::{Value, json};
use std::fs::File;
use std::sync::atomic::{AtomicBool, Ordering};

/// How hard the encoder tries: as little as it can.
const SPEED: u8 = 10;
/// From which picture to which decoding can begin: at every so many.
pub(crate) const KEY_INTERVAL: u64 = 10;
/// How coarse a video is, 0 to 255: what is lost is less than the noise of a camera.
const QUANTIZER: usize = 80;
/// Grey has no colour.
const NO_COLOUR: u8 = 128;

/// How an export is watched and ended.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Raised, it ends the export.
    pub interrupted: &'a AtomicBool,
    /// Called after every picture, by any thread.
    pub picture_done: &'a (dyn Fn() + Sync),
}

/// The camera of a finger whose pictures become a video.
pub(crate) struct Camera<'a> {
    /// Name of the run, for messages.
    pub run: &'a str,
    /// The feature that they are.
    pub key: String,
    /// The camera.
    pub camera: RecordedCamera<File>,
    /// Columns and rows, px.
    pub size: (u16, u16),
    /// Frames per second.
    pub rate: u32,
    /// What came of the picture that each frame of the episode saw.
    pub seen: Vec<&'a Tactile>,
}

impl Camera<'_> {
    /// As they stand in `info.json`.
    pub fn description(&self) -> Value {
        let (width, height) = self.size;
        json!({
            "dtype": "video",
            "shape": [height, width, 3],
            "names": ["height", "width", "channels"],
            "info": {
                "video.height": height,
                "video.width": width,
                "video.codec": "av1",
                "video.pix_fmt": "yuv420p",
                "video.fps": self.rate,
                "video.channels": 3,
                "video.g": KEY_INTERVAL,
                "has_audio": false,
                "is_depth_map": false,
            },
        })
    }

    /// Encodes all of them to the end of `video`: their statistics.
    pub fn encode(mut self, video: &mut Mp4, watch: Watch<'_>) -> Result<Stats, ExportError> {
        let mut encoder = self.encoder()?;
        let mut histogram = Histogram::default();
        let (width, height) = self.size;
        let mut frame = Frame::black(width.into(), height.into());
        let seen = std::mem::take(&mut self.seen);
        let mut captured = false;
        for tactile in &seen {
            if watch.interrupted.load(Ordering::Relaxed) {
                return Err(ExportError::Interrupted);
            }
            while !captured || !is_of(&frame, tactile) {
                let picture = self.camera.capture(&mut frame);
                picture.map_err(|source| ExportError::Picture {
                    run: self.run.into(),
                    source,
                })?;
                captured = true;
            }
            histogram.add(&frame.picture.pixels);
            self.send(&mut encoder, &frame)?;
            self.receive(&mut encoder, video)?;
            (watch.picture_done)();
        }
        encoder.flush();
        self.receive(&mut encoder, video)?;
        Ok(histogram.stats())
    }

    fn encoder(&self) -> Result<Context<u8>, ExportError> {
        let mut config = EncoderConfig::with_speed_preset(SPEED);
        (config.width, config.height) = (self.size.0.into(), self.size.1.into());
        config.time_base = Rational::new(1, self.rate.into());
        config.chroma_sampling = ChromaSampling::Cs420;
        config.pixel_range = PixelRange::Full;
        config.quantizer = QUANTIZER;
        config.min_key_frame_interval = 0;
        config.max_key_frame_interval = KEY_INTERVAL;
        config.speed_settings.scene_detection_mode = SceneDetectionSpeed::None;
        // Each picture as it comes: none waits for a later one.
        config.low_latency = true;
        let config = Config::new().with_encoder_config(config).with_threads(1);
        config.new_context().map_err(|error| self.failed(&error))
    }

    fn send(&self, encoder: &mut Context<u8>, frame: &Frame) -> Result<(), ExportError> {
        let mut picture = encoder.new_frame();
        let [grey, colours @ ..] = &mut picture.planes;
        grey.copy_from_raw_u8(&frame.picture.pixels, frame.picture.width, 1);
        for colour in colours {
            colour.data.fill(NO_COLOUR);
        }
        let sent = encoder.send_frame(picture);
        sent.map_err(|error| self.failed(&error))
    }

    /// Writes what is encoded.
    fn receive(&self, encoder: &mut Context<u8>, video: &mut Mp4) -> Result<(), ExportError> {
        loop {
            match encoder.receive_packet() {
                Ok(packet) => video
                    .push(&packet.data)
                    .map_err(|error| self.failed(&error))?,
                Err(EncoderStatus::Encoded) => {}
                Err(EncoderStatus::NeedMoreData | EncoderStatus::LimitReached) => return Ok(()),
                Err(error) => return Err(self.failed(&error)),
            }
        }
    }

    fn failed(&self, error: &dyn std::error::Error) -> ExportError {
        ExportError::Video {
            run: self.run.into(),
            key: self.key.clone(),
            reason: error.to_string(),
        }
    }
}

/// The cameras of a run whose pictures were recorded, at these frames of so many per second.
pub(crate) fn cameras<'a>(
    run: &Run<'a>,
    rate: u32,
    frames: &[Step<'a>],
) -> Result<Vec<Camera<'a>>, ExportError> {
    let fingers = run.recording.fingers.iter().enumerate();
    let seen = fingers.filter(|(_, record)| !record.pictures.is_empty());
    seen.map(|(finger, _)| {
        let key = format!("observation.images.finger_{finger}");
        let mut camera = RecordedCamera::open(run.path, run.recording, finger)?;
        let size = camera
            .picture_size()
            .map_err(|source| ExportError::Picture {
                run: run.name.into(),
                source,
            })?;
        let (width, height) = size.unwrap_or_default();
        let (Ok(columns), Ok(rows)) = (u16::try_from(width), u16::try_from(height)) else {
            let expected = format!("pictures of at most {0}x{0} px", u16::MAX);
            let actual = format!("{width}x{height} px");
            return Err(ExportError::of_run(run.name, key, expected, actual));
        };
        let seen = frames
            .iter()
            .filter_map(|step| step.finger(finger)?.tactile);
        Ok(Camera {
            run: run.name,
            key,
            camera,
            size: (columns, rows),
            rate,
            seen: seen.collect(),
        })
    })
    .collect()
}

/// Whether the tactile frame was made of this picture.
fn is_of(frame: &Frame, tactile: &Tactile) -> bool {
    (frame.sequence, frame.stamp) == (tactile.sequence, tactile.stamp)
}

/// How often pictures have each grey value.
struct Histogram {
    pictures: usize,
    counts: [u64; 256],
}

impl Default for Histogram {
    fn default() -> Self {
        Self {
            pictures: 0,
            counts: [0; 256],
        }
    }
}

impl Histogram {
    fn add(&mut self, pixels: &[u8]) {
        self.pictures += 1;
        for &pixel in pixels {
            self.counts[usize::from(pixel)] += 1;
        }
    }

    /// Statistics of red, green and blue, which are all the same, from 0 to 1.
    fn stats(&self) -> Stats {
        let counts = self.counts.iter().zip(0u32..);
        let values = counts.map(|(&count, value)| (f64::from(value) / 255.0, count));
        let mut stats = Stats::of_counted(self.pictures, vec![values.collect()]);
        stats.repeat_in_shape(&[3, 1, 1]);
        stats
    }
}
