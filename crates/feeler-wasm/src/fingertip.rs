//! Markers of a fingertip in the images of a video or a camera.

use crate::js;
use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{LocateConfig, MeanPicture, locate};
use feeler::sensor::track::{MarkerTracker, TrackError};
use wasm_bindgen::prelude::*;

/// Number of values that `Fingertip::track` returns for each marker.
const NUMBERS: usize = 5;

/// Follows the markers of a fingertip from image to image.
#[wasm_bindgen]
pub struct Fingertip {
    layout: LocatedLayout,
    warnings: Vec<String>,
    tracker: MarkerTracker,
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
        let layout = LocatedLayout::new(&located);
        Ok(Self {
            warnings: located.warnings.iter().map(ToString::to_string).collect(),
            tracker: MarkerTracker::new(&layout).map_err(js)?,
            layout,
            gray,
        })
    }

    /// Tracks the markers into the next image of the same size. Returns five numbers for each marker: column and row
    /// (px), displacement from the untouched fingertip along both (px), and confidence (0 to 1).
    ///
    /// # Errors
    /// If the image has another size.
    pub fn track(&mut self, rgba: &[u8]) -> Result<Vec<f32>, JsError> {
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
        let mut numbers = Vec::with_capacity(NUMBERS * self.tracker.markers().len());
        for marker in self.tracker.markers() {
            let (place, by) = (marker.place, marker.displacement);
            let values = [place.x, place.y, by.x, by.y, marker.confidence];
            numbers.extend(values.map(|value| value as f32));
        }
        Ok(numbers)
    }

    /// Number of markers.
    pub fn markers(&self) -> usize {
        self.layout.elements.len()
    }

    /// Text of the layout file, as `feeler locate` writes it.
    ///
    /// # Errors
    /// Never for a located fingertip.
    pub fn layout(&self) -> Result<String, JsError> {
        self.layout.to_toml().map_err(js)
    }

    /// Possible problems of the located markers, as sentences.
    pub fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }
}

/// Converts pixels of a canvas to gray levels (ITU-R BT.601, as images from files).
fn to_gray(rgba: &[u8], gray: &mut Vec<u8>) {
    gray.clear();
    gray.extend(rgba.chunks_exact(4).map(|pixel| {
        let [red, green, blue] = [pixel[0], pixel[1], pixel[2]].map(u32::from);
        ((299 * red + 587 * green + 114 * blue + 500) / 1000) as u8
    }));
}
