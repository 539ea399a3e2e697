//! Slip detectors applied to a recording of a grasp.

use feeler::control::grasp_slip::{
    ContactLoss, ContactLossConfig, GraspDrag, GraspDragConfig, GraspSlipError, Picture, noise_of,
};
use feeler::control::{FlagAnalyzer, FlagThresholds};
use feeler::sensor::forces::TactileFrame;
use feeler_report::measures::percentile;
use glam::{DVec2, DVec3};

/// Quantile of the drag over all frames that is the score of a recording. A quantile below 1 ignores short jolts.
const SUSTAINED: f64 = 0.9;
/// Time constant of the filter before the paper's rule (s).
const RATE_FILTER: f64 = 0.1;
/// Minimum number of visible elements in the frame that defines the pattern, as a fraction of the usual number.
const USUAL: f64 = 0.9;

/// A slip detector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detector {
    /// The paper's rule: largest shear rate of any element.
    ShearRate,
    /// The paper's rule after a filter of 0.1 s.
    FilteredShearRate,
    /// Largest shear of any element.
    Shear,
    /// Loss of contact ([`ContactLoss`]).
    ContactLoss,
    /// Motion of the object in the grip ([`GraspDrag`]).
    Drag,
    /// Similarity of the image to that of the untouched gel ([`ImageLoss`](feeler::control::grasp_slip::ImageLoss)).
    ImageLoss,
}

/// All detectors, in the order of their scores.
pub const DETECTORS: [Detector; 6] = [
    Detector::ShearRate,
    Detector::FilteredShearRate,
    Detector::Shear,
    Detector::ContactLoss,
    Detector::Drag,
    Detector::ImageLoss,
];

impl Detector {
    /// Displayed name.
    pub fn name(self) -> &'static str {
        match self {
            Self::ShearRate => "shear rate (the paper's rule)",
            Self::FilteredShearRate => "shear rate, filtered",
            Self::Shear => "shear",
            Self::ContactLoss => "contact loss",
            Self::Drag => "drag",
            Self::ImageLoss => "image loss",
        }
    }

    /// Name in tables and files.
    pub fn key(self) -> &'static str {
        match self {
            Self::ShearRate => "shear_rate",
            Self::FilteredShearRate => "filtered_shear_rate",
            Self::Shear => "shear",
            Self::ContactLoss => "contact_loss",
            Self::Drag => "drag",
            Self::ImageLoss => "image_loss",
        }
    }

    /// Describes the score of a frame, for vectors in `unit`.
    pub fn meaning(self, unit: &str) -> String {
        match self {
            Self::ShearRate | Self::FilteredShearRate => {
                format!("largest change of an element, {unit}/s")
            }
            Self::Shear => format!("largest shear of an element, {unit}"),
            Self::ContactLoss => "-ln of the load".into(),
            Self::Drag => "excursion from the slow mean, standard deviations of the noise".into(),
            Self::ImageLoss => "-ln of the distance from the untouched image, grey levels".into(),
        }
    }

    /// Describes the score of a whole recording.
    pub fn of_a_recording(self) -> &'static str {
        match self {
            Self::ShearRate | Self::FilteredShearRate | Self::Shear => "maximum",
            Self::ContactLoss | Self::ImageLoss => "maximum of the second half",
            Self::Drag => "value exceeded in a tenth of the frames",
        }
    }

    /// Returns the score of a recording from the scores of its frames, or `None` if it has none.
    pub fn sum_up(self, mut frames: Vec<Option<f64>>) -> Option<f64> {
        if matches!(self, Self::ContactLoss | Self::ImageLoss) {
            // Neither a later touch nor the time before the grasp should affect the score.
            frames.drain(..frames.len() / 2);
        }
        let known = frames.into_iter().flatten();
        match self {
            Self::Drag => percentile(known, 100.0 * SUSTAINED),
            _ => known.max_by(f64::total_cmp),
        }
    }
}

/// Prior knowledge of the measured vectors without contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ContactReference {
    /// Nothing is known.
    Unknown,
    /// The measured vectors of the elements are 0 without contact, so that a zero vector means an untouched element.
    Zero,
    /// The elements form a regular pattern in the image. The argument describes the image, if known.
    Pattern(Option<Picture>),
    /// The elements form a regular pattern in this image and are not tracked between frames: the vectors are positions
    /// (px) in any order and number.
    LocatedPattern(Picture),
}

