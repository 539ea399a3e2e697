//! A tile: a piece of a sub-region on which the weights are smooth, in at most 64x64 px.
//!
//! A piece that is at most a half or a quarter as wide is folded: its rows are cut into two or four bands, which lie side by side in its
//! tile, so that this has that many times fewer rows.
//!
//! A tile is sixteen strips side by side, each [`STRIP`] px wide. What is summed of a strip are
//! integers, so that the order of summation does not matter: with `g` the pixel above the dark
//! level, `k` its place across the strip and `m` its row counted upwards from the tile's last, which
//! is 1, the ten sums of `g` times
//!
//! ```text
//! 1  m  m(m+1)/2  m(m+1)(m+2)/6      for k^0, {1, 1, 1, 1}
//! 1  m  m(m+1)/2                     for k^1, {-3, -1, 1, 3}
//! 1  m                               for k^2, {1, -1, -1, 1}
//! 1                                  for k^3, {-1, 3, -3, 1}
//! ```
//!
//! The powers of `m` are sums of sums, one addition to a row each. Any weight that is a cubic
//! polynomial within each strip is a combination of the ten; see `fit`.

/// Columns of a tile, px.
pub(super) const TILE_WIDTH: usize = 64;

/// Most rows of a tile, px. Then no sum exceeds `4 * 255 * 766480`, which an `i32` holds:
/// `64 * 65 * 66 * 67 / 24 = 766480` is the sum of all `m(m+1)(m+2)/6`.
pub(super) const TILE_ROWS: usize = 64;

/// Columns of a strip, px.
pub(super) const STRIP: usize = 4;

/// Strips of a tile.
pub(super) const STRIPS: usize = TILE_WIDTH / STRIP;

/// Quarters of a tile's columns, of four strips each: what the narrowest vectors hold.
pub(super) const QUARTERS: usize = 4;

/// Columns of a quarter, px.
pub(super) const QUARTER_WIDTH: usize = TILE_WIDTH / QUARTERS;

/// Sums of a strip.
pub(super) const SUMS: usize = 10;

/// Factors of a strip's pixels, one row for each power of the place across the strip.
pub(super) const ACROSS: [[i8; STRIP]; 4] =
    [[1, 1, 1, 1], [-3, -1, 1, 3], [1, -1, -1, 1], [-1, 3, -3, 1]];

/// For each of [`ACROSS`], how many powers of the row are summed.
pub(super) const ROW_POWERS: [usize; 4] = [4, 3, 2, 1];

/// The three sums that moments are made of: gray, gray times x, gray times y.
pub(super) const WEIGHTS: usize = 3;

/// What the sums of each strip count for in gray, gray times x and gray times y.
#[derive(Debug, Clone, PartialEq)]
#[repr(align(64))]
pub(super) struct TileWeights(pub [[[f32; STRIPS]; SUMS]; WEIGHTS]);

/// A byte for each pixel of a tile's row.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub(super) struct Row(pub [u8; TILE_WIDTH]);

/// Where a tile is, and what its pixels count for.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tile {
    /// Where in the picture its first pixel is.
    pub offset: usize,
    /// Index of its first row's mask among the kernel's.
    pub first_mask: usize,
    /// How many rows it has.
    pub rows: usize,
    /// How many bands lie side by side in it.
    pub bands: usize,
    /// How far the first pixel of each quarter of its columns is from the tile's first in the picture.
    pub quarters: [usize; QUARTERS],
    /// For each quarter of its columns, the first row with pixels of the sub-region; `rows` if there is none. Rows before it add
    /// nothing to the quarter's sums.
    pub first_rows: [usize; QUARTERS],
    /// What its sums count for.
    pub weights: TileWeights,
}

impl Tile {
    /// Where in a picture of `width` columns the pixel is that lies in `row` and `column` of the tile.
    pub fn pixel(&self, row: usize, column: usize, width: usize) -> usize {
        let (quarter, column) = (column / QUARTER_WIDTH, column % QUARTER_WIDTH);
        self.offset + self.quarters[quarter] + row * width + column
    }
}

/// The sums of one pixel of gray value 1, `across` px from its strip's left, `m` rows from the
/// tile's last, which is 1.
pub(super) fn basis(across: usize, m: usize) -> [f64; SUMS] {
    let m = m as f64;
    let powers = [1.0, m, m * (m + 1.0) / 2.0, m * (m + 1.0) * (m + 2.0) / 6.0];
    let mut basis = [0.0; SUMS];
    let mut sums = basis.iter_mut();
    for (factors, count) in ACROSS.iter().zip(ROW_POWERS) {
        for (power, sum) in powers[..count].iter().zip(sums.by_ref()) {
            *sum = f64::from(factors[across]) * power;
        }
    }
    basis
}
