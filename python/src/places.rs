//! Where a fingertip's elements are.

use crate::errors::refused;
use feeler::sensor::dome::DomeProjection;
use feeler::sensor::fingertip::{Fingertip, FingertipConfig};
use feeler::sensor::layout::{ElementLayout, SensingElement};
use feeler::sensor::located_layout::LocatedLayout;
use glam::{DMat3, DVec2, DVec3};
use pyo3::PyResult;

/// Where the elements of a fingertip are in its pictures and, if the dome is known, on it.
#[derive(Clone)]
pub struct Places {
    /// Column and row of each element's centre, px.
    pub centres: Vec<DVec2>,
    /// Of each element, if the dome is known.
    pub on_dome: Option<Vec<OnDome>>,
}

/// Where an element is on the dome.
#[derive(Clone)]
pub struct OnDome {
    /// Tip of the unloaded feeler, m, in `T`.
    pub tip: DVec3,
    /// From the element's frame `E_i` to `T`.
    pub rotation: DMat3,
}

impl Places {
    /// Of the fingertip that `config` describes.
    pub fn of_fingertip(config: &FingertipConfig) -> PyResult<Self> {
        let (layout, projection) = Fingertip::layout_and_projection(config).map_err(refused)?;
        Ok(Self {
            centres: centres(&layout, &projection),
            on_dome: Some(on_dome(&layout)),
        })
    }

    /// Of the elements that were located.
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

/// An element that the camera does not see has no sub-region, and its fingertip no kernel.
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
