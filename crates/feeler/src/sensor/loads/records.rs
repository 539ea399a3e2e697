//! What is known of each element from pictures and their moments, for a fit.

use crate::sensor::{
    calibration_fit::{ElementRecord, LoadSample},
    moments::ElementMoments,
};
use glam::DVec3;

/// A picture's forces and moments.
#[derive(Debug, Clone, PartialEq)]
pub struct TakenPicture {
    /// Force on each element in its frame `E_i`, N; `None` where it is not known.
    pub forces: Vec<Option<DVec3>>,
    /// Moments of each element.
    pub moments: Vec<ElementMoments>,
}

/// What is known of each element from pictures and their moments, for a fit.
///
/// All loads are both fitted and looked at for repetitions; errors are found by cross-validation.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordBuilder {
    elements: usize,
    pictures: Vec<TakenPicture>,
}

impl RecordBuilder {
    /// For `elements` elements.
    pub fn new(elements: usize) -> Self {
        Self {
            elements,
            pictures: Vec::new(),
        }
    }

    /// Adds a picture's forces and the moments of all elements in it, from wherever they come. Elements without either are unknown.
    pub fn add(&mut self, forces: &[Option<DVec3>], moments: &[ElementMoments]) {
        let mut picture = TakenPicture {
            forces: forces.to_vec(),
            moments: moments.to_vec(),
        };
        let known = forces.len().min(moments.len());
        picture.forces.truncate(known);
        picture.forces.resize(self.elements, None);
        picture
            .moments
            .resize(self.elements, ElementMoments::default());
        self.pictures.push(picture);
    }

    /// The pictures, in the order in which they were added.
    pub fn pictures(&self) -> &[TakenPicture] {
        &self.pictures
    }

    /// The records, one for each element.
    pub fn records(&self) -> Vec<ElementRecord> {
        match self.pictures.is_empty() {
            true => vec![ElementRecord::default(); self.elements],
            false => records(&self.pictures),
        }
    }
}

/// Loads and moments of each element in `pictures` of one fingertip.
pub fn records<'a>(pictures: impl IntoIterator<Item = &'a TakenPicture>) -> Vec<ElementRecord> {
    let mut records = Vec::new();
    for TakenPicture { forces, moments } in pictures {
        records.resize(forces.len(), ElementRecord::default());
        for ((record, force), &moments) in records.iter_mut().zip(forces).zip(moments) {
            let Some(force) = *force else { continue };
            let sample = LoadSample { force, moments };
            if force == DVec3::ZERO {
                record.unloaded.push(moments);
            } else {
                record.fitted.push(sample);
            }
            record.cycled.push(sample);
        }
    }
    records
}
