//! The outline that a contour task drew, and the true one.

use super::series::finite;
use feeler_record::{FindingName, Recording};
use glam::DVec2;

/// The points that were drawn, with their times, s; m, in W.
pub fn drawn(recording: &Recording) -> Vec<(f64, DVec2)> {
    let points = recording.findings.iter().filter_map(|found| {
        let value = |name: FindingName| finite(found.value(&name)?);
        let point = DVec2::new(value(FindingName::SurfaceX)?, value(FindingName::SurfaceY)?);
        Some((found.stamp, point))
    });
    points.collect()
}

/// The true section as a closed path, m, in W.
pub fn section(recording: &Recording) -> Vec<DVec2> {
    let points = recording.facts.section.iter();
    let mut path: Vec<_> = points.map(|&point| DVec2::from_array(point)).collect();
    path.extend(path.first().copied());
    path
}
