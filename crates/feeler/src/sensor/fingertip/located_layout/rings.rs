//! Sorts elements located on a dome in the order of a designed layout, so that indices persist between images.

use super::ElementPlace;
use glam::DVec3;
use std::f64::consts::TAU;

/// Sorts elements by ring and azimuth. A new ring starts if the polar angle increases by more than a third of the
/// typical spacing.
pub(super) fn sort_into_rings(elements: &mut [ElementPlace]) {
    let axis = |e: &ElementPlace| e.direction.unwrap_or(DVec3::X);
    let polar = |e: &ElementPlace| libm::acos(axis(e).x.clamp(-1.0, 1.0));
    elements.sort_by(|a, b| polar(a).total_cmp(&polar(b)));
    let directions: Vec<DVec3> = elements.iter().map(axis).collect();
    let nearest = |(own, d): (usize, &DVec3)| {
        let others = directions
            .iter()
            .enumerate()
            .filter(|(other, _)| *other != own);
        others
            .map(|(_, o)| o.angle_between(*d))
            .fold(f64::INFINITY, f64::min)
    };
    let mut angles: Vec<f64> = directions.iter().enumerate().map(nearest).collect();
    angles.sort_by(f64::total_cmp);
    let step = angles.get(angles.len() / 2).copied().unwrap_or(0.0) / 3.0;
    let (mut ring, mut last) = (0, None);
    for element in elements.iter_mut() {
        let polar = polar(element);
        if last.is_some_and(|last| polar - last > step) {
            ring += 1;
        }
        last = Some(polar);
        element.ring = Some(ring);
    }
    // Tolerates noise around azimuth 0, so that the element at y of `T` always comes first.
    let azimuth = |e: &ElementPlace| {
        let d = axis(e);
        (libm::atan2(d.z, d.y) + 0.25 * step).rem_euclid(TAU)
    };
    elements.sort_by(|a, b| a.ring.cmp(&b.ring).then(azimuth(a).total_cmp(&azimuth(b))));
}
