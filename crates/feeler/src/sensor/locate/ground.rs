//! Background gray level around each element.

use super::{Polarity, quantile, reference::ReferencePicture};

/// Fraction of a dark marker's contrast up to which a pixel counts as background, because a gel darkens where it is
/// pressed.
const SHADE: f64 = 0.35;

/// Maximum spread of background levels over the elements, in gray levels, for the lighting to count as even.
const EVEN: f64 = 20.0;

/// Background around each element, measured in an image in which elements are bright.
pub(super) struct Ground {
    polarity: Polarity,
    two_level: bool,
    /// Background gray level around each element.
    levels: Vec<f64>,
    noise: f64,
}

impl Ground {
    /// Measures the background in the elements' sub-regions.
    pub fn new(
        reference: &ReferencePicture,
        polarity: Polarity,
        regions: &[Vec<(usize, usize)>],
        noise: f64,
    ) -> Self {
        let level = |region: &Vec<(usize, usize)>| {
            let gray =
                |&(c, r): &(usize, usize)| f64::from(reference.gray[r * reference.width + c]);
            // The darkest fifth of a sub-region is background even if the spot fills most of it. 400 pixels suffice.
            let some = region.iter().step_by(region.len() / 400 + 1);
            let mut grays: Vec<f64> = some.map(gray).collect();
            quantile(&mut grays, 0.2)
        };
        Self {
            polarity,
            two_level: reference.two_level,
            levels: regions.iter().map(level).collect(),
            noise,
        }
    }

    /// Background level of each element, given the elements' contrasts. If the lighting is even, all bright elements
    /// have the same level.
    pub fn of_elements(&self, contrasts: &[f64]) -> Vec<u8> {
        let quantile_of = |q: f64| quantile(&mut self.levels.clone(), q);
        let uneven = quantile_of(0.95) - quantile_of(0.05) > EVEN.max(8.0 * self.noise);
        let levels = self.levels.iter().zip(contrasts);
        match self.polarity {
            _ if self.two_level => vec![127; self.levels.len()],
            Polarity::Bright if !uneven => vec![self.of_all(contrasts); self.levels.len()],
            Polarity::Bright => {
                let above = |(level, _): (&f64, &f64)| self.gray(level + 4.0 * self.noise);
                levels.map(above).collect()
            }
            Polarity::Dark => {
                let above = |(level, contrast): (&f64, &f64)| {
                    self.gray(level + (SHADE * contrast).max(4.0 * self.noise))
                };
                levels.map(above).collect()
            }
        }
    }

    /// Common background level of all elements, slightly above the background so that its noise does not affect the
    /// sums.
    pub fn of_all(&self, contrasts: &[f64]) -> u8 {
        if self.two_level {
            return 127;
        }
        let above = match self.polarity {
            Polarity::Bright => 0.0,
            Polarity::Dark => SHADE * quantile(&mut contrasts.to_vec(), 0.5),
        };
        let level = quantile(&mut self.levels.clone(), 0.9);
        self.gray(level + above.max(4.0 * self.noise))
    }

    /// Converts a level to a gray value of the original image, which may be inverted.
    fn gray(&self, level: f64) -> u8 {
        match self.polarity {
            Polarity::Bright => level.ceil().min(254.0) as u8,
            Polarity::Dark => (255.0 - level).floor().max(1.0) as u8,
        }
    }
}
