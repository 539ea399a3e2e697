//! Positions of a fingertip's elements.

use crate::errors::refused;
use feeler::sensor::fingertip::{
    DomeProjection, ElementLayout, Fingertip, FingertipConfig, LocatedLayout, SensingElement,
};
use glam::{DMat3, DVec2, DVec3};
use pyo3::PyResult;

/// Positions of a fingertip's elements in its images and, if the dome is known, on the dome.
#[derive(Clone)]
pub struct Places {
    /// Column and row of each element's centre, px.
    pub centres: Vec<DVec2>,
    /// Pose of each element on the dome, or `None` if the dome is not known.
    pub on_dome: Option<Vec<OnDome>>,
}

/// Pose of an element on the dome.
#[derive(Clone)]
pub struct OnDome {
    /// Tip of the unloaded feeler, m, in `T`.
    pub tip: DVec3,
    /// Rotation from the element's frame `E_i` to `T`.
    pub rotation: DMat3,
}

impl Places {
    /// Positions of the elements of the fingertip that `config` describes.
    pub fn of_fingertip(config: &FingertipConfig) -> PyResult<Self> {
        let (layout, projection) = Fingertip::layout_and_projection(config).map_err(refused)?;
        Ok(Self {
            centres: centres(&layout, &projection),
            on_dome: Some(on_dome(&layout)),
        })
    }

    /// Positions of the elements that were located in an image.
    pub fn of_layout(layout: &LocatedLayout) -> Self {
        let directions: Option<Vec<DVec3>> = layout.elements.iter().map(|e| e.direction).collect();
        let on_dome = layout
            .dome
            .as_ref()
            .zip(directions)
            .map(|(dome, directions)| {
                on_dome(&ElementLayout {
                    dome_radius: dome.radius,
                    elements: directions.into_iter().map(SensingElement::facing).collect(),
                })
            });
        Self {
            centres: layout.elements.iter().map(|e| e.centre_px).collect(),
            on_dome,
        }
    }
}

/// Returns the position of each element in the image (px); NaN if the camera cannot see it. Moments cannot be computed
/// for a fingertip with such an element.
fn centres(layout: &ElementLayout, projection: &DomeProjection) -> Vec<DVec2> {
    let tips = (0..layout.elements.len()).map(|index| layout.tip(index));
    tips.map(|tip| projection.project(tip).unwrap_or(DVec2::NAN))
        .collect()
}

fn on_dome(layout: &ElementLayout) -> Vec<OnDome> {
    let elements = layout.elements.iter().enumerate();
    elements
        .map(|(index, element)| OnDome {
            tip: layout.tip(index),
            rotation: element.rotation,
        })
        .collect()
}
