//! Drag: deviation of the load on the elements from its slow mean, a measure of an object's motion within the grip.

use super::{GraspSlipError, LARGEST, part, passed};
use crate::check::Checker;
use glam::DVec3;

/// Median magnitude of the difference of two samples of a normal distribution with standard deviation 1.
const MEDIAN_OF_CHANGES: f64 = 0.953_87;

/// Time constants of [`GraspDrag`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GraspDragConfig {
    /// Time constant of the noise filter (s).
    pub fast: f64,
    /// Time constant of the slow mean with which loads are compared (s). Slower creep does not count as slip.
    pub slow: f64,
}

impl Default for GraspDragConfig {
    /// 0.05 s and 1 s. On recordings of two sensors, slow time constants of 0.3 to 3 s perform equally well, within
    /// 0.05 of area under the curve.
    fn default() -> Self {
        Self {
            fast: 0.05,
            slow: 1.0,
        }
    }
}

impl GraspDragConfig {
    fn check(&self, scale: f64) -> Result<(), GraspSlipError> {
        let mut checker = Checker::default();
        checker.positive("scale", scale);
        checker.between("fast", self.fast, 1e-4, 1e3);
        checker.between("slow", self.slow, 1e-4, 1e5);
        checker.finish().map_err(GraspSlipError::Values)
    }
}

/// Filter state of one element.
#[derive(Debug, Clone, Copy)]
struct Filtered {
    /// Filtered vector in units of the scale; NaN before the first vector.
    fast: DVec3,
    /// Slow mean of `fast`.
    slow: DVec3,
    /// Duration for which the element has been missing, if it was missing in the latest frames (s).
    missing: f64,
}

const NOTHING: Filtered = Filtered {
    fast: DVec3::NAN,
    slow: DVec3::NAN,
    missing: 0.0,
};

/// Detects whether a grasped object moves within the grip.
///
/// For each element's vector u_i (force or displacement; with 0 as the normal component if only tangential
/// displacement is measured) in units of `scale`, with a = 1 - exp(-dt / tau):
///
/// ```text
/// f_i += a_fast (u_i - f_i)        m_i += a_slow (f_i - m_i)        D = sqrt(mean over i of |f_i - m_i|^2)
/// ```
///
/// The normal component is included, because a dragged object tilts in the grip and shifts its load between elements.
///
/// D is dimensionless. With the sensor's noise as scale ([`noise_of`]) it is in standard deviations; which value of D
/// indicates a slip depends on the sensor. Applying, releasing or shaking a load also raises D, so the caller must
/// evaluate it at a suitable time in the task.
#[derive(Debug, Clone)]
pub struct GraspDrag {
    config: GraspDragConfig,
    scale: f64,
    elements: Vec<Filtered>,
    drag: Option<f64>,
}

impl GraspDrag {
    /// Creates a detector for `elements` elements whose vectors are in units of `scale` (N, m, px or counts).
    ///
    /// # Errors
    /// If the scale or a time constant is out of range.
    pub fn new(
        elements: usize,
        scale: f64,
        config: GraspDragConfig,
    ) -> Result<Self, GraspSlipError> {
        config.check(scale)?;
        Ok(Self {
            config,
            scale,
            elements: vec![NOTHING; elements],
            drag: None,
        })
    }

    /// Restarts the detector for another grasp.
    pub fn restart(&mut self) {
        self.elements.fill(NOTHING);
        self.drag = None;
    }

    /// Updates D with the next frame, `interval` (s) after the previous one. `vectors` has one vector per element, NaN
    /// if it was not measured; excess vectors are ignored. An interval of 0 or less only initialises elements that had
    /// no vector yet. Returns D, or `None` if no element has a vector. Must be called once per frame; neither allocates
    /// nor panics.
    pub fn update(
        &mut self,
        interval: f64,
        vectors: impl IntoIterator<Item = DVec3>,
    ) -> Option<f64> {
        let interval = passed(interval);
        let parts = (
            part(interval, self.config.fast),
            part(interval, self.config.slow),
        );
        let (mut sum, mut count) = (0.0, 0_u32);
        let mut vectors = vectors.into_iter();
        for element in &mut self.elements {
            let vector = vectors.next().map(|vector| vector / self.scale);
            let vector = vector.filter(|v| v.abs().cmple(DVec3::splat(LARGEST)).all());
            let Some(vector) = vector else {
                element.missing += interval;
                continue;
            };
            let (fast, slow) = if element.missing > 0.0 {
                let interval = interval + std::mem::take(&mut element.missing);
                (
                    part(interval, self.config.fast),
                    part(interval, self.config.slow),
                )
            } else {
                parts
            };
            if element.fast.is_nan() {
                (element.fast, element.slow) = (vector, vector);
            }
            element.fast += fast * (vector - element.fast);
            element.slow += slow * (element.fast - element.slow);
            sum += (element.fast - element.slow).length_squared();
            count += 1;
        }
        self.drag = (count > 0).then(|| (sum / f64::from(count)).sqrt());
        self.drag
    }

    /// Drag D at the latest frame; `None` if no element had a vector.
    pub fn drag(&self) -> Option<f64> {
        self.drag
    }
}

/// Estimates the standard deviation of the noise in each component of a sensor's vectors, in their unit. `changes` are
/// the differences of components between consecutive frames; they are sorted in place. The estimate is their median
/// magnitude divided by 0.954, which is insensitive to slips, jolts and gaps. Returns `None` if there are no changes or
/// most are 0.
pub fn noise_of(changes: &mut [f64]) -> Option<f64> {
    changes.iter_mut().for_each(|change| *change = change.abs());
    changes.sort_unstable_by(f64::total_cmp);
    // NaNs are sorted last.
    let known = changes.partition_point(|change| !change.is_nan());
    let median = *changes.get(known / 2).filter(|_| known > 0)?;
    (median > 0.0).then_some(median / MEDIAN_OF_CHANGES)
}
