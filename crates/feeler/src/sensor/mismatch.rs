//! Whether the first pictures are of the fingertip that a calibration was made with.

use super::calibration::{ElementCalibration, Inputs};
use super::moments::ElementMoments;

/// Part of the range that the calibration's loads caused by which an unloaded element may be off: what would pass for a
/// twentieth of full scale.
const TOLERANCE: f64 = 0.05;

/// The first pictures of a fingertip are not those of the calibration's.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the pictures do not match the calibration: {off} of {lit} elements are not where they are without load. Expected the fingertip that it was made with, untouched at the start; this may be another fingertip, or its camera is swapped with another's"
)]
pub struct Mismatch {
    /// Elements that are off.
    pub off: usize,
    /// Elements that are neither dark nor saturated.
    pub lit: usize,
}

/// Watches pictures until the first that tells.
///
/// No object touches more than half of a dome's elements, so that as many that are off, by place or by brightness, are
/// another's. Whoever starts while a finger grasps is not held up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct FirstPicture {
    seen: bool,
}

impl FirstPicture {
    /// Looks at the `moments` of the elements that are lit well, each with its calibration, out of `elements`. A picture with
    /// fewer than half of them tells nothing: the next one is looked at.
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
    let Inputs {
        growth,
        displacement,
    } = element.inputs(moments);
    let inputs = [growth, displacement.x, displacement.y];
    let mut inputs = inputs.into_iter().zip(element.map.ranges());
    inputs.any(|(input, [low, high])| {
        let good = input.abs() <= TOLERANCE * (high - low);
        !good
    })
}
