//! Sums of a tile in plain loops, which the compiler can vectorize.

use super::{
    ElementMoments, MomentsKernel,
    sum::{TileRows, Totals, all_elements},
    tile::{QUARTER_WIDTH, QUARTERS, Row, STRIP, STRIPS, SUMS, TILE_ROWS, TILE_WIDTH, TileWeights},
};

/// Number of strips processed together: a quarter of a tile.
const LANES: usize = STRIPS / QUARTERS;

/// Computes the moments of all elements.
///
/// The background is subtracted from all rows of a tile before they are summed. In a combined loop, the compiler would
/// not vectorize.
pub(super) fn all_moments(
    kernel: &MomentsKernel,
    pixels: &[u8],
    next: &[u8],
    moments: &mut [ElementMoments],
) {
    let mut bright = [Row([0; TILE_WIDTH]); TILE_ROWS];
    all_elements(kernel, pixels, next, moments, |tile, weights, totals| {
        brighten(tile, &mut bright);
        let rows = bright.get(..tile.count()).unwrap_or(&[]);
        for (quarter, &first) in tile.first_rows.iter().enumerate() {
            match rows.get(first..) {
                None | Some([]) => {}
                Some(rows) => add_quarter(quarter_sums(rows, quarter), quarter, weights, totals),
            }
        }
    });
}

/// Computes gray levels above the background for the pixels of a tile; 0 for pixels outside the sub-region.
#[inline(always)]
fn brighten(tile: &TileRows, bright: &mut [Row; TILE_ROWS]) {
    for quarter in 0..QUARTERS {
        let rows = tile.with_background::<1, QUARTER_WIDTH>(QUARTER_WIDTH * quarter, 0);
        for (bright, ([pixels], ground)) in bright.iter_mut().zip(rows) {
            let bright = &mut bright.0.as_chunks_mut::<QUARTER_WIDTH>().0[quarter];
            let ground = &ground.0.as_chunks::<QUARTER_WIDTH>().0[quarter];
            for ((bright, &pixel), &ground) in bright.iter_mut().zip(pixels).zip(ground) {
                *bright = if tile.dark {
                    ground.saturating_sub(pixel)
                } else {
                    pixel.saturating_sub(ground)
                };
            }
        }
    }
}

/// Adds the weighted sums of the strips of one quarter to the totals.
#[inline(always)]
fn add_quarter(
    sums: [[i32; LANES]; SUMS],
    quarter: usize,
    weights: &TileWeights,
    totals: &mut Totals,
) {
    for (total, weights) in totals.0.iter_mut().zip(&weights.0) {
        let total = &mut total.as_chunks_mut::<LANES>().0[quarter];
        for (sums, weights) in sums.iter().zip(weights) {
            let weights = &weights.as_chunks::<LANES>().0[quarter];
            for lane in 0..LANES {
                total[lane] += weights[lane] * sums[lane] as f32;
            }
        }
    }
}

/// Sums of the strips in one quarter of the tile.
#[inline(always)]
fn quarter_sums(rows: &[Row], quarter: usize) -> [[i32; LANES]; SUMS] {
    let zero = [0; LANES];
    let [mut a0, mut a1, mut a2, mut a3] = [zero; 4];
    let [mut b0, mut b1, mut b2] = [zero; 3];
    let [mut c0, mut c1] = [zero; 2];
    let mut d0 = zero;
    for row in rows {
        let strips = row.0.as_chunks::<STRIP>().0;
        let strips = &strips.as_chunks::<LANES>().0[quarter];
        for lane in 0..LANES {
            // As one integer, so that the strip stays in its lane.
            let strip = u32::from_le_bytes(strips[lane]);
            let pixel = |place: usize| (strip >> (8 * place) & 0xff) as i32;
            let (outer, inner) = (pixel(0) + pixel(3), pixel(1) + pixel(2));
            let (across, between) = (pixel(3) - pixel(0), pixel(2) - pixel(1));
            // The rows of `ACROSS`, one after the other.
            a0[lane] += outer + inner;
            a1[lane] += a0[lane];
            a2[lane] += a1[lane];
            a3[lane] += a2[lane];
            b0[lane] += 3 * across + between;
            b1[lane] += b0[lane];
            b2[lane] += b1[lane];
            c0[lane] += outer - inner;
            c1[lane] += c0[lane];
            d0[lane] += across - 3 * between;
        }
    }
    [a0, a1, a2, a3, b0, b1, b2, c0, c1, d0]
}

#[cfg(test)]
mod tests {
    use super::{super::tile::basis, *};

    /// Tests arbitrary pixels, and the maximum values in the tallest tile.
    #[test]
    fn sums_equal_their_definition() {
        let mut word = 1_u32;
        for (rows, any) in [(1, true), (2, true), (17, true), (64, true), (64, false)] {
            let mut pixel = || {
                word = word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                if any { (word >> 24) as u8 } else { 255 }
            };
            let rows: Vec<_> = (0..rows)
                .map(|_| Row(std::array::from_fn(|_| pixel())))
                .collect();
            for quarter in 0..QUARTERS {
                let sums = quarter_sums(&rows, quarter);
                for lane in 0..LANES {
                    let left = (quarter * LANES + lane) * STRIP;
                    let mut expected = [0.0; SUMS];
                    for (row, pixels) in rows.iter().enumerate() {
                        for across in 0..STRIP {
                            let pixel = f64::from(pixels.0[left + across]);
                            let basis = basis(across, rows.len() - row);
                            for (expected, basis) in expected.iter_mut().zip(basis) {
                                *expected += pixel * basis;
                            }
                        }
                    }
                    assert_eq!(sums.map(|sum| f64::from(sum[lane])), expected);
                }
            }
        }
    }
}
