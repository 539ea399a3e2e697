//! Reference image in which elements are located: the mean of images of the unloaded sensor.

use super::{LocateError, Polarity};
use crate::sensor::image::frame::Picture;
use glam::DVec2;
use std::borrow::Cow;

/// Mean of several images, with the information needed to estimate its noise.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferencePicture {
    /// Width, px.
    pub width: usize,
    /// Height, px.
    pub height: usize,
    /// Mean gray values, row by row from the top left, 0 to 255.
    pub gray: Vec<f32>,
    /// Number of images averaged.
    pub pictures: usize,
    /// `true` if every pixel of every image is black or white, as after thresholding.
    pub two_level: bool,
}

impl ReferencePicture {
    /// Averages `pictures`.
    ///
    /// # Errors
    /// If there are no images, if their sizes differ, or if an image is too small.
    pub fn mean<'a>(pictures: impl IntoIterator<Item = &'a Picture>) -> Result<Self, LocateError> {
        let mut sum = MeanPicture::default();
        for picture in pictures {
            sum.add(picture)?;
        }
        sum.finish()
    }

    /// Returns the image with bright elements: inverted if the elements are dark.
    pub(super) fn oriented(&self, polarity: Polarity) -> Cow<'_, Self> {
        match polarity {
            Polarity::Bright => Cow::Borrowed(self),
            Polarity::Dark => Cow::Owned(Self {
                gray: self.gray.iter().map(|gray| 255.0 - gray).collect(),
                ..*self
            }),
        }
    }

    /// Bins `factor` x `factor` pixels into their mean. The last column and row are repeated to complete a bin.
    pub(super) fn binned(&self, factor: usize) -> Self {
        let size = (self.width.div_ceil(factor), self.height.div_ceil(factor));
        let share = 1.0 / (factor * factor) as f32;
        let mut gray = vec![0.0; size.0 * size.1];
        let mut sums = vec![0.0; self.width];
        for (row, binned) in gray.chunks_exact_mut(size.0).enumerate() {
            sums.fill(0.0);
            for below in 0..factor {
                let row = (row * factor + below).min(self.height - 1);
                let pixels = &self.gray[row * self.width..][..self.width];
                sums.iter_mut()
                    .zip(pixels)
                    .for_each(|(sum, pixel)| *sum += pixel);
            }
            for (binned, sums) in binned.iter_mut().zip(sums.chunks(factor)) {
                let missing = (factor - sums.len()) as f32 * sums[sums.len() - 1];
                *binned = share * (sums.iter().sum::<f32>() + missing);
            }
        }
        Self {
            width: size.0,
            height: size.1,
            gray,
            ..*self
        }
    }

    /// Gray level at `place` (column and row, px), interpolated between the four nearest pixels.
    pub(super) fn gray_at(&self, place: DVec2) -> f64 {
        let last = DVec2::new((self.width - 1) as f64, (self.height - 1) as f64);
        let place = place.clamp(DVec2::ZERO, last);
        let (column, row) = (place.x as usize, place.y as usize);
        let part = place - place.floor();
        let at = |dx: usize, dy: usize| {
            let (column, row) = (
                (column + dx).min(self.width - 1),
                (row + dy).min(self.height - 1),
            );
            f64::from(self.gray[row * self.width + column])
        };
        let along = |dy: usize| at(0, dy) + part.x * (at(1, dy) - at(0, dy));
        along(0) + part.y * (along(1) - along(0))
    }

    /// Standard deviation of the noise of a single image, gray levels. Estimated from the deviation of each pixel from
    /// a plane through its neighbours, in the fifth of the image with the least detail. At least the rounding noise of
    /// 0.29.
    pub fn noise(&self) -> f64 {
        let (width, height) = (self.width, self.height);
        // Every other row and column suffices; for images of millions of pixels, still fewer.
        let step = 2 * (width * height / 1_000_000).isqrt().max(1);
        let mut off = Vec::with_capacity(width * height / (step * step) + 1);
        for row in (1..height.saturating_sub(1)).step_by(step) {
            for column in (1..width.saturating_sub(1)).step_by(step) {
                let at = |dy: usize, dx: usize| {
                    f64::from(self.gray[(row + dy - 1) * width + column + dx - 1])
                };
                let corners = at(0, 0) + at(0, 2) + at(2, 0) + at(2, 2);
                let sides = at(0, 1) + at(1, 0) + at(1, 2) + at(2, 1);
                off.push((corners - 2.0 * sides + 4.0 * at(1, 1)).abs());
            }
        }
        // The mask's weights have a root sum of squares of 6. A fifth of the magnitudes of a normal distribution lies
        // below 0.2533 standard deviations.
        let of_mean = super::quantile(&mut off, 0.2) / (6.0 * 0.2533);
        (of_mean * (self.pictures as f64).sqrt()).max(0.29)
    }
}

/// Accumulates the sum of images without storing them.
#[derive(Debug, Clone, Default)]
pub struct MeanPicture {
    size: (usize, usize),
    sum: Vec<u32>,
    pictures: usize,
    gray_levels: bool,
}

/// Maximum number of images in a mean: their sum must fit into a `u32`.
const MAX_PICTURES: usize = (u32::MAX / 255) as usize;

impl MeanPicture {
    /// Adds one image.
    ///
    /// # Errors
    /// If the size differs from that of earlier images, or if the image is too small.
    pub fn add<P: AsRef<[u8]>>(&mut self, picture: &Picture<P>) -> Result<(), LocateError> {
        let (width, height) = (picture.width, picture.height);
        let gray = picture.pixels.as_ref();
        let pixels = gray.len();
        if self.pictures == 0 {
            if width < super::MIN_SIZE || height < super::MIN_SIZE {
                return Err(LocateError::TooSmall { width, height });
            }
            self.size = (width, height);
            self.sum = vec![0; width.saturating_mul(height).min(pixels)];
        }
        if (width, height) != self.size || pixels != width * height {
            return Err(LocateError::PictureSize {
                expected_width: self.size.0,
                expected_height: self.size.1,
                width,
                height,
                pixels,
            });
        }
        if self.pictures == MAX_PICTURES {
            return Err(LocateError::TooMany { most: MAX_PICTURES });
        }
        for (sum, &pixel) in self.sum.iter_mut().zip(gray) {
            *sum += u32::from(pixel);
            self.gray_levels |= pixel != 0 && pixel != 255;
        }
        self.pictures += 1;
        Ok(())
    }

    /// Returns the mean of the images added.
    ///
    /// # Errors
    /// If no image was added.
    pub fn finish(self) -> Result<ReferencePicture, LocateError> {
        if self.pictures == 0 {
            return Err(LocateError::NoPicture);
        }
        let scale = 1.0 / self.pictures as f64;
        Ok(ReferencePicture {
            width: self.size.0,
            height: self.size.1,
            gray: self
                .sum
                .iter()
                .map(|&s| (f64::from(s) * scale) as f32)
                .collect(),
            pictures: self.pictures,
            two_level: !self.gray_levels,
        })
    }
}
