//! Report of a measurement as text and JSON.

use serde::Serialize;
use std::io::{self, Write};

/// Output of `--json`. Unknown values are null.
#[derive(Debug, Serialize)]
pub struct Measured {
    pub camera: String,
    pub width_px: usize,
    pub height_px: usize,
    /// Requested rate (Hz).
    pub requested_rate: f64,
    /// Number of images received.
    pub frames: u64,
    /// Time between the stamps of the first and the last image (s).
    pub seconds: f64,
    /// Rate of received images (Hz).
    pub rate: Option<f64>,
    /// Number of images missing according to the frame numbers.
    pub dropped: u64,
    /// Number of images received damaged.
    pub damaged: u64,
    /// Data rate sent by the camera, before decoding (bytes/s).
    pub bytes_per_second: Option<f64>,
    /// Decoding time per image (s).
    pub decoding: Option<Spread>,
    /// Interval between the stamps of consecutive images (s).
    pub interval: Option<Spread>,
}

/// Statistics of a set of values.
#[derive(Debug, PartialEq, Serialize)]
pub struct Spread {
    pub mean: f64,
    pub min: f64,
    pub max: f64,
    pub standard_deviation: f64,
}

impl Spread {
    /// Computes the statistics, or returns `None` if `values` is empty.
    pub fn of(values: &[f64]) -> Option<Self> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares = values.iter().map(|value| (value - mean).powi(2));
        (count > 0.0).then(|| Self {
            mean,
            min: values.iter().copied().fold(f64::INFINITY, f64::min),
            max: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            standard_deviation: (squares.sum::<f64>() / count).sqrt(),
        })
    }
}

impl Measured {
    pub fn say(&self, out: &mut dyn Write) -> io::Result<()> {
        let unknown = || "unknown".to_string();
        let (width, height) = (self.width_px, self.height_px);
        let requested = self.requested_rate;
        writeln!(out, "{}: {width}x{height} px", self.camera)?;
        let rate = self
            .rate
            .map_or_else(unknown, |rate| format!("{rate:.2} Hz"));
        let (frames, seconds) = (self.frames, self.seconds);
        writeln!(
            out,
            "rate       {rate} ({requested} Hz requested); {frames} frames in {seconds:.2} s"
        )?;
        let (dropped, damaged) = (self.dropped, self.damaged);
        writeln!(out, "lost       {dropped} dropped, {damaged} damaged")?;
        let bandwidth = self.bytes_per_second.map(|bytes| bytes / 1e6);
        let bandwidth = bandwidth.map_or_else(unknown, |bytes| format!("{bytes:.2} MB/s"));
        writeln!(out, "bandwidth  {bandwidth}")?;
        let milliseconds = |spread: &Spread| {
            let [mean, min, max] = [spread.mean, spread.min, spread.max].map(|value| 1e3 * value);
            format!("{mean:.2} ms on average, {min:.2} to {max:.2} ms")
        };
        let decoding = self.decoding.as_ref().map_or_else(unknown, milliseconds);
        writeln!(out, "decoding   {decoding}")?;
        let interval = self.interval.as_ref().map_or_else(unknown, milliseconds);
        let jitter = self.interval.as_ref().map(|interval| {
            let jitter = 1e3 * interval.standard_deviation;
            format!("; jitter {jitter:.2} ms (standard deviation)")
        });
        writeln!(out, "interval   {interval}{}", jitter.unwrap_or_default())
    }
}
