//! Tracks the markers of a fingertip in the images of a video or a camera, and computes forces with a calibration.

use crate::forces::Forces;
use crate::js;
use feeler::control::FlagThresholds;
use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::forces::NO_FORCE;
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{LocateConfig, MeanPicture, locate};
use feeler::sensor::track::{MarkerTracker, TrackError};
use feeler_lab::sensor::SensorGeometry;
use wasm_bindgen::prelude::*;

/// Number of values that `Fingertip::track` returns for each marker.
const NUMBERS: usize = 8;

/// Follows the markers of a fingertip from image to image.
#[wasm_bindgen]
pub struct Fingertip {
    layout: LocatedLayout,
    warnings: Vec<String>,
    tracker: MarkerTracker,
    forces: Option<Forces>,
    /// Forces computed from the latest image, as JSON; empty without a calibration.
    sensed: String,
    /// Pixels of the latest image (gray).
    gray: Vec<u8>,
}

#[wasm_bindgen]
impl Fingertip {
    /// Locates the markers in an image of the untouched fingertip, as `feeler locate` does. `rgba` has four bytes for
    /// each pixel, row by row, as in a canvas.
    ///
    /// # Errors
    /// If the image has another number of bytes, or contains no pattern of markers.
    #[wasm_bindgen(constructor)]
    pub fn new(rgba: &[u8], width: usize, height: usize) -> Result<Fingertip, JsError> {
        let mut gray = Vec::new();
        to_gray(rgba, &mut gray);
        let mut mean = MeanPicture::default();
        let pixels = &gray[..];
        let picture = Picture {
            width,
            height,
            pixels,
        };
        mean.add(&picture).map_err(js)?;
        let reference = mean.finish().map_err(js)?;
        let located = locate(&reference, &LocateConfig::default()).map_err(js)?;
        let warnings = located.warnings.iter().map(ToString::to_string).collect();
        Self::with_layout(LocatedLayout::new(&located), warnings)
    }

    /// Loads the markers from the layout file content `text`, as `feeler locate` writes it.
    ///
    /// # Errors
    /// If the layout is invalid.
    pub fn from_layout(text: &str) -> Result<Fingertip, JsError> {
        let layout = LocatedLayout::from_toml(text).map_err(js)?;
        Self::with_layout(layout, Vec::new())
    }

    fn with_layout(layout: LocatedLayout, warnings: Vec<String>) -> Result<Fingertip, JsError> {
        Ok(Self {
            warnings,
            tracker: MarkerTracker::new(&layout).map_err(js)?,
            forces: None,
            sensed: String::new(),
            layout,
            gray: Vec::new(),
        })
    }

    /// Loads a calibration from the file content `text`; later images yield forces. The next image must show the
    /// untouched fingertip. Returns `true` if the calibration yields the force on each element, and therefore flags.
    ///
    /// # Errors
    /// If the calibration is invalid, or was made for another layout; then there are no forces.
    pub fn calibrate(&mut self, text: &str) -> Result<bool, JsError> {
        self.forces = None;
        self.sensed.clear();
        let geometry = SensorGeometry::of_layout(&self.layout).map_err(js)?;
        let forces = self.forces.insert(Forces::new(geometry, text).map_err(js)?);
        Ok(forces.has_flags())
    }

    /// Sets the thresholds of the flags: compressions `touch_force` and `over_force` (N) and shear rate `slip_threshold`
    /// (N/s).
    pub fn set_thresholds(&mut self, touch_force: f64, over_force: f64, slip_threshold: f64) {
        if let Some(forces) = &mut self.forces {
            forces.set_thresholds(FlagThresholds {
                touch_force,
                over_force,
                slip_threshold,
            });
        }
    }

    /// Tracks the markers into the next image of the same size, taken at `stamp` (s). Returns eight numbers for each
    /// marker: column and row (px), displacement from the untouched fingertip along both (px), confidence (0 to 1),
    /// and the force on it in its frame (N), NaN if unknown.
    ///
    /// # Errors
    /// If the image has another size, or does not fit the calibration.
    pub fn track(&mut self, rgba: &[u8], stamp: f64) -> Result<Vec<f32>, JsError> {
        to_gray(rgba, &mut self.gray);
        let picture = Picture {
            width: self.layout.width,
            height: self.layout.height,
            pixels: &self.gray[..],
        };
        self.tracker.track(&picture).map_err(js)?;
        if self.tracker.is_lost() {
            match self.tracker.match_picture(&picture) {
                Ok(_) => {}
                // No pattern is visible: all markers are lost.
                Err(TrackError::Locate(_)) => self.tracker.lose(),
                Err(error) => return Err(js(error)),
            }
        }
        if let Some(forces) = &mut self.forces {
            let sensed = forces.sense(&picture, stamp).map_err(js)?;
            self.sensed = serde_json::to_string(&sensed).map_err(js)?;
        }
        let mut forces = self.forces.iter().flat_map(Forces::element_forces);
        let mut numbers = Vec::with_capacity(NUMBERS * self.tracker.markers().len());
        for marker in self.tracker.markers() {
            let (place, by) = (marker.place, marker.displacement);
            let force = forces.next().unwrap_or(NO_FORCE);
            let values = [place.x, place.y, by.x, by.y, marker.confidence];
            let values = values.into_iter().chain(force.to_array());
            numbers.extend(values.map(|value| value as f32));
        }
        Ok(numbers)
    }

    /// Forces computed from the latest image, as JSON (`Sensed` in `web/playground/protocol.ts`); empty without a
    /// calibration.
    pub fn sensed(&self) -> String {
        self.sensed.clone()
    }

    /// Number of markers.
    pub fn markers(&self) -> usize {
        self.layout.elements.len()
    }

    /// Width of the images (px).
    pub fn width(&self) -> usize {
        self.layout.width
    }

    /// Height of the images (px).
    pub fn height(&self) -> usize {
        self.layout.height
    }

    /// Text of the layout file, as `feeler locate` writes it.
    ///
    /// # Errors
    /// Never for a located fingertip.
    pub fn layout(&self) -> Result<String, JsError> {
        self.layout.to_toml().map_err(js)
    }

    /// Warnings about the located markers, as sentences.
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}

/// Converts pixels of a canvas to gray levels (ITU-R BT.601).
fn to_gray(rgba: &[u8], gray: &mut Vec<u8>) {
    gray.clear();
    gray.extend(rgba.chunks_exact(4).map(|pixel| {
        let [red, green, blue] = [pixel[0], pixel[1], pixel[2]].map(u32::from);
        ((299 * red + 587 * green + 114 * blue + 500) / 1000) as u8
    }));
}
