//! Which element is touched, by how its moments differ from those without load.

use super::super::moments::ElementMoments;
use glam::DVec2;

/// Changes of an element, in standard deviations without load, below which it is untouched and from which it is touched.
const UNTOUCHED: f64 = 6.0;
const TOUCHED: f64 = 12.0;
/// Part of all change (squared) that the one element that is touched must have.
const ALONE: f64 = 0.8;

/// What is touched in a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Contact {
    /// Nothing.
    None,
    /// This element alone.
    Element(usize),
    /// Several elements, or one so lightly that it may be noise.
    Unclear,
}

/// The elements without load.
#[derive(Debug, Clone, PartialEq)]
pub struct Untouched {
    elements: Vec<Noise>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Noise {
    gray: f64,
    centroid: DVec2,
    /// Standard deviations.
    of_gray: f64,
    of_centroid: f64,
}

impl Untouched {
    /// Of pictures without load; none where there are fewer than two.
    ///
    /// Pictures tell of noise what a second shows of it. An element that happened to be still in them has that of most others, and all
    /// have a ten-thousandth of their gray value at least.
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

    /// What is touched, and how much has changed in all, in standard deviations.
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
    fn one_element_is_told_from_none_and_from_several() {
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
