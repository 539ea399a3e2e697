//! Light sources of an image: spots, and unloaded elements, whose light is constant and precomputed.

use super::seen_spot::ProjectedSpot;
use crate::optics::model::OpticsModel;
use std::ops::Range;

/// A light source of an image.
#[derive(Debug, Clone)]
pub(crate) enum Light {
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
