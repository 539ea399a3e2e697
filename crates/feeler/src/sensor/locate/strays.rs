//! Separates the spots of the pattern from specks, reflections and stray spots.

use super::{median, median_of, nearest, quantile, spot::Spot};
use crate::sensor::image::cells::Cells;
use glam::DVec2;
use std::ops::Range;

pub(super) fn centres(spots: &[Spot]) -> Vec<DVec2> {
    spots.iter().map(|s| s.centre).collect()
}

/// Removes spots whose response is low compared with their neighbours or with all spots.
pub(super) fn as_strong_as_their_neighbours(spots: Vec<Spot>) -> Vec<Spot> {
    let mut all: Vec<f64> = spots.iter().map(|s| s.response).collect();
    let floor = 0.03 * quantile(&mut all, 0.9);
    let neighbours = nearest(&centres(&spots), 12);
    let strong = |(spot, near): (&Spot, Vec<usize>)| {
        let near = median_of(&near, |i| spots[i].response);
        let strong = spot.response >= floor && spot.response >= 0.25 * near;
        strong.then_some(*spot)
    };
    spots.iter().zip(neighbours).filter_map(strong).collect()
}

/// Distance from each spot to its nearest neighbour.
pub(super) fn gaps(spots: &[Spot], neighbours: &[Vec<usize>]) -> Vec<f64> {
    let gap = |(spot, near): (&Spot, &Vec<usize>)| {
        near.first()
            .map_or(0.0, |&i| spots[i].centre.distance(spot.centre))
    };
    spots.iter().zip(neighbours).map(gap).collect()
}

/// Splits spots by the mask `keep`. Returns the kept spots and the centres of the others.
fn split(spots: &[Spot], keep: &[bool]) -> (Vec<Spot>, Vec<DVec2>) {
    let others = spots.iter().zip(keep).filter(|(_, keep)| !**keep);
    let others = others.map(|(spot, _)| spot.centre).collect();
    (kept(spots, keep), others)
}

pub(super) fn kept(spots: &[Spot], keep: &[bool]) -> Vec<Spot> {
    let kept = spots.iter().zip(keep);
    kept.filter_map(|(spot, keep)| keep.then_some(*spot))
        .collect()
}

/// Maximum ratio of the responses of neighbouring spots of the same pattern.
const ALIKE: f64 = 3.0;
/// Maximum ratio between the nearest-neighbour distances of neighbouring spots of the same pattern.
const EVEN: f64 = 1.5;

/// Separates the pattern from surrounding texture, such as that of a housing. Returns the spots of the pattern and the
/// centres of the others. Texture spots have less than half the response of the nearest pattern spots and are not
/// connected to the pattern by similar neighbours.
pub(super) fn without_surroundings(spots: Vec<Spot>) -> (Vec<Spot>, Vec<DVec2>) {
    let centres = centres(&spots);
    let neighbours = nearest(&centres, 8);
    let pattern = strongest_component(&spots, &neighbours, &gaps(&spots, &neighbours));
    let members: Vec<usize> = (0..spots.len()).filter(|&i| pattern[i]).collect();
    let places: Vec<DVec2> = members.iter().map(|&i| centres[i]).collect();
    let cells = Cells::new(&places);
    let mut near = Vec::new();
    let mut belongs = |own: usize| {
        if pattern[own] {
            return true;
        }
        cells.nearest(centres[own], 6, &mut near);
        let near: Vec<usize> = near.iter().map(|&(_, i)| members[i]).collect();
        2.0 * spots[own].response >= median_of(&near, |i| spots[i].response)
    };
    let keep: Vec<bool> = (0..spots.len()).map(&mut belongs).collect();
    split(&spots, &keep)
}

/// Returns a mask of the connected component with the largest total response. Edges connect neighbours of similar
/// response and spacing.
fn strongest_component(spots: &[Spot], neighbours: &[Vec<usize>], gaps: &[f64]) -> Vec<bool> {
    let within = |ratio: f64, most: f64| (1.0 / most..most).contains(&ratio);
    let alike = |a: usize, b: usize| {
        within(spots[a].response / spots[b].response, ALIKE)
            && within(gaps[a] / gaps[b], EVEN)
            && neighbours[b].contains(&a)
    };
    let mut component = vec![usize::MAX; spots.len()];
    let mut strongest = (0.0, 0);
    for start in 0..spots.len() {
        if component[start] != usize::MAX {
            continue;
        }
        let (mut open, mut total) = (vec![start], 0.0);
        component[start] = start;
        while let Some(own) = open.pop() {
            total += spots[own].response;
            for &other in &neighbours[own] {
                if component[other] == usize::MAX && alike(own, other) {
                    component[other] = start;
                    open.push(other);
                }
            }
        }
        if total > strongest.0 {
            strongest = (total, start);
        }
    }
    component.iter().map(|&own| own == strongest.1).collect()
}

