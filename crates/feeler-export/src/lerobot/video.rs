//! Encodes the images of one camera over an episode as a video.

use super::mp4::Mp4;
use super::run::Run;
use super::stats::Stats;
use crate::error::ExportError;
use feeler::sensor::image::{Camera as _, Frame};
use feeler_record::{RecordedCamera, Step, Tactile};
use rav1e::prelude::{
    ChromaSampling, Config, Context, EncoderConfig, EncoderStatus, PixelRange, Rational,
    SceneDetectionSpeed,
};
use serde_json::{Value, json};
use std::fs::File;
use std::sync::atomic::{AtomicBool, Ordering};

/// Speed preset of rav1e; 10 is the fastest.
const SPEED: u8 = 10;
/// Key frame interval (frames).
pub(crate) const KEY_INTERVAL: u64 = 10;
/// Quantizer (0 to 255), chosen so that coding loss stays below camera noise.
const QUANTIZER: usize = 80;
/// Neutral chroma value for gray images.
const NO_COLOUR: u8 = 128;

/// Cancellation flag and progress callback of an export.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Set to `true` to abort the export.
    pub interrupted: &'a AtomicBool,
    /// Called after each encoded frame, from any thread.
    pub picture_done: &'a (dyn Fn() + Sync),
}

/// A finger's camera whose recorded images are encoded as a video.
pub(crate) struct Camera<'a> {
    /// Name of the run, for messages.
    pub run: &'a str,
    /// Feature key of the images.
    pub key: String,
    /// Source of the recorded images.
    pub camera: RecordedCamera<File>,
    /// Width and height (px).
    pub size: (u16, u16),
    /// Frames per second.
    pub rate: u32,
    /// Tactile frame at each video frame; identifies the image it was computed from.
    pub seen: Vec<&'a Tactile>,
}

impl Camera<'_> {
    /// Description of the video feature for `info.json`.
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

    /// Encodes all images, appends them to `video` and returns their statistics.
    pub fn encode(mut self, video: &mut Mp4, watch: Watch<'_>) -> Result<Stats, ExportError> {
        let mut encoder = self.encoder()?;
        let mut histogram = Histogram {
            pictures: 0,
            counts: [0; 256],
        };
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
        // Emit each frame at once; do not reorder.
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

    /// Writes all packets that the encoder has ready.
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

/// Cameras of a run with recorded images, for the given frames and frame rate (1/s).
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
            let expected = format!("images of at most {0}x{0} px", u16::MAX);
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

/// `true` if the tactile frame was computed from this image.
fn is_of(frame: &Frame, tactile: &Tactile) -> bool {
    (frame.sequence, frame.stamp) == (tactile.sequence, tactile.stamp)
}

/// Number of pixels per gray value over all images.
struct Histogram {
    pictures: usize,
    counts: [u64; 256],
}

impl Histogram {
    fn add(&mut self, pixels: &[u8]) {
        self.pictures += 1;
        for &pixel in pixels {
            self.counts[usize::from(pixel)] += 1;
        }
    }

    /// Statistics of the red, green and blue channels, which are equal, scaled to 0 to 1.
    fn stats(&self) -> Stats {
        let counts = self.counts.iter().zip(0u32..);
        let values = counts.map(|(&count, value)| (f64::from(value) / 255.0, count));
        let mut stats = Stats::of_counted(self.pictures, vec![values.collect()]);
        stats.repeat_in_shape(&[3, 1, 1]);
        stats
    }
}
