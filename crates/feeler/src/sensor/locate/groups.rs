//! Groups spots into elements.

use super::{median, nearest, quantile, spot::Spot, tree::Tree};
use crate::sensor::image::cells::Cells;
use glam::DVec2;
use std::collections::BTreeMap;

/// Assignment of spots to elements.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grouped {
    /// Indices of the spots of each element.
    pub members: Vec<Vec<usize>>,
    /// Typical number of spots per element.
    pub per_element: usize,
    /// Indices of spots that belong to no element.
    pub left_out: Vec<usize>,
}

/// Numbers of spots per group to search for.
const SIZES: std::ops::RangeInclusive<usize> = 3..=32;

/// Maximum number of spots for which groups are searched; above it, each spot is one element.
const MOST: usize = 2048;

/// Minimum clearance of a group: distance from its centre to the nearest spot of another group, relative to that of its
/// farthest own spot.
const CLEAR: f64 = 1.25;

/// Minimum fraction of all spots covered by groups of a single size.
const COVERED: f64 = 0.7;

/// Among group sizes that cover at least this fraction of the spots covered by the best size, the largest is chosen. If
/// some groups are incomplete, half groups can cover more spots than whole groups.
const NEARLY: f64 = 0.9;

/// Minimum separation of groups: median ratio of the distance to the nearest spot of another group to that of the
/// nearest spot of the same group. For any partition of a lattice, it is about one.
const APART: f64 = 1.25;

/// Number of spots below which nine out of ten spots, not only half, must reach the ratio [`APART`].
const SMALL: usize = 20;

/// Maximum median difference in size between neighbouring groups (natural logarithm of the ratio). Elements of a sensor
/// have similar sizes; accidental clusters of scattered spots do not.
const ALIKE: f64 = 0.12;

/// Groups `spots` into elements: by `diameter` (px) if given, otherwise into groups of a single size if possible,
/// otherwise one element per spot.
pub(super) fn group(spots: &[Spot], diameter: Option<f64>) -> Grouped {
    let centres: Vec<DVec2> = spots.iter().map(|s| s.centre).collect();
    if let Some(diameter) = diameter {
        return within(&centres, diameter);
    }
    if centres.len() > MOST {
        return singles(centres.len());
    }
    let clear = clear_groups(&centres);
    let of_one_size = SIZES.filter_map(|size| {
        let groups = disjoint(&clear, size, centres.len());
        let covered = (groups.len() * size) as f64 / centres.len() as f64;
        let good = groups.len() >= 2
            && covered >= COVERED
            && apart(&groups, &centres) >= APART
            && unlike(&groups, &centres) <= ALIKE;
        good.then_some((covered, size, groups))
    });
    let of_one_size: Vec<_> = of_one_size.collect();
    let most = of_one_size.iter().fold(0.0, |most, a| f64::max(most, a.0));
    let largest = of_one_size
        .into_iter()
        .rfind(|(covered, ..)| *covered >= NEARLY * most);
    match largest {
        Some((_, size, groups)) => with_incomplete(groups, &centres, size),
        None => singles(centres.len()),
    }
}

/// A group of spots with clearance to all other spots.
#[derive(Debug, Clone)]
struct ClearGroup {
    members: Vec<usize>,
    /// Distance from the group's centre to the nearest spot of another group, relative to that of its farthest own
    /// spot.
    clearance: f64,
}

/// Finds candidate groups around the midpoints of pairs of nearby spots, because the midpoint of two opposite spots is
/// the centre of their group.
fn clear_groups(centres: &[DVec2]) -> Vec<ClearGroup> {
    let cells = Cells::new(centres);
    let mut near = Vec::new();
    let mut found = BTreeMap::<Vec<usize>, f64>::new();
    for (own, other) in near_pairs(centres) {
        let seed = 0.5 * (centres[own] + centres[other]);
        for group in clear_about(seed, &cells, &mut near) {
            // Repeat about the group's own centre, where its clearance is largest.
            let middle = mean(&group.members, centres);
            let again = clear_about(middle, &cells, &mut near);
            for group in again
                .into_iter()
                .filter(|g| g.members.len() == group.members.len())
            {
                found.insert(group.members, group.clearance);
            }
        }
    }
    let group = |(members, clearance)| ClearGroup { members, clearance };
    found.into_iter().map(group).collect()
}

/// Pairs of nearby spots, each listed once.
fn near_pairs(centres: &[DVec2]) -> Vec<(usize, usize)> {
    let near = nearest(centres, 12);
    let pairs = near
        .iter()
        .enumerate()
        .flat_map(|(own, near)| near.iter().map(move |&other| (own, other)));
    let once = |&(own, other): &(usize, usize)| own < other || !near[other].contains(&own);
    pairs.filter(once).collect()
}

/// Groups of the spots nearest to `seed`, for all sizes for which the clearance to the next spot is sufficient.
fn clear_about(seed: DVec2, cells: &Cells, near: &mut Vec<(f64, usize)>) -> Vec<ClearGroup> {
    cells.nearest(seed, SIZES.end() + 1, near);
    let clear = |size: usize| {
        let (last, next) = (near.get(size - 1)?.0, near.get(size)?.0);
        let clearance = (next / last).sqrt();
        (clearance >= CLEAR).then(|| {
            let mut members: Vec<usize> = near[..size].iter().map(|n| n.1).collect();
            members.sort_unstable();
            ClearGroup { members, clearance }
        })
    };
    SIZES.filter_map(clear).collect()
}

