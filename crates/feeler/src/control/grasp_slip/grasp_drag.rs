//! Drag: how far the load of a grasp is from its own slow mean.

use super::{GraspSlipError, LARGEST, part, passed};
use crate::check::Checker;
use glam::DVec3;

/// Median of |x| of a normal distribution of standard deviation 1, times the square root of 2 for the difference of two samples.
const MEDIAN_OF_CHANGES: f64 = 0.953_87;

/// Times of [`GraspDrag`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GraspDragConfig {
    /// Time constant of the filter that takes out noise, s.
    pub fast: f64,
    /// Time constant of the slow mean that loads are held against, s: what creeps slower is no slip.
    pub slow: f64,
}

impl Default for GraspDragConfig {
    /// 0.05 s and 1 s: on recordings of two sensors, 0.3 to 3 s do as well within 0.05 of area under the curve.
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
        match checker.problems() {
            problems if problems.is_empty() => Ok(()),
            problems => Err(GraspSlipError::Values(problems)),
        }
    }
}

/// One element.
#[derive(Debug, Clone, Copy)]
struct Filtered {
    /// The filtered vector, in units of the scale; not a number before the first.
    fast: DVec3,
    /// Its slow mean.
    slow: DVec3,
    /// Time since the element's newest vector, s, where frames without one came since.
    missing: f64,
}

const NOTHING: Filtered = Filtered {
    fast: DVec3::NAN,
    slow: DVec3::NAN,
    missing: 0.0,
};

/// Tells whether what is grasped is displaced in the grip.
///
/// Of each element's vector u_i (force, or displacement; 0 along the normal where only its plane is seen) in units of `scale`, with
/// a = 1 - exp(-dt / tau):
///
/// ```text
/// f_i += a_fast (u_i - f_i)        m_i += a_slow (f_i - m_i)        D = sqrt(mean over i of |f_i - m_i|^2)
/// ```
///
/// The normal counts, as an object that is dragged tilts in the grip and shifts its load from element to element.
///
/// D has no unit. With the sensor's noise as scale ([`noise_of`]) it counts standard deviations; which D is a slip differs
/// from sensor to sensor. A load that is put on, let go or shaken is an excursion, too: D tells a grasp that is at rest from
/// one that is not, and it is for who knows the task to ask at the right time.
#[derive(Debug, Clone)]
pub struct GraspDrag {
    config: GraspDragConfig,
    scale: f64,
    elements: Vec<Filtered>,
    drag: Option<f64>,
}

impl GraspDrag {
    /// For so many elements, whose vectors are in units of `scale` (N, m, px or counts, as the vectors are).
    ///
    /// # Errors
    /// When scale or times are out of range.
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

    /// Begins another grasp: what was felt before has nothing to do with it.
    pub fn restart(&mut self) {
        self.elements.fill(NOTHING);
        self.drag = None;
    }

    /// Takes the next frame, `interval` (s) after the one before, with a vector for each element, not a number where it has
    /// none; those beyond the number of elements do not count. An interval that is not positive changes nothing but for
    /// elements that had no vector yet. D, if any element has a vector. To be called once a frame; neither allocates nor
    /// panics.
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

    /// D at the newest frame; none where no element had a vector.
    pub fn drag(&self) -> Option<f64> {
        self.drag
    }
}

/// Standard deviation of the noise in each component of a sensor's vectors, in their unit, from the `changes` of components
/// between neighbouring frames: their median size by 0.954, which slips, jolts and gaps do not move. None of no changes, or
/// where most are 0. Sorts them.
pub fn noise_of(changes: &mut [f64]) -> Option<f64> {
    changes.iter_mut().for_each(|change| *change = change.abs());
    changes.sort_unstable_by(f64::total_cmp);
    // Those that are not a number stand last.
    let known = changes.partition_point(|change| !change.is_nan());
    let median = *changes.get(known / 2).filter(|_| known > 0)?;
    (median > 0.0).then_some(median / MEDIAN_OF_CHANGES)
}
