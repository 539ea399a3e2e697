//! Collects the loads and moments of each element for a fit.

use crate::sensor::calibration::fit::{ElementRecord, LoadSample};
use crate::sensor::moments::kernel::ElementMoments;
use glam::DVec3;

/// Forces and moments of one image.
#[derive(Debug, Clone, PartialEq)]
pub struct CapturedImage {
    /// Force on each element in its frame `E_i`, N; `None` if unknown.
    pub forces: Vec<Option<DVec3>>,
    /// Moments of each element.
    pub moments: Vec<ElementMoments>,
}

/// Collects loads and moments of each element from images, for a fit.
///
/// All loads are used both for fitting and for repeatability; errors are estimated by cross-validation.
#[derive(Debug, Clone, PartialEq)]
pub struct RecordBuilder {
    elements: usize,
    pictures: Vec<CapturedImage>,
}

impl RecordBuilder {
    /// Creates a builder for `elements` elements.
    pub fn new(elements: usize) -> Self {
        Self {
            elements,
            pictures: Vec::new(),
        }
    }

    /// Adds the forces and the moments of all elements in one image. If one list is shorter, the remaining elements are
    /// ignored.
    pub fn add(&mut self, forces: &[Option<DVec3>], moments: &[ElementMoments]) {
        let mut picture = CapturedImage {
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

    /// Images added so far, in order.
    pub fn pictures(&self) -> &[CapturedImage] {
        &self.pictures
    }

    /// Returns one record per element.
    pub fn records(&self) -> Vec<ElementRecord> {
        match self.pictures.is_empty() {
            true => vec![ElementRecord::default(); self.elements],
            false => records(&self.pictures),
        }
    }
}

/// Returns the loads and moments of each element from `pictures` of one fingertip.
pub fn records<'a>(pictures: impl IntoIterator<Item = &'a CapturedImage>) -> Vec<ElementRecord> {
    let mut records = Vec::new();
    for CapturedImage { forces, moments } in pictures {
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
