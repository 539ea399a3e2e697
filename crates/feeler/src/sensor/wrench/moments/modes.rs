//! Modes of deformation: principal components of the displacement field.
//!
//! The response of a soft fingertip to a load depends on its current deformation, for example on where it is touched.
//! A contact has few degrees of freedom, so few modes describe the displacements of all elements, and a regression on
//! the modes and the products of all pairs of modes has few terms. With the unit vector d_k and the standard deviation
//! s_k of principal component k, and a common factor g:
//!
//! ```text
//! t_k = g d_k · (u - mean u) / sqrt(s_k)
//! ```
//!
//! The square root is a compromise between no standardisation, which leaves weak modes unused, and full
//! standardisation, which amplifies their noise. The variance of a mode is 1 on average.

use super::standard::ElementStandard;
use crate::sensor::moments::kernel::ElementMoments;
use crate::sensor::wrench::novelty::{Direction, principal};
use glam::DVec2;
use nalgebra::DMatrix;

/// Maximum number of modes. Chosen on sheared contacts of a TacTip, for which 12 are too few and 30 no better.
const MAX_MODES: usize = 20;

/// Maximum number of images, evenly spread, from which modes are computed.
const MAX_ROWS: usize = 400;

/// Computes the modes from the images of the calibration, and stores them in `standards`.
pub(super) fn add_modes(
    standards: &mut [ElementStandard],
    pictures: &[&Vec<Option<ElementMoments>>],
) {
    let step = pictures.len().div_ceil(MAX_ROWS).max(1);
    let pictures: Vec<_> = pictures.iter().step_by(step).collect();
    let deflections = pictures.iter().flat_map(|seen| {
        let elements = standards.iter().zip(seen.iter());
        elements.flat_map(|(standard, moments)| standard.deflection(moments.as_ref()).to_array())
    });
    let (rows, columns) = (pictures.len(), 2 * standards.len());
    let mut field = DMatrix::from_row_iterator(rows, columns, deflections);
    // Scaled to a mean variance of 1.
    let scale = (rows * columns) as f64 / field.norm_squared();
    if !scale.is_finite() {
        return;
    }
    let (scale, per_row) = (scale.sqrt(), (rows as f64).sqrt());
    field *= scale / per_row;
    let most = (rows / 3).min(columns / 2).min(MAX_MODES);
    let modes = principal(&field, f64::INFINITY, most);
    let deviations: f64 = modes.iter().map(|mode| mode.variance.sqrt()).sum();
    let common = scale * (modes.len() as f64 / deviations).sqrt();
    for (element, standard) in standards.iter_mut().enumerate() {
        let loading = |mode: &Direction| {
            let along = &mode.along[2 * element..][..2];
            common * DVec2::from_slice(along) / mode.variance.sqrt().sqrt()
        };
        standard.loadings = modes.iter().map(loading).collect();
    }
}

/// Fills `modes` with the values of the modes in an image.
pub(super) fn fill_modes(
    standards: &[ElementStandard],
    seen: &[Option<ElementMoments>],
    modes: &mut [f64],
) {
    modes.fill(0.0);
    for (standard, moments) in standards.iter().zip(seen) {
        let deflection = standard.deflection(moments.as_ref());
        for (mode, loading) in modes.iter_mut().zip(&standard.loadings) {
            *mode += loading.dot(deflection);
        }
    }
}

/// The modes, then the products of all pairs. Products of different modes are multiplied by √2, so that their variance
/// equals that of squares.
pub(super) fn terms(modes: &[f64]) -> impl Iterator<Item = f64> {
    let products = modes.iter().enumerate().flat_map(move |(index, &first)| {
        let others = modes[index + 1..].iter();
        let mixed = others.map(move |second| std::f64::consts::SQRT_2 * first * second);
        std::iter::once(first * first).chain(mixed)
    });
    modes.iter().copied().chain(products)
}

/// Number of [`terms`] of `modes` modes.
pub(super) fn term_count(modes: usize) -> usize {
    modes + modes * (modes + 1) / 2
}
