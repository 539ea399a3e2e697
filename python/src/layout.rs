//! Locates the sensing elements in images.

use crate::errors::{failed, refused};
use crate::interrupt::interruptible;
use feeler::sensor::fingertip::{DomeGeometry, LocatedLayout};
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{LocateConfig, MeanPicture, Polarity, locate};
use feeler_lab::config::Experiment;
use numpy::{PyArray1, PyArray2, PyReadonlyArray3, PyUntypedArrayMethods as _};
use pyo3::prelude::*;

/// Positions of a sensor's elements in its images.
#[pyclass(frozen, module = "feeler._core")]
pub struct Layout {
    pub layout: LocatedLayout,
    warnings: Vec<String>,
}

#[pymethods]
impl Layout {
    /// Parses the layout in `text` (TOML); `warnings` are those about the images from which it was located.
    #[staticmethod]
    #[pyo3(signature = (text, warnings = Vec::new()))]
    fn parse(text: &str, warnings: Vec<String>) -> PyResult<Self> {
        Ok(Self {
            layout: LocatedLayout::from_toml(text).map_err(refused)?,
            warnings,
        })
    }

    fn to_toml(&self) -> PyResult<String> {
        self.layout.to_toml().map_err(failed)
    }

    #[getter]
    fn element_count(&self) -> usize {
        self.layout.elements.len()
    }

    /// Width and height of the images, px.
    #[getter]
    fn picture_size(&self) -> (usize, usize) {
        (self.layout.width, self.layout.height)
    }

    #[getter]
    fn dark_level(&self) -> u8 {
        self.layout.dark_level
    }

    /// Polarity of the elements: bright or dark.
    #[getter]
    fn polarity(&self) -> String {
        self.layout.polarity.to_string()
    }

    #[getter]
    fn has_dome(&self) -> bool {
        self.layout.dome.is_some()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// Column and row of each element's centre, px [E, 2].
    fn centres<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let elements = self.layout.elements.iter();
        let centres: Vec<_> = elements.map(|e| e.centre_px.to_array().to_vec()).collect();
        Ok(PyArray2::from_vec2(py, &centres)?)
    }

    /// Radius of each element's sub-region, px [E].
    fn radii<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let elements = self.layout.elements.iter();
        PyArray1::from_iter(py, elements.map(|e| e.radius_px))
    }
}

/// Locates the elements in the mean of `frames` [N, H, W] of the untouched sensor.
#[pyfunction]
#[pyo3(name = "locate", signature = (frames, polarity, spot_diameter, element_diameter, region_radius, dome))]
pub fn locate_elements(
    py: Python<'_>,
    frames: PyReadonlyArray3<'_, u8>,
    polarity: Option<&str>,
    spot_diameter: Option<f64>,
    element_diameter: Option<f64>,
    region_radius: f64,
    dome: Option<&str>,
) -> PyResult<Layout> {
    let (height, width) = (frames.shape()[1], frames.shape()[2]);
    let mut mean = MeanPicture::default();
    for pixels in frames.as_slice()?.chunks_exact((width * height).max(1)) {
        let picture = Picture {
            width,
            height,
            pixels,
        };
        mean.add(&picture).map_err(refused)?;
    }
    let reference = mean.finish().map_err(refused)?;
    let polarity = polarity.map(str::parse::<Polarity>).transpose();
    let polarity = polarity.map_err(refused)?;
    let config = LocateConfig {
        polarity,
        spot_diameter_px: spot_diameter,
        element_diameter_px: element_diameter,
        region_radius,
    };
    let located = interruptible(py, |_| locate(&reference, &config), |_| Ok(()))?;
    let located = located.map_err(refused)?;
    let layout = match dome {
        Some(name) => {
            let experiment = Experiment::load(name, &[]).map_err(refused)?;
            let fingertip = experiment.config.sensor.fingertip;
            let dome = DomeGeometry {
                radius: fingertip.layout.dome_radius,
                camera: fingertip.camera,
            };
            LocatedLayout::on_dome(&located, dome).map_err(refused)?
        }
        None => LocatedLayout::new(&located),
    };
    // Fail early if the layout cannot be used for sensing.
    layout.kernel().map_err(refused)?;
    Ok(Layout {
        layout,
        warnings: located.warnings.iter().map(ToString::to_string).collect(),
    })
}
