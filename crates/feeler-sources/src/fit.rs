//! Scaling of images to another size without distortion.

/// Maximum fraction of an image's columns or rows that may be cropped to reach another aspect ratio.
pub const MAX_CROP: f64 = 0.1;

/// Error of fitting a camera's images to the wanted size.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum FitError {
    /// The camera's images are smaller than the wanted ones, or one of both sizes is empty.
    #[error("{}x{} px are too few for images of {}x{} px", offered.0, offered.1, wanted.0, wanted.1)]
    TooSmall {
        /// Width and height of the camera's images, px.
        offered: (usize, usize),
        /// Width and height of the wanted images, px.
        wanted: (usize, usize),
    },
    /// The aspect ratios differ too much.
    #[error(
        "{}x{} px would lose {:.0} % of their {side} to become {}x{} px; expected at most {:.0} %",
        offered.0, offered.1, 100.0 * crop, wanted.0, wanted.1, 100.0 * MAX_CROP
    )]
    Shape {
        /// Width and height of the camera's images, px.
        offered: (usize, usize),
        /// Width and height of the wanted images, px.
        wanted: (usize, usize),
        /// Fraction of the columns or rows that would be cropped, 0 to 1.
        crop: f64,
        /// Cropped side: `columns` or `rows`.
        side: &'static str,
    },
}

/// Uniform scale and central crop from images of the offered size to images of the wanted size.
///
/// Columns and rows have the same scale, so that circles stay circles. If the aspect ratios differ, both edges of one
/// side are cropped.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fit {
    offered: (usize, usize),
    wanted: (usize, usize),
    /// Number of columns (and of rows) of the offered image per output pixel.
    cell: f64,
}

impl Fit {
    /// Fits images of the `offered` size (columns, rows; px) to the `wanted` size.
    ///
    /// # Errors
    /// If the offered size has fewer columns or rows, or more than `MAX_CROP` would be cropped.
    pub fn new(offered: (usize, usize), wanted: (usize, usize)) -> Result<Self, FitError> {
        if wanted.0 == 0 || wanted.1 == 0 || offered.0 < wanted.0 || offered.1 < wanted.1 {
            return Err(FitError::TooSmall { offered, wanted });
        }
        let columns = offered.0 as f64 / wanted.0 as f64;
        let rows = offered.1 as f64 / wanted.1 as f64;
        let cell = columns.min(rows);
        let (crop, side) = match columns > rows {
            true => (1.0 - cell / columns, "columns"),
            false => (1.0 - cell / rows, "rows"),
        };
        if crop > MAX_CROP {
            return Err(FitError::Shape {
                offered,
                wanted,
                crop,
                side,
            });
        }
        Ok(Self {
            offered,
            wanted,
            cell,
        })
    }

    /// Width and height of the camera's images, px.
    pub fn offered(&self) -> (usize, usize) {
        self.offered
    }

    /// Width and height of the images after scaling, px.
    pub fn wanted(&self) -> (usize, usize) {
        self.wanted
    }

    /// Returns whether the camera's images already have the wanted size.
    pub fn is_exact(&self) -> bool {
        self.offered == self.wanted
    }

    /// Largest of 1, 2, 4 and 8 by which an image can be divided without becoming smaller than the wanted size.
    pub fn denominator(&self) -> usize {
        let fits = |&denominator: &usize| denominator as f64 <= self.cell;
        [8, 4, 2].into_iter().find(fits).unwrap_or(1)
    }

    /// Width and height of a camera's image after scaling down by `denominator`, px.
    pub fn scaled(&self, denominator: usize) -> (usize, usize) {
        let (columns, rows) = self.offered;
        let denominator = denominator.max(1);
        (columns.div_ceil(denominator), rows.div_ceil(denominator))
    }
}

/// Scales images down by averaging source pixels over the area of each output pixel.
///
/// Each source pixel is weighted by its overlap with the area. Filters of image libraries use whole pixels if the
/// scale is not an integer, which shifts markers by up to half a pixel.
#[derive(Debug, Clone)]
pub struct AreaAverage {
    columns: Vec<Span>,
    rows: Vec<Span>,
    /// Weighted sum of the source rows of one output row, by source column.
    sums: Vec<f32>,
}

/// Source pixels that overlap one output pixel, along one axis.
#[derive(Debug, Clone, PartialEq)]
struct Span {
    first: usize,
    /// Weights of the pixels from `first` on; they add up to 1.
    weights: Vec<f32>,
}

impl AreaAverage {
    /// Creates an averager for images that a decoder has already scaled down by `denominator`.
    pub fn new(fit: &Fit, denominator: usize) -> Self {
        let scale = 1.0 / denominator.max(1) as f64;
        let (columns, rows) = fit.scaled(denominator);
        let spans = |offered: usize, wanted: usize, count: usize| {
            let begin = (offered as f64 - fit.cell * wanted as f64) / 2.0;
            let edge = |index: usize| ((begin + fit.cell * index as f64) * scale).max(0.0);
            (0..wanted)
                .map(|index| Span::new(edge(index), edge(index + 1), count))
                .collect()
        };
        Self {
            columns: spans(fit.offered.0, fit.wanted.0, columns),
            rows: spans(fit.offered.1, fit.wanted.1, rows),
            sums: vec![0.0; columns],
        }
    }

    /// Averages `source`, whose rows start `stride` bytes apart, into `pixels`. Missing source pixels count as 0.
    pub fn average(&mut self, source: &[u8], stride: usize, pixels: &mut [u8]) {
        let width = self.columns.len().max(1);
        for (span, row) in self.rows.iter().zip(pixels.chunks_exact_mut(width)) {
            self.sums.fill(0.0);
            let lines = source.chunks(stride.max(1)).skip(span.first);
            for (line, &weight) in lines.zip(&span.weights) {
                for (sum, &pixel) in self.sums.iter_mut().zip(line) {
                    *sum += weight * f32::from(pixel);
                }
            }
            for (span, pixel) in self.columns.iter().zip(row) {
                let sums = self.sums.get(span.first..).unwrap_or_default();
                let sum: f32 = sums.iter().zip(&span.weights).map(|(s, w)| s * w).sum();
                *pixel = (sum + 0.5) as u8;
            }
        }
    }
}

impl Span {
    /// Weights of the pixels (`count` in total) that overlap the interval from `begin` to `end`.
    fn new(begin: f64, end: f64, count: usize) -> Self {
        let last = count.saturating_sub(1);
        let first = (begin as usize).min(last);
        let after = (end.ceil() as usize).clamp(first + 1, last + 1);
        let overlap = |pixel: usize| {
            let pixel = pixel as f64;
            ((pixel + 1.0).min(end) - pixel.max(begin)).max(0.0)
        };
        let total: f64 = (first..after).map(overlap).sum();
        let weights = (first..after).map(|pixel| (overlap(pixel) / total.max(1e-12)) as f32);
        Self {
            first,
            weights: weights.collect(),
        }
    }
}

#[cfg(test)]
#[path = "fit/tests.rs"]
mod tests;
