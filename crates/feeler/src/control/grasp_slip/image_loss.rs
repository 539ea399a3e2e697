//! Detects from images of a gel that a grasped object is lost.

use super::{part, passed};
use crate::sensor::image::Picture;

/// Number of block columns and rows of a [`CoarseImage`].
const BLOCKS: (usize, usize) = (40, 30);
/// Number of blocks summed between checks of whether the distance exceeds its limit.
const CHUNK: usize = 120;
/// Lower bound of the distance in gray levels, below the noise of any camera.
const LEAST: f64 = 1e-2;
/// Time constant of the filter (s). 0.2, 0.35 and 0.5 were compared on recordings.
const TIME_CONSTANT: f64 = 0.3;

/// Image of a gel as mean gray levels of 40 x 30 blocks, relative to the mean of the image.
#[derive(Debug, Clone, PartialEq)]
pub struct CoarseImage(Box<[f32]>);

impl Default for CoarseImage {
    fn default() -> Self {
        Self(vec![0.0; BLOCKS.0 * BLOCKS.1].into_boxed_slice())
    }
}

impl CoarseImage {
    /// Computes the block means of a picture.
    pub fn of<P: AsRef<[u8]>>(picture: &Picture<P>) -> Self {
        let mut coarse = Self::default();
        coarse.take(picture);
        coarse
    }

    /// Replaces the content with the block means of a picture. Does not allocate. Blocks without pixels are 0.
    pub fn take<P: AsRef<[u8]>>(&mut self, picture: &Picture<P>) {
        let (columns, rows) = BLOCKS;
        let (width, height) = (picture.width, picture.height);
        let pixels = picture.pixels.as_ref();
        for (index, block) in self.0.iter_mut().enumerate() {
            let (column, row) = (index % columns, index / columns);
            let [left, right] = [column, column + 1].map(|edge| edge * width / columns);
            let [top, bottom] = [row, row + 1].map(|edge| edge * height / rows);
            let line = |y: usize| pixels.get(y * width + left..y * width + right);
            let lines = (top..bottom).filter_map(line).flatten();
            let (sum, count) = lines.fold((0_u32, 0_u32), |(sum, count), pixel| {
                (sum + u32::from(*pixel), count + 1)
            });
            *block = sum as f32 / count.max(1) as f32;
        }
        let mean = self.0.iter().sum::<f32>() / self.0.len() as f32;
        self.0.iter_mut().for_each(|block| *block -= mean);
    }

    /// Root mean square difference between the blocks of two images, gray levels.
    pub fn distance(&self, other: &Self) -> f64 {
        self.distance_below(other, f64::INFINITY)
            .unwrap_or(f64::INFINITY)
    }

    /// Like [`distance`](Self::distance), but `None` if it is not below `limit`. Faster for a low limit.
    pub fn distance_below(&self, other: &Self, limit: f64) -> Option<f64> {
        let count = self.0.len() as f64;
        let most = limit * limit * count;
        let mut sum = 0.0;
        for (own, others) in self.0.chunks(CHUNK).zip(other.0.chunks(CHUNK)) {
            let squares = own.iter().zip(others).map(|(a, b)| (a - b) * (a - b));
            sum += f64::from(squares.sum::<f32>());
            if sum >= most {
                return None;
            }
        }
        Some((sum / count).sqrt())
    }
}

/// Detects from images of the gel whether a grasped object is lost.
///
/// With d the distance (gray levels) of an image from the one of the untouched gel ([`CoarseImage::distance`]) and
/// a = 1 - exp(-dt / 0.3 s):
///
/// ```text
/// s += a (-ln d - s)        p = 1 / (1 + exp(-(w0 + w1 s)))
/// ```
///
/// The imprint of an object shades the gel and displaces its markers. Both change d, even for threads and cloth that
/// displace no marker. A released object counts as lost. p is the probability of a slip in a grasp that should hold;
/// its weights were computed by `feeler score-slip` from 120 recorded grasps (`docs/slip.md`).
#[derive(Debug, Clone, Default)]
pub struct ImageLoss {
    score: Option<f64>,
}

impl ImageLoss {
    /// Coefficients w0 and w1 of the probability.
    pub const WEIGHTS: [f64; 2] = [3.350, 4.631];

    /// Updates the score with the image's `distance` (gray levels) from the untouched gel, `interval` (s) after the
    /// previous image. A NaN distance changes nothing. Neither allocates nor panics.
    pub fn update(&mut self, interval: f64, distance: f64) -> Option<f64> {
        if !distance.is_nan() {
            let newest = -libm::log(distance.clamp(LEAST, f64::MAX));
            let before = self.score.unwrap_or(newest);
            let part = part(passed(interval), TIME_CONSTANT);
            self.score = Some(before + part * (newest - before));
        }
        self.score
    }

    /// Score s, the filtered negative logarithm of the distance; `None` before the first image.
    pub fn score(&self) -> Option<f64> {
        self.score
    }

    /// Probability that the object is lost, or `None` before the first image.
    pub fn probability(&self) -> Option<f64> {
        let [constant, slope] = Self::WEIGHTS;
        self.score
            .map(|score| 1.0 / (1.0 + libm::exp(-(constant + slope * score))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(grey: impl Fn(usize, usize) -> u8) -> Picture {
        let (width, height) = (80, 60);
        let pixels = (0..width * height).map(|i| grey(i % width, i / width));
        Picture {
            width,
            height,
            pixels: pixels.collect(),
        }
    }

    /// A quarter of the image is 40 levels brighter: relative to the mean, +30 there and -10 elsewhere.
    #[test]
    fn the_distance_is_that_of_the_blocks_relative_to_their_mean() {
        let flat = CoarseImage::of(&picture(|_, _| 100));
        let brighter = CoarseImage::of(&picture(|_, _| 120));
        assert_eq!(flat.distance(&brighter), 0.0);
        let quarter = CoarseImage::of(&picture(|x, y| 100 + 40 * u8::from(x < 40 && y < 30)));
        let expected = (0.25 * 30.0_f64.powi(2) + 0.75 * 10.0_f64.powi(2)).sqrt();
        assert!((flat.distance(&quarter) - expected).abs() < 1e-4);
        assert_eq!(flat.distance_below(&quarter, expected * 0.99), None);
        assert_eq!(
            flat.distance_below(&quarter, 1e9),
            Some(flat.distance(&quarter))
        );
    }

    #[test]
    fn pictures_of_any_size_are_reduced() {
        for (width, height) in [(0, 0), (1, 1), (7, 100), (41, 31)] {
            let picture = Picture {
                width,
                height,
                pixels: vec![200_u8; width * height],
            };
            let coarse = CoarseImage::of(&picture);
            assert!(coarse.0.iter().all(|block| block.is_finite()));
        }
    }

    /// After one time constant, the score has covered 1 - 1/e of the step.
    #[test]
    fn the_score_follows_the_distance() {
        let mut loss = ImageLoss::default();
        assert_eq!((loss.score(), loss.probability()), (None, None));
        loss.update(0.0, 1.0);
        assert_eq!(loss.update(0.1, f64::NAN), Some(0.0));
        for _ in 0..30 {
            loss.update(0.01, libm::exp(-1.0));
        }
        let expected = 1.0 - libm::exp(-1.0);
        assert!((loss.score().unwrap() - expected).abs() < 1e-9);
        assert!(loss.update(1.0, 0.0).unwrap().is_finite());
        assert!(loss.probability().unwrap() > 0.99);
        loss.update(1e9, f64::INFINITY);
        assert!(loss.probability().unwrap() < 0.01);
    }
}
