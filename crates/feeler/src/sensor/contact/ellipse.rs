//! Extent of a contact in its tangent plane.

use glam::{DVec2, DVec3};

/// Ratio of a squared semi-axis to the pressure's second moment along it, for Hertzian pressure p ~ sqrt(1 - r²).
const HERTZ: f64 = 5.0;

/// Contact area: an ellipse with the second moments of the measured pressure.
///
/// The semi-axes assume the pressure distribution of an elastic contact (Hertz; K. L. Johnson, *Contact Mechanics*,
/// 1985, section 4.2). They are 12 % too long if the pressure is uniform, and 9 % too short if it is parabolic, as on
/// an elastic foundation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactEllipse {
    /// Semi-axes, m; the longer one first.
    pub semi_axes: [f64; 2],
    /// Standard errors of the semi-axes, m. About 90 % of deviations are within two standard errors.
    pub errors: [f64; 2],
    /// Direction of the longer semi-axis, a unit vector in the fingertip frame `T`. Its sign is arbitrary.
    pub direction: DVec3,
}

impl ContactEllipse {
    /// Area of the contact, m².
    pub fn area(&self) -> f64 {
        std::f64::consts::PI * self.semi_axes[0] * self.semi_axes[1]
    }

    /// Standard error of the area, m².
    pub fn area_error(&self) -> f64 {
        let relative = (0..2).map(|i| self.errors[i] / self.semi_axes[i]);
        self.area() * relative.fold(0.0, libm::hypot)
    }
}

/// Element in the tangent plane of the contact.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Position relative to the centre, m.
    pub position: DVec2,
    /// Compression relative to the total compression of the contact.
    pub weight: f64,
    /// Squared distance to the nearest element, m².
    pub cell_area: f64,
}

/// Variance of the position within a square cell with sides of 1 (Sheppard's correction of moments of grouped data).
pub(super) const CELL_VARIANCE: f64 = 1.0 / 12.0;

/// Maximum ratio of the second moments across and along a line of elements; above zero because of rounding.
const ON_A_LINE: f64 = 1e-6;

/// Contact ellipse, or `None` if the elements do not resolve it: if fewer than three are in contact, if they lie on a
/// line, or if one of them carries nearly the entire force. `tangents` are the axes of positions in `T`, `touching` is
/// the number of elements in contact, and `noise` the standard error of each weight.
pub(super) fn ellipse(
    elements: impl Iterator<Item = Sample> + Clone,
    tangents: (DVec3, DVec3),
    touching: usize,
    noise: f64,
) -> Option<ContactEllipse> {
    if touching < 3 {
        return None;
    }
    let mean =
        |f: &dyn Fn(&Sample) -> f64| -> f64 { elements.clone().map(|s| s.weight * f(&s)).sum() };
    let within = CELL_VARIANCE * mean(&|s| s.cell_area);
    let [xx, xy, yy] = [
        mean(&|s| s.position.x * s.position.x),
        mean(&|s| s.position.x * s.position.y),
        mean(&|s| s.position.y * s.position.y),
    ];
    let (middle, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let radius = libm::hypot(half, xy);
    let angle = 0.5 * libm::atan2(xy, half);
    let along = DVec2::new(libm::cos(angle), libm::sin(angle));
    let square = |value: f64| value * value;
    let variance = |lever: &dyn Fn(DVec2) -> f64| -> f64 {
        let levers = elements.clone().map(|s| square(lever(s.position)));
        noise * noise * levers.sum::<f64>()
    };
    // Noise across the axes makes the longer one longer and the shorter one shorter, most in a round contact.
    let across = variance(&|position| position.dot(along) * position.dot(along.perp()));
    let split = across / libm::sqrt(across).max(2.0 * radius).max(f64::MIN_POSITIVE);
    let axis = |moment: f64, axis: DVec2| {
        // Smaller moments describe the cells rather than the contact, or elements on a line. False for NaN.
        if !(moment > 2.0 * within.max(0.0) && moment > ON_A_LINE * (middle + radius)) {
            return None;
        }
        let semi_axis = libm::sqrt(HERTZ * (moment - within));
        let noise = variance(&|position| square(position.dot(axis)) - moment);
        let grouping = within * within / touching as f64;
        let error = libm::sqrt(noise + grouping + split * split);
        Some((semi_axis, 0.5 * HERTZ / semi_axis * error))
    };
    let (long, long_error) = axis(middle + radius, along)?;
    let (short, short_error) = axis(middle - radius, along.perp())?;
    Some(ContactEllipse {
        semi_axes: [long, short],
        errors: [long_error, short_error],
        direction: along.x * tangents.0 + along.y * tangents.1,
    })
}
