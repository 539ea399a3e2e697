//! Measures a marker from the pixels around a position.

use crate::sensor::image::polarity::Polarity;
use glam::DVec2;
use multiversion::multiversion;

/// Contrast below which the window shows no marker, gray levels.
pub(super) const MIN_CONTRAST: f64 = 6.0;
/// Maximum width of a window, px.
const WIDEST: usize = 128;
/// Maximum number of times a window is recentred on the centroid.
const STEPS: usize = 5;
/// Maximum distance of the centroid from the window's centre for a valid measurement, px.
const SETTLED: f64 = 0.8;

/// A disc-shaped window of pixels.
#[derive(Debug, Clone)]
pub(super) struct Window {
    /// Radius, px. The window has `2 * radius + 1` columns and rows.
    radius: usize,
    /// First column and number of columns of each row.
    rows: Vec<(usize, usize)>,
}

/// Result of measuring in a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Look {
    /// A marker.
    Seen(Seen),
    /// A marker with this contrast (gray levels), but its centroid is too far from the window's centre.
    Elsewhere(f64),
    /// No marker: the window is outside the image or uniformly gray.
    Nothing,
}

/// A marker measured in a window.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Seen {
    /// Column and row of the centroid, px.
    pub place: DVec2,
    /// Contrast between background and marker, gray levels.
    pub contrast: f64,
    /// Sum of gray levels over the pixels above the threshold, gray levels px².
    pub sum: f64,
}

impl Window {
    /// Creates a window of about `radius` px.
    pub fn new(radius: f64) -> Self {
        let radius = (radius.round() as usize).clamp(2, WIDEST / 2 - 1);
        let row = |row: usize| {
            let dy = row as f64 - radius as f64;
            let reach = ((radius as f64 + 0.5).powi(2) - dy * dy).max(0.0).sqrt() as usize;
            (radius - reach.min(radius), 2 * reach.min(radius) + 1)
        };
        Self {
            radius,
            rows: (0..=2 * radius).map(row).collect(),
        }
    }

    /// Measures the marker around the position `about` in an image of `size` px, if most of the window is inside the
    /// image.
    pub fn look(
        &self,
        pixels: &[u8],
        size: (usize, usize),
        polarity: Polarity,
        about: DVec2,
    ) -> Look {
        let flip = match polarity {
            Polarity::Bright => 0,
            Polarity::Dark => u8::MAX,
        };
        let (mut centre, mut contrast) = (about.round(), 0.0);
        for _ in 0..STEPS {
            let cut = self.cut(size, centre);
            let Some(sums) = cut.and_then(|cut| sums(pixels, &cut, &self.rows, flip)) else {
                break;
            };
            contrast = sums.contrast;
            let place = centre + sums.centroid - self.radius as f64;
            // A centroid farther away than the window's radius belongs to another marker.
            if place.distance(about) > self.radius as f64 {
                break;
            }
            if place.distance(centre) <= SETTLED {
                let sum = sums.total;
                return Look::Seen(Seen {
                    place,
                    contrast,
                    sum,
                });
            }
            centre = place.round();
        }
        // The window was drawn farther and farther away along the flank of another marker.
        match contrast > 0.0 {
            true => Look::Elsewhere(contrast),
            false => Look::Nothing,
        }
    }

    /// Part of a window at `centre` that is inside the image; `None` if it is too small.
    fn cut(&self, (width, height): (usize, usize), centre: DVec2) -> Option<Cut> {
        let radius = self.radius as isize;
        let (column, row) = (centre.x as isize - radius, centre.y as isize - radius);
        let side = 2 * radius + 1;
        let inside = |first: isize, end: usize| {
            let low = (-first).max(0);
            let high = (end as isize - first).min(side);
            (high - low >= radius + 2).then_some((low as usize, high as usize))
        };
        Some(Cut {
            width,
            column,
            row,
            columns: inside(column, width)?,
            rows: inside(row, height)?,
        })
    }
}

/// Part of a window that is inside an image.
struct Cut {
    width: usize,
    /// Column in the image of the window's left edge; may be outside the image.
    column: isize,
    /// Row in the image of the window's upper edge; may be outside the image.
    row: isize,
    /// Range of the window's columns inside the image.
    columns: (usize, usize),
    /// Range of the window's rows inside the image.
    rows: (usize, usize),
}

struct Sums {
    contrast: f64,
    total: f64,
    /// Column and row of the centroid in the window, px.
    centroid: DVec2,
}

/// Computes moments of the pixels that exceed 0.4 of the contrast in the window, using SIMD instructions if available.
#[multiversion(targets("x86_64+avx2"))]
fn sums(pixels: &[u8], cut: &Cut, rows: &[(usize, usize)], flip: u8) -> Option<Sums> {
    let span = |row: usize| {
        let (first, count) = *rows.get(row)?;
        let (first, end) = (first.max(cut.columns.0), (first + count).min(cut.columns.1));
        let start = (cut.row + row as isize) * cut.width as isize + cut.column + first as isize;
        let start = usize::try_from(start).ok()?;
        Some((first, pixels.get(start..start + end.checked_sub(first)?)?))
    };
    let (mut low, mut high) = (u8::MAX, 0);
    for row in cut.rows.0..cut.rows.1 {
        for &pixel in span(row)?.1 {
            let pixel = pixel ^ flip;
            low = low.min(pixel);
            high = high.max(pixel);
        }
    }
    let level = low + ((u16::from(high - low) * 2) / 5) as u8;
    let mut columns = [0_u32; WIDEST];
    let (mut total, mut down) = (0_u32, 0_u32);
    for row in cut.rows.0..cut.rows.1 {
        let (first, pixels) = span(row)?;
        let mut sum = 0;
        for (column, &pixel) in columns.get_mut(first..)?.iter_mut().zip(pixels) {
            let above = u32::from((pixel ^ flip).saturating_sub(level));
            *column += above;
            sum += above;
        }
        total += sum;
        down += sum * row as u32;
    }
    let across = columns.iter().zip(0_u32..);
    let across: u32 = across.map(|(sum, column)| sum * column).sum();
    let weight = f64::from(total);
    (total > 0).then(|| Sums {
        contrast: f64::from(high - low),
        total: weight,
        centroid: DVec2::new(f64::from(across), f64::from(down)) / weight,
    })
}
