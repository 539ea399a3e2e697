//! Which axes of a force sensor are those of the fingertip.

use glam::{DMat3, DVec3};
use std::fmt;
use std::str::FromStr;

/// From a force sensor's axes to the fingertip's: `z,x,-y` means that x of the fingertip is z of the sensor, its y the sensor's x, and
/// its z against the sensor's y.
///
/// Of a sensor's frame they are a rotation ([`is_rotation`](Self::is_rotation)). Columns of a table may also be mirrored, as an element's
/// `F_z` is compression.
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

    /// Those whose x, y and z are these unit vectors along axes of the sensor.
    pub(crate) fn of_rows([x, y, z]: [DVec3; 3]) -> Self {
        Self(DMat3::from_cols(x, y, z).transpose())
    }

    /// Whether they turn a right-handed frame into one that is right-handed.
    pub fn is_rotation(&self) -> bool {
        self.0.determinant() > 0.0
    }

    /// The opposite axes, as of forces on the other of two bodies.
    pub fn reversed(self) -> Self {
        Self(-self.0)
    }

    /// These axes of forces that `first` has turned.
    pub fn after(self, first: Self) -> Self {
        Self(self.0 * first.0)
    }
}

impl fmt::Display for ForceAxes {
    /// As in `z,x,-y`.
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
        let axes = Self::of_rows(rows);
        match (count, axes.0.determinant()) {
            (3, 1.0 | -1.0) => Ok(axes),
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
            ("x,y", "fewer"),
            ("x,y,z,x", "more"),
            ("x,y,w", "something else"),
            ("", "something else"),
            ("x,x,z", "twice"),
        ] {
            let error = text.parse::<ForceAxes>().unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }
}