/// One frame of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct GraspFrame {
    /// Timestamp (s).
    pub stamp: f64,
    /// Shear or in-plane displacement of each element; NaN if unknown.
    pub shear: Vec<DVec2>,
    /// Normal load of each element, in the unit of `shear`. Empty if only in-plane values are measured.
    pub normal: Vec<f64>,
}

impl GraspFrame {
    /// Load of each element, with a normal component of 0 if only the plane is measured; NaN if unknown.
    fn loads(&self) -> impl Iterator<Item = DVec3> + '_ {
        let normal = |element| self.normal.get(element).copied().unwrap_or(0.0);
        let shear = self.shear.iter().enumerate();
        shear.map(move |(element, shear)| shear.extend(normal(element)))
    }
}

/// Recording of a grasp from any sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct GraspRecording {
    /// Prior knowledge of the measured vectors without contact.
    pub untouched: ContactReference,
    /// Position in the image (px) at which the vector of each element is 0. Empty if there are no images.
    pub origins: Vec<DVec2>,
    /// The frames in chronological order.
    pub frames: Vec<GraspFrame>,
}

impl GraspRecording {
    fn elements(&self) -> usize {
        let counts = self.frames.iter().map(|frame| frame.shear.len());
        counts.max().unwrap_or(0)
    }

    /// Positions of all elements in a frame (px).
    fn places<'a>(&'a self, frame: &'a GraspFrame) -> impl Iterator<Item = DVec2> + 'a {
        let origins = self.origins.iter().zip(&frame.shear);
        origins.map(|(origin, shear)| *origin + *shear)
    }

    /// Creates the detector of contact loss for this recording.
    ///
    /// # Errors
    /// If the elements do not form a regular pattern although one is expected.
    fn contact_loss(&self) -> Result<ContactLoss, GraspSlipError> {
        let config = ContactLossConfig::default();
        match self.untouched {
            ContactReference::Unknown => Ok(ContactLoss::without_reference()),
            // A single element, whose load is computed from each frame.
            ContactReference::LocatedPattern(_) => ContactLoss::from_untouched(1, 1.0, config),
            ContactReference::Zero => ContactLoss::from_untouched(self.elements(), 1.0, config),
            ContactReference::Pattern(picture) => {
                let count = |frame: &GraspFrame| {
                    self.places(frame).filter(|place| place.is_finite()).count()
                };
                let mut counts: Vec<_> = self.frames.iter().map(count).collect();
                counts.sort_unstable();
                let usual = counts.get(counts.len() / 2).copied().unwrap_or(0);
                // The first frame with the usual number of markers, with or without contact.
                let enough = |frame: &&GraspFrame| count(frame) as f64 >= USUAL * usual as f64;
                let first = self.frames.iter().find(enough);
                let places: Vec<_> = first.into_iter().flat_map(|f| self.places(f)).collect();
                ContactLoss::on_pattern(&places, picture, config)
            }
        }
    }

    /// Standard deviation of the noise of a shear component, in the unit of the vectors. `None` if nothing changes, or
    /// fewer than two frames have vectors.
    fn noise(&self) -> Option<f64> {
        let pairs = self.frames.windows(2);
        let changes = pairs.flat_map(|pair| pair[0].shear.iter().zip(&pair[1].shear));
        let mut changes: Vec<_> = changes
            .flat_map(|(before, now)| (*now - *before).to_array())
            .collect();
        noise_of(&mut changes)
    }
}

/// Scores of all detectors for a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct DetectorTrace {
    /// Scores of each frame in the order of [`DETECTORS`]; `None` if unknown, and always for [`Detector::ImageLoss`],
    /// which requires images. Drag is in the unit of the vectors.
    pub frames: Vec<[Option<f64>; DETECTORS.len()]>,
    /// Noise of the recording in the unit of the vectors, if known.
    pub noise: Option<f64>,
    /// Reason why contact loss is unknown although a pattern was expected. If frames are fitted individually, the
    /// reason of the first failure.
    pub no_pattern: Option<GraspSlipError>,
}

