//! Residual of marker positions after fitting a regular pattern seen through an unknown lens.

use super::{GraspSlipError, Picture, RegularPattern, scaled};
use glam::DVec2;
use nalgebra::DMatrix;

/// Number of parameters of the fit: plane (6), radial distortion (1), perspective (2), and decentring distortion (2).
const WAYS: usize = 11;
/// Minimum diagonal element of the triangular factor, relative to the largest, for columns to count as independent.
const RANK: f64 = 1e-8;
/// Minimum pivot of the factorisation if elements are missing; below it, the remaining ones do not determine all
/// parameters.
const PIVOT: f64 = 1e-3;

type Ways = [f64; WAYS];

/// Marker of the pattern.
#[derive(Debug, Clone)]
struct Element {
    /// Position in the fitted pattern without contact, in units of the scale.
    ideal: DVec2,
    /// Rows of the orthonormal basis for the marker's x and y.
    basis: [Ways; 2],
}

/// Orthonormal basis of all marker positions that a pattern without contact can have in the image: six parameters for
/// its plane, one for the lens's radial distortion, two for perspective, and two for decentring (Brown, "Decentering
/// distortion of lenses", Photogrammetric Engineering 32 (1966)).
#[derive(Debug, Clone)]
pub struct LensFit {
    /// Elements of the pattern; `None` for those that do not belong to it.
    elements: Vec<Option<Element>>,
    /// Number of elements in the pattern.
    count: usize,
}

impl LensFit {
    /// Fits the `pattern` of the positions `places` (px) in `picture`. If `picture` is `None`, the pattern is assumed
    /// to fill the image.
    ///
    /// # Errors
    /// If the pattern is too small to determine all parameters.
    pub fn new(
        pattern: &RegularPattern,
        places: &[DVec2],
        picture: Option<Picture>,
    ) -> Result<Self, GraspSlipError> {
        let members: Vec<_> = (pattern.indices().iter().zip(places))
            .filter_map(|(index, place)| Some(((*index)?, *place)))
            .collect();
        let count = members.len();
        let narrow = || GraspSlipError::TooFew { actual: count };
        let plane = on_plane(&members).ok_or_else(narrow)?;
        let picture = picture.unwrap_or_else(|| around(&plane));
        let ideal: Vec<_> = plane
            .iter()
            .map(|place| (*place - picture.centre) / picture.half_width)
            .collect();
        let ways = DMatrix::from_fn(2 * count, WAYS, |row, way| {
            ways(ideal[row % count])[row / count][way]
        });
        let factors = ways.qr();
        let diagonal = factors.r().diagonal().abs();
        if diagonal.min() < RANK * diagonal.max() {
            return Err(narrow());
        }
        let basis = factors.q();
        let place = |row: usize| {
            let (_, place) = members[row % count];
            [place.x, place.y][row / count] / pattern.spacing()
        };
        let places = DMatrix::from_fn(2 * count, 1, |row, _| place(row));
        let seen = &basis * (basis.transpose() * places);
        let row = |row: usize| std::array::from_fn(|way| basis[(row, way)]);
        let mut found = (0..count).map(|member| Element {
            ideal: DVec2::new(seen[member], seen[count + member]),
            basis: [row(member), row(count + member)],
        });
        let indices = pattern.indices().iter();
        Ok(Self {
            elements: indices
                .map(|index| index.and_then(|_| found.next()))
                .collect(),
            count,
        })
    }

