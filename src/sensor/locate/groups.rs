//! Groups of spots that are one element each.

use super::{median, spots::Spot};
use glam::DVec2;

/// Which spots are which element.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Grouped {
    /// Indices of each element's spots.
    pub members: Vec<Vec<usize>>,
    /// Spots of most elements.
    pub per_element: usize,
    /// Spots that belong to none.
    pub left_out: Vec<usize>,
}

/// Largest group of spots that is looked for.
const LARGEST: usize = 32;

/// Part of all spots that must lie in groups of exactly one size.
const COVERED: f64 = 0.7;

/// Distance to the nearest spot of another group over that to the nearest of the own one, at the
/// median. Of a lattice, cut into groups in whatever way, it is about one.
const APART: f64 = 1.25;

/// Groups `spots`: into elements of `diameter` px if that is given, else into groups of one size if
/// they lie in such, else each for itself.
pub(super) fn group(spots: &[Spot], diameter: Option<f64>) -> Grouped {
    let centres: Vec<DVec2> = spots.iter().map(|s| s.centre).collect();
    let tree = Tree::new(&centres);
    if let Some(diameter) = diameter {
        return within(&tree, &centres, diameter);
    }
    (3..=LARGEST)
        .filter_map(|size| Some((size, separation(&tree, &centres, size)?)))
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .map_or_else(|| singles(centres.len()), |(size, _)| of_size(&tree, &centres, size))
}

fn singles(spots: usize) -> Grouped {
    Grouped {
        members: (0..spots).map(|i| vec![i]).collect(),
        per_element: 1,
        left_out: Vec::new(),
    }
}

/// The largest groups no farther across than an element.
fn within(tree: &Tree, centres: &[DVec2], diameter: f64) -> Grouped {
    // Spots' centres lie inside the element's outline; a little is granted to perspective.
    let fits = |leaves: &[usize]| {
        let across = |&a: &usize| {
            let distance = |&b: &usize| centres[a].distance(centres[b]);
            leaves.iter().map(distance).fold(0.0, f64::max)
        };
        leaves.iter().map(across).fold(0.0, f64::max) <= diameter
    };
    let members = tree.largest(|node| {
        // A lattice has huge groups that need not be measured spot by spot.
        tree.size(node) <= 64 && fits(&tree.leaves(node))
    });
    let mut sizes: Vec<f64> = members.iter().map(|m| m.len() as f64).collect();
    Grouped {
        per_element: (median(&mut sizes) as usize).max(1),
        members,
        left_out: Vec::new(),
    }
}

/// How far apart groups of `size` lie, if there are such and most spots are in one.
fn separation(tree: &Tree, centres: &[DVec2], size: usize) -> Option<f64> {
    let groups = tree.largest(|node| tree.size(node) == size);
    if groups.len() < 2 || ((groups.len() * size) as f64) < COVERED * centres.len() as f64 {
        return None;
    }
    let mut group_of = vec![usize::MAX; centres.len()];
    for (index, group) in groups.iter().enumerate() {
        group.iter().for_each(|&leaf| group_of[leaf] = index);
    }
    let ratio = |&leaf: &usize| {
        let (mut own, mut other) = (f64::INFINITY, f64::INFINITY);
        for (spot, centre) in centres.iter().enumerate().filter(|(s, _)| *s != leaf) {
            let distance = centre.distance(centres[leaf]);
            if group_of[spot] == group_of[leaf] {
                own = own.min(distance);
            } else {
                other = other.min(distance);
            }
        }
        other / own
    };
    let mut ratios: Vec<f64> = groups.iter().flatten().map(ratio).collect();
    Some(median(&mut ratios)).filter(|&ratio| ratio >= APART)
}

/// Groups of `size`; of the spots that are left, what is nearly one group, or several that touch.
fn of_size(tree: &Tree, centres: &[DVec2], size: usize) -> Grouped {
    let mut members = tree.largest(|node| tree.size(node) == size);
    let mut taken = vec![false; centres.len()];
    members.iter().flatten().for_each(|&leaf| taken[leaf] = true);
    // Groups that run into each other: as large as several, with none inside.
    let several = |node: usize| {
        let leaves = tree.size(node);
        leaves % size == 0 && leaves <= 4 * size && !tree.leaves(node).iter().any(|&l| taken[l])
    };
    let merged = tree.largest(several);
    for group in &merged {
        group.iter().for_each(|&leaf| taken[leaf] = true);
        members.extend(split(group, centres, group.len() / size));
    }
    let nearly = tree.largest(|node| {
        let leaves = tree.size(node);
        2 * leaves > size && leaves < 2 * size && !tree.leaves(node).iter().any(|&l| taken[l])
    });
    nearly.iter().flatten().for_each(|&leaf| taken[leaf] = true);
    members.extend(nearly);
    Grouped {
        members,
        per_element: size,
        left_out: (0..centres.len()).filter(|&leaf| !taken[leaf]).collect(),
    }
}

