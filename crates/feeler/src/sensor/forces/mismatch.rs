//! Checks that the first images are of the fingertip for which the calibration was made.

use crate::sensor::calibration::element::ElementCalibration;
use crate::sensor::moments::kernel::ElementMoments;

/// Maximum deviation of an unloaded element's moments, as a fraction of the range of the calibration's loads:
/// equivalent to a twentieth of full scale.
const TOLERANCE: f64 = 0.05;

/// The first images do not match the calibration.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the images do not match the calibration: {off} of {lit} elements differ from their unloaded state. Expected the calibrated fingertip, untouched at the start; this may be another fingertip, or its camera is swapped with another"
)]
pub struct Mismatch {
    /// Number of elements that differ from their unloaded state.
    pub off: usize,
    /// Number of elements that are neither dark nor saturated.
    pub lit: usize,
}

/// Compares images with the calibrated unloaded state until one of them is conclusive.
///
/// An object touches at most half of a dome's elements. If more than half deviate in position or brightness, the image
/// is of another fingertip. A finger may therefore grasp an object at the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(in crate::sensor) struct MountingCheck {
    seen: bool,
}

impl MountingCheck {
    /// Checks an image, unless an earlier one was conclusive. `lit` yields the calibration and moments of each
    /// well-exposed element; `elements` is the total number. An image is inconclusive if fewer than half of the
    /// elements are well exposed.
    pub fn check<'a>(
        &mut self,
        elements: usize,
        lit: impl Iterator<Item = (&'a ElementCalibration, &'a ElementMoments)>,
    ) -> Result<(), Mismatch> {
        if self.seen {
            return Ok(());
        }
        let (lit, off) = lit.fold((0, 0), |(lit, off), (element, moments)| {
            (lit + 1, off + usize::from(is_off(element, moments)))
        });
        self.seen = 2 * lit >= elements;
        if self.seen && 2 * off > lit {
            self.seen = false;
            return Err(Mismatch { off, lit });
        }
        Ok(())
    }
}

fn is_off(element: &ElementCalibration, moments: &ElementMoments) -> bool {
    let inputs = element.inputs(moments).components();
    inputs
        .into_iter()
        .zip(element.map.ranges())
        .any(|(input, [low, high])| {
            let good = input.abs() <= TOLERANCE * (high - low);
            !good
        })
}
