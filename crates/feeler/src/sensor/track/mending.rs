//! Corrects swapped matches at the edge of a pattern.
//!
//! At the edge, a marker that moved by half a spacing may be matched with its neighbour's spot, that neighbour with the
//! spot of the next, and so on, which leaves one spot or one marker unmatched. Each such chain of matches is followed
//! from the unmatched spot or marker, and reversed if that makes the displacement field smoother.

use super::{field::Field, matching::Matching};
use glam::DVec2;

/// Maximum distance of an unmatched spot from a marker's predicted position, in units of the marker spacing.
const NEAR: f64 = 0.75;
/// Deviation of a marker's displacement from the field, in units of the marker spacing, above which its match is
/// doubtful.
const DOUBTFUL: f64 = 0.1;
/// Squared deviation assigned to a marker without a spot: that of half a marker spacing.
const WITHOUT: f64 = 0.25;
/// Maximum number of markers in a chain.
const LONGEST: usize = 6;
/// Maximum number of chains to reverse per image.
const CHAINS: usize = 12;
/// Maximum number of unmatched spots for chains to be followed; an image with more shows something else.
const MAX_LEFT: usize = 12;

/// Reassigns spots, starting with unmatched ones, while the displacement field becomes smoother.
pub(super) fn mend(matching: &mut Matching, reference: &[DVec2], field: &Field, places: &[DVec2]) {
    let scene = Scene {
        reference,
        field,
        places,
    };
    for _ in 0..CHAINS {
        let left = scene.left_over(matching);
        let complete = left.is_empty() && matching.known.iter().all(|&known| known);
        if complete || left.len() > MAX_LEFT {
            return;
        }
        let now = scene.roughness(matching);
        let starts = left.iter().flat_map(|&spot| {
            let firsts = scene.suited(matching, spot, &[]);
            firsts.into_iter().map(move |first| (spot, first))
        });
        let from_spots = starts.map(|(spot, first)| scene.reverse_from_spot(matching, spot, first));
        let unmatched = (0..reference.len()).filter(|&own| !matching.known[own]);
        let from_markers = unmatched.filter_map(|first| scene.reverse_from_marker(matching, first));
        let smoothest = from_spots
            .chain(from_markers)
            .min_by(|(a, _), (b, _)| a.total_cmp(b));
        match smoothest {
            Some((roughness, mended)) if roughness < now => *matching = mended,
            _ => return,
        }
    }
}

struct Scene<'a> {
    reference: &'a [DVec2],
    field: &'a Field,
    places: &'a [DVec2],
}

impl Scene<'_> {
    /// Spots that are not matched with a marker.
    fn left_over(&self, matching: &Matching) -> Vec<usize> {
        let mut left = vec![true; self.places.len()];
        for &spot in matching.spots.iter().flatten() {
            left[spot] = false;
        }
        (0..left.len()).filter(|&spot| left[spot]).collect()
    }

    /// Sum of squared deviations of all markers from the displacement field.
    fn roughness(&self, matching: &Matching) -> f64 {
        let off = |own: usize| match matching.known[own] {
            true => self.off(matching, own).powi(2),
            false => WITHOUT,
        };
        (0..self.reference.len()).map(off).sum()
    }

    fn off(&self, matching: &Matching, own: usize) -> f64 {
        self.field
            .off(own, &matching.displacements, &matching.known)
    }

    /// Candidate markers for `spot`, nearest first: not in `passed`, with a doubtful match or without a spot, and
    /// predicted nearby.
    fn suited(&self, matching: &Matching, spot: usize, passed: &[usize]) -> Vec<usize> {
        let far = |own: usize| {
            let predicted = self
                .field
                .predict(own, &matching.displacements, &matching.known)?;
            let place = self.reference[own] + predicted;
            Some(place.distance(self.places[spot]) / self.field.spacing(own))
        };
        let doubtful = |own: usize| !matching.known[own] || self.off(matching, own) > DOUBTFUL;
        let near = (0..self.reference.len()).filter(|own| !passed.contains(own));
        let near = near.filter_map(|own| Some((own, far(own)?)));
        let mut near: Vec<_> = near
            .filter(|&(own, far)| far < NEAR && doubtful(own))
            .collect();
        near.sort_by(|a, b| a.1.total_cmp(&b.1));
        near.into_iter().map(|(own, _)| own).collect()
    }

    /// Reverses a chain that ends at an unmatched `spot`: assigns it to the marker `first`, that marker's previous spot to
    /// the best candidate, and so on. Returns the smoothest of the resulting matchings with its roughness.
    fn reverse_from_spot(&self, matching: &Matching, spot: usize, first: usize) -> (f64, Matching) {
        let mut mended = matching.clone();
        let (mut spot, mut own) = (spot, first);
        let mut passed = Vec::with_capacity(LONGEST);
        let mut smoothest = (f64::INFINITY, matching.clone());
        loop {
            let freed = mended.spots[own];
            mended.take(own, spot, self.places[spot] - self.reference[own]);
            passed.push(own);
            let roughness = self.roughness(&mended);
            if roughness < smoothest.0 {
                smoothest = (roughness, mended.clone());
            }
            let next = freed.filter(|_| passed.len() < LONGEST);
            let next = next.and_then(|freed| {
                let suited = self.suited(&mended, freed, &passed);
                Some((freed, *suited.first()?))
            });
            match next {
                Some(next) => (spot, own) = next,
                None => return smoothest,
            }
        }
    }

    /// Reverses a chain that ends at the unmatched marker `first`: assigns it a neighbour's spot, that neighbour the
    /// spot of another, and so on; the last one remains unmatched. Returns the smoothest of the resulting matchings with
    /// its roughness; `None` if no neighbour's match is doubtful.
    fn reverse_from_marker(&self, matching: &Matching, first: usize) -> Option<(f64, Matching)> {
        let mut mended = matching.clone();
        let mut smoothest: Option<(f64, Matching)> = None;
        let mut passed = vec![first];
        let mut own = first;
        while passed.len() <= LONGEST
            && let Some((giver, spot)) = self.giver(&mended, own, &passed)
        {
            mended.spots[giver] = None;
            mended.known[giver] = false;
            mended.take(own, spot, self.places[spot] - self.reference[own]);
            let roughness = self.roughness(&mended);
            if smoothest.as_ref().is_none_or(|best| roughness < best.0) {
                smoothest = Some((roughness, mended.clone()));
            }
            passed.push(giver);
            own = giver;
        }
        smoothest
    }

    /// Neighbour with a doubtful match, not in `passed`, whose spot is nearest to the predicted position of the marker
    /// `own`, and that spot.
    fn giver(&self, matching: &Matching, own: usize, passed: &[usize]) -> Option<(usize, usize)> {
        let predicted = self
            .field
            .predict(own, &matching.displacements, &matching.known)?;
        let place = self.reference[own] + predicted;
        let near = self.field.neighbours(own).iter().copied();
        let spots = near
            .filter(|other| !passed.contains(other) && self.off(matching, *other) > DOUBTFUL)
            .filter_map(|other| Some((other, matching.spots[other]?)));
        let far = |spot: usize| self.places[spot].distance(place) / self.field.spacing(own);
        spots
            .filter(|&(_, spot)| far(spot) < NEAR)
            .min_by(|a, b| far(a.1).total_cmp(&far(b.1)))
    }
}
