//! Light sources of an image: spots, and unloaded elements, whose light is constant and precomputed.

use super::{
    hull,
    seen_spot::{ProjectedSpot, side_by_side},
};
use crate::optics::model::OpticsModel;
use glam::DVec3;
use std::ops::Range;

/// A light source of an image.
#[derive(Debug, Clone)]
pub(super) enum Light {
    Spot(ProjectedSpot),
    /// All spots of an unloaded element.
    AtRest(usize),
    /// No light: the region of a loaded element, which differs from the image at rest.
    NotAtRest(usize),
}

impl Light {
    /// Rows that the light can affect.
    pub fn rows(&self, model: &OpticsModel) -> Range<usize> {
        match self {
            Self::Spot(spot) => spot.rows.clone(),
            Self::AtRest(element) | Self::NotAtRest(element) => {
                model.at_rest[*element].rows.clone()
            }
        }
    }

    /// Columns that the light can affect.
    #[inline(always)]
    pub fn columns(&self, model: &OpticsModel) -> Range<usize> {
        match self {
            Self::Spot(spot) => spot.columns.clone(),
            Self::AtRest(element) | Self::NotAtRest(element) => {
                model.at_rest[*element].columns.clone()
            }
        }
    }

    /// Columns in which the light changes the image at rest, if any.
    #[inline(always)]
    pub fn changes(&self, model: &OpticsModel) -> Option<Range<usize>> {
        match self {
            Self::AtRest(_) => None,
            Self::Spot(_) | Self::NotAtRest(_) => Some(self.columns(model)),
        }
    }

    /// Adds the light to row `row` of the image.
    #[inline(always)]
    pub fn light_row(&self, model: &OpticsModel, row: usize, lit: &mut [f32]) {
        match self {
            Self::Spot(spot) => spot.light_row(model, row, lit),
            Self::AtRest(element) => model.at_rest[*element].light_row(row, lit),
            Self::NotAtRest(_) => {}
        }
    }
}

/// Light of an unloaded element, per pixel.
#[derive(Debug, Clone, Default)]
pub(crate) struct RestLight {
    rows: Range<usize>,
    columns: Range<usize>,
    /// Light of each pixel in `rows` and `columns`, row by row: 0 at the background's gray level, 1 at a spot's.
    light: Vec<f32>,
}

impl RestLight {
    /// Precomputes the light of each element of `model`.
    pub fn of_elements(model: &OpticsModel) -> Vec<Self> {
        let elements = 0..model.layout.elements.len();
        elements.map(|element| Self::new(model, element)).collect()
    }

    fn new(model: &OpticsModel, element: usize) -> Self {
        let seen = |spot| ProjectedSpot::new(model, element, &spot);
        let spots = model.spots(DVec3::ZERO).into_iter().filter_map(seen);
        let spots: Vec<ProjectedSpot> = spots.collect();
        let rows = spots.iter().map(|spot| spot.rows.clone()).reduce(hull);
        let columns = spots.iter().map(|spot| spot.columns.clone()).reduce(hull);
        let (rows, columns) = (rows.unwrap_or_default(), columns.unwrap_or_default());
        let columns = side_by_side(columns.start, columns.end, model.projection.width());
        let mut light = Vec::with_capacity(rows.len() * columns.len());
        let mut lit = vec![0.0; model.projection.width()];
        for row in rows.clone() {
            lit.fill(0.0);
            for spot in spots.iter().filter(|spot| spot.rows.contains(&row)) {
                spot.light_row(model, row, &mut lit);
            }
            light.extend(&lit[columns.clone()]);
        }
        Self {
            rows,
            columns,
            light,
        }
    }

    #[inline(always)]
    fn light_row(&self, row: usize, lit: &mut [f32]) {
        let width = self.columns.len();
        let own = (row - self.rows.start) * width;
        let (Some(lit), Some(light)) = (
            lit.get_mut(self.columns.clone()),
            self.light.get(own..own + width),
        ) else {
            return;
        };
        for (lit, light) in lit.iter_mut().zip(light) {
            *lit += light;
        }
    }
}