impl DetectorTrace {
    /// Applies all detectors to a recording.
    ///
    /// # Errors
    /// If a detector rejects its default parameters, which does not happen.
    pub fn of(recording: &GraspRecording) -> Result<Self, GraspSlipError> {
        let elements = recording.elements();
        let (mut loss, mut no_pattern) = match recording.contact_loss() {
            Ok(loss) => (loss, None),
            Err(error) => (ContactLoss::without_reference(), Some(error)),
        };
        let mut drag = GraspDrag::new(elements, 1.0, GraspDragConfig::default())?;
        let mut flags = FlagAnalyzer::new(no_thresholds(), elements);
        let mut tactile = TactileFrame::unloaded(elements);
        let mut rate = FilteredRate(vec![DVec2::NAN; elements]);
        let mut before = None;
        let mut frames = Vec::with_capacity(recording.frames.len());
        for (number, frame) in recording.frames.iter().enumerate() {
            let interval = before.replace(frame.stamp).map_or(0.0, |b| frame.stamp - b);
            (tactile.sequence, tactile.stamp) = (number as u64, frame.stamp);
            for (index, force) in tactile.forces.iter_mut().enumerate() {
                let shear = frame.shear.get(index).copied().unwrap_or(DVec2::NAN);
                *force = shear.extend(0.0);
            }
            flags.analyze(&tactile);
            match recording.untouched {
                ContactReference::Pattern(_) => loss.update(interval, recording.places(frame)),
                ContactReference::LocatedPattern(picture) => {
                    let newest = load_afresh(&frame.shear, picture).unwrap_or_else(|error| {
                        no_pattern.get_or_insert(error);
                        f64::NAN
                    });
                    loss.update(interval, [DVec2::X * newest]);
                    frames.push([None, None, None, loss.score(), None, None]);
                    continue;
                }
                _ => loss.update(interval, frame.shear.iter().copied()),
            };
            let shear = frame.shear.iter().map(|shear| shear.length());
            frames.push([
                largest(flags.shear_rate().iter().copied()),
                largest(rate.take(interval, &frame.shear)),
                largest(shear),
                loss.score(),
                drag.update(interval, frame.loads()),
                None,
            ]);
        }
        Ok(Self {
            frames,
            noise: match recording.untouched {
                ContactReference::LocatedPattern(_) => None,
                _ => recording.noise(),
            },
            no_pattern,
        })
    }

    /// Returns the score of each detector for the whole recording.
    pub fn sums(&self) -> [Option<f64>; DETECTORS.len()] {
        std::array::from_fn(|detector| {
            let frames = self.frames.iter().map(move |frame| frame[detector]);
            DETECTORS[detector].sum_up(frames.collect())
        })
    }
}

/// Low-pass filtered shear (N).
struct FilteredRate(Vec<DVec2>);

impl FilteredRate {
    /// Updates the filter and returns the rate of change of the filtered shear (N/s): the difference between input and
    /// output, divided by the time constant.
    fn take<'a>(&'a mut self, interval: f64, shear: &'a [DVec2]) -> impl Iterator<Item = f64> + 'a {
        let part = -(-interval.max(0.0) / RATE_FILTER).exp_m1();
        let known = self.0.iter_mut().zip(shear);
        known
            .filter(|(_, shear)| shear.is_finite())
            .map(move |(filtered, shear)| {
                if filtered.is_nan() {
                    *filtered = *shear;
                }
                *filtered += part * (*shear - *filtered);
                filtered.distance(*shear) / RATE_FILTER
            })
    }
}

/// Load of the markers at `places` (px) in a single frame, in marker spacings. NaN if there are too few markers to
/// distinguish load from lens distortion.
///
/// # Errors
/// If the markers do not form a regular pattern.
fn load_afresh(places: &[DVec2], picture: Picture) -> Result<f64, GraspSlipError> {
    let config = ContactLossConfig::default();
    let mut loss = ContactLoss::on_pattern(places, Some(picture), config)?;
    loss.update(0.0, places.iter().copied());
    Ok(loss.load().unwrap_or(f64::NAN))
}

/// Largest finite number.
fn largest(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let finite = numbers.filter(|number| number.is_finite());
    finite.max_by(f64::total_cmp)
}

/// Infinite thresholds, for an analyzer that is used only for its rates.
fn no_thresholds() -> FlagThresholds {
    FlagThresholds {
        touch_force: f64::INFINITY,
        over_force: f64::INFINITY,
        slip_threshold: f64::INFINITY,
    }
}
