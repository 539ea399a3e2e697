//! Tracks markers individually under large displacements.
//!
//! A marker is searched for at the position predicted from its own motion and that of its neighbours, and measured from
//! the pixels there (`window`). It counts as found if there is contrast and if its displacement agrees with the smooth
//! displacement field of its neighbours (`field`). If two markers are swapped, they deviate by a marker spacing, which
//! is detected. A marker that is not found is assigned the position predicted by the field, and is searched for there
//! in the next images. If many markers are lost at once, the pattern may have jumped by a spacing, and all markers
//! become doubtful.
//!
//! A single image without a predecessor is matched with the reference alone: matching starts in regions that hardly
//! moved and extends to regions that moved far (`growing`).

mod error;
mod field;
mod growing;
mod matching;
mod measuring;
mod mending;
mod window;

pub use error::TrackError;

use self::{
    field::Field,
    growing::Matched,
    window::{Look, Seen, Window},
};
use super::locate::{LocateConfig, MeanPicture, blobs_of_size, locate};
use crate::sensor::fingertip::located_layout::LocatedLayout;
use crate::sensor::image::frame::Picture;
use crate::sensor::image::polarity::Polarity;
use glam::DVec2;

/// Deviation from the displacement field, in units of the marker spacing, above which a measurement is of another
/// marker.
const MAX_OFF: f64 = 0.45;
/// Maximum fraction of the markers at the pattern's edge that are lost in one image. Above it, all markers are
/// doubtful, because the pattern may have jumped by a spacing, which leaves one side of its edge without spots.
const JUMPED: f64 = 0.2;
/// Maximum fraction of markers mistaken for others in one image; above it, all markers are doubtful.
const MISTAKEN: f64 = 0.02;
/// Factor that reduces the confidence in a doubtful marker.
const DOUBT: f64 = 0.3;
/// Minimum quality at which the result of the fast matching is accepted; below it, the full search runs.
const QUICKLY_MATCHED: f64 = 0.95;
/// Quality of a matching below which all markers are doubtful.
const MIN_MATCHED: f64 = 0.85;
/// Smoothing factor per image with which a marker's typical contrast falls.
const FADES: f64 = 0.02;
/// Minimum fraction of markers found; if there are fewer, the image may not be of the sensor.
const MIN_FOUND: f64 = 0.3;

/// State of one tracked marker.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TrackedMarker {
    /// Column and row of the marker, px.
    pub place: DVec2,
    /// Displacement from the reference, px.
    pub displacement: DVec2,
    /// Confidence from 0 (lost: the position is a prediction) to 1 (as in the reference).
    pub confidence: f64,
    /// Integrated contrast of the marker's pixels, gray levels px²; of a lost marker, the last measured value.
    pub integrated_gray: f64,
}

/// Tracks the markers of a layout.
#[derive(Debug, Clone)]
pub struct MarkerTracker {
    size: (usize, usize),
    polarity: Polarity,
    /// Diameter of a spot, px, if the layout contains it.
    spot_diameter: Option<f64>,
    /// Positions of the markers in the reference, px.
    reference: Vec<DVec2>,
    field: Field,
    window: Window,
    markers: Vec<TrackedMarker>,
    /// Displacement of each marker since the previous frame, smoothed over neighbours, px.
    velocities: Vec<DVec2>,
    /// Predicted or measured displacements in the latest image, px.
    work: Vec<DVec2>,
    found: Vec<bool>,
    /// `true` for each marker that was found in the previous image.
    before: Vec<bool>,
    /// `true` if all markers may have been mistaken for their neighbours in some frame.
    doubtful: bool,
    /// Typical contrast of each marker when clearly visible, gray levels; 0 until first measured.
    contrasts: Vec<f64>,
    /// Latest measurement of each marker.
    seen: Vec<Seen>,
    /// Result of the measurement at each marker's predicted position.
    looks: Vec<Look>,
    /// Buffer for the contrasts in the latest image, in no particular order, gray levels.
    contrasts_seen: Vec<f64>,
    /// Median contrast in the latest image, gray levels.
    typical: f64,
}

