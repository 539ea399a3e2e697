//! Size of the connected bright region around a maximum.

use super::reference::ReferencePicture;
use std::f64::consts::SQRT_2;

/// Flood fill over bright pixels, with buffers that are reused for each maximum.
#[derive(Debug, Default)]
pub(super) struct Outline {
    /// Visited pixels of the square around the maximum, row by row.
    visited: Vec<bool>,
    /// Columns and rows of the pixels to visit.
    open: Vec<(usize, usize)>,
}

impl Outline {
    /// Returns `true` if the bright region around a maximum is larger than a spot of scale `sigma`, as for a
    /// reflection.
    pub fn exceeds(&mut self, picture: &ReferencePicture, index: usize, sigma: f64) -> bool {
        let (width, height) = (picture.width, picture.height);
        let (column, row) = (index % width, index / width);
        let around = (3.0 * sigma).ceil() as usize;
        let columns = column.saturating_sub(around)..(column + around + 1).min(width);
        let rows = row.saturating_sub(around)..(row + around + 1).min(height);
        let valley = rows
            .flat_map(|row| &picture.gray[row * width..][columns.clone()])
            .fold(f32::MAX, |valley, &gray| valley.min(gray));
        let level = valley + 0.7 * (picture.gray[index] - valley);
        // A region is too large if it extends three diameters to any side.
        let reach = (6.0 * SQRT_2 * sigma).ceil() as usize;
        let side = 2 * reach + 1;
        self.visited.clear();
        self.visited.resize(side * side, false);
        self.open.clear();
        self.open.push((column, row));
        while let Some((c, r)) = self.open.pop() {
            let (dx, dy) = (c + reach - column, r + reach - row);
            if dx == 0 || dy == 0 || dx == side - 1 || dy == side - 1 {
                return true;
            }
            if std::mem::replace(&mut self.visited[dy * side + dx], true) {
                continue;
            }
            let left = (c > 0).then(|| (c - 1, r));
            let up = (r > 0).then(|| (c, r - 1));
            let right = (c + 1 < width).then_some((c + 1, r));
            let down = (r + 1 < height).then_some((c, r + 1));
            let next = [left, up, right, down].into_iter().flatten();
            let bright = |&(c, r): &(usize, usize)| picture.gray[r * width + c] >= level;
            self.open.extend(next.filter(bright));
        }
        false
    }
}
