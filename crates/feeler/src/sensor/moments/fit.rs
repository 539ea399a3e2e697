//! Cuts a sub-region into tiles and fits their weights, so closely that no picture can tell.
//!
//! A tile is as tall as it can be with every pixel's weights met to [`TOLERANCE`]; a tile of one row
//! meets any weights exactly, as four pixels have four sums. With every pixel's area right to the
//! tolerance so is every `G`, and no centroid is off by more than twice the tolerance times the
//! sub-region's radius, whatever the picture.

use super::{
    super::subregion::WeightedPixel,
    tile::{
        QUARTER_WIDTH, QUARTERS, STRIP, STRIPS, SUMS, TILE_ROWS, TILE_WIDTH, Tile, TileWeights,
        WEIGHTS, basis,
    },
};
use std::ops::Range;

/// Largest error of a pixel's area, of itself, and of its area times place, of its area times the
/// distance of the farthest pixel.
const TOLERANCE: f64 = 3e-5;

/// Share of the tolerance at which a fit is good enough: more sums would cancel each other.
const GOOD_ENOUGH: f64 = 0.125;

/// Rounding of a weight, of its product with a sum and of the total, as `f32`, of each term.
const ROUNDING: f64 = 4.0 * f32::EPSILON as f64 / 2.0;

/// Folding must save so many rows: more strips' sums are to be weighed for it.
const LEAST_SAVED: usize = 8;

/// The sums by the degree of their polynomial, the smoothest first.
const BY_DEGREE: [usize; SUMS] = [0, 1, 4, 2, 5, 7, 3, 6, 8, 9];

/// A sum that is but this far from a combination of those before it adds nothing but rounding.
const INDEPENDENT: f64 = 1e-9;

/// The tiles of some sub-regions, as they are made.
#[derive(Debug, Default)]
pub(super) struct Tiling {
    /// The tiles.
    pub tiles: Vec<Tile>,
    /// For each row of each tile, which of its pixels belong to the sub-region, the first lowest.
    pub masks: Vec<u64>,
}

/// A pixel of a strip: what its gray value adds to the sums, and what it shall count for.
struct Target {
    sums: [f64; SUMS],
    weights: [f64; WEIGHTS],
    tolerance: [f64; WEIGHTS],
}

impl Tiling {
    /// Adds the tiles of a sub-region in pictures of `width` columns.
    pub(super) fn add(&mut self, region: &[WeightedPixel], width: usize) {
        let mut pixels = region.to_vec();
        pixels.sort_by_key(|pixel| (pixel.row, pixel.column));
        pixels.dedup_by_key(|pixel| (pixel.row, pixel.column));
        let reach = pixels.iter().map(|p| p.point.length()).fold(0.0, f64::max);
        let columns = || pixels.iter().map(|pixel| pixel.column);
        let (Some(first), Some(last)) = (columns().min(), columns().max()) else {
            return;
        };
        // In columns that are folded without gaps, and none narrower than a quarter of a tile.
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

    /// Adds the tiles of `pixels`, sorted by row, all in these `columns`, which are as many as a tile has, or a half or a quarter of it.
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

/// A pixel, and where it lies in its tile.
struct InTile {
    row: usize,
    column: usize,
    pixel: WeightedPixel,
}

/// In how many bands a piece of so many columns and rows is folded.
fn bands(columns: usize, rows: usize) -> usize {
    let bands = TILE_WIDTH / columns;
    match rows - rows.div_ceil(bands) {
        LEAST_SAVED.. => bands,
        _ => 1,
    }
}

/// The weights of the sums of a tile of so many `rows`, or nothing if they do not meet those of its `pixels` to the tolerance and the
/// tile has rows to be split.
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

/// Whether a pixel's weights come out of its sums as they shall, whatever the rounding.
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

/// A combination of a strip's sums.
struct Direction {
    /// Its value for each of the targets; together of length 1, and square to all other directions.
    values: Vec<f64>,
    /// How much of each sum it holds.
    combination: [f64; SUMS],
}

/// Weights of the sums that come nearest to those of all targets, with no more sums than it takes.
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

/// Gram and Schmidt's directions; a sum that depends on those before it has none.
fn directions(targets: &[Target]) -> Vec<Direction> {
    let mut directions: Vec<Direction> = Vec::with_capacity(SUMS);
    for sum in BY_DEGREE {
        let mut values: Vec<_> = targets.iter().map(|target| target.sums[sum]).collect();
        let mut combination = [0.0; SUMS];
        combination[sum] = 1.0;
        let whole = dot(&values, &values).sqrt();
        // Once more for what rounding has left.
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
