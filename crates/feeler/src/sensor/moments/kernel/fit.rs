//! Divides a sub-region into tiles and fits their weights.
//!
//! A tile is as tall as possible while the error of every pixel's weights is within [`TOLERANCE`]. A tile of one row
//! reproduces any weights exactly, as four pixels have four sums. If every pixel's area is within the tolerance, so is
//! every `G`, and the error of a centroid is at most twice the tolerance times the sub-region's radius, for any image.

use super::tile::{
    QUARTER_WIDTH, QUARTERS, STRIP, STRIPS, SUMS, TILE_ROWS, TILE_WIDTH, Tile, TileWeights,
    WEIGHTS, basis,
};
use crate::sensor::image::subregion::WeightedPixel;
use std::ops::Range;

/// Maximum error of a pixel's area relative to the area, and of its area times position relative to the area times
/// the distance of the farthest pixel.
const TOLERANCE: f64 = 3e-5;

/// Fraction of the tolerance below which no further sums are added to a fit, because they would mostly cancel each
/// other.
const GOOD_ENOUGH: f64 = 0.125;

/// Relative rounding error of each term in `f32`: of the weight, its product with a sum, and the total.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64 / 2.0;

/// Minimum number of rows that folding must save to compensate for the additional strips.
const MIN_SAVED: usize = 8;

/// Order in which sums are added to a fit: by increasing degree of their polynomial.
const BY_DEGREE: [usize; SUMS] = [0, 1, 4, 2, 5, 7, 3, 6, 8, 9];

/// Relative remainder below which a sum counts as linearly dependent on the previous ones.
const INDEPENDENT: f64 = 1e-9;

/// Tiles created so far for the sub-regions.
#[derive(Debug, Default)]
pub(super) struct Tiling {
    pub tiles: Vec<Tile>,
    /// Bit mask of the pixels that belong to the sub-region, for each row of each tile; the first pixel is the lowest
    /// bit.
    pub masks: Vec<u64>,
}

/// Target of the fit for one pixel of a strip: its contribution to the sums per gray level, and the weights that the
/// fit must reproduce.
struct Target {
    sums: [f64; SUMS],
    weights: [f64; WEIGHTS],
    tolerance: [f64; WEIGHTS],
}

impl Tiling {
    /// Divides a sub-region of an image with `width` columns into tiles and adds them.
    pub(super) fn add(&mut self, region: &[WeightedPixel], width: usize) {
        let mut pixels = region.to_vec();
        pixels.sort_by_key(|pixel| (pixel.row, pixel.column));
        pixels.dedup_by_key(|pixel| (pixel.row, pixel.column));
        let reach = pixels.iter().map(|p| p.point.length()).fold(0.0, f64::max);
        let columns = || pixels.iter().map(|pixel| pixel.column);
        let (Some(first), Some(last)) = (columns().min(), columns().max()) else {
            return;
        };
        // Split into columns that can be folded without gaps, none narrower than a quarter of a tile.
        let mut left = first;
        while left <= last {
            let across = match (last - left) / QUARTER_WIDTH {
                0 => QUARTER_WIDTH,
                1 | 2 => 2 * QUARTER_WIDTH,
                _ => TILE_WIDTH,
            };
            let columns = left..left + across;
            let own = pixels.iter().filter(|p| columns.contains(&p.column));
            self.add_column(&own.copied().collect::<Vec<_>>(), &columns, width, reach);
            left += across;
        }
    }

    /// Adds the tiles that cover `pixels`, which are sorted by row and all within `columns`. The number of columns is
    /// that of a tile, or a half or a quarter of it.
    fn add_column(
        &mut self,
        pixels: &[WeightedPixel],
        columns: &Range<usize>,
        width: usize,
        reach: f64,
    ) {
        let (Some(first), Some(last)) = (pixels.first(), pixels.last()) else {
            return;
        };
        let (top, height) = (first.row, last.row - first.row + 1);
        let bands = bands(columns.len(), height);
        let (rows, across) = (height.div_ceil(bands), TILE_WIDTH / bands);
        let in_tile = |pixel| {
            let WeightedPixel { row, column, .. } = pixel;
            let band = (row - top) / rows;
            InTile {
                row: (row - top) % rows,
                column: band * across + column - columns.start,
                pixel,
            }
        };
        let own: Vec<_> = pixels.iter().copied().map(in_tile).collect();
        let weights = (rows <= TILE_ROWS)
            .then(|| fit(&own, rows, reach))
            .flatten();
        let Some(weights) = weights else {
            let middle = pixels.partition_point(|pixel| pixel.row < top + height / 2);
            let (upper, lower) = pixels.split_at(middle);
            self.add_column(upper, columns, width, reach);
            self.add_column(lower, columns, width, reach);
            return;
        };
        let first_mask = self.masks.len();
        self.masks.resize(first_mask + rows, 0);
        let mut first_rows = [rows; QUARTERS];
        for &InTile { row, column, .. } in &own {
            self.masks[first_mask + row] |= 1 << column;
            let first_row = &mut first_rows[column / QUARTER_WIDTH];
            *first_row = (*first_row).min(row);
        }
        self.tiles.push(Tile {
            offset: top * width + columns.start,
            first_mask,
            rows,
            bands,
            quarters: std::array::from_fn(|quarter| {
                let column = quarter * QUARTER_WIDTH;
                column / across * rows * width + column % across
            }),
            first_rows,
            weights,
        });
    }
}