impl MarkerTracker {
    /// Tracks the elements of `layout` as markers, starting from their positions in the layout.
    ///
    /// # Errors
    /// Returns [`TrackError::MarkerCount`] if there are too few markers.
    pub fn new(layout: &LocatedLayout) -> Result<Self, TrackError> {
        let reference: Vec<DVec2> = layout.elements.iter().map(|e| e.centre_px).collect();
        let count = reference.len();
        if count < field::FEWEST {
            return Err(TrackError::MarkerCount {
                expected: field::FEWEST,
                actual: count,
            });
        }
        let mut radii: Vec<f64> = layout.elements.iter().map(|e| e.radius_px).collect();
        let region = super::locate::median(&mut radii);
        // Half as large again as a spot, to include the background around it.
        let spot = layout
            .spot_diameter_px
            .map(|diameter| 0.75 * diameter + 1.5);
        let window = Window::new(spot.unwrap_or(region).min(1.2 * region));
        Ok(Self {
            size: (layout.width, layout.height),
            polarity: layout.polarity,
            spot_diameter: layout.spot_diameter_px,
            field: Field::new(&reference),
            window,
            markers: reference
                .iter()
                .map(|&place| TrackedMarker {
                    place,
                    ..TrackedMarker::default()
                })
                .collect(),
            velocities: vec![DVec2::ZERO; count],
            work: vec![DVec2::ZERO; count],
            found: vec![false; count],
            before: vec![false; count],
            doubtful: false,
            contrasts: vec![0.0; count],
            seen: vec![Seen::default(); count],
            looks: vec![Look::Nothing; count],
            contrasts_seen: vec![0.0; count],
            typical: 0.0,
            reference,
        })
    }

    /// Markers in the latest image.
    pub fn markers(&self) -> &[TrackedMarker] {
        &self.markers
    }

    /// Number of markers found in the latest image.
    pub fn found(&self) -> usize {
        self.found.iter().filter(|&&found| found).count()
    }

    /// Returns `true` if too few markers were found to continue, or if markers may have been confused with their
    /// neighbours because many were lost at once. [`match_picture`](Self::match_picture) can recover them; until then,
    /// confidence is low.
    pub fn is_lost(&self) -> bool {
        self.doubtful || (self.found() as f64) < MIN_FOUND * self.markers.len() as f64
    }

    /// Tracks the markers into the next image of a video. Neither allocates nor panics.
    ///
    /// # Errors
    /// Returns [`TrackError::PictureSize`] if the image size differs from the layout.
    pub fn track<P: AsRef<[u8]>>(
        &mut self,
        picture: &Picture<P>,
    ) -> Result<&[TrackedMarker], TrackError> {
        self.check(picture)?;
        for (work, (marker, velocity)) in self
            .work
            .iter_mut()
            .zip(self.markers.iter().zip(&self.velocities))
        {
            *work = marker.displacement + *velocity;
        }
        self.before.copy_from_slice(&self.found);
        let mistaken = self.measure(picture.pixels.as_ref());
        let edge = self.field.edge();
        let lost = edge
            .iter()
            .filter(|&&own| self.before[own] && !self.found[own])
            .count();
        // In a small pattern, a few markers may be lost by chance.
        self.doubtful |= mistaken as f64 > (MISTAKEN * self.markers.len() as f64).max(2.0)
            || lost as f64 > (JUMPED * edge.len() as f64).max(2.0);
        self.settle();
        Ok(&self.markers)
    }

