//! Follows every marker by identity, however far it moves.
//!
//! A marker is looked for where its own motion and its neighbours' foretell it, and measured by the pixels there (`window`). It has been
//! found if there is contrast and if its displacement agrees with the smooth field that its neighbours' displacements make (`field`): a
//! swap of two markers is off by a spacing, and is seen. A marker that is not found keeps the place that the field foretells, and is
//! looked for there from then on. Where many are lost at once, the pattern may have jumped by a spacing, and all are in doubt.
//!
//! A single picture, of which no picture before is known, is matched against the reference alone: identities grow from where markers
//! hardly moved into where they moved far (`matching`).

mod error;
mod field;
mod matching;
mod measuring;
mod mending;
mod window;

pub use error::TrackError;

use self::{
    field::Field,
    matching::Matched,
    window::{Look, Seen, Window},
};
use super::{
    frame::Picture,
    locate::{LocateConfig, MeanPicture, blobs_of_size, locate},
    located_layout::LocatedLayout,
    polarity::Polarity,
};
use glam::DVec2;

/// Displacement off that of the field about it, over the spacing, from which on a marker is not the one that it is taken for.
const MOST_OFF: f64 = 0.45;
/// Part of the markers at the pattern's edge that, lost within one frame, make all others doubtful: the pattern may have jumped by a
/// spacing, so that one side of its edge shows nothing.
const JUMPED: f64 = 0.2;
/// Part of all markers that were taken for others at first, which makes all doubtful, too.
const MISTAKEN: f64 = 0.02;
/// What is left of the confidence in a marker that may be another.
const DOUBT: f64 = 0.3;
/// Quality of a matching from which on no better spots are looked for.
const QUICKLY_MATCHED: f64 = 0.95;
/// Quality of a matching below which all markers may be others.
const LEAST_MATCHED: f64 = 0.85;
/// Part of the way that a marker's usual contrast goes with one that has faded, from picture to picture.
const FADES: f64 = 0.02;
/// Part of the markers that must be found for a picture to be one of the sensor's.
const LEAST_FOUND: f64 = 0.3;

/// What is known of one marker.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TrackedMarker {
    /// Column and row, px.
    pub place: DVec2,
    /// From its place in the reference, px.
    pub displacement: DVec2,
    /// 0 (lost: the place is foretold) to 1 (as in the reference).
    pub confidence: f64,
    /// Sum of the contrast of its pixels, grey levels px²; of a lost one the last that was seen.
    pub integrated_gray: f64,
}

/// Follows the markers of a layout.
#[derive(Debug, Clone)]
pub struct MarkerTracker {
    size: (usize, usize),
    polarity: Polarity,
    /// Diameter of a spot, px, if the layout says it.
    spot_diameter: Option<f64>,
    /// Places in the reference, px.
    reference: Vec<DVec2>,
    field: Field,
    window: Window,
    markers: Vec<TrackedMarker>,
    /// Displacement since the frame before, smoothed over neighbours, px.
    velocities: Vec<DVec2>,
    /// Displacements that are foretold or were found in the newest picture, px.
    work: Vec<DVec2>,
    found: Vec<bool>,
    /// Which were found in the picture before.
    before: Vec<bool>,
    /// Whether all may be mistaken for their neighbours since some frame.
    doubtful: bool,
    /// Contrast that each marker has when it is seen well, grey levels; 0 until it was seen.
    contrasts: Vec<f64>,
    /// What each marker was seen as in the newest picture, if it was.
    seen: Vec<Seen>,
    /// What was seen where each marker was foretold.
    looks: Vec<Look>,
    /// Contrasts in the newest picture, in no order, and their median, grey levels.
    contrasts_seen: Vec<f64>,
    typical: f64,
}

impl MarkerTracker {
    /// Tracks the elements of `layout` as markers, which are where it says until a picture shows them elsewhere.
    ///
    /// # Errors
    /// When there are too few markers.
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
        // Half as far again as a spot reaches, so that the ground about it is seen.
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

    /// The markers as they were in the newest picture.
    pub fn markers(&self) -> &[TrackedMarker] {
        &self.markers
    }

    /// How many markers were found in the newest picture.
    pub fn found(&self) -> usize {
        self.found.iter().filter(|&&found| found).count()
    }

    /// Whether too few markers were found to go on, or those that were may be mistaken for their neighbours, as many were lost at once.
    /// [`match_picture`](Self::match_picture) finds them again if the picture shows them; until then, confidence is low.
    pub fn is_lost(&self) -> bool {
        self.doubtful || (self.found() as f64) < LEAST_FOUND * self.markers.len() as f64
    }

    /// Follows the markers into the next picture of a video. Neither allocates nor panics.
    ///
    /// # Errors
    /// When the picture has another size than the layout's.
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
        // A few are lost by chance in a small pattern.
        self.doubtful |= mistaken as f64 > (MISTAKEN * self.markers.len() as f64).max(2.0)
            || lost as f64 > (JUMPED * edge.len() as f64).max(2.0);
        self.settle();
        Ok(&self.markers)
    }

    /// Finds the markers in a picture by the reference alone, whatever was seen before. Takes about a millisecond where nearly all markers are seen as
    /// spots of the layout's size, else some tens of milliseconds.
    ///
    /// # Errors
    /// When the picture has another size than the layout's, or shows no markers.
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
        self.doubtful = matched.quality < LEAST_MATCHED;
        self.settle();
        self.velocities.fill(DVec2::ZERO);
        Ok(&self.markers)
    }

    /// Spots of the layout's size, and which markers they are; `None` unless nearly all markers are among them.
    fn matched_quickly<P: AsRef<[u8]>>(
        &self,
        picture: &Picture<P>,
    ) -> Option<(Vec<DVec2>, Matched)> {
        let count = self.reference.len();
        let places = blobs_of_size(picture, self.polarity, self.spot_diameter?, count);
        let matched = matching::matched(&self.reference, &self.field, &places);
        (matched.quality >= QUICKLY_MATCHED).then_some((places, matched))
    }

    /// Spots of whatever size, and which markers they are.
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
        let matched = matching::matched(&self.reference, &self.field, &places);
        Ok((places, matched))
    }

    /// Gives all markers up, which stay where they were last: for a picture that shows none.
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

    /// Takes over what `work` and `found` say.
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
                // Brightens at once, fades slowly: a fading marker stays the same.
                *usual = contrast.max(*usual + FADES * (contrast - *usual));
                let off = self.field.off(own, &self.work, &self.found);
                let agrees = (1.0 - off / MOST_OFF).clamp(0.0, 1.0);
                marker.confidence = doubt * agrees * (contrast / *usual).min(1.0);
                marker.integrated_gray = sum;
            }
        }
        self.field
            .smooth(&mut self.velocities, &mut self.work, &self.found);
    }
}
