//! Validates layouts, which may come from handwritten files.

use super::{DomeGeometry, LayoutError, LocatedLayout, MAX_LOCATED_ELEMENTS};
use crate::sensor::fingertip::dome::DomeProjection;

/// Maximum width and height of an image, px.
const MAX_SIDE: usize = 1 << 14;
/// Maximum number of pixels of an image.
const MAX_PIXELS: usize = 1 << 26;

impl LocatedLayout {
    /// Rejects a layout from which moments cannot be computed.
    pub(super) fn check(&self) -> Result<(), LayoutError> {
        let unusable = |name: &str, expected: &str, actual: String| {
            Err(LayoutError::Unusable {
                name: name.into(),
                expected: expected.into(),
                actual,
            })
        };
        let (width, height) = (self.width, self.height);
        let sides = 1..=MAX_SIDE;
        if !(sides.contains(&width) && sides.contains(&height) && width * height <= MAX_PIXELS) {
            let expected = format!("1 to {MAX_SIDE} px per side and at most {MAX_PIXELS} px");
            return unusable("width, height", &expected, format!("{width}x{height} px"));
        }
        let diameters = 1e-3..=width.max(height) as f64;
        if let Some(diameter) = self.spot_diameter_px.filter(|d| !diameters.contains(d)) {
            let expected = "a diameter above 0 and within the image";
            return unusable("spot_diameter_px", expected, diameter.to_string());
        }
        let actual = self.elements.len();
        if !(1..=MAX_LOCATED_ELEMENTS).contains(&actual) {
            return Err(LayoutError::ElementCount { actual });
        }
        for (index, element) in self.elements.iter().enumerate() {
            let (centre, radius) = (element.centre_px, element.radius_px);
            let inside =
                (0.0..width as f64).contains(&centre.x) && (0.0..height as f64).contains(&centre.y);
            let name = |field: &str| format!("element {index}: {field}");
            if !inside {
                let expected = format!("a position in the image of {width}x{height} px");
                return unusable(&name("centre_px"), &expected, centre.to_string());
            }
            if !(radius > 0.0 && radius <= width.max(height) as f64) {
                let expected = "a radius above 0 and within the image";
                return unusable(&name("radius_px"), expected, radius.to_string());
            }
            match element.direction {
                Some(d) if !d.is_finite() || (d.length() - 1.0).abs() > 1e-6 => {
                    return unusable(&name("direction"), "a unit vector", d.to_string());
                }
                None if self.dome.is_some() => {
                    let expected = "a unit vector, required with a dome";
                    return unusable(&name("direction"), expected, "none".into());
                }
                _ => {}
            }
        }
        self.dome.as_ref().map_or(Ok(()), |dome| {
            DomeProjection::new(&dome.camera, dome.radius)?;
            self.check_camera(dome)
        })
    }

    /// Rejects a dome whose camera has another image size than the layout.
    pub(super) fn check_camera(&self, dome: &DomeGeometry) -> Result<(), LayoutError> {
        let camera = &dome.camera;
        if (camera.width, camera.height) == (self.width, self.height) {
            return Ok(());
        }
        Err(LayoutError::Unusable {
            name: "dome.camera: width, height".into(),
            expected: format!("{}x{} px as in the layout", self.width, self.height),
            actual: format!("{}x{} px", camera.width, camera.height),
        })
    }
}
