//! The grey level that elements rise from.

use super::{Polarity, quantile, reference::ReferencePicture};

/// Part of the contrast of a dark marker up to which a pixel is ground: a gel is shaded where it is pressed.
const SHADE: f64 = 0.35;

/// Grey levels by which the ground may differ from element to element and be even.
const EVEN: f64 = 20.0;

/// What the ground about each element is like, in a picture in which elements are bright.
pub(super) struct Ground {
    polarity: Polarity,
    two_level: bool,
    /// Grey level of the ground about each element.
    levels: Vec<f64>,
    noise: f64,
}

impl Ground {
    /// Measures it in the elements' sub-regions.
    pub fn new(
        reference: &ReferencePicture,
        polarity: Polarity,
        regions: &[Vec<(usize, usize)>],
        noise: f64,
    ) -> Self {
        let level = |region: &Vec<(usize, usize)>| {
            let gray =
                |&(c, r): &(usize, usize)| f64::from(reference.gray[r * reference.width + c]);
            // Most of a sub-region may be bright; its darkest fifth is not. Some hundred pixels say where that ends.
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

    /// The level of each element of these `contrasts`; the same for all bright ones where light is even.
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

    /// One level for all: a little above the ground, so that its noise does not reach the sums.
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

    /// The grey level in the picture as it was taken.
    fn gray(&self, level: f64) -> u8 {
        match self.polarity {
            Polarity::Bright => level.ceil().min(254.0) as u8,
            Polarity::Dark => (255.0 - level).floor().max(1.0) as u8,
        }
    }
}
