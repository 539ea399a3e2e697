//! Assignment of spots to markers.

use super::field::Field;
use glam::DVec2;

/// Deviation of a match from the displacement field, in units of the marker spacing, above which it lowers the score.
const SMOOTH: f64 = 0.3;

/// Spot and displacement of each marker.
#[derive(Debug, Clone)]
pub(super) struct Matching {
    pub spots: Vec<Option<usize>>,
    pub displacements: Vec<DVec2>,
    pub known: Vec<bool>,
}

impl Matching {
    pub fn none(count: usize) -> Self {
        Self {
            spots: vec![None; count],
            displacements: vec![DVec2::ZERO; count],
            known: vec![false; count],
        }
    }

    pub fn take(&mut self, own: usize, spot: usize, displacement: DVec2) {
        self.spots[own] = Some(spot);
        self.displacements[own] = displacement;
        self.known[own] = true;
    }

    /// Number of markers matched, minus three times the number that deviate from the displacement field.
    pub fn score(&self, field: &Field) -> f64 {
        let known = (0..self.known.len()).filter(|&own| self.known[own]);
        let worth = known.map(|own| {
            let off = field.off(own, &self.displacements, &self.known);
            if off > SMOOTH { -2.0 } else { 1.0 }
        });
        worth.sum()
    }

    /// Number of matched nearest neighbours of an unmatched marker, and its predicted displacement.
    pub fn supported(&self, field: &Field, own: usize) -> Option<(usize, DVec2)> {
        let near = field.neighbours(own).iter().take(8);
        let support = near.filter(|&&other| self.known[other]).count();
        let predicted =
            (support >= 3).then(|| field.predict(own, &self.displacements, &self.known));
        Some((support, predicted??))
    }
}
