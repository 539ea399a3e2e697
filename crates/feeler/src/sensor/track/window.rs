//! A marker as the pixels about a place show it.

use crate::sensor::polarity::Polarity;
use glam::DVec2;
use multiversion::multiversion;

/// Contrast below which nothing is seen, grey levels.
pub(super) const LEAST_CONTRAST: f64 = 6.0;
/// Widest window, px.
const WIDEST: usize = 128;
/// Times that a window follows the centroid in it.
const STEPS: usize = 5;
/// Distance of the centroid from the window's centre at which it is the marker's, px.
const SETTLED: f64 = 0.8;

/// A disc of pixels.
#[derive(Debug, Clone)]
pub(super) struct Window {
    /// Radius, px: its columns and rows are twice as many and one.
    radius: usize,
    /// First column and number of columns of each row.
    rows: Vec<(usize, usize)>,
}

/// What is seen in a window.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Look {
    /// A marker.
    Seen(Seen),
    /// Something of this contrast, grey levels, which lies elsewhere.
    Elsewhere(f64),
    /// Nothing: the window is outside the picture, or shows one grey level.
    Nothing,
}

/// A marker in a window.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Seen {
    /// Column and row of the centroid, px.
    pub place: DVec2,
    /// From ground to marker, grey levels.
    pub contrast: f64,
    /// Sum over the pixels above the level, grey levels px².
    pub sum: f64,
}

impl Window {
    /// One of about `radius` px.
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

    /// The marker about the place `about` in a picture of `size` px, if most of the window is inside the picture.
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
            // Beyond its own radius it is another's.
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
        // The flank of another marker draws the window ever farther.
        match contrast > 0.0 {
            true => Look::Elsewhere(contrast),
            false => Look::Nothing,
        }
    }

    /// The part of the window that is in the picture, if that is most of it.
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

/// Where a window lies in a picture.
struct Cut {
    width: usize,
    /// Column and row of the window's corner, which may be outside.
    column: isize,
    row: isize,
    /// Columns and rows of the window that are inside.
    columns: (usize, usize),
    rows: (usize, usize),
}

struct Sums {
    contrast: f64,
    total: f64,
    /// Column and row in the window.
    centroid: DVec2,
}

/// Weighs pixels that stand out by more than 0.4 of the contrast in the window, with the widest instructions that the processor has.
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
