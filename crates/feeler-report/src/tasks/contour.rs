//! Report of the contour task: the drawn outline compared with the true section.

use super::task_report::TaskReport;
use crate::figures::{Figure, outline};
use crate::measures::claim::{Claim, part};
use crate::measures::contour_points::{drawn, section};
use crate::measures::paths::{MM, Polyline};
use crate::measures::series::{maximum, rms};
use crate::measures::strokes::StrokeMeasures;
use crate::run::data::RunData;
use feeler_record::{Recording, TaskOutcome};
use glam::DVec2;

/// Maximum RMS error of the outline (m).
const RMS_ERROR: f64 = 0.5e-3;
/// Maximum duration of a loss of contact (s).
const LOST_TIME: f64 = 0.1;
/// Maximum distance between a corner and the outline for the corner to count as passed (m): three times the allowed RMS
/// error.
const CORNER_DISTANCE: f64 = 1.5e-3;
/// Maximum distance of any point of the section from the outline (m); ensures that the outline covers the whole
/// section.
const GREATEST_GAP: f64 = 1.5e-3;
/// Minimum change of direction within [`CORNER_LENGTH`] at a corner of the section (rad).
const CORNER_ANGLE: f64 = 0.5;
/// Length of a corner, see [`CORNER_ANGLE`] (m).
const CORNER_LENGTH: f64 = 0.4e-3;

/// Corners of a closed path: the midpoints of sharp bends.
fn corners(section: &[DVec2]) -> Vec<DVec2> {
    let Some(ring) = section.len().checked_sub(1).filter(|&count| count > 2) else {
        return Vec::new();
    };
    let length: f64 = section
        .windows(2)
        .map(|pair| pair[0].distance(pair[1]))
        .sum();
    let reach = (CORNER_LENGTH / length * ring as f64).ceil() as usize;
    let at = |place: usize| section[place % ring];
    let turn = |place: usize| {
        let (before, here, after) = (at(place + ring - reach), at(place), at(place + reach));
        (here - before).angle_to(after - here).abs()
    };
    let turns: Vec<_> = (0..ring).map(turn).collect();
    let sharpest = |place: &usize| {
        let near = (ring - reach..=ring + reach).map(|offset| (place + offset) % ring);
        let largest = near.map(|other| turns[other]).fold(0.0, f64::max);
        turns[*place] > CORNER_ANGLE && turns[*place] >= largest
    };
    let mut found: Vec<DVec2> = Vec::new();
    for place in (0..ring).filter(sharpest) {
        let corner = at(place);
        // Neighbouring points with equal bends are one corner.
        if found
            .iter()
            .all(|other| other.distance(corner) > CORNER_LENGTH)
        {
            found.push(corner);
        }
    }
    found
}

/// Longest time without touch while tracing the outline (s).
fn longest_loss(data: &RunData) -> Option<f64> {
    Some(data.longest_loss? as f64 * data.facts.control_period)
}

/// Report of the contour task.
pub struct ContourReport;

impl TaskReport for ContourReport {
    fn claims(&self, recording: &Recording, data: &RunData, _: &[StrokeMeasures]) -> Vec<Claim> {
        claims(recording, data)
    }

    fn figures(&self, recording: &Recording, data: &RunData) -> Vec<Figure> {
        outline::figures(recording, data)
    }
}

/// Claims about the task.
fn claims(recording: &Recording, data: &RunData) -> Vec<Claim> {
    let section = section(recording);
    let drawn: Vec<_> = drawn(recording).into_iter().map(|(_, p)| p).collect();
    let known = section.len() > 1 && !drawn.is_empty();
    let known = |value: Option<f64>| value.filter(|_| known);
    let outline = Polyline::new(&section);
    let errors = || drawn.iter().map(|&point| outline.distance(point));
    let nearest = |point: DVec2| {
        drawn
            .iter()
            .map(|d| d.distance(point))
            .fold(f64::INFINITY, f64::min)
    };
    let corners = corners(&section);
    let passed = corners
        .iter()
        .filter(|&&corner| nearest(corner) <= CORNER_DISTANCE);
    let closed = recording
        .findings
        .last()
        .map(|found| f64::from(u8::from(found.outcome == Some(TaskOutcome::Closed))));
    let millimetres = |value: Option<f64>| known(value).map(|v| MM * v);
    let gap = maximum(section.iter().map(|&point| nearest(point)));
    vec![
        Claim::new(
            "outline-closed",
            "The finger follows the whole outline and detects that it is closed.",
            vec![
                part("closed").equals(closed, 1.0),
                part("maximum distance of the section from the outline")
                    .in_unit("mm")
                    .at_most(millimetres(gap), MM * GREATEST_GAP),
            ],
        ),
        Claim::new(
            "outline-true",
            "The outline matches the object's section.",
            vec![
                part("RMS error")
                    .in_unit("mm")
                    .at_most(millimetres(rms(errors())), MM * RMS_ERROR),
            ],
        ),
        Claim::new(
            "corners-passed",
            "Every corner is passed.",
            vec![
                part("corners passed")
                    .equals(known(Some(passed.count() as f64)), corners.len() as f64),
            ],
        ),
        Claim::new(
            "contact-kept",
            "The finger keeps contact with the object.",
            vec![
                part("longest time without touch")
                    .in_unit("s")
                    .at_most(longest_loss(data), LOST_TIME),
            ],
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn closed(mut path: Vec<DVec2>) -> Vec<DVec2> {
        path.push(path[0]);
        path
    }

    #[test]
    fn a_square_has_four_corners_and_a_circle_none() {
        let corners_of = |ends: [DVec2; 4]| {
            let sides = (0..4).flat_map(|side| {
                let (from, to) = (ends[side], ends[(side + 1) % 4]);
                (0..200).map(move |step| from.lerp(to, f64::from(step) / 200.0))
            });
            corners(&closed(sides.collect()))
        };
        let ends = [(0.01, 0.01), (-0.01, 0.01), (-0.01, -0.01), (0.01, -0.01)];
        let found = corners_of(ends.map(DVec2::from));
        assert_eq!(found.len(), 4, "{found:?}");
        assert!(
            ends.iter()
                .all(|&end| found.iter().any(|f| f.distance(end.into()) < 1e-9))
        );

        let circle = (0..800).map(|i| 0.01 * DVec2::from_angle(TAU * f64::from(i) / 800.0));
        assert_eq!(corners(&closed(circle.collect())), []);
    }

    #[test]
    fn no_section_has_no_corners() {
        assert_eq!(corners(&[]), []);
        assert_eq!(corners(&[DVec2::ZERO, DVec2::X]), []);
    }
}
