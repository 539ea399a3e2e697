//! Detects the regular grid of markers in an image.

use super::GraspSlipError;
use glam::DVec2;
use std::collections::{HashMap, HashSet, VecDeque};

/// Minimum number of markers in a pattern, so that enough degrees of freedom remain after the lens fit.
pub const FEWEST_ELEMENTS: usize = 12;
/// Maximum distance between neighbours, in units of the spacing. Steps along rows and columns may differ by a third.
const NEAR: f64 = 1.35;
/// Maximum distance between two difference vectors that count as the same step, in units of the spacing.
const ALIKE: f64 = 0.25;
/// Maximum distance of a neighbour from its predicted position, in units of the spacing. Contact displaces neighbours
/// almost equally.
const TOLERANCE: f64 = 0.4;
/// Minimum fraction of elements that can be reached by steps, and of pairs of grid neighbours that are one step apart.
const MOST: f64 = 0.9;

/// Geometry of the image that contains a pattern.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Picture {
    /// Position of the lens axis in the image (px), near the image centre.
    pub centre: DVec2,
    /// Half the image width (px).
    pub half_width: f64,
}

impl Picture {
    /// Geometry of an image of `columns` x `rows` pixels, with the lens axis through its centre.
    pub fn of_size(columns: usize, rows: usize) -> Self {
        let size = DVec2::new(columns as f64, rows as f64);
        Self {
            centre: size / 2.0,
            half_width: size.x / 2.0,
        }
    }
}

/// Grid indices of markers in an image. The two step directions are arbitrary, which covers square, rectangular, offset
/// and hexagonal grids.
#[derive(Debug, Clone, PartialEq)]
pub struct RegularPattern {
    indices: Vec<Option<(i32, i32)>>,
    spacing: f64,
}

impl RegularPattern {
    /// Finds the grid formed by the positions `places` (px). The search starts at the centre and proceeds from
    /// neighbour to neighbour, in steps that may vary slowly across the image because of the lens and of contact. NaN
    /// positions and positions that no step reaches get no index.
    ///
    /// # Errors
    /// If there are fewer than [`FEWEST_ELEMENTS`] positions, if less than nine of ten can be reached, or if less than
    /// nine of ten pairs of neighbours are one step apart.
    pub fn of(places: &[DVec2]) -> Result<Self, GraspSlipError> {
        let known: Vec<_> = (0..places.len())
            .filter(|&i| places[i].is_finite())
            .collect();
        let elements = known.len();
        if elements < FEWEST_ELEMENTS {
            return Err(GraspSlipError::TooFew { actual: elements });
        }
        let refused = |covered, (agreeing, neighbours)| GraspSlipError::NotAGrid {
            covered,
            elements,
            agreeing,
            neighbours,
        };
        let spacing = spacing(places, &known);
        let Some(steps) = steps(places, &known, spacing) else {
            return Err(refused(1, (0, 0)));
        };
        let indices = walk(places, &known, steps, spacing);
        let covered = indices.iter().flatten().count();
        let (agreeing, neighbours) = agreement(places, &indices, steps, spacing);
        let enough = |part: usize, whole: usize| part as f64 >= MOST * whole as f64;
        if !enough(covered, elements) || !enough(agreeing, neighbours) || covered < FEWEST_ELEMENTS
        {
            return Err(refused(covered, (agreeing, neighbours)));
        }
        let count = |index: fn(&(i32, i32)) -> i32| {
            let different: HashSet<_> = indices.iter().flatten().map(index).collect();
            different.len()
        };
        let (columns, rows) = (count(|i| i.0), count(|i| i.1));
        if columns.min(rows) < 3 {
            return Err(GraspSlipError::TooNarrow { columns, rows });
        }
        Ok(Self { indices, spacing })
    }

    /// Grid index of each element, in steps along both directions from an element near the centre; `None` for elements
    /// outside the grid.
    pub fn indices(&self) -> &[Option<(i32, i32)>] {
        &self.indices
    }

    /// Median distance between an element and its nearest neighbour (px).
    pub fn spacing(&self) -> f64 {
        self.spacing
    }
}

