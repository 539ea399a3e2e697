//! Smooth displacement field of the markers. Predicts a marker's displacement from those of its neighbours.

use crate::sensor::calibration::least_squares::outer;
use crate::sensor::locate::nearest;
use glam::{DMat3, DVec2, DVec3};

/// Minimum number of markers of a field.
pub(super) const FEWEST: usize = 6;
/// Number of neighbours used to predict a marker's displacement.
const NEIGHBOURS: usize = 10;
/// Minimum number of neighbours with known displacements for a prediction.
const KNOWN: usize = 3;

/// Predicts the displacement of a marker with an affine least-squares fit to the displacements of its neighbours.
/// Weights decrease with distance.
#[derive(Debug, Clone)]
pub(super) struct Field {
    /// Indices of each marker's neighbours, nearest first.
    neighbours: Vec<Vec<usize>>,
    /// Offsets of the neighbours from the marker, divided by the local spacing, with their weights.
    offsets: Vec<Vec<(DVec2, f64)>>,
    /// Weight of each neighbour's displacement in the prediction, if those of all neighbours are known.
    shares: Vec<Vec<f64>>,
    /// Distance of each marker to its nearest neighbour, px.
    spacing: Vec<f64>,
    /// Indices of markers that have neighbours on one side only.
    edge: Vec<usize>,
}

impl Field {
    pub fn new(places: &[DVec2]) -> Self {
        let neighbours = nearest(places, NEIGHBOURS);
        let gap = |own: usize| {
            let near = neighbours[own].first();
            near.map_or(1.0, |&i| places[i].distance(places[own]))
                .max(1e-3)
        };
        let spacing: Vec<f64> = (0..places.len()).map(gap).collect();
        let offset = |own: usize, i: usize| {
            let offset = (places[i] - places[own]) / spacing[own];
            (offset, libm::exp(-offset.length_squared() / 4.5))
        };
        let offsets: Vec<Vec<(DVec2, f64)>> = neighbours
            .iter()
            .enumerate()
            .map(|(own, near)| near.iter().map(|&i| offset(own, i)).collect())
            .collect();
        let shares = offsets.iter().map(|offsets| shares(offsets)).collect();
        let one_sided = |offsets: &Vec<(DVec2, f64)>| {
            let near = offsets.iter().take(6).map(|&(offset, _)| offset);
            let sum = near.clone().sum::<DVec2>().length();
            sum > 0.4 * near.map(DVec2::length).sum::<f64>()
        };
        let edge = offsets
            .iter()
            .enumerate()
            .filter(|(_, offsets)| one_sided(offsets));
        let edge = edge.map(|(own, _)| own).collect();
        Self {
            edge,
            neighbours,
            offsets,
            shares,
            spacing,
        }
    }

    pub fn neighbours(&self, own: usize) -> &[usize] {
        &self.neighbours[own]
    }

    /// Indices of the markers at the edge of the pattern.
    pub fn edge(&self) -> &[usize] {
        &self.edge
    }

    /// Distance of a marker to its nearest neighbour in the reference, px.
    pub fn spacing(&self, own: usize) -> f64 {
        self.spacing[own]
    }

    /// Displacement of a marker (px) predicted from its known neighbours; `None` if too few are known.
    pub fn predict(&self, own: usize, displacements: &[DVec2], known: &[bool]) -> Option<DVec2> {
        let near = &self.neighbours[own];
        let count = near.iter().filter(|&&i| known[i]).count();
        if count == near.len() {
            let shares = near.iter().zip(&self.shares[own]);
            return Some(shares.map(|(&i, share)| *share * displacements[i]).sum());
        }
        if count < KNOWN {
            return None;
        }
        let (mut normal, mut right) = (ridge(), [DVec3::ZERO; 2]);
        for (&i, &(offset, weight)) in near.iter().zip(&self.offsets[own]) {
            if known[i] {
                let row = DVec3::new(1.0, offset.x, offset.y);
                normal += weight * outer(row);
                right[0] += weight * displacements[i].x * row;
                right[1] += weight * displacements[i].y * row;
            }
        }
        let inverse = normal.inverse();
        let predicted = DVec2::new((inverse * right[0]).x, (inverse * right[1]).x);
        predicted.is_finite().then_some(predicted)
    }

    /// Deviation of a marker's displacement from its prediction, in units of the marker spacing; 0 if it cannot be
    /// predicted.
    pub fn off(&self, own: usize, displacements: &[DVec2], known: &[bool]) -> f64 {
        let predicted = self.predict(own, displacements, known);
        predicted.map_or(0.0, |u| u.distance(displacements[own]) / self.spacing[own])
    }

    /// Replaces the displacements of markers that are not `known` with predictions, from known markers outward.
    pub fn fill(&self, displacements: &mut [DVec2], known: &[bool]) {
        let mut known = known.to_vec();
        loop {
            let next: Vec<(usize, DVec2)> = (0..known.len())
                .filter(|&own| !known[own])
                .filter_map(|own| Some((own, self.predict(own, displacements, &known)?)))
                .collect();
            if next.is_empty() {
                return;
            }
            for (own, displacement) in next {
                displacements[own] = displacement;
                known[own] = true;
            }
        }
    }

    /// Replaces each value with the mean over itself and its known neighbours. `work` is a buffer.
    pub fn smooth(&self, values: &mut [DVec2], work: &mut [DVec2], known: &[bool]) {
        work.copy_from_slice(values);
        for (own, value) in values.iter_mut().enumerate() {
            let (mut sum, mut count) = (DVec2::ZERO, 0.0);
            let near = self.neighbours[own].iter().take(6).copied();
            for i in near.chain([own]).filter(|&i| known[i]) {
                sum += work[i];
                count += 1.0;
            }
            *value = if count > 0.0 {
                sum / count
            } else {
                DVec2::ZERO
            };
        }
    }
}

/// Regularization matrix that keeps the slopes finite for collinear neighbours.
fn ridge() -> DMat3 {
    DMat3::from_diagonal(DVec3::new(0.0, 0.02, 0.02))
}

/// Weight of each neighbour's value in the prediction of a marker.
fn shares(offsets: &[(DVec2, f64)]) -> Vec<f64> {
    let row = |offset: DVec2| DVec3::new(1.0, offset.x, offset.y);
    let normal = offsets.iter().fold(ridge(), |sum, &(offset, weight)| {
        sum + weight * outer(row(offset))
    });
    let first = normal.inverse().row(0);
    offsets
        .iter()
        .map(|&(offset, weight)| weight * first.dot(row(offset)))
        .collect()
}
