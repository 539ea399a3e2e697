//! Reference and statistics of the elements of a camera's sensor.

use super::PER_ELEMENT;
use crate::sensor::moments::kernel::ElementMoments;
use crate::sensor::wrench::WrenchError;
use crate::sensor::wrench::basis::{MAX_FEATURE, mean_and_scale};
use crate::sensor::wrench::calibration::{LARGEST, check_number};
use glam::DVec2;
use serde::{Deserialize, Serialize};

/// Reference moments and feature statistics of one element over the images of the calibration.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElementStandard {
    /// `true` if the element is used: it was neither dark nor saturated in at least half of the images.
    pub used: bool,
    /// Mean integrated gray value G_0 over the images, gray levels times m² (px² for a planar layout).
    pub gray: f64,
    /// Mean centroid c_0 of the element without load, in x, y of its plane (m; px if the layout has no dome).
    pub centroid: DVec2,
    /// Mean of each feature.
    pub mean: [f64; PER_ELEMENT],
    /// Standard deviation of each feature; 0 for a constant feature, which is not used.
    pub scale: [f64; PER_ELEMENT],
    /// Change of each mode of deformation per unit of this element's displacement along x and y, 1/m or 1/px.
    #[serde(default, skip_serializing_if = "Vec::is_empty", rename = "modes")]
    pub loadings: Vec<DVec2>,
}

impl ElementStandard {
    const UNUSED: Self = Self {
        used: false,
        gray: 0.0,
        centroid: DVec2::ZERO,
        mean: [0.0; PER_ELEMENT],
        scale: [0.0; PER_ELEMENT],
        loadings: Vec::new(),
    };

    pub(super) fn standardised(&self, raw: [f64; PER_ELEMENT]) -> [f64; PER_ELEMENT] {
        std::array::from_fn(|kind| {
            if self.scale[kind] > 0.0 {
                ((raw[kind] - self.mean[kind]) / self.scale[kind]).clamp(-MAX_FEATURE, MAX_FEATURE)
            } else {
                0.0
            }
        })
    }

    pub(super) fn check(&self, index: usize) -> Result<(), WrenchError> {
        let field = |name: &str| format!("model.elements[{index}].{name}");
        if self.used {
            // A tiny value would make growth overflow.
            check_number(&field("gray"), self.gray, 1e-100..=LARGEST)?;
        }
        for place in self.centroid.to_array() {
            check_number(&field("centroid"), place, -LARGEST..=LARGEST)?;
        }
        for loading in self.loadings.iter().flat_map(DVec2::to_array) {
            check_number(&field("modes"), loading, -LARGEST..=LARGEST)?;
        }
        for (mean, scale) in self.mean.into_iter().zip(self.scale) {
            check_number(&field("mean"), mean, -LARGEST..=LARGEST)?;
            check_number(&field("scale"), scale, 0.0..=LARGEST)?;
        }
        Ok(())
    }

    /// Displacement of the element from its mean position; 0 if it is not used or its moments are missing.
    pub(super) fn deflection(&self, moments: Option<&ElementMoments>) -> DVec2 {
        let [.., x, y] = self.mean;
        moments
            .filter(|_| self.used)
            .map_or(DVec2::ZERO, |moments| {
                moments.centroid - self.centroid - DVec2::new(x, y)
            })
    }

    /// Features before standardisation, for an image with the common gain `gain`.
    pub(super) fn raw(&self, moments: &ElementMoments, gain: f64) -> [f64; PER_ELEMENT] {
        let growth = moments.integrated_gray / self.gray;
        let displacement = moments.centroid - self.centroid;
        [
            growth / gain - 1.0,
            growth - 1.0,
            displacement.x,
            displacement.y,
        ]
    }
}

/// Moments of all elements in one image; `None` if missing.
type Seen = [Option<ElementMoments>];

/// Computes the reference and statistics of `elements` elements over `pictures`.
pub(super) fn standards(
    elements: usize,
    pictures: &[&Vec<Option<ElementMoments>>],
) -> Vec<ElementStandard> {
    let total = pictures.len();
    let mut standards: Vec<_> = (0..elements)
        .map(|element| {
            reference(
                pictures.iter().filter_map(|seen| *seen.get(element)?),
                total,
            )
        })
        .collect();
    let mut sums = vec![[[0.0; 3]; PER_ELEMENT]; elements];
    for seen in pictures {
        let Some(gain) = common_gain(&standards, seen) else {
            continue;
        };
        for (element, moments) in seen.iter().enumerate() {
            let Some(moments) = moments.filter(|_| standards[element].used) else {
                continue;
            };
            let raw = standards[element].raw(&moments, gain);
            for (sum, value) in sums[element].iter_mut().zip(raw) {
                for (sum, power) in sum.iter_mut().zip([1.0, value, value * value]) {
                    *sum += power;
                }
            }
        }
    }
    for (standard, sums) in standards.iter_mut().zip(sums) {
        for (kind, sums) in sums.into_iter().enumerate() {
            (standard.mean[kind], standard.scale[kind]) = mean_and_scale(sums);
        }
    }
    standards
}

/// Mean of an element's moments; `None` unless at least half of the `total` images contain them.
fn reference(moments: impl Iterator<Item = ElementMoments>, total: usize) -> ElementStandard {
    let (mut count, mut gray, mut centroid) = (0, 0.0, DVec2::ZERO);
    for moments in moments {
        count += 1;
        gray += moments.integrated_gray;
        centroid += moments.centroid;
    }
    if count == 0 || 2 * count < total {
        return ElementStandard::UNUSED;
    }
    ElementStandard {
        used: true,
        gray: gray / count as f64,
        centroid: centroid / count as f64,
        ..ElementStandard::UNUSED
    }
}

/// Mean of G/G_0 over the elements that are used and visible; `None` if there are no such elements.
pub(super) fn common_gain(standards: &[ElementStandard], seen: &Seen) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for (standard, moments) in standards.iter().zip(seen) {
        if let Some(moments) = moments.filter(|_| standard.used) {
            sum += moments.integrated_gray / standard.gray;
            count += 1.0;
        }
    }
    let gain = sum / count;
    (gain.is_finite() && gain > 0.0).then_some(gain)
}