    /// Root mean square residual of the vectors (positions, px) in units of `scale`, or `None` if too few elements
    /// have a vector. Neither allocates nor panics.
    ///
    /// If elements are missing, the pattern is fitted to the remaining ones, and the residual is corrected for the
    /// lower number of degrees of freedom.
    pub fn residual(&self, vectors: impl IntoIterator<Item = DVec2>, scale: f64) -> Option<f64> {
        let mut vectors = vectors.into_iter();
        let (mut along, mut missing) = ([0.0; WAYS], [[0.0; WAYS]; WAYS]);
        let (mut sum, mut seen) = (0.0, 0_usize);
        for element in &self.elements {
            let vector = vectors.next().and_then(|vector| scaled(vector, scale));
            let Some(Element { ideal, basis }) = element else {
                continue;
            };
            match vector {
                Some(vector) => {
                    let off = vector - *ideal;
                    let [x, y] = basis;
                    for (along, (x, y)) in along.iter_mut().zip(x.iter().zip(y)) {
                        *along += x * off.x + y * off.y;
                    }
                    sum += off.length_squared();
                    seen += 1;
                }
                None => basis.iter().for_each(|row| add_square(&mut missing, row)),
            }
        }
        if 2 * seen < self.count || seen < WAYS {
            return None;
        }
        let explained = match seen == self.count {
            true => along.iter().map(|a| a * a).sum(),
            false => explained(missing, along)?,
        };
        let freedom = |elements: usize| 1.0 - WAYS as f64 / (2 * elements) as f64;
        let made_up = freedom(self.count) / freedom(seen);
        Some(((sum - explained).max(0.0) / seen as f64 * made_up).sqrt())
    }
}

/// Positions of the markers in the best affine fit to their grid indices; `None` if the fit fails.
fn on_plane(members: &[((i32, i32), DVec2)]) -> Option<Vec<DVec2>> {
    let design = DMatrix::from_fn(members.len(), 3, |row, column| {
        let (column_index, row_index) = members[row].0;
        [1.0, f64::from(column_index), f64::from(row_index)][column]
    });
    let places = DMatrix::from_fn(members.len(), 2, |row, axis| members[row].1[axis]);
    let factors = design.clone().svd(true, true);
    let solution = factors.solve(&places, RANK).ok()?;
    let plane = design * solution;
    let places = plane.row_iter().map(|row| DVec2::new(row[0], row[1]));
    Some(places.collect())
}

/// Geometry of an image that these positions would fill.
fn around(places: &[DVec2]) -> Picture {
    let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let (low, high) = (places.iter()).fold(none, |(low, high), &p| (low.min(p), high.max(p)));
    Picture {
        centre: (low + high) / 2.0,
        half_width: (high - low).max_element() / 2.0,
    }
}

/// Derivatives of a position's x and y with respect to each parameter. The position is in half widths from the image
/// centre.
fn ways(DVec2 { x: a, y: b }: DVec2) -> [Ways; 2] {
    let square = a * a + b * b;
    let (over, under) = (square + 2.0 * a * a, square + 2.0 * b * b);
    let mixed = 2.0 * a * b;
    [
        [
            1.0,
            a,
            b,
            0.0,
            0.0,
            0.0,
            a * square,
            a * a,
            a * b,
            over,
            mixed,
        ],
        [
            0.0,
            0.0,
            0.0,
            1.0,
            a,
            b,
            b * square,
            a * b,
            b * b,
            mixed,
            under,
        ],
    ]
}

fn add_square(sum: &mut [Ways; WAYS], row: &Ways) {
    for (sums, left) in sum.iter_mut().zip(row) {
        for (sum, right) in sums.iter_mut().zip(row) {
            *sum += left * right;
        }
    }
}

/// Part of the sum of squares explained by a fit to the remaining elements: c' (1 - G)^-1 c by Cholesky factorisation,
/// with G from the `missing` rows and c the projections `along` the basis. `None` if the remaining elements do not
/// determine all parameters.
fn explained(missing: [Ways; WAYS], along: Ways) -> Option<f64> {
    let mut lower = [[0.0; WAYS]; WAYS];
    let (mut solved, mut explained) = ([0.0; WAYS], 0.0);
    for i in 0..WAYS {
        for j in 0..=i {
            let unit = f64::from(u8::from(i == j));
            let product: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            let rest = unit - missing[i][j] - product;
            lower[i][j] = match i == j {
                true if rest < PIVOT => return None,
                true => rest.sqrt(),
                false => rest / lower[j][j],
            };
        }
        let product: f64 = (0..i).map(|k| lower[i][k] * solved[k]).sum();
        solved[i] = (along[i] - product) / lower[i][i];
        explained += solved[i] * solved[i];
    }
    Some(explained)
}
