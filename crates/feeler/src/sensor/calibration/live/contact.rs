//! Detects the touched element from the deviation of its moments from the unloaded ones.

use crate::sensor::moments::kernel::ElementMoments;
use glam::DVec2;

/// Deviation below which an element counts as untouched, in standard deviations of the unloaded moments.
const UNTOUCHED: f64 = 6.0;
/// Deviation from which an element counts as touched, in standard deviations of the unloaded moments.
const TOUCHED: f64 = 12.0;
/// Minimum share of one element in the total squared deviation for it to count as the only touched element.
const ALONE: f64 = 0.8;

/// Contact state detected in an image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Contact {
    /// No element is touched.
    None,
    /// Only this element is touched.
    Element(usize),
    /// Several elements are touched, or one so lightly that it may be noise.
    Unclear,
}

/// Mean and noise of the moments of all elements without load.
#[derive(Debug, Clone, PartialEq)]
pub struct Untouched {
    elements: Vec<Noise>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Noise {
    gray: f64,
    centroid: DVec2,
    /// Standard deviation of the integrated gray value.
    of_gray: f64,
    /// Standard deviation of the centroid.
    of_centroid: f64,
}

impl Untouched {
    /// Computes the statistics from unloaded images; `None` if there are fewer than two.
    ///
    /// A few images underestimate the noise of some elements. The standard deviations are therefore at least the
    /// median over all elements, and at least a ten-thousandth of the gray value.
    pub fn of(pictures: &[Vec<ElementMoments>]) -> Option<Self> {
        let count = pictures.len() as f64;
        let elements = pictures.first().filter(|_| pictures.len() >= 2)?.len();
        let of = |element: usize| {
            let own = || pictures.iter().map(move |moments| moments[element]);
            let gray = own().map(|m| m.integrated_gray).sum::<f64>() / count;
            let centroid = own().map(|m| m.centroid).sum::<DVec2>() / count;
            let gray_off = own()
                .map(|m| (m.integrated_gray - gray).powi(2))
                .sum::<f64>();
            let centroid_off = own()
                .map(|m| (m.centroid - centroid).length_squared())
                .sum::<f64>();
            Noise {
                gray,
                centroid,
                of_gray: (gray_off / (count - 1.0)).sqrt(),
                of_centroid: (centroid_off / (count - 1.0)).sqrt(),
            }
        };
        let mut elements: Vec<Noise> = (0..elements).map(of).collect();
        let least_gray = median(elements.iter().map(|e| e.of_gray / e.gray)).max(1e-4);
        let least_centroid = median(elements.iter().map(|e| e.of_centroid)).max(f64::MIN_POSITIVE);
        for noise in &mut elements {
            noise.of_gray = noise.of_gray.max(least_gray * noise.gray);
            noise.of_centroid = noise.of_centroid.max(least_centroid);
        }
        Some(Self { elements })
    }

    /// Detects the contact in an image. Returns it with the total deviation of all elements, in standard deviations.
    pub fn contact(&self, moments: &[ElementMoments]) -> (Contact, f64) {
        let changes = self.elements.iter().zip(moments).map(|(noise, now)| {
            let gray = (now.integrated_gray - noise.gray) / noise.of_gray;
            let centroid = (now.centroid - noise.centroid) / noise.of_centroid;
            gray * gray + centroid.length_squared()
        });
        let (mut all, mut most) = (0.0, (0, 0.0));
        for (element, change) in changes.enumerate() {
            all += change;
            if change > most.1 {
                most = (element, change);
            }
        }
        let contact = if most.1 < UNTOUCHED * UNTOUCHED {
            Contact::None
        } else if most.1 >= TOUCHED * TOUCHED && most.1 >= ALONE * all {
            Contact::Element(most.0)
        } else {
            Contact::Unclear
        };
        (contact, all.sqrt())
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moments(changed: &[(usize, f64)], noise: f64) -> Vec<ElementMoments> {
        let of = |element: usize| {
            let own = changed.iter().find(|(index, _)| *index == element);
            let growth = own.map_or(0.0, |(_, growth)| *growth);
            ElementMoments {
                integrated_gray: 100.0 * (1.0 + growth + noise),
                centroid: DVec2::new(growth, noise),
            }
        };
        (0..4).map(of).collect()
    }

    #[test]
    fn one_touched_element_is_distinguished_from_none_and_several() {
        let pictures: Vec<_> = (0..16)
            .map(|k| moments(&[], 0.01 * f64::from(k % 2)))
            .collect();
        let untouched = Untouched::of(&pictures).expect("pictures");
        let contact = |changed: &[(usize, f64)]| untouched.contact(&moments(changed, 0.005)).0;
        assert_eq!(contact(&[]), Contact::None);
        assert_eq!(contact(&[(2, 0.01)]), Contact::None);
        assert_eq!(contact(&[(2, 0.5)]), Contact::Element(2));
        assert_eq!(contact(&[(2, 0.5), (1, 0.1)]), Contact::Element(2));
        assert_eq!(contact(&[(2, 0.5), (1, 0.4)]), Contact::Unclear);
        assert_eq!(contact(&[(2, 0.035)]), Contact::Unclear);
        assert_eq!(Untouched::of(&pictures[..1]), None);
    }
}