    /// Finds the markers in an image by comparison with the reference alone, independently of earlier images. Takes
    /// about a millisecond if nearly all markers are visible as spots of the layout's size, otherwise some tens of
    /// milliseconds.
    ///
    /// # Errors
    /// If the image size differs from the layout, or if the image shows no markers.
    pub fn match_picture<P: AsRef<[u8]>>(
        &mut self,
        picture: &Picture<P>,
    ) -> Result<&[TrackedMarker], TrackError> {
        self.check(picture)?;
        let (places, matched) = match self.matched_quickly(picture) {
            Some(matched) => matched,
            None => self.matched_surely(picture)?,
        };
        for (own, spot) in matched.spots.iter().enumerate() {
            self.found[own] = spot.is_some();
            self.work[own] = spot.map_or(DVec2::ZERO, |spot| places[spot] - self.reference[own]);
        }
        self.field.fill(&mut self.work, &self.found);
        self.measure(picture.pixels.as_ref());
        self.doubtful = matched.quality < MIN_MATCHED;
        self.settle();
        self.velocities.fill(DVec2::ZERO);
        Ok(&self.markers)
    }

    /// Matches only spots with the diameter given in the layout, which is fast. Returns `None` if the layout contains
    /// no diameter or the quality of the matching is below [`QUICKLY_MATCHED`].
    fn matched_quickly<P: AsRef<[u8]>>(
        &self,
        picture: &Picture<P>,
    ) -> Option<(Vec<DVec2>, Matched)> {
        let count = self.reference.len();
        let places = blobs_of_size(picture, self.polarity, self.spot_diameter?, count);
        let matched = growing::matched(&self.reference, &self.field, &places);
        (matched.quality >= QUICKLY_MATCHED).then_some((places, matched))
    }

    /// Matches spots of any size, with the full search.
    fn matched_surely<P: AsRef<[u8]>>(
        &self,
        picture: &Picture<P>,
    ) -> Result<(Vec<DVec2>, Matched), TrackError> {
        let mut mean = MeanPicture::default();
        mean.add(picture)?;
        let config = LocateConfig {
            polarity: Some(self.polarity),
            ..LocateConfig::default()
        };
        let located = locate(&mean.finish()?, &config)?;
        let places: Vec<DVec2> = located.elements.iter().map(|e| e.centre_px).collect();
        let matched = growing::matched(&self.reference, &self.field, &places);
        Ok((places, matched))
    }

    /// Marks all markers as lost at their last positions, after an image without markers.
    pub fn lose(&mut self) {
        self.found.fill(false);
        self.velocities.fill(DVec2::ZERO);
        self.markers
            .iter_mut()
            .for_each(|marker| marker.confidence = 0.0);
    }

    fn check<P: AsRef<[u8]>>(&self, picture: &Picture<P>) -> Result<(), TrackError> {
        let (actual, pixels) = (
            (picture.width, picture.height),
            picture.pixels.as_ref().len(),
        );
        if actual == self.size && pixels == actual.0 * actual.1 {
            return Ok(());
        }
        Err(TrackError::PictureSize {
            expected: self.size,
            actual,
            pixels,
        })
    }

    /// Updates the state of all markers from `work` and `found`.
    fn settle(&mut self) {
        let doubt = if self.doubtful { DOUBT } else { 1.0 };
        for own in 0..self.reference.len() {
            let displacement = self.work[own];
            self.velocities[own] = displacement - self.markers[own].displacement;
            let marker = &mut self.markers[own];
            marker.place = self.reference[own] + displacement;
            marker.displacement = displacement;
            marker.confidence = 0.0;
            if self.found[own] {
                let Seen { contrast, sum, .. } = self.seen[own];
                let usual = &mut self.contrasts[own];
                // Increases at once and decreases slowly, so that a fading marker is kept.
                *usual = contrast.max(*usual + FADES * (contrast - *usual));
                let off = self.field.off(own, &self.work, &self.found);
                let agrees = (1.0 - off / MAX_OFF).clamp(0.0, 1.0);
                marker.confidence = doubt * agrees * (contrast / *usual).min(1.0);
                marker.integrated_gray = sum;
            }
        }
        self.field
            .smooth(&mut self.velocities, &mut self.work, &self.found);
    }
}
