//! Light of unloaded elements.

use std::ops::Range;

/// Light of an unloaded element, per pixel.
#[derive(Debug, Clone, Default)]
pub(crate) struct RestLight {
    pub rows: Range<usize>,
    pub columns: Range<usize>,
    /// Light of each pixel in `rows` and `columns`, row by row: 0 at the background's gray level, 1 at a spot's.
    pub light: Vec<f32>,
}

impl RestLight {
    /// Adds the light to row `row` of the image, one of `rows`.
    #[inline(always)]
    pub fn light_row(&self, row: usize, lit: &mut [f32]) {
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