/// Splits a group into `parts` about centres that are far from each other (Lloyd's algorithm).
fn split(group: &[usize], centres: &[DVec2], parts: usize) -> Vec<Vec<usize>> {
    let mean = |leaves: &[usize]| {
        leaves.iter().map(|&l| centres[l]).sum::<DVec2>() / leaves.len().max(1) as f64
    };
    let mut seeds = vec![mean(group)];
    while seeds.len() < parts + 1 {
        let far = |&leaf: &usize| {
            let to_seed = |s: &DVec2| s.distance_squared(centres[leaf]);
            seeds.iter().map(to_seed).fold(f64::INFINITY, f64::min)
        };
        let farthest = group.iter().max_by(|a, b| far(a).total_cmp(&far(b)));
        seeds.extend(farthest.map(|&leaf| centres[leaf]));
    }
    seeds.remove(0);
    let mut shares = Vec::new();
    for _ in 0..16 {
        shares = vec![Vec::new(); parts];
        for &leaf in group {
            let to_seed = |part: &usize| seeds[*part].distance_squared(centres[leaf]);
            let nearest = (0..parts).min_by(|a, b| to_seed(a).total_cmp(&to_seed(b)));
            shares[nearest.unwrap_or(0)].push(leaf);
        }
        for (seed, share) in seeds.iter_mut().zip(&shares) {
            if !share.is_empty() {
                *seed = mean(share);
            }
        }
    }
    shares.retain(|share| !share.is_empty());
    shares
}

/// Spots joined nearest first (single linkage): leaves are the spots, a node joins two below it.
struct Tree {
    leaf_count: usize,
    children: Vec<(usize, usize)>,
    sizes: Vec<usize>,
}

impl Tree {
    fn new(points: &[DVec2]) -> Self {
        let mut edges = shortest_edges(points);
        edges.sort_by(|a, b| a.2.total_cmp(&b.2));
        let leaf_count = points.len();
        let mut tree = Self {
            leaf_count,
            children: Vec::new(),
            sizes: vec![1; leaf_count],
        };
        let mut parents: Vec<usize> = (0..leaf_count).collect();
        for (a, b, _) in edges {
            let (a, b) = (root(&mut parents, a), root(&mut parents, b));
            let node = tree.sizes.len();
            tree.children.push((a, b));
            tree.sizes.push(tree.sizes[a] + tree.sizes[b]);
            parents.push(node);
            parents[a] = node;
            parents[b] = node;
        }
        tree
    }

    fn size(&self, node: usize) -> usize {
        self.sizes[node]
    }

    fn children(&self, node: usize) -> Option<(usize, usize)> {
        self.children.get(node.checked_sub(self.leaf_count)?).copied()
    }

    fn leaves(&self, node: usize) -> Vec<usize> {
        let (mut open, mut leaves) = (vec![node], Vec::new());
        while let Some(node) = open.pop() {
            match self.children(node) {
                Some((a, b)) => open.extend([a, b]),
                None => leaves.push(node),
            }
        }
        leaves.sort_unstable();
        leaves
    }

    /// Leaves of the largest nodes that fulfil `wanted`, from the root down.
    fn largest(&self, wanted: impl Fn(usize) -> bool) -> Vec<Vec<usize>> {
        let mut open: Vec<usize> = self.sizes.len().checked_sub(1).into_iter().collect();
        let mut found = Vec::new();
        while let Some(node) = open.pop() {
            if wanted(node) {
                found.push(self.leaves(node));
            } else if let Some((a, b)) = self.children(node) {
                open.extend([a, b]);
            }
        }
        found
    }
}

/// The topmost node above a node.
fn root(parents: &mut [usize], mut node: usize) -> usize {
    while parents[node] != node {
        parents[node] = parents[parents[node]];
        node = parents[node];
    }
    node
}

/// The edges of the tree of least length that joins all points (Prim's algorithm).
fn shortest_edges(points: &[DVec2]) -> Vec<(usize, usize, f64)> {
    let mut joined = vec![false; points.len()];
    let mut best = vec![(f64::INFINITY, 0); points.len()];
    let mut edges = Vec::with_capacity(points.len().saturating_sub(1));
    let mut newest = 0;
    for _ in 1..points.len() {
        joined[newest] = true;
        for (index, best) in best.iter_mut().enumerate() {
            let distance = points[index].distance_squared(points[newest]);
            if distance < best.0 {
                *best = (distance, newest);
            }
        }
        let next = (0..points.len())
            .filter(|&i| !joined[i])
            .min_by(|&a, &b| best[a].0.total_cmp(&best[b].0));
        let Some(next) = next else { break };
        edges.push((next, best[next].1, best[next].0));
        newest = next;
    }
    edges
}
