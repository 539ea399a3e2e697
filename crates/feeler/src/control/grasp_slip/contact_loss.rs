//! Loss of contact: whether what was grasped still loads the elements.

use super::lens_fit::LensFit;
use super::{GraspSlipError, Picture, RegularPattern, part, passed};
use crate::check::Checker;
use glam::DVec2;

/// How far above the threshold the load must have been for a grasp to be one.
const HELD: f64 = 1.5;
/// Least load that a score is taken of: no sensor measures less.
const LEAST: f64 = 1e-9;

/// What [`ContactLoss`] goes by.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactLossConfig {
    /// Time constant of the filter, s. A loss is told about as much later.
    pub time_constant: f64,
    /// Load below which nothing is held, in units of the scale: spacings of a pattern, or full scales of shear.
    pub threshold: f64,
}

impl Default for ContactLossConfig {
    /// 0.5 s, and 0.0185 spacings, for a pattern of markers: on 40 recorded grasps with six gels, 0.016 to 0.021 do as well.
    /// A controller may take 0.1 s. For shear, it is for the sensor's owner to say what is noise.
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
        match checker.problems() {
            problems if problems.is_empty() => Ok(()),
            problems => Err(GraspSlipError::Values(problems)),
        }
    }
}

/// What is known of the contact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Contact {
    /// Nothing: it is not known what the elements are untouched, or too few of them were seen so far.
    Unknown,
    /// No load was above 1.5 thresholds yet.
    Untouched,
    /// The load was above 1.5 thresholds and has not fallen below one since.
    Held,
    /// After that, it has fallen below the threshold. Also where it was let go on purpose.
    Lost,
}

/// What the elements are held against.
#[derive(Debug, Clone)]
enum Reference {
    /// Nothing.
    Unknown,
    /// Their vectors are 0 where nothing touches, for so many elements.
    Untouched(usize),
    /// Their places are a pattern seen through a lens where nothing touches.
    Pattern(Box<LensFit>),
}

/// Tells whether what was grasped is still held, from the load on the elements.
///
/// With q_i the vector of element i in units of `scale`, n elements, and a = 1 - exp(-dt / tau):
///
/// ```text
/// l = sqrt(sum |e_i|^2 / n)        L += a (l - L)        score: -ln L
/// ```
///
/// - [`from_untouched`](Self::from_untouched): q is displacement or shear from an untouched reference, and e = q.
/// - [`on_pattern`](Self::on_pattern): q is the place in the picture, and e what remains of it beside all places
///   that an untouched, regular pattern could have: moved and sheared as a plane, tilted, and seen through a lens. A touch
///   that moves all elements alike is not seen.
/// - [`without_reference`](Self::without_reference): nothing is known, and it says so.
///
/// Elements that have no vector in a frame do not count in it; a frame in which more than half have none leaves L as it is.
#[derive(Debug, Clone)]
pub struct ContactLoss {
    config: ContactLossConfig,
    scale: f64,
    reference: Reference,
    load: Option<f64>,
    /// Time of frames that told nothing, since the last that did, s.
    waited: f64,
    contact: Contact,
}

impl ContactLoss {
    /// For so many elements, whose vectors are shear or displacement from an untouched reference. `scale`: full scale of
    /// shear, or their spacing, in the unit of the vectors.
    ///
    /// # Errors
    /// When a value is out of range.
    pub fn from_untouched(
        elements: usize,
        scale: f64,
        config: ContactLossConfig,
    ) -> Result<Self, GraspSlipError> {
        config.check(scale)?;
        Ok(Self::new(config, scale, Reference::Untouched(elements)))
    }

    /// For elements that are markers in a `picture` and were at `places` in one frame, touched or not, in px; not a number where
    /// one has none. The scale is their spacing; its [`RegularPattern`] is found at once.
    ///
    /// # Errors
    /// When the places are no regular pattern, or a value is out of range.
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

    /// For elements of which nobody knows what they are untouched: the contact stays unknown.
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

    /// Begins another grasp with the same sensor.
    pub fn restart(&mut self) {
        (self.load, self.waited, self.contact) = (None, 0.0, Contact::Unknown);
    }

    /// Takes the next frame, `interval` (s) after the one before, with a vector for each element, not a number where it has
    /// none; those beyond the number of elements do not count. After the first frame, an interval that is not positive
    /// changes nothing. To be called once a frame; neither allocates nor panics.
    pub fn update(&mut self, interval: f64, vectors: impl IntoIterator<Item = DVec2>) -> Contact {
        let interval = passed(interval) + self.waited;
        self.waited = interval;
        let newest = match &mut self.reference {
            Reference::Unknown => None,
            Reference::Untouched(elements) => {
                rms(vectors.into_iter().take(*elements), (*elements, self.scale))
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

    /// What is known of the contact at the newest frame.
    pub fn contact(&self) -> Contact {
        self.contact
    }

    /// L, the filtered load in units of the scale; none while it is unknown.
    pub fn load(&self) -> Option<f64> {
        self.load
    }

    /// -ln L: the higher, the surer nothing is held. None while it is unknown.
    pub fn score(&self) -> Option<f64> {
        self.load.map(|load| -load.max(LEAST).ln())
    }
}

/// Root of the mean square of the vectors that there are, in units of the scale; none where more than half of so many
/// elements have none.
fn rms(vectors: impl Iterator<Item = DVec2>, (elements, scale): (usize, f64)) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0_usize);
    for vector in vectors.filter_map(|vector| super::scaled(vector, scale)) {
        sum += vector.length_squared();
        count += 1;
    }
    (count > 0 && 2 * count >= elements).then(|| (sum / count as f64).sqrt())
}
