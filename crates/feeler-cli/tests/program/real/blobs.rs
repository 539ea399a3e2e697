//! Independent detection of round spots, as a reference for `locate`: connected components that differ from a
//! morphological closing (dark spots) or opening (bright spots) of the image.

use feeler::sensor::image::Picture;

/// One connected component.
#[derive(Debug, Clone)]
pub struct Blob {
    /// Centroid of its pixels (column and row, px).
    pub centre: [f64; 2],
    /// Number of pixels.
    pub area: usize,
    /// `true` if it reaches the outermost two rows or columns of the image.
    pub at_border: bool,
}

impl Blob {
    pub fn radius(&self) -> f64 {
        (self.area as f64 / std::f64::consts::PI).sqrt()
    }

    /// Distance from the blob's centre to `place` (column and row, px).
    pub fn distance(&self, place: [f64; 2]) -> f64 {
        (place[0] - self.centre[0]).hypot(place[1] - self.centre[1])
    }
}

/// Finds the spots of an image. `part` is the minimum contrast of a spot, relative to the 98th percentile of the
/// contrast of all pixels. Spots with less than a tenth of the median area are omitted.
pub fn blobs(picture: &Picture, dark: bool, part: f64) -> Vec<Blob> {
    let size = (picture.width, picture.height);
    let gray = picture.pixels.iter().map(|&pixel| f64::from(pixel));
    // Bright spots are dark spots of the negative. The contrast of dark spots is relative to the background.
    let gray: Vec<f64> = gray.map(|g| if dark { g } else { 255.0 - g }).collect();
    let smooth = mean(&gray, size, 1);
    let reach = size.1 / 16;
    let ground = extreme(
        &extreme(&smooth, size, reach, f64::max),
        size,
        reach,
        f64::min,
    );
    let stands_out = |(smooth, ground): (&f64, &f64)| {
        let scale = if dark { ground.max(1.0) } else { 255.0 };
        (ground - smooth) / scale
    };
    let contrast: Vec<f64> = smooth.iter().zip(&ground).map(stands_out).collect();
    let mut sorted = contrast.clone();
    sorted.sort_by(f64::total_cmp);
    let least = part * sorted[sorted.len() * 98 / 100];
    let mut blobs = components(contrast.iter().map(|c| *c > least).collect(), size);
    let median = median_area(&blobs);
    blobs.retain(|blob| 10 * blob.area > median);
    blobs
}

/// Median area of the blobs in pixels, or 0 if there are no blobs.
pub fn median_area(blobs: &[Blob]) -> usize {
    let mut areas: Vec<usize> = blobs.iter().map(|blob| blob.area).collect();
    areas.sort_unstable();
    areas.get(areas.len() / 2).copied().unwrap_or(0)
}

/// Mean over a square window that extends by `reach` pixels to each side.
fn mean(values: &[f64], size: (usize, usize), reach: usize) -> Vec<f64> {
    filter(values, size, reach, &|window| {
        window.iter().sum::<f64>() / window.len() as f64
    })
}

/// Maximum or minimum over such a window.
fn extreme(
    values: &[f64],
    size: (usize, usize),
    reach: usize,
    of: fn(f64, f64) -> f64,
) -> Vec<f64> {
    filter(values, size, reach, &|window| {
        window[1..].iter().fold(window[0], |a, &b| of(a, b))
    })
}

/// Applies a filter along rows, then along columns.
fn filter(
    values: &[f64],
    (width, height): (usize, usize),
    reach: usize,
    of: &dyn Fn(&[f64]) -> f64,
) -> Vec<f64> {
    let along = |values: &[f64], length: usize| -> Vec<f64> {
        let lines = values.chunks(length).flat_map(|line| {
            let window = move |i: usize| &line[i.saturating_sub(reach)..length.min(i + reach + 1)];
            (0..length).map(move |i| of(window(i)))
        });
        lines.collect()
    };
    let turned = |values: &[f64], width: usize| -> Vec<f64> {
        let columns = (0..width).flat_map(|column| values[column..].iter().step_by(width));
        columns.copied().collect()
    };
    let rows = along(values, width);
    turned(&along(&turned(&rows, width), height), height)
}

/// Finds the 4-connected components.
fn components(mut left: Vec<bool>, (width, height): (usize, usize)) -> Vec<Blob> {
    let mut found = Vec::new();
    for start in 0..left.len() {
        if !std::mem::take(&mut left[start]) {
            continue;
        }
        let (mut open, mut sum) = (vec![start], [0.0, 0.0]);
        let (mut area, mut at_border) = (0, false);
        while let Some(index) = open.pop() {
            let (column, row) = (index % width, index / width);
            area += 1;
            sum = [sum[0] + column as f64, sum[1] + row as f64];
            at_border |= column < 2 || row < 2 || column + 2 >= width || row + 2 >= height;
            let beside = [
                (column > 0).then(|| index - 1),
                (column + 1 < width).then(|| index + 1),
                index.checked_sub(width),
                Some(index + width).filter(|&next| next < left.len()),
            ];
            for next in beside.into_iter().flatten() {
                if std::mem::take(&mut left[next]) {
                    open.push(next);
                }
            }
        }
        let centre = sum.map(|sum| sum / area as f64);
        found.push(Blob {
            centre,
            area,
            at_border,
        });
    }
    found
}
