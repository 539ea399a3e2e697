//! Handles spots that are too close to each other: overlapping blobs, several blobs of one marker, and specks beside
//! markers.

use super::spot::Spot;
use super::strays::{centres, gaps, kept};
use super::{median_of, nearest};
use crate::sensor::image::cells::Cells;

/// Keeps only the strongest of overlapping spots.
pub(super) fn without_overlaps(mut spots: Vec<Spot>) -> Vec<Spot> {
    spots.sort_by(|a, b| b.response.total_cmp(&a.response));
    let centres = centres(&spots);
    let cells = Cells::new(&centres);
    let mut kept = vec![false; spots.len()];
    let mut covered = kept.clone();
    for (own, spot) in spots.iter().enumerate() {
        let reach = 0.5 * spot.diameter;
        let inside = |&other: &usize| {
            centres[other].distance_squared(spot.centre) < reach * reach && other != own
        };
        let mut near = cells.within(spot.centre, reach).filter(inside);
        if covered[own] || near.any(|other| kept[other]) {
            continue;
        }
        kept[own] = true;
        for other in cells.within(spot.centre, reach).filter(inside) {
            covered[other] = true;
        }
    }
    self::kept(&spots, &kept)
}

/// Maximum distance of two spots that count as too close, relative to the spacing around them.
const CROWDED: f64 = 0.62;

/// Maximum ratio of the responses of two comparable spots.
const COMPARABLE: f64 = 1.3;

/// Returns `true` if the responses differ by less than a factor of [`COMPARABLE`].
fn are_comparable(a: &Spot, b: &Spot) -> bool {
    (1.0 / COMPARABLE..COMPARABLE).contains(&(a.response / b.response))
}

/// Removes one of two spots that are unusually close to each other, such as a speck beside a pin: the much weaker one, or
/// else the one that differs more from its neighbours in size and response.
pub(super) fn without_crowding(spots: Vec<Spot>) -> Vec<Spot> {
    let neighbours = nearest(&centres(&spots), 9);
    let gaps = gaps(&spots, &neighbours);
    let off = |own: usize, value: &dyn Fn(usize) -> f64| {
        libm::log(value(own) / median_of(&neighbours[own], value)).abs()
    };
    let difference =
        |own: usize| off(own, &|i| spots[i].diameter) + off(own, &|i| spots[i].response);
    let is_worse = |own: usize, other: usize| match are_comparable(&spots[own], &spots[other]) {
        true => (difference(own), own) > (difference(other), other),
        false => spots[own].response < spots[other].response,
    };
    let crowded = |(own, near): (usize, &Vec<usize>)| {
        let enough = near.len() >= 9;
        let close = enough && gaps[own] < CROWDED * median_of(&near[1..], |i| gaps[i]);
        close && near.first().is_some_and(|&i| is_worse(own, i))
    };
    let keep: Vec<bool> = neighbours.iter().enumerate().map(|n| !crowded(n)).collect();
    kept(&spots, &keep)
}

/// Merges pairs of blobs that belong to the same marker: much closer to each other than to all other spots, and without
/// background between them according to `joined`.
pub(super) fn with_merged_pairs(
    spots: Vec<Spot>,
    joined: impl Fn(&Spot, &Spot) -> bool,
) -> Vec<Spot> {
    let neighbours = nearest(&centres(&spots), 8);
    let distance = |a: usize, b: usize| spots[a].centre.distance(spots[b].centre);
    let partner = |own: usize| {
        let nearest = *neighbours[own].first()?;
        (neighbours[nearest].first() == Some(&own)).then_some(nearest)
    };
    // Distance to the nearest spot that is not the partner, which the pairs themselves do not shorten.
    let spacing = |own: usize| {
        let partner = partner(own);
        let next = neighbours[own].iter().find(|&&i| Some(i) != partner);
        next.map_or(f64::INFINITY, |&i| distance(own, i))
    };
    let spacings: Vec<f64> = (0..spots.len()).map(spacing).collect();
    let mut merged = Vec::with_capacity(spots.len());
    for (own, spot) in spots.iter().enumerate() {
        // The decision is the same for both spots of a pair.
        let close = |&other: &usize| {
            let spacing = median_of(&neighbours[own.min(other)], |i| spacings[i]);
            distance(own, other) < CROWDED * spacing
        };
        match partner(own).filter(close) {
            Some(other) if are_comparable(spot, &spots[other]) && joined(spot, &spots[other]) => {
                // The first of the pair stands for both.
                if own < other {
                    merged.push(merged_pair(spot, &spots[other]));
                }
            }
            _ => merged.push(*spot),
        }
    }
    merged
}

/// Merges two blobs into one spot.
fn merged_pair(a: &Spot, b: &Spot) -> Spot {
    Spot {
        centre: 0.5 * (a.centre + b.centre),
        sigma: libm::hypot(a.sigma, b.sigma),
        diameter: libm::hypot(a.diameter, b.diameter),
        response: 0.5 * (a.response + b.response),
        ..*a
    }
}
