//! `feeler sense --track`: tracks the identity of markers and writes displacements with their confidence.

use super::frames::WAIT;
use super::output::{Format, FrameReadings, ImageFormat, Output, RowFile};
use super::source::Source;
use super::tally::SensingStats;
use super::{SenseOptions, close};
use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::forces::ElementReading;
use feeler::sensor::image::{CameraError, Picture};
use feeler::sensor::track::{MarkerTracker, TrackError, TrackedMarker};
use feeler_console::{CommandError, is_raised};
use feeler_lab::sensor::read_layout;
use feeler_record::SensedWriter;
use feeler_sources::FramePump;
use serde::Serialize;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// Tracking mode: images are either a video or independent of each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Track {
    /// Images are consecutive in time; markers are tracked from one to the next.
    Video,
    /// Images are independent; each is matched against the layout alone.
    Single,
}

/// Tracks the markers of the layout in the images of `source` until it ends or `interrupted` is set.
pub fn sense(
    options: &SenseOptions,
    track: Track,
    source: &Source,
    tally: &mut SensingStats,
    interrupted: &AtomicBool,
) -> Result<(), CommandError> {
    let Some(path) = &options.layout else {
        return Err("--track: requires --layout LAYOUT.toml, written by `feeler locate`".into());
    };
    let layout = read_layout(path).map_err(|e| format!("--layout {}: {e}", path.display()))?;
    let mut stage = Stage::new(&layout, track)?;
    let size = (layout.width, layout.height);
    let camera = source.camera(options, size)?;
    let pictures = options.recorded_finger();
    let output = options.open_output_as(MarkerFormat(ImageFormat {
        forces: false,
        pictures,
    }))?;
    let mut output = options.beside_the_sensor(output, source, tally)?;
    let pump = FramePump::start(camera, size)?;
    let ended = stage.follow(&pump, output.as_mut(), tally, interrupted);
    stage.say(tally);
    let whole = source.is_stream() || !is_raised(interrupted);
    close(output, tally, ended, whole)
}

struct Stage {
    tracker: MarkerTracker,
    /// State of the tracker before the first image.
    untouched: MarkerTracker,
    track: Track,
    readings: Vec<ElementReading>,
    /// Number of images in which markers were recovered by matching against the reference.
    found_again: u64,
    /// Number of images without a marker pattern, and the sequence number of the first of them.
    without: Option<(u64, u64)>,
}

impl Stage {
    fn new(layout: &LocatedLayout, track: Track) -> Result<Self, CommandError> {
        let tracker = MarkerTracker::new(layout)?;
        Ok(Self {
            untouched: tracker.clone(),
            tracker,
            track,
            readings: vec![ElementReading::default(); layout.elements.len()],
            found_again: 0,
            without: None,
        })
    }

    fn follow(
        &mut self,
        pump: &FramePump,
        output: &mut dyn Output,
        tally: &mut SensingStats,
        interrupted: &AtomicBool,
    ) -> Result<(), CommandError> {
        while !is_raised(interrupted) {
            // Flush as soon as no frame is waiting.
            let mut captured = pump.next(Duration::ZERO);
            if captured.is_none() {
                output.flush()?;
                captured = pump.next(WAIT);
            }
            let Some(captured) = captured else { continue };
            if let Some(warning) = &captured.report.warning {
                tally.warn(warning);
            }
            match captured.frame {
                Ok(frame) => {
                    self.see(&frame.picture, frame.sequence)?;
                    output.write_picture(&frame)?;
                    output.write(&FrameReadings {
                        sequence: frame.sequence,
                        stamp: frame.stamp,
                        readings: &self.readings,
                        markers: self.tracker.markers(),
                    })?;
                    tally.picture(frame.sequence, captured.at, &self.readings);
                    pump.give_back(frame);
                }
                Err(error) if error.is_recoverable() => tally.skip(&error.to_string()),
                Err(CameraError::Ended { .. }) => return Ok(()),
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    /// Locates the markers in the next image.
    fn see(&mut self, picture: &Picture, sequence: u64) -> Result<(), CommandError> {
        match self.track {
            Track::Video => drop(self.tracker.track(picture)?),
            // A tracker remembers earlier images.
            Track::Single => self.tracker.clone_from(&self.untouched),
        }
        if self.track == Track::Single || self.tracker.is_lost() {
            match self.tracker.match_picture(picture) {
                Ok(_) => self.found_again += u64::from(self.track == Track::Video),
                Err(TrackError::Locate(_)) => {
                    // No pattern is visible: all markers are lost.
                    self.tracker.lose();
                    let (count, first) = self.without.unwrap_or((0, sequence));
                    self.without = Some((count + 1, first));
                }
                Err(error) => return Err(error.into()),
            }
        }
        for (reading, marker) in self.readings.iter_mut().zip(self.tracker.markers()) {
            *reading = marker.into();
        }
        Ok(())
    }

    fn say(&self, tally: &SensingStats) {
        if self.found_again > 0 {
            let count = self.found_again;
            tally.warn(&format!(
                "markers were lost or uncertain in {count} frames and were matched against the layout again"
            ));
        }
        if let Some((count, first)) = self.without {
            tally.warn(&format!(
                "{count} frames show no pattern of markers, the first is frame {first}"
            ));
        }
    }
}

/// Output format for tracked markers. Messages have the same form as without tracking; a lost marker has no
/// displacement.
struct MarkerFormat(ImageFormat);

/// Columns of one marker in one frame.
#[derive(Serialize)]
struct Row {
    frame: u64,
    stamp: f64,
    element: usize,
    integrated_gray: f64,
    u_x: f64,
    u_y: f64,
    confidence: f64,
}

fn rows<'a>(frame: &'a FrameReadings) -> impl Iterator<Item = Row> + 'a {
    let row = |(element, marker): (usize, &TrackedMarker)| Row {
        frame: frame.sequence,
        stamp: frame.stamp,
        element,
        integrated_gray: marker.integrated_gray,
        u_x: marker.displacement.x,
        u_y: marker.displacement.y,
        confidence: marker.confidence,
    };
    frame.markers.iter().enumerate().map(row)
}

impl Format for MarkerFormat {
    fn columns(&self) -> Vec<&'static str> {
        [self.0.columns(), vec!["confidence"]].concat()
    }

    fn write_rows(
        &mut self,
        frame: &FrameReadings,
        file: &mut RowFile,
    ) -> Result<(), CommandError> {
        rows(frame).try_for_each(|row| file.write(&row))
    }

    fn create_mcap(&self, path: &Path) -> Result<SensedWriter, CommandError> {
        self.0.create_mcap(path)
    }

    fn recorded_finger(&self) -> Option<usize> {
        self.0.recorded_finger()
    }

    fn write_messages(
        &mut self,
        frame: &FrameReadings,
        writer: &mut SensedWriter,
    ) -> Result<(), CommandError> {
        self.0.write_messages(frame, writer)
    }
}
