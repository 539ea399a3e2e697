//! Single-linkage clustering of spots.

use glam::DVec2;

/// Single-linkage tree (dendrogram). Leaves are points; each inner node joins two nodes, the closest ones first.
pub(super) struct Tree {
    leaf_count: usize,
    children: Vec<(usize, usize)>,
    sizes: Vec<usize>,
}

impl Tree {
    /// Builds the tree of `points`.
    pub(super) fn new(points: &[DVec2]) -> Self {
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

    /// Number of leaves below `node`.
    pub(super) fn size(&self, node: usize) -> usize {
        self.sizes[node]
    }

    fn children(&self, node: usize) -> Option<(usize, usize)> {
        self.children
            .get(node.checked_sub(self.leaf_count)?)
            .copied()
    }

    /// Leaves below `node`, in ascending order.
    pub(super) fn leaves(&self, node: usize) -> Vec<usize> {
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

    /// Leaves of each of the largest nodes that satisfy `wanted`, searched from the root.
    pub(super) fn largest(&self, wanted: impl Fn(usize) -> bool) -> Vec<Vec<usize>> {
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

/// Returns the root of the tree that contains `node`.
fn root(parents: &mut [usize], mut node: usize) -> usize {
    while parents[node] != node {
        parents[node] = parents[parents[node]];
        node = parents[node];
    }
    node
}

/// Edges of the minimum spanning tree (Prim's algorithm), with squared lengths.
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
