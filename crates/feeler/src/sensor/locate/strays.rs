//! Separates the spots of the pattern from specks, reflections and strays.

use super::{median, nearest, quantile, spot::Spot};
use crate::sensor::image::cells::Cells;
use glam::DVec2;

/// Keeps the strongest of overlapping spots.
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
    let kept = spots.into_iter().zip(kept);
    kept.filter_map(|(spot, kept)| kept.then_some(spot))
        .collect()
}

fn centres(spots: &[Spot]) -> Vec<DVec2> {
    spots.iter().map(|s| s.centre).collect()
}

/// Removes spots that are faint compared with their neighbours or with all spots.
pub(super) fn as_strong_as_their_neighbours(spots: Vec<Spot>) -> Vec<Spot> {
    let mut all: Vec<f64> = spots.iter().map(|s| s.response).collect();
    let floor = 0.03 * quantile(&mut all, 0.9);
    let neighbours = nearest(&centres(&spots), 12);
    let strong = |(spot, near): (&Spot, Vec<usize>)| {
        let mut near: Vec<f64> = near.iter().map(|&i| spots[i].response).collect();
        let strong = spot.response >= floor && spot.response >= 0.25 * median(&mut near);
        strong.then_some(*spot)
    };
    spots.iter().zip(neighbours).filter_map(strong).collect()
}

/// Distance from each spot to its nearest neighbour.
fn gaps(spots: &[Spot], neighbours: &[Vec<usize>]) -> Vec<f64> {
    let gap = |(spot, near): (&Spot, &Vec<usize>)| {
        near.first()
            .map_or(0.0, |&i| spots[i].centre.distance(spot.centre))
    };
    spots.iter().zip(neighbours).map(gap).collect()
}

/// Removes the weaker of two spots that are unusually close to each other, such as a speck beside a pin.
pub(super) fn without_crowding(spots: Vec<Spot>) -> Vec<Spot> {
    let neighbours = nearest(&centres(&spots), 9);
    let gaps = gaps(&spots, &neighbours);
    let crowded = |(own, near): (usize, &Vec<usize>)| {
        let mut about: Vec<f64> = near.iter().skip(1).map(|&i| gaps[i]).collect();
        let beside_stronger = near
            .first()
            .is_some_and(|&i| spots[i].response >= spots[own].response);
        beside_stronger && about.len() >= 8 && gaps[own] < 0.62 * median(&mut about)
    };
    let keep: Vec<bool> = neighbours.iter().enumerate().map(|n| !crowded(n)).collect();
    let kept = spots
        .iter()
        .zip(keep)
        .filter_map(|(s, keep)| keep.then_some(*s));
    kept.collect()
}

/// Splits spots into the pattern and the centres of strays. A stray is much farther from its neighbours than they are
/// from each other, or faint, or unlike its neighbours and with few of them although the pattern is dense.
pub(super) fn without_strays(spots: Vec<Spot>) -> (Vec<Spot>, Vec<DVec2>) {
    /// Minimum number of spots in a pattern; fewer have no strays.
    const PATTERN: usize = 20;
    /// A spot with less than this fraction of its neighbours' contrast must continue the pattern.
    const FAINT: f64 = 0.5;
    /// Maximum distance of a spot from the continuation of a row, over the spacing.
    const STRAIGHT: f64 = 0.3;
    if spots.len() < PATTERN {
        return (spots, Vec::new());
    }
    let neighbours = nearest(&centres(&spots), 6);
    let gaps = gaps(&spots, &neighbours);
    let about = |own: usize, value: &dyn Fn(usize) -> f64| {
        let mut values: Vec<f64> = neighbours[own].iter().map(|&i| value(i)).collect();
        median(&mut values)
    };
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
    let (strays, kept): (Vec<usize>, Vec<usize>) = (0..spots.len()).partition(|&i| apart(i));
    (
        kept.iter().map(|&i| spots[i]).collect(),
        strays.iter().map(|&i| spots[i].centre).collect(),
    )
}
