//! A tile: a piece of a sub-region with smooth weights, of at most 64x64 px.
//!
//! A piece of at most a half or a quarter of this width is folded: its rows are divided into two or four bands, which
//! are placed side by side in the tile. The tile then has correspondingly fewer rows.
//!
//! A tile consists of sixteen strips side by side, each [`STRIP`] px wide. The sums of a strip are integers, so the
//! order of summation does not matter. With `g` the pixel above the dark level, `k` its position across the strip and
//! `m` its row counted upwards from the tile's last row, which is 1, the ten sums are of `g` times
//!
//! ```text
//! 1  m  m(m+1)/2  m(m+1)(m+2)/6      for k^0, {1, 1, 1, 1}
//! 1  m  m(m+1)/2                     for k^1, {-3, -1, 1, 3}
//! 1  m                               for k^2, {1, -1, -1, 1}
//! 1                                  for k^3, {-1, 3, -3, 1}
//! ```
//!
//! The powers of `m` are cumulative sums, with one addition per row each. Any weight that is a cubic polynomial
//! within each strip is a linear combination of the ten sums; see `fit`.

/// Columns of a tile, px.
pub(super) const TILE_WIDTH: usize = 64;

/// Maximum number of rows of a tile, px. It ensures that no sum exceeds `4 * 255 * 766480`, which fits into an `i32`:
/// `64 * 65 * 66 * 67 / 24 = 766480` is the sum of all `m(m+1)(m+2)/6`.
pub(super) const TILE_ROWS: usize = 64;

/// Columns of a strip, px.
pub(super) const STRIP: usize = 4;

/// Number of strips of a tile.
pub(super) const STRIPS: usize = TILE_WIDTH / STRIP;

/// Number of quarters of a tile's columns; a quarter of four strips fits into the narrowest vectors.
pub(super) const QUARTERS: usize = 4;

/// Columns of a quarter, px.
pub(super) const QUARTER_WIDTH: usize = TILE_WIDTH / QUARTERS;

/// Number of sums per strip.
pub(super) const SUMS: usize = 10;

/// Factors of the pixels across a strip: one row of four factors for each power of the position.
pub(super) const ACROSS: [[i8; STRIP]; 4] =
    [[1, 1, 1, 1], [-3, -1, 1, 3], [1, -1, -1, 1], [-1, 3, -3, 1]];

/// Number of powers of the row index that are summed with each row of [`ACROSS`].
pub(super) const ROW_POWERS: [usize; 4] = [4, 3, 2, 1];

/// Number of quantities from which moments are computed: gray value, gray value times x, gray value times y.
pub(super) const WEIGHTS: usize = 3;

/// Weights of each strip's sums in the quantities gray value, gray value times x, gray value times y.
#[derive(Debug, Clone, PartialEq)]
#[repr(align(64))]
pub(super) struct TileWeights(pub [[[f32; STRIPS]; SUMS]; WEIGHTS]);

/// One byte for each pixel in a row of a tile.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(64))]
pub(super) struct Row(pub [u8; TILE_WIDTH]);

/// Position of a tile and weights of its sums.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tile {
    /// Index of the tile's first pixel in the image.
    pub offset: usize,
    /// Index in the kernel's masks of the mask of the tile's first row.
    pub first_mask: usize,
    /// Number of rows of the tile.
    pub rows: usize,
    /// Number of bands side by side.
    pub bands: usize,
    /// Offset in the image from the tile's first pixel to the first pixel of each quarter of the columns.
    pub quarters: [usize; QUARTERS],
    /// First row with pixels of the sub-region, for each quarter of the columns; `rows` if it has none. Earlier
    /// rows contribute nothing to the quarter's sums.
    pub first_rows: [usize; QUARTERS],
    /// Weights of the strips' sums.
    pub weights: TileWeights,
}

impl Tile {
    /// Index of the pixel at `row` and `column` of the tile, in an image of `width` columns.
    pub fn pixel(&self, row: usize, column: usize, width: usize) -> usize {
        let (quarter, column) = (column / QUARTER_WIDTH, column % QUARTER_WIDTH);
        self.offset + self.quarters[quarter] + row * width + column
    }
}

/// Contribution to a strip's sums of a single pixel of gray value 1, `across` px from the strip's left edge, in row
/// `m`. Rows are counted upwards from the tile's last row, which is 1.
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