fn mean(members: &[usize], centres: &[DVec2]) -> DVec2 {
    members.iter().map(|&l| centres[l]).sum::<DVec2>() / members.len().max(1) as f64
}

/// Chooses disjoint groups of `size` spots in order of decreasing clearance.
fn disjoint(clear: &[ClearGroup], size: usize, spots: usize) -> Vec<Vec<usize>> {
    let mut of_size: Vec<_> = clear.iter().filter(|g| g.members.len() == size).collect();
    of_size.sort_by(|a, b| b.clearance.total_cmp(&a.clearance));
    let mut taken = vec![false; spots];
    let mut groups = Vec::new();
    for group in of_size {
        if group.members.iter().all(|&m| !taken[m]) {
            group.members.iter().for_each(|&m| taken[m] = true);
            groups.push(group.members.clone());
        }
    }
    groups
}

fn singles(spots: usize) -> Grouped {
    Grouped {
        members: (0..spots).map(|i| vec![i]).collect(),
        per_element: 1,
        left_out: Vec::new(),
    }
}

/// Groups spots into the largest clusters that fit within `diameter`.
fn within(centres: &[DVec2], diameter: f64) -> Grouped {
    let tree = Tree::new(centres);
    // The centres of the spots lie inside the element's outline, which leaves some margin for perspective.
    let fits = |leaves: &[usize]| {
        let across = |&a: &usize| {
            let distance = |&b: &usize| centres[a].distance(centres[b]);
            leaves.iter().map(distance).fold(0.0, f64::max)
        };
        leaves.iter().map(across).fold(0.0, f64::max) <= diameter
    };
    let members = tree.largest(|node| {
        // Skip huge groups, such as a whole lattice: their diameter is costly to compute.
        tree.size(node) <= 64 && fits(&tree.leaves(node))
    });
    let mut sizes: Vec<f64> = members.iter().map(|m| m.len() as f64).collect();
    Grouped {
        per_element: (median(&mut sizes) as usize).max(1),
        members,
        left_out: Vec::new(),
    }
}

/// Separation of `groups`, for comparison with [`APART`].
fn apart(groups: &[Vec<usize>], centres: &[DVec2]) -> f64 {
    let mut group_of = vec![usize::MAX; centres.len()];
    for (index, group) in groups.iter().enumerate() {
        group.iter().for_each(|&spot| group_of[spot] = index);
    }
    let cells = Cells::new(centres);
    let mut near = Vec::new();
    let largest = groups.iter().map(Vec::len).max().unwrap_or(0);
    let ratio = |&spot: &usize| {
        // One more than the group has, to reach a foreign spot.
        cells.nearest(centres[spot], largest + 1, &mut near);
        let same = |&&(_, another): &&(f64, usize)| group_of[another] == group_of[spot];
        let others = near.iter().filter(|n| n.1 != spot);
        let own = others.clone().find(same);
        let other = others.clone().find(|n| !same(n));
        let distance = |n: Option<&(f64, usize)>| n.map_or(f64::INFINITY, |n| n.0.sqrt());
        distance(other) / distance(own)
    };
    let mut ratios: Vec<f64> = groups.iter().flatten().map(ratio).collect();
    // In a small lattice, most spots are at its ends, where only spots of the same group are near.
    let part = if ratios.len() < SMALL { 0.1 } else { 0.5 };
    quantile(&mut ratios, part)
}

/// Median difference in size between neighbouring groups, for comparison with [`ALIKE`].
fn unlike(groups: &[Vec<usize>], centres: &[DVec2]) -> f64 {
    let middles: Vec<DVec2> = groups.iter().map(|group| mean(group, centres)).collect();
    let size = |(group, middle): (&Vec<usize>, &DVec2)| {
        let squares = group
            .iter()
            .map(|&spot| centres[spot].distance_squared(*middle));
        squares.sum::<f64>().sqrt()
    };
    let sizes: Vec<f64> = groups.iter().zip(&middles).map(size).collect();
    let off = |(own, near): (usize, &Vec<usize>)| {
        let mut about: Vec<f64> = near.iter().map(|&i| sizes[i]).collect();
        libm::log(sizes[own] / median(&mut about)).abs()
    };
    let mut off: Vec<f64> = nearest(&middles, 5).iter().enumerate().map(off).collect();
    median(&mut off)
}

/// Adds groups formed by the remaining spots that fit within the same diameter: incomplete or merged groups.
fn with_incomplete(mut groups: Vec<Vec<usize>>, centres: &[DVec2], size: usize) -> Grouped {
    let mut taken = vec![false; centres.len()];
    groups.iter().flatten().for_each(|&spot| taken[spot] = true);
    let across = |group: &Vec<usize>| {
        let middle = mean(group, centres);
        let from_middle = |&spot: &usize| centres[spot].distance(middle);
        2.0 * group.iter().map(from_middle).fold(0.0, f64::max)
    };
    let largest = groups.iter().map(across).fold(0.0, f64::max);
    let left: Vec<usize> = (0..centres.len()).filter(|&spot| !taken[spot]).collect();
    let left_centres: Vec<DVec2> = left.iter().map(|&spot| centres[spot]).collect();
    let mut left_out = Vec::new();
    for members in within(&left_centres, 1.1 * largest).members {
        let members = members.into_iter().map(|m| left[m]).collect::<Vec<_>>();
        if 2 * members.len() >= size {
            groups.push(members);
        } else {
            left_out.extend(members);
        }
    }
    Grouped {
        members: groups,
        per_element: size,
        left_out,
    }
}
