//! Precomputed light and image of an unloaded fingertip.

use super::camera_noise::NOISE_LANES;
use super::config::OpticsConfig;
use super::error::OpticsError;
use super::model::OpticsModel;
use super::renderer::exposed_block::{ExposedBlock, Exposure};
use super::renderer::light::Light;
use super::renderer::ranges::hull;
use super::renderer::rest_light::RestLight;
use super::renderer::seen_spot::{ProjectedSpot, side_by_side};
use feeler::sensor::fingertip::{DomeProjection, ElementLayout};
use glam::DVec3;

impl OpticsModel {
    /// Creates the optics of `config` for elements at `layout`, projected by `projection`.
    ///
    /// # Errors
    /// If a value is out of its range, or an element is not visible.
    pub fn new(
        config: &OpticsConfig,
        layout: &ElementLayout,
        projection: &DomeProjection,
    ) -> Result<Self, OpticsError> {
        let mut model = Self::without_light_at_rest(config, layout, projection)?;
        if model.markers.is_none() {
            let elements = 0..layout.elements.len();
            model.at_rest = elements
                .map(|element| light_at_rest(&model, element))
                .collect();
        }
        model.exposed_at_rest = exposed_at_rest(&model);
        Ok(model)
    }
}

/// Light of an unloaded element.
fn light_at_rest(model: &OpticsModel, element: usize) -> RestLight {
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
    RestLight {
        rows,
        columns,
        light,
    }
}

/// Noise-free blocks of the image of an unloaded fingertip, row by row; with markers, of the dome alone.
fn exposed_at_rest(model: &OpticsModel) -> Vec<ExposedBlock> {
    let (lost_by_column, _) = model.light_lost_by_column.as_chunks::<NOISE_LANES>();
    let mut exposed = Vec::with_capacity(model.projection.height() * lost_by_column.len());
    let mut lit = vec![0.0; model.padded_width()];
    for row in 0..model.projection.height() {
        lit.fill(0.0);
        for light in (0..model.at_rest.len()).map(Light::AtRest) {
            if light.rows(model).contains(&row) {
                light.light_row(model, row, &mut lit);
            }
        }
        let exposure = Exposure::new(&model.config, model.light_lost_by_row[row]);
        let (lit, _) = lit.as_chunks::<NOISE_LANES>();
        let blocks = lit.iter().zip(lost_by_column);
        exposed.extend(blocks.map(|(lit, lost)| exposure.expose(lit, lost)));
    }
    exposed
}
