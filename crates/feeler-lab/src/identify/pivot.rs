//! Pivot and radius of the object: a circle through the tips of the touching elements.

use super::noise::Measured;
use super::trace::FingerTrace;
use feeler::control::feeler_shape::Stiffness;
use feeler::control::task::probe::Step;
use glam::{DMat3, DVec2, DVec3};
use std::collections::BTreeMap;

/// Least number of contacts that determine a circle.
const LEAST_CONTACTS: usize = 5;
/// Standard deviation of a contact's place that is assumed at least, m.
const LEAST_DEVIATION: f64 = 2e-5;

/// Circle on which the centres of the rounded tips lie, along the object's axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Circle {
    /// Its centre, m, x and y in W.
    pub x: Measured,
    /// See `x`.
    pub y: Measured,
    /// Its radius, m.
    pub radius: Measured,
    /// The contacts that it was fitted to, m, x and y in W, by finger.
    pub points: Vec<(usize, DVec2)>,
}

impl Circle {
    /// Its centre, m, x and y in W.
    pub fn centre(&self) -> DVec2 {
        DVec2::new(self.x.value, self.y.value)
    }
}

/// Tip of `element` where the force on it has pushed it, m, in W.
pub fn pushed_tip(trace: &FingerTrace, row: usize, element: usize, stiffness: Stiffness) -> DVec3 {
    let row = &trace.rows[row];
    let force = row.forces[element];
    let frame = row.pose.rotation * trace.layout.elements[element].rotation;
    row.tip(&trace.layout, element) + frame * stiffness.displacement(force)
}

/// The mean tip of each contact: of one element at one place.
fn contact_points(
    (finger, trace): (usize, &FingerTrace),
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

/// Fits the circle to the contacts of all fingers that are pressed with at least `least`, N; `None` if they do not determine it.
///
/// Algebraic fit first, then the geometric one by Gauss and Newton. Each contact is one observation, as the errors of its
/// samples are not independent.
pub fn circle(fingers: &[(&FingerTrace, Stiffness, f64)]) -> Option<Circle> {
    let points: Vec<(usize, DVec2)> = fingers
        .iter()
        .enumerate()
        .flat_map(|(finger, &(trace, stiffness, least))| {
            contact_points((finger, trace), stiffness, least)
        })
        .collect();
    fit_circle(points)
}

/// Fits a circle to `points`, each with its finger; see [`circle`].
pub fn fit_circle(points: Vec<(usize, DVec2)>) -> Option<Circle> {
    if points.len() < LEAST_CONTACTS {
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
    let variance = misses.sum::<f64>() / (count - 3.0).max(1.0) + LEAST_DEVIATION.powi(2);
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
    fn points_on_a_circle_give_it_back() {
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
    fn points_on_a_line_give_no_circle() {
        let points = (0..6).map(|index| (0, DVec2::new(0.001 * f64::from(index), 0.0)));
        assert_eq!(fit_circle(points.collect()), None);
        assert_eq!(fit_circle(Vec::new()), None);
    }
}