/// A pixel with its position in its tile.
struct InTile {
    row: usize,
    column: usize,
    pixel: WeightedPixel,
}

/// Number of bands into which a piece of `columns` x `rows` px is folded.
fn bands(columns: usize, rows: usize) -> usize {
    let bands = TILE_WIDTH / columns;
    match rows - rows.div_ceil(bands) {
        MIN_SAVED.. => bands,
        _ => 1,
    }
}

/// Fits the weights of a tile's sums. `None` if they do not reproduce the weights of the `pixels` within the tolerance
/// and the tile can be split because it has several rows.
fn fit(pixels: &[InTile], rows: usize, reach: f64) -> Option<TileWeights> {
    let mut tile = TileWeights([[[0.0; STRIPS]; SUMS]; WEIGHTS]);
    for strip in 0..STRIPS {
        let own = pixels.iter().filter(|own| own.column / STRIP == strip);
        let targets: Vec<_> = own
            .map(|InTile { row, column, pixel }| Target {
                sums: basis(column % STRIP, rows - row),
                weights: [1.0, pixel.point.x, pixel.point.y].map(|factor| pixel.area * factor),
                tolerance: [1.0, reach, reach].map(|unit| TOLERANCE * unit * pixel.area),
            })
            .collect();
        let weights = least_squares(&targets);
        if rows > 1 && !targets.iter().all(|target| met(target, &weights)) {
            return None;
        }
        for (tile, weights) in tile.0.iter_mut().zip(weights) {
            for (sum, weight) in tile.iter_mut().zip(weights) {
                sum[strip] = weight as f32;
            }
        }
    }
    Some(tile)
}

/// Returns whether the fitted weights reproduce the target weights of a pixel within the tolerance, including rounding.
fn met(target: &Target, weights: &[[f64; SUMS]; WEIGHTS]) -> bool {
    (0..WEIGHTS).all(|index| {
        let terms = weights[index]
            .iter()
            .zip(&target.sums)
            .map(|(w, sum)| w * sum);
        let (value, size) = terms.fold((0.0, 0.0), |(value, size), term: f64| {
            (value + term, size + term.abs())
        });
        let error = (value - target.weights[index]).abs();
        error + ROUNDING * size <= target.tolerance[index]
    })
}

/// A linear combination of a strip's sums.
struct Direction {
    /// Value of the combination at each target. The vector is normalized and orthogonal to those of all other
    /// directions.
    values: Vec<f64>,
    /// Coefficients of the linear combination, one per sum.
    combination: [f64; SUMS],
}

/// Weights of the sums that best approximate the weights of all targets, using as few sums as necessary.
fn least_squares(targets: &[Target]) -> [[f64; SUMS]; WEIGHTS] {
    let directions = directions(targets);
    std::array::from_fn(|index| {
        let mut fitted = [0.0; SUMS];
        let mut rest: Vec<_> = targets.iter().map(|t| t.weights[index]).collect();
        for direction in &directions {
            let good_enough = |(rest, target): (&f64, &Target)| {
                rest.abs() <= GOOD_ENOUGH * target.tolerance[index]
            };
            if rest.iter().zip(targets).all(good_enough) {
                break;
            }
            let share = dot(&rest, &direction.values);
            subtract(&mut rest, share, &direction.values);
            subtract(&mut fitted, -share, &direction.combination);
        }
        fitted
    })
}

/// Orthogonalizes the sums (Gram-Schmidt); linearly dependent sums are omitted.
fn directions(targets: &[Target]) -> Vec<Direction> {
    let mut directions: Vec<Direction> = Vec::with_capacity(SUMS);
    for sum in BY_DEGREE {
        let mut values: Vec<_> = targets.iter().map(|target| target.sums[sum]).collect();
        let mut combination = [0.0; SUMS];
        combination[sum] = 1.0;
        let whole = dot(&values, &values).sqrt();
        // The second pass removes rounding errors.
        for _ in 0..2 {
            for before in &directions {
                let share = dot(&values, &before.values);
                subtract(&mut values, share, &before.values);
                subtract(&mut combination, share, &before.combination);
            }
        }
        let length = dot(&values, &values).sqrt();
        if length > INDEPENDENT * whole {
            values.iter_mut().for_each(|value| *value /= length);
            directions.push(Direction {
                values,
                combination: combination.map(|share| share / length),
            });
        }
    }
    directions
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn subtract(from: &mut [f64], share: f64, what: &[f64]) {
    for (from, what) in from.iter_mut().zip(what) {
        *from -= share * what;
    }
}
