//! Matches the spots of an image with the markers of the reference.

use super::{field::Field, matching::Matching, mending::mend};
use crate::math::direction_at;
use glam::DVec2;

/// Maximum distance of a spot from a marker's predicted position, in units of the marker spacing.
const NEAR: f64 = 0.45;
/// Maximum distance of a spot from a seed marker's assumed position, in units of the marker spacing.
const SEED: f64 = 0.35;
/// Maximum deviation of a seed's displacement from the affine prediction or from those of most neighbours, in units of
/// the marker spacing.
const ALIKE: f64 = 0.15;
/// Minimum number of neighbours, out of six, that must move like a seed. Also the minimum size of a group of seeds.
const AGREE: usize = 4;
/// Fraction of the markers (or of the spots, if there are fewer) that must be matched to end the search.
const ENOUGH: f64 = 0.985;
/// Number of markers matched between updates of the predictions.
const AT_ONCE: usize = 10;

/// Result of matching markers with spots.
pub(super) struct Matched {
    /// Index of each marker's spot; `None` if the marker is not matched.
    pub spots: Vec<Option<usize>>,
    /// Fraction of markers matched, minus three times the fraction that deviate from the displacement field.
    pub quality: f64,
}

/// Matches the markers of the `reference` with the spots at `places`.
///
/// Matching starts at seeds and extends to neighbouring markers, those with most matched neighbours first. Seeds are
/// groups of markers with similar displacements, each matched with its nearest spot. The first seeds are markers that
/// hardly moved; unless nearly all markers are matched from there, seeds that moved by up to one and a half spacings in
/// any direction are tried. Returns the matching with most markers and the smoothest displacement field.
pub(super) fn matched(reference: &[DVec2], field: &Field, places: &[DVec2]) -> Matched {
    let mut best = grown_best(reference, field, places);
    mend(&mut best, reference, field, places);
    Matched {
        quality: best.score(field) / reference.len() as f64,
        spots: best.spots,
    }
}

/// Returns the matching with most markers and the smoothest displacement field.
fn grown_best(reference: &[DVec2], field: &Field, places: &[DVec2]) -> Matching {
    let enough = ENOUGH * reference.len().min(places.len()) as f64;
    let mut best = Matching::none(reference.len());
    let mut score = 0.0;
    let mut known: Vec<Vec<Option<usize>>> = Vec::new();
    for shift in shifts(typical_spacing(field, reference.len())) {
        let groups = seeds(reference, field, places, shift);
        for seeds in groups.iter().take(2) {
            // Skip seeds that an earlier matching contains: they would grow into the same matching.
            let same = |spots: &Vec<Option<usize>>| {
                seeds.iter().all(|&(own, spot)| spots[own] == Some(spot))
            };
            if known.iter().any(same) {
                continue;
            }
            let mut grown = grow(reference, field, places, seeds);
            if shift == DVec2::ZERO {
                add_islands(&mut grown, reference, field, places, &groups);
            }
            known.push(grown.spots.clone());
            let reached = grown.score(field);
            if reached > score {
                (best, score) = (grown, reached);
            }
            if score >= enough {
                return best;
            }
        }
    }
    best
}

fn typical_spacing(field: &Field, count: usize) -> f64 {
    let mut spacing: Vec<f64> = (0..count).map(|own| field.spacing(own)).collect();
    crate::sensor::locate::median(&mut spacing)
}

/// Displacements to try for seeds, px: zero, then half, one and one and a half spacings in twelve directions.
fn shifts(spacing: f64) -> impl Iterator<Item = DVec2> {
    let turned = move |step: f64| {
        (0..12).map(move |twelfth| {
            let angle = f64::from(twelfth) * std::f64::consts::FRAC_PI_6;
            step * spacing * direction_at(angle)
        })
    };
    [DVec2::ZERO]
        .into_iter()
        .chain([0.5, 1.0, 1.5].into_iter().flat_map(turned))
}

/// Returns the index of the nearest spot and its distance.
fn nearest_spot(places: &[DVec2], place: DVec2) -> Option<(usize, f64)> {
    let distances = places
        .iter()
        .map(|spot| spot.distance_squared(place))
        .enumerate();
    let nearest = distances.min_by(|a, b| a.1.total_cmp(&b.1));
    nearest.map(|(index, squared)| (index, squared.sqrt()))
}

