//! Which axes of a force sensor are those of the fingertip.

use glam::{DMat3, DVec3};
use std::str::FromStr;

/// Rotation from a force sensor's frame to the fingertip's, by axes: `z,x,-y` says that x of the fingertip is z of the sensor, its y
/// the sensor's x, and its z against the sensor's y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceAxes(DMat3);

/// Why a text names no axes.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{text:?} {what}; expected three axes of the force sensor, as in \"x,y,z\" or \"z,x,-y\"")]
pub struct AxesError {
    text: String,
    what: &'static str,
}

impl Default for ForceAxes {
    fn default() -> Self {
        Self(DMat3::IDENTITY)
    }
}

impl ForceAxes {
    /// A force (N) in the sensor's frame, in the fingertip's.
    pub fn to_fingertip(&self, force: DVec3) -> DVec3 {
        self.0 * force
    }
}

impl FromStr for ForceAxes {
    type Err = AxesError;

    fn from_str(text: &str) -> Result<Self, AxesError> {
        let wrong = |what| AxesError {
            text: text.into(),
            what,
        };
        let mut rows = [DVec3::ZERO; 3];
        let mut count = 0;
        for name in text.split(',') {
            let (sign, axis) = match name.trim().strip_prefix('-') {
                Some(axis) => (-1.0, axis),
                None => (1.0, name.trim()),
            };
            let axis = match axis {
                "x" => DVec3::X,
                "y" => DVec3::Y,
                "z" => DVec3::Z,
                _ => return Err(wrong("names something else than x, y and z")),
            };
            let row = rows
                .get_mut(count)
                .ok_or_else(|| wrong("names more axes"))?;
            *row = sign * axis;
            count += 1;
        }
        let rotation = DMat3::from_cols_array_2d(&rows.map(|row| row.to_array())).transpose();
        match (count, rotation.determinant()) {
            (3, 1.0) => Ok(Self(rotation)),
            (3, -1.0) => Err(wrong("is left-handed: a sign or the order is wrong")),
            (3, _) => Err(wrong("names an axis twice")),
            _ => Err(wrong("names fewer axes")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_turn_forces_and_others_are_refused() {
        let force = DVec3::new(1.0, 2.0, 3.0);
        for (text, turned) in [
            ("x,y,z", force),
            ("z, x, y", DVec3::new(3.0, 1.0, 2.0)),
            ("x,-z,y", DVec3::new(1.0, -3.0, 2.0)),
        ] {
            assert_eq!(
                text.parse::<ForceAxes>().unwrap().to_fingertip(force),
                turned
            );
        }
        for (text, words) in [
            ("x,y", "fewer"),
            ("x,y,z,x", "more"),
            ("x,y,w", "something else"),
            ("", "something else"),
            ("x,x,z", "twice"),
            ("y,x,z", "left-handed"),
        ] {
            let error = text.parse::<ForceAxes>().unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