/// Separates the pattern from specks: spots that differ from their neighbours in size and do not lie midway between two
/// of them. Returns the spots of the pattern and the centres of the specks.
pub(super) fn without_specks(spots: Vec<Spot>) -> (Vec<Spot>, Vec<DVec2>) {
    /// Valid range of a spot's diameter relative to its neighbours.
    const SIZE: Range<f64> = 0.72..1.6;
    /// Maximum distance between a spot and the midpoint of two neighbours for the spot to lie midway, relative to the
    /// spacing.
    const MIDDLE: f64 = 0.4;
    /// Minimum distance of such a spot from all neighbours, relative to the spacing.
    const GAP: f64 = 0.75;
    if spots.len() < PATTERN {
        return (spots, Vec::new());
    }
    let neighbours = nearest(&centres(&spots), 12);
    let gaps = gaps(&spots, &neighbours);
    let about = |own: usize, value: &dyn Fn(usize) -> f64| median_of(&neighbours[own], value);
    let keep = |own: usize| {
        let size = spots[own].diameter / about(own, &|i| spots[i].diameter);
        if SIZE.contains(&size) {
            return true;
        }
        let spacing = about(own, &|i| gaps[i]);
        let place = spots[own].centre;
        let between = neighbours[own].iter().any(|&i| {
            let opposite = 2.0 * place - spots[i].centre;
            let near = spots[i].centre.distance(place) < 1.5 * spacing;
            near && neighbours[own]
                .iter()
                .any(|&j| spots[j].centre.distance(opposite) < MIDDLE * spacing)
        });
        between && gaps[own] > GAP * spacing
    };
    let keep: Vec<bool> = (0..spots.len()).map(keep).collect();
    split(&spots, &keep)
}

/// Minimum number of spots for detecting specks and stray spots.
const PATTERN: usize = 20;

/// Separates the pattern from stray spots. Returns the spots of the pattern and the centres of the others. A stray spot
/// does not continue a row of the pattern and is much farther from its neighbours than they are from each other, or
/// faint, or different from its neighbours and with few of them in a dense pattern.
pub(super) fn without_strays(spots: Vec<Spot>) -> (Vec<Spot>, Vec<DVec2>) {
    /// Contrast relative to the neighbours' below which a spot counts as faint.
    const FAINT: f64 = 0.5;
    /// Maximum distance of a spot from the continuation of a row, relative to the spacing.
    const STRAIGHT: f64 = 0.3;
    if spots.len() < PATTERN {
        return (spots, Vec::new());
    }
    let neighbours = nearest(&centres(&spots), 6);
    let gaps = gaps(&spots, &neighbours);
    let about = |own: usize, value: &dyn Fn(usize) -> f64| median_of(&neighbours[own], value);
    let spacing: Vec<f64> = (0..spots.len()).map(|i| about(i, &|i| gaps[i])).collect();
    let close = |own: usize| {
        let near = |&&i: &&usize| spots[i].centre.distance(spots[own].centre) < 1.5 * spacing[own];
        neighbours[own].iter().filter(near).count()
    };
    let mut counts: Vec<f64> = (0..spots.len()).map(|i| close(i) as f64).collect();
    let closely = median(&mut counts) >= 5.0;
    let unlike = |own: usize| {
        let contrast = spots[own].contrast / about(own, &|i| spots[i].contrast);
        let diameter = spots[own].diameter / about(own, &|i| spots[i].diameter);
        !(0.7..1.4).contains(&contrast) || !(0.85..1.18).contains(&diameter)
    };
    let continues = |own: usize| {
        let near = &neighbours[own];
        let diameter = spots[own].diameter / about(own, &|i| spots[i].diameter);
        let place = spots[own].centre;
        // The spot continues a row: the spot before it is halfway to the one before that.
        let rows = near.iter().filter(|&&next| {
            let beyond = 2.0 * spots[next].centre - place;
            let far = &neighbours[next];
            far.iter()
                .any(|&i| spots[i].centre.distance(beyond) < STRAIGHT * spacing[own])
        });
        (0.7..1.4).contains(&diameter) && rows.count() >= 2
    };
    let faint = |own: usize| spots[own].contrast < FAINT * about(own, &|i| spots[i].contrast);
    let apart = |own: usize| {
        let far = gaps[own] > 1.42 * spacing[own];
        (far || faint(own) || (closely && close(own) < 3 && unlike(own))) && !continues(own)
    };
    let keep: Vec<bool> = (0..spots.len()).map(|i| !apart(i)).collect();
    split(&spots, &keep)
}