/// Connected groups of markers with similar displacements of about `shift`, each with its nearest spot; largest groups
/// first.
fn seeds(
    reference: &[DVec2],
    field: &Field,
    places: &[DVec2],
    shift: DVec2,
) -> Vec<Vec<(usize, usize)>> {
    let nearest: Vec<Option<(usize, f64)>> = reference
        .iter()
        .map(|place| nearest_spot(places, *place + shift))
        .collect();
    let near = |own: usize| nearest[own].is_some_and(|(_, far)| far < SEED * field.spacing(own));
    let known: Vec<bool> = nearest.iter().map(Option::is_some).collect();
    let moved: Vec<DVec2> = reference
        .iter()
        .zip(&nearest)
        .map(|(place, nearest)| nearest.map_or(DVec2::ZERO, |(spot, _)| places[spot] - *place))
        .collect();
    let is_seed = |own: usize| {
        let alike =
            |other: &&usize| moved[own].distance(moved[**other]) < ALIKE * field.spacing(own);
        // In a rotation or expansion, neighbours move differently but by an affine field.
        let affine = field.off(own, &moved, &known) < ALIKE;
        let agree = || field.neighbours(own).iter().take(6).filter(alike).count() >= AGREE;
        near(own) && known[own] && (affine || agree())
    };
    let mut open: Vec<bool> = (0..reference.len()).map(is_seed).collect();
    let mut groups = Vec::new();
    for first in 0..reference.len() {
        if !std::mem::take(&mut open[first]) {
            continue;
        }
        let (mut next, mut group) = (vec![first], Vec::new());
        while let Some(own) = next.pop() {
            group.extend(nearest[own].map(|(spot, _)| (own, spot)));
            for &other in field.neighbours(own).iter().take(6) {
                if std::mem::take(&mut open[other]) {
                    next.push(other);
                }
            }
        }
        if group.len() >= AGREE {
            groups.push(group);
        }
    }
    groups.sort_by_key(|group| std::cmp::Reverse(group.len()));
    groups
}

fn grow(
    reference: &[DVec2],
    field: &Field,
    places: &[DVec2],
    seeds: &[(usize, usize)],
) -> Matching {
    /// Maximum number of rounds of discarding wrong matches and matching again.
    const ROUNDS: usize = 6;
    let mut matching = Matching::none(reference.len());
    let mut taken = vec![false; places.len()];
    for &(own, spot) in seeds {
        if !std::mem::replace(&mut taken[spot], true) {
            matching.take(own, spot, places[spot] - reference[own]);
        }
    }
    for _ in 0..ROUNDS {
        while spread(&mut matching, &mut taken, reference, field, places) {}
        let misfits: Vec<usize> = (0..reference.len())
            .filter(|&own| {
                let off = field.off(own, &matching.displacements, &matching.known);
                matching.known[own] && off > NEAR
            })
            .collect();
        if misfits.is_empty() {
            break;
        }
        for own in misfits {
            matching.known[own] = false;
            if let Some(spot) = matching.spots[own].take() {
                taken[spot] = false;
            }
        }
    }
    matching
}

/// Adds matches of those `groups` of markers that are not connected to the matched ones, such as a second view in a
/// mirror. Skips a group if a matched neighbour moved differently.
fn add_islands(
    matching: &mut Matching,
    reference: &[DVec2],
    field: &Field,
    places: &[DVec2],
    groups: &[Vec<(usize, usize)>],
) {
    let mut taken = vec![false; places.len()];
    for spot in matching.spots.iter().flatten() {
        taken[*spot] = true;
    }
    for group in groups {
        let fits = |&(own, spot): &(usize, usize)| {
            let moved = places[spot] - reference[own];
            let differs = |&&other: &&usize| {
                let other = matching.known[other].then(|| matching.displacements[other]);
                other.is_some_and(|other| other.distance(moved) > NEAR * field.spacing(own))
            };
            let contradicted = field.neighbours(own).iter().any(|other| differs(&other));
            !matching.known[own] && !taken[spot] && !contradicted
        };
        if !group.iter().all(fits) {
            continue;
        }
        for &(own, spot) in group {
            if !std::mem::replace(&mut taken[spot], true) {
                matching.take(own, spot, places[spot] - reference[own]);
            }
        }
        while spread(matching, &mut taken, reference, field, places) {}
    }
}

/// Matches up to [`AT_ONCE`] markers, those with most known neighbours first. Returns `true` if at least one was
/// matched.
fn spread(
    matching: &mut Matching,
    taken: &mut [bool],
    reference: &[DVec2],
    field: &Field,
    places: &[DVec2],
) -> bool {
    let mut open: Vec<(usize, usize, DVec2)> = (0..reference.len())
        .filter(|&own| !matching.known[own])
        .filter_map(|own| {
            let (support, predicted) = matching.supported(field, own)?;
            Some((own, support, predicted))
        })
        .collect();
    open.sort_by_key(|&(own, support, _)| (std::cmp::Reverse(support), own));
    let mut count = 0;
    for (own, _, predicted) in open {
        let nearest = nearest_spot(places, reference[own] + predicted);
        let free = nearest
            .filter(|&(spot, distance)| distance < NEAR * field.spacing(own) && !taken[spot]);
        if let Some((spot, _)) = free {
            taken[spot] = true;
            matching.take(own, spot, places[spot] - reference[own]);
            count += 1;
            if count == AT_ONCE {
                break;
            }
        }
    }
    count > 0
}