fn spacing(places: &[DVec2], known: &[usize]) -> f64 {
    let nearest = |&i: &usize| {
        let others = known.iter().filter(|&&j| j != i);
        others.fold(f64::INFINITY, |least, &j| {
            least.min(places[i].distance_squared(places[j]))
        })
    };
    let mut distances: Vec<_> = known.iter().map(nearest).collect();
    distances.sort_unstable_by(f64::total_cmp);
    distances[distances.len() / 2].sqrt()
}

/// The two most common steps between neighbours (px), in different directions.
fn steps(places: &[DVec2], known: &[usize], spacing: f64) -> Option<[DVec2; 2]> {
    let mut differences = Vec::new();
    for (rank, &i) in known.iter().enumerate() {
        for &j in &known[rank + 1..] {
            let difference = places[j] - places[i];
            if difference.length() <= NEAR * spacing {
                differences.push(difference);
            }
        }
    }
    let first = commonest(&differences, spacing)?;
    let across = |d: &DVec2| first.perp_dot(*d).abs() > 0.5 * first.length() * d.length();
    differences.retain(across);
    let second = commonest(&differences, spacing)?;
    Some([first, second])
}

/// Mean of the largest group of similar differences, ignoring their sign.
fn commonest(differences: &[DVec2], spacing: f64) -> Option<DVec2> {
    /// Maximum number of differences that are tried as the centre of a group, evenly spread.
    const TRIED: usize = 200;
    let alike = |step: DVec2| {
        differences.iter().filter_map(move |&d| {
            let d = if d.dot(step) < 0.0 { -d } else { d };
            (d.distance(step) < ALIKE * spacing).then_some(d)
        })
    };
    let tried = differences
        .iter()
        .step_by(differences.len().div_ceil(TRIED).max(1));
    // The first of equals.
    let best = tried.rev().max_by_key(|&&step| alike(step).count())?;
    let count = alike(*best).count();
    Some(alike(*best).sum::<DVec2>() / count as f64)
}

/// Assigns grid indices by a breadth-first search from the centre.
fn walk(
    places: &[DVec2],
    known: &[usize],
    [first, second]: [DVec2; 2],
    spacing: f64,
) -> Vec<Option<(i32, i32)>> {
    let mut indices = vec![None; places.len()];
    let mean = known.iter().map(|&i| places[i]).sum::<DVec2>() / known.len() as f64;
    let Some(start) = nearest(places, known, mean) else {
        return indices;
    };
    indices[start] = Some((0, 0));
    let mut taken = HashSet::from([(0, 0)]);
    let mut waiting = VecDeque::from([(start, (0, 0))]);
    while let Some((from, (column, row))) = waiting.pop_front() {
        let steps = [
            (1, 0, first),
            (-1, 0, -first),
            (0, 1, second),
            (0, -1, -second),
        ];
        for (right, down, step) in steps {
            let index = (column + right, row + down);
            let led = places[from] + step;
            let reached = nearest(places, known, led).filter(|&to| {
                indices[to].is_none() && places[to].distance(led) <= TOLERANCE * spacing
            });
            if let Some(to) = reached.filter(|_| taken.insert(index)) {
                indices[to] = Some(index);
                waiting.push_back((to, index));
            }
        }
    }
    indices
}

fn nearest(places: &[DVec2], known: &[usize], to: DVec2) -> Option<usize> {
    let distance = |&i: &usize| places[i].distance_squared(to);
    let known = known.iter().copied();
    known.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Number of pairs of grid neighbours that are one step apart, and number of all pairs of grid neighbours.
fn agreement(
    places: &[DVec2],
    indices: &[Option<(i32, i32)>],
    [first, second]: [DVec2; 2],
    spacing: f64,
) -> (usize, usize) {
    let indexed = || {
        indices
            .iter()
            .zip(places)
            .filter_map(|(i, p)| Some(((*i)?, *p)))
    };
    let places: HashMap<_, _> = indexed().collect();
    let (mut agreeing, mut all) = (0, 0);
    for ((column, row), place) in indexed() {
        for (index, step) in [((column + 1, row), first), ((column, row + 1), second)] {
            if let Some(next) = places.get(&index) {
                all += 1;
                agreeing += usize::from(next.distance(place + step) <= TOLERANCE * spacing);
            }
        }
    }
    (agreeing, all)
}
