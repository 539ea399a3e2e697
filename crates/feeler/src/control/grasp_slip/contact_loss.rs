//! Detects from the load on the elements that a grasped object is lost.

use super::lens_fit::LensFit;
use super::{GraspSlipError, Picture, RegularPattern, part, passed};
use crate::check::Checker;
use glam::DVec2;

/// Load above which contact counts as a grasp, in units of the threshold.
const HELD: f64 = 1.5;
/// Lower bound of the load, in units of the scale, that keeps the score finite; below the resolution of any sensor.
const LEAST: f64 = 1e-9;

/// Parameters of [`ContactLoss`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLossConfig {
    /// Time constant of the filter (s). It is also the approximate delay of detection.
    pub time_constant: f64,
    /// Load below which no object is held, in units of the scale (the spacing of a pattern, or the full scale of
    /// shear).
    pub threshold: f64,
}

impl Default for ContactLossConfig {
    /// 0.5 s and 0.0185 spacings, for a pattern of markers. On 40 recorded grasps with six gels, 0.016 to 0.021
    /// perform equally well. A controller may use 0.1 s. For shear, choose a threshold above the sensor's noise.
    fn default() -> Self {
        Self {
            time_constant: 0.5,
            threshold: 0.0185,
        }
    }
}

impl ContactLossConfig {
    fn check(&self, scale: f64) -> Result<(), GraspSlipError> {
        let mut checker = Checker::default();
        checker.positive("scale", scale);
        checker.between("time_constant", self.time_constant, 1e-4, 1e3);
        checker.positive("threshold", self.threshold);
        checker.finish().map_err(GraspSlipError::Values)
    }
}

/// State of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contact {
    /// Unknown, because there is no reference for the untouched elements or too few of them have been measured so far.
    Unknown,
    /// No grasp yet: the load has not exceeded 1.5 thresholds.
    Untouched,
    /// Grasp: the load has exceeded 1.5 thresholds and has not fallen below the threshold since.
    Held,
    /// The load has fallen below the threshold after a grasp, whether by accident or on purpose.
    Lost,
}

/// Reference with which the elements are compared.
#[derive(Debug, Clone)]
enum Reference {
    /// No reference.
    Unknown,
    /// The vectors are 0 without contact. Contains the number of elements.
    Untouched(usize),
    /// Without contact, the positions of the elements are a regular pattern seen through a lens.
    Pattern(Box<LensFit>),
}

/// Detects from the load on the elements whether a grasped object is still held.
///
/// With q_i the vector of element i in units of `scale`, n elements, and a = 1 - exp(-dt / tau):
///
/// ```text
/// l = sqrt(sum |e_i|^2 / n)        L += a (l - L)        score: -ln L
/// ```
///
/// - [`from_untouched`](Self::from_untouched): q is the displacement or shear relative to an untouched reference, and
///   e = q.
/// - [`on_pattern`](Self::on_pattern): q is the position in the image, and e its residual after fitting all images of
///   an untouched, regular pattern: translated, sheared and tilted, seen through a lens. A load that displaces all
///   elements alike is not detected.
/// - [`without_reference`](Self::without_reference): the contact is always [`Contact::Unknown`].
///
/// Elements without a vector are left out of a frame's load. A frame leaves L unchanged if more than half of the
/// elements lack a vector.
#[derive(Debug, Clone)]
pub struct ContactLoss {
    config: ContactLossConfig,
    scale: f64,
    reference: Reference,
    load: Option<f64>,
    /// Time since the last frame that updated the load (s).
    waited: f64,
    contact: Contact,
}

impl ContactLoss {
    /// Creates a detector for `elements` elements whose vectors are shear or displacement relative to an untouched
    /// reference. `scale` is the full scale of shear, or the spacing of the elements, in the unit of the vectors.
    ///
    /// # Errors
    /// If a value is out of range.
    pub fn from_untouched(
        elements: usize,
        scale: f64,
        config: ContactLossConfig,
    ) -> Result<Self, GraspSlipError> {
        config.check(scale)?;
        Ok(Self::new(config, scale, Reference::Untouched(elements)))
    }

    /// Creates a detector for markers in a `picture`, given their positions `places` (px) in one frame, with or without
    /// contact; NaN for markers that were not found. The scale is the markers' spacing. Finds their [`RegularPattern`].
    ///
    /// # Errors
    /// If the positions do not form a regular pattern, or a value is out of range.
    pub fn on_pattern(
        places: &[DVec2],
        picture: Option<Picture>,
        config: ContactLossConfig,
    ) -> Result<Self, GraspSlipError> {
        let pattern = RegularPattern::of(places)?;
        let scale = pattern.spacing();
        config.check(scale)?;
        let fit = LensFit::new(&pattern, places, picture)?;
        Ok(Self::new(config, scale, Reference::Pattern(Box::new(fit))))
    }

    /// Creates a detector for elements without a known state without contact. It always reports [`Contact::Unknown`].
    pub fn without_reference() -> Self {
        Self::new(ContactLossConfig::default(), 1.0, Reference::Unknown)
    }

    fn new(config: ContactLossConfig, scale: f64, reference: Reference) -> Self {
        Self {
            config,
            scale,
            reference,
            load: None,
            waited: 0.0,
            contact: Contact::Unknown,
        }
    }

    /// Restarts the detector for another grasp with the same sensor and reference.
    pub fn restart(&mut self) {
        (self.load, self.waited, self.contact) = (None, 0.0, Contact::Unknown);
    }

    /// Updates the contact with the next frame, `interval` (s) after the previous one. `vectors` has one vector per
    /// element, NaN if it was not measured; excess vectors are ignored. After the first frame, an interval of 0 or less
    /// changes nothing. Must be called once per frame; neither allocates nor panics.
    pub fn update(&mut self, interval: f64, vectors: impl IntoIterator<Item = DVec2>) -> Contact {
        let interval = passed(interval) + self.waited;
        self.waited = interval;
        let newest = match &mut self.reference {
            Reference::Unknown => None,
            Reference::Untouched(elements) => {
                rms(vectors.into_iter().take(*elements), *elements, self.scale)
            }
            Reference::Pattern(fit) => fit.residual(vectors, self.scale),
        };
        let Some(newest) = newest else {
            return self.contact;
        };
        self.waited = 0.0;
        let before = self.load.unwrap_or(newest);
        let load = before + part(interval, self.config.time_constant) * (newest - before);
        self.load = Some(load);
        self.contact = match self.contact {
            _ if load > HELD * self.config.threshold => Contact::Held,
            Contact::Unknown => Contact::Untouched,
            Contact::Held if load < self.config.threshold => Contact::Lost,
            contact => contact,
        };
        self.contact
    }

    /// State of the contact at the latest frame.
    pub fn contact(&self) -> Contact {
        self.contact
    }

    /// Filtered load L in units of the scale; `None` while it is unknown.
    pub fn load(&self) -> Option<f64> {
        self.load
    }

    /// Score -ln L, the negative logarithm of the load; `None` while it is unknown. The higher the score, the more
    /// likely the object is lost.
    pub fn score(&self) -> Option<f64> {
        self.load.map(|load| -libm::log(load.max(LEAST)))
    }
}

/// Root mean square of the valid vectors in units of `scale`; `None` if more than half of the `elements` lack a valid
/// vector.
fn rms(vectors: impl Iterator<Item = DVec2>, elements: usize, scale: f64) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_usize);
    for vector in vectors.filter_map(|vector| super::scaled(vector, scale)) {
        sum += vector.length_squared();
        count += 1;
    }
    (count > 0 && 2 * count >= elements).then(|| (sum / count as f64).sqrt())
}
