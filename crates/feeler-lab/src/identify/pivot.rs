//! Pivot and radius of the object, from a circle through the tips of the touching elements.

use super::noise::Measured;
use super::trace::FingerTrace;
use feeler::control::Stiffness;
use feeler::control::task::probe::Step;
use glam::{DMat3, DVec2, DVec3};
use std::collections::BTreeMap;

/// Minimum number of contacts for fitting a circle.
const MIN_CONTACTS: usize = 5;
/// Minimum assumed standard deviation of a contact's position (m).
const MIN_DEVIATION: f64 = 2e-5;

/// Circle through the centres of the rounded tips, in the plane perpendicular to the object's axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Circle {
    /// x of the centre in W (m).
    pub x: Measured,
    /// y of the centre in W (m).
    pub y: Measured,
    /// Radius (m).
    pub radius: Measured,
    /// Fitted contacts: index of the finger, and position in the x-y plane of W (m).
    pub points: Vec<(usize, DVec2)>,
}

impl Circle {
    /// Centre in the x-y plane of W (m).
    pub fn centre(&self) -> DVec2 {
        DVec2::new(self.x.value, self.y.value)
    }
}

/// Tip of `element`, displaced by the force on it, in W (m).
pub fn pushed_tip(trace: &FingerTrace, row: usize, element: usize, stiffness: Stiffness) -> DVec3 {
    let row = &trace.rows[row];
    let force = row.forces[element];
    let frame = row.pose.rotation * trace.layout.elements[element].rotation;
    row.tip(&trace.layout, element) + frame * stiffness.displacement(force)
}

/// Mean tip position of each contact, that is, of each element at each place.
fn contact_points(
    finger: usize,
    trace: &FingerTrace,
    stiffness: Stiffness,
    least: f64,
) -> Vec<(usize, DVec2)> {
    let mut sums: BTreeMap<(u32, usize), (DVec2, f64)> = BTreeMap::new();
    for (index, row) in trace.rows.iter().enumerate() {
        if !(Step::Press as u8..=Step::Slide as u8).contains(&(row.step as u8)) {
            continue;
        }
        for element in (0..row.forces.len()).filter(|&e| row.forces[e].z >= least) {
            let tip = pushed_tip(trace, index, element, stiffness).truncate();
            let sum = sums.entry((row.place, element)).or_default();
            *sum = (sum.0 + tip, sum.1 + 1.0);
        }
    }
    let means = sums.into_values().filter(|sum| sum.1 >= 10.0);
    means.map(|(sum, count)| (finger, sum / count)).collect()
}

/// Fits a circle to the contacts of all fingers that are pressed with at least the given force (N). Returns `None` if
/// they do not determine a circle.
///
/// An algebraic fit is refined by a geometric one with the Gauss-Newton method. Each contact is one observation
/// because the errors of its samples are correlated.
pub fn circle(fingers: &[(&FingerTrace, Stiffness, f64)]) -> Option<Circle> {
    let points: Vec<(usize, DVec2)> = fingers
        .iter()
        .enumerate()
        .flat_map(|(finger, &(trace, stiffness, least))| {
            contact_points(finger, trace, stiffness, least)
        })
        .collect();
    fit_circle(points)
}

/// Fits a circle to `points`, each with the index of its finger; see [`circle`].
pub fn fit_circle(points: Vec<(usize, DVec2)>) -> Option<Circle> {
    if points.len() < MIN_CONTACTS {
        return None;
    }
    let count = points.len() as f64;
    let origin = points.iter().map(|p| p.1).sum::<DVec2>() / count;
    let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
    for (_, point) in &points {
        let p = *point - origin;
        let row = p.extend(1.0);
        normal += DMat3::from_cols(row * row.x, row * row.y, row);
        right += row * p.length_squared();
    }
    let algebraic = solve(normal, right)?;
    let mut centre = 0.5 * algebraic.truncate();
    let mut radius = (algebraic.z + centre.length_squared()).max(0.0).sqrt();
    let mut inverse = DMat3::ZERO;
    for _ in 0..20 {
        let (mut normal, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for (_, point) in &points {
            let from_centre = *point - origin - centre;
            let row = from_centre.normalize_or_zero().extend(1.0);
            normal += DMat3::from_cols(row * row.x, row * row.y, row);
            right += row * (from_centre.length() - radius);
        }
        let step = solve(normal, right)?;
        inverse = normal.inverse();
        centre += step.truncate();
        radius += step.z;
    }
    let misses = points
        .iter()
        .map(|(_, p)| (p.distance(origin + centre) - radius).powi(2));
    let variance = misses.sum::<f64>() / (count - 3.0).max(1.0) + MIN_DEVIATION.powi(2);
    let measured = |value: f64, unit: f64| Measured {
        value,
        deviation: (variance * unit).max(0.0).sqrt(),
    };
    let middle = origin + centre;
    let finite = middle.is_finite() && radius.is_finite();
    finite.then(|| Circle {
        x: measured(middle.x, inverse.x_axis.x),
        y: measured(middle.y, inverse.y_axis.y),
        radius: measured(radius, inverse.z_axis.z),
        points,
    })
}

fn solve(normal: DMat3, right: DVec3) -> Option<DVec3> {
    let scale = normal.x_axis.x * normal.y_axis.y * normal.z_axis.z;
    (normal.determinant() > 1e-12 * scale).then(|| normal.inverse() * right)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_on_a_circle_are_fitted_exactly() {
        let centre = DVec2::new(0.0003, -0.0002);
        let on = |finger: usize, angle: f64| {
            (
                finger,
                centre + 0.016 * DVec2::new(angle.cos(), angle.sin()),
            )
        };
        let angles = [-0.2, 0.0, 0.2];
        let points = angles.map(|a| on(0, a)).into_iter();
        let points = points.chain(angles.map(|a| on(1, std::f64::consts::PI + a)));
        let circle = fit_circle(points.collect()).expect("a circle");
        assert!(circle.centre().distance(centre) < 1e-9, "{circle:?}");
        assert!((circle.radius.value - 0.016).abs() < 1e-9, "{circle:?}");
    }

    #[test]
    fn points_on_a_line_do_not_determine_a_circle() {
        let points = (0..6).map(|index| (0, DVec2::new(0.001 * f64::from(index), 0.0)));
        assert_eq!(fit_circle(points.collect()), None);
        assert_eq!(fit_circle(Vec::new()), None);
    }
}
