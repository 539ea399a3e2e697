//! Coefficient of friction from a contact that begins to slide.

use glam::DVec3;

/// Maximum growth of an element's shear for it to count as sliding, relative to the mean of those that grow faster than
/// average.
const MAX_STILL_GROWTH: f64 = 0.25;
/// Minimum ratio of shear to compression of an element that may be sliding, relative to the largest such ratio.
const TOP_RATIO: f64 = 0.93;
/// Minimum compression of an evaluated element, relative to the contact threshold; ratios of weakly pressed elements
/// are mostly noise.
pub(super) const MIN_COMPRESSION: f64 = 3.0;
/// Minimum growth of shear between two evaluations, relative to the compression.
const MIN_GROWTH: f64 = 0.02;
/// Minimum growth of shear per element between two evaluations, relative to the minimum compression, to exceed the
/// noise.
const ABOVE_NOISE: f64 = 0.67;

/// Estimates the coefficient of friction from elements that begin to slide before others (incipient slip).
///
/// While the tangential load grows, the shear of sticking elements grows, but that of sliding elements remains at
/// friction times compression (Cattaneo 1938, Mindlin 1949; K. L. Johnson, *Contact Mechanics*, 1985, section 7.2). If
/// the shear of most elements with the largest ratios of shear to compression remains constant while that of others
/// grows, the median of these ratios is the coefficient. Only growth of shear in excess of the growth of compression
/// counts, so pressing harder gives no estimate.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FrictionEstimator {
    /// Minimum compression of an evaluated element, N.
    min_compression: f64,
    /// Forces on the fingertip at the last evaluation, N in `T`; NaN without contact.
    anchor: Vec<DVec3>,
    /// Evaluated elements: growth of shear (N) and ratio of shear to compression.
    judged: Vec<(f64, f64)>,
    friction: Option<f64>,
}

impl FrictionEstimator {
    /// Creates an estimator for `elements` elements, which are in contact at compressions above `touch` (N).
    pub fn new(elements: usize, touch: f64) -> Self {
        Self {
            min_compression: MIN_COMPRESSION * touch,
            anchor: vec![DVec3::NAN; elements],
            judged: Vec::with_capacity(elements),
            friction: None,
        }
    }

    /// Ends a contact, so that the next one is not compared with it.
    pub fn end_contact(&mut self) {
        self.anchor.fill(DVec3::NAN);
    }

    /// Discards the estimate, for example when another object is touched.
    pub fn restart(&mut self) {
        self.end_contact();
        self.friction = None;
    }

    /// Updates the estimate with the next frame and returns it, or `None` if no element has begun to slide before
    /// others yet. `normal` is the outward normal of the contact; `touching` are the indices of the elements in
    /// contact, each with the force on the fingertip there (N in `T`). Does not allocate.
    pub fn update(
        &mut self,
        normal: DVec3,
        touching: impl Iterator<Item = (usize, DVec3)> + Clone,
    ) -> Option<f64> {
        self.judged.clear();
        let (mut growth, mut pressed) = (0.0, 0.0);
        for (element, force) in touching.clone() {
            let (shear, compression) = shear_and_compression(force, normal);
            let (shear_before, compression_before) =
                shear_and_compression(self.anchor[element], normal);
            // False for NaN.
            if !(compression > self.min_compression && compression_before > self.min_compression) {
                continue;
            }
            let ratio = shear.length() / compression;
            // Less what a sliding element gains with its compression.
            let grown = (shear - shear_before).dot(shear.normalize_or_zero())
                - ratio * (compression - compression_before);
            growth += grown;
            pressed += compression;
            self.judged.push((grown, ratio));
        }
        let step = (MIN_GROWTH * pressed)
            .max(ABOVE_NOISE * self.min_compression * self.judged.len() as f64);
        if growth > step {
            self.friction = sliding_friction(&mut self.judged).or(self.friction);
        } else if growth > -step && pressed > 0.0 {
            return self.friction;
        }
        self.anchor.fill(DVec3::NAN);
        for (element, force) in touching {
            self.anchor[element] = force;
        }
        self.friction
    }
}

/// Shear and compression (N) of a `force` on the fingertip, by its outward `normal`.
pub(super) fn shear_and_compression(force: DVec3, normal: DVec3) -> (DVec3, f64) {
    let outward = force.dot(normal);
    (force - outward * normal, -outward)
}

/// Median of the largest ratios of shear to compression; `None` if the shear of most of these elements grows, or if it
/// is constant for fewer than two.
fn sliding_friction(judged: &mut [(f64, f64)]) -> Option<f64> {
    let mean_above = |least: f64| {
        let faster = judged
            .iter()
            .map(|&(grown, _)| grown)
            .filter(|&grown| grown >= least);
        let (sum, count) = faster.fold((0.0, 0), |(sum, count), grown| (sum + grown, count + 1));
        sum / f64::from(count)
    };
    let fast = mean_above(mean_above(f64::NEG_INFINITY));
    judged.sort_unstable_by(|a, b| a.1.total_cmp(&b.1));
    let &(_, largest) = judged.last()?;
    let top = &judged[judged.partition_point(|&(_, ratio)| ratio < TOP_RATIO * largest)..];
    let still = top
        .iter()
        .filter(|(grown, _)| grown.abs() < MAX_STILL_GROWTH * fast)
        .count();
    let (_, middle) = top[top.len() / 2];
    (2 * still > top.len() && still > 1).then_some(middle)
}
