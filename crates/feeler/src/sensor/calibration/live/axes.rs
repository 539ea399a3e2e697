//! Mapping from the axes of a force sensor to those of the fingertip.

use glam::{DMat3, DVec3};
use std::fmt;
use std::str::FromStr;

/// Maps a force sensor's axes to the fingertip's. `z,x,-y` means that x of the fingertip is z of the sensor, y is the
/// sensor's x, and z is opposite to the sensor's y.
///
/// For a sensor's frame the mapping must be a rotation ([`is_rotation`](Self::is_rotation)). The columns of a table
/// may also be mirrored, as an element's `F_z` is compression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceAxes(DMat3);

/// Error of parsing [`ForceAxes`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{text:?} {what}; expected three axes of the force sensor, as in \"x,y,z\" or \"z,x,-y\"")]
pub struct ParseAxesError {
    text: String,
    what: &'static str,
}

impl Default for ForceAxes {
    fn default() -> Self {
        Self(DMat3::IDENTITY)
    }
}

impl ForceAxes {
    /// Converts a force (N) from the sensor's frame to the fingertip's.
    pub fn to_fingertip(&self, force: DVec3) -> DVec3 {
        self.0 * force
    }

    /// Creates axes from the unit vectors of x, y and z in the sensor's frame.
    pub(crate) fn of_rows([x, y, z]: [DVec3; 3]) -> Self {
        Self(DMat3::from_cols(x, y, z).transpose())
    }

    /// Returns whether the mapping preserves right-handedness.
    pub fn is_rotation(&self) -> bool {
        self.0.determinant() > 0.0
    }

    /// Mapping with all axes negated, such as from the force on one body to the reaction force on the other.
    pub fn reversed(self) -> Self {
        Self(-self.0)
    }

    /// Composition of two mappings: applies `first`, then `self`.
    pub fn after(self, first: Self) -> Self {
        Self(self.0 * first.0)
    }
}

impl fmt::Display for ForceAxes {
    /// Formats the axes, such as `z,x,-y`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let axes = self.0.transpose();
        for (separator, axis) in
            ["", ",", ","]
                .into_iter()
                .zip([axes.x_axis, axes.y_axis, axes.z_axis])
        {
            let name = ["x", "y", "z"][axis.abs().max_position()];
            let sign = if axis.element_sum() < 0.0 { "-" } else { "" };
            write!(f, "{separator}{sign}{name}")?;
        }
        Ok(())
    }
}

impl FromStr for ForceAxes {
    type Err = ParseAxesError;

    fn from_str(text: &str) -> Result<Self, ParseAxesError> {
        let wrong = |what| ParseAxesError {
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
                _ => return Err(wrong("contains an axis other than x, y and z")),
            };
            let row = rows
                .get_mut(count)
                .ok_or_else(|| wrong("has too many axes"))?;
            *row = sign * axis;
            count += 1;
        }
        let axes = Self::of_rows(rows);
        match (count, axes.0.determinant()) {
            (3, 1.0 | -1.0) => Ok(axes),
            (3, _) => Err(wrong("contains an axis twice")),
            _ => Err(wrong("has too few axes")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_rotate_forces_and_invalid_ones_are_refused() {
        let force = DVec3::new(1.0, 2.0, 3.0);
        for (text, turned) in [
            ("x,y,z", force),
            ("z, x, y", DVec3::new(3.0, 1.0, 2.0)),
            ("x,-z,y", DVec3::new(1.0, -3.0, 2.0)),
            ("y,x,-z", DVec3::new(2.0, 1.0, -3.0)),
        ] {
            assert_eq!(
                text.parse::<ForceAxes>().unwrap().to_fingertip(force),
                turned
            );
        }
        let [rotation, mirrored] =
            ["z,x,y", "y,x,z"].map(|text| text.parse::<ForceAxes>().unwrap());
        assert!(
            rotation.is_rotation() && !mirrored.is_rotation() && mirrored.reversed().is_rotation()
        );
        assert_eq!(ForceAxes::default().reversed().to_fingertip(force), -force);
        let both = rotation.after(mirrored);
        assert_eq!(
            both.to_fingertip(force),
            rotation.to_fingertip(mirrored.to_fingertip(force))
        );
        assert_eq!(
            [rotation, mirrored.reversed(), both].map(|axes| axes.to_string()),
            ["z,x,y", "-y,-x,-z", "z,y,x"]
        );
        for (text, words) in [
            ("x,y", "too few"),
            ("x,y,z,x", "too many"),
            ("x,y,w", "other than"),
            ("", "other than"),
            ("x,x,z", "twice"),
        ] {
            let error = text.parse::<ForceAxes>().unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
