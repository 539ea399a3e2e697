//! The outline drawn by a contour task, and the true outline.

use super::series::finite;
use feeler_record::{FindingName, Recording};
use glam::DVec2;

/// Surface points that the hand found along the outline, in W (m), with their times (s).
pub fn drawn(recording: &Recording) -> Vec<(f64, DVec2)> {
    let points = recording.findings.iter().filter_map(|found| {
        let value = |name: FindingName| finite(found.value(&name)?);
        let point = DVec2::new(value(FindingName::SurfaceX)?, value(FindingName::SurfaceY)?);
        Some((found.stamp, point))
    });
    points.collect()
}

/// True section as a closed path in W (m).
pub fn section(recording: &Recording) -> Vec<DVec2> {
    let points = recording.facts.section.iter();
    let mut path: Vec<_> = points.map(|&point| DVec2::from_array(point)).collect();
    path.extend(path.first().copied());
    path
}
