//! What slip detectors say of a recording of a grasp.

use feeler::control::flags::{FlagAnalyzer, FlagThresholds};
use feeler::control::grasp_slip::{
    ContactLoss, ContactLossConfig, GraspDrag, GraspDragConfig, GraspSlipError, Picture, noise_of,
};
use feeler::sensor::reading::TactileFrame;
use feeler_report::series::percentile;
use glam::{DVec2, DVec3};

/// Share of a recording's frames in which drag must be as high as its score: a slip lasts, a jolt does not.
const SUSTAINED: f64 = 0.9;
/// Time constant of the filter before the paper's rule, s.
const RATE_FILTER: f64 = 0.1;
/// Share of the elements that are usually seen which must be seen in the frame that the pattern is found in.
const USUAL: f64 = 0.9;

/// A detector of slip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Detector {
    /// The paper's rule: the largest rate of shear of any element.
    ShearRate,
    /// The same, of shear behind a filter of 0.1 s.
    FilteredShearRate,
    /// The largest shear of any element.
    Shear,
    /// That contact is lost ([`ContactLoss`]).
    ContactLoss,
    /// That what is held moves in the grip ([`GraspDrag`]).
    Drag,
}

/// All detectors, in the order of their numbers.
pub const DETECTORS: [Detector; 5] = [
    Detector::ShearRate,
    Detector::FilteredShearRate,
    Detector::Shear,
    Detector::ContactLoss,
    Detector::Drag,
];

impl Detector {
    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::ShearRate => "shear rate (the paper's rule)",
            Self::FilteredShearRate => "shear rate, filtered",
            Self::Shear => "shear",
            Self::ContactLoss => "contact loss",
            Self::Drag => "drag",
        }
    }

    /// The same in a word, as in a table.
    pub fn key(self) -> &'static str {
        match self {
            Self::ShearRate => "shear_rate",
            Self::FilteredShearRate => "filtered_shear_rate",
            Self::Shear => "shear",
            Self::ContactLoss => "contact_loss",
            Self::Drag => "drag",
        }
    }

    /// What its number for a frame is, where vectors are in `unit`.
    pub fn meaning(self, unit: &str) -> String {
        match self {
            Self::ShearRate | Self::FilteredShearRate => {
                format!("largest change of an element, {unit}/s")
            }
            Self::Shear => format!("largest shear of an element, {unit}"),
            Self::ContactLoss => "-ln of the load".into(),
            Self::Drag => "excursion from the slow mean, standard deviations of the noise".into(),
        }
    }

    /// What its number for a whole recording is.
    pub fn of_a_recording(self) -> &'static str {
        match self {
            Self::ShearRate | Self::FilteredShearRate | Self::Shear => "its largest",
            Self::ContactLoss => "its largest in the second half",
            Self::Drag => "what it exceeds in a tenth of the frames",
        }
    }

    /// The number for a recording of these numbers, one for each frame.
    fn sum_up(self, mut frames: Vec<Option<f64>>) -> Option<f64> {
        if self == Self::ContactLoss {
            // So that a later touch does not hide a loss, nor the time before a grasp look like one.
            frames.drain(..frames.len() / 2);
        }
        let known = frames.into_iter().flatten();
        match self {
            Self::Drag => percentile(known, 100.0 * SUSTAINED),
            _ => known.max_by(f64::total_cmp),
        }
    }
}

/// What is known of the elements where nothing touches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Untouched {
    /// Nothing.
    Unknown,
    /// Their vectors are 0.
    Zero,
    /// Their places are a regular pattern in the picture, of which this is known.
    Pattern(Option<Picture>),
    /// Their places are a regular pattern in this picture, and nobody knows which is which from frame to frame: their vectors
    /// are places, px, in any order and number.
    Afresh(Picture),
}

/// One frame.
#[derive(Debug, Clone, PartialEq)]
pub struct GraspFrame {
    /// Its time, s.
    pub stamp: f64,
    /// Shear, or displacement in the plane, of each element; not a number where it has none.
    pub shear: Vec<DVec2>,
    /// Load of each element along its normal, in the same unit; empty where only the plane is seen.
    pub normal: Vec<f64>,
}

impl GraspFrame {
    /// Load of each element, 0 along the normal where only the plane is seen; not a number where it has none.
    fn loads(&self) -> impl Iterator<Item = DVec3> + '_ {
        let normal = |element| self.normal.get(element).copied().unwrap_or(0.0);
        let shear = self.shear.iter().enumerate();
        shear.map(move |(element, shear)| shear.extend(normal(element)))
    }
}

/// A recording of a grasp, from any sensor.
#[derive(Debug, Clone, PartialEq)]
pub struct GraspRecording {
    /// What is known of the elements where nothing touches.
    pub untouched: Untouched,
    /// Place of each element in the picture where its vector is 0, px; empty where there is no picture.
    pub origins: Vec<DVec2>,
    /// The frames, in order.
    pub frames: Vec<GraspFrame>,
}

impl GraspRecording {
    fn elements(&self) -> usize {
        let counts = self.frames.iter().map(|frame| frame.shear.len());
        counts.max().unwrap_or(0)
    }

    /// Places of all elements in a frame, px.
    fn places<'a>(&'a self, frame: &'a GraspFrame) -> impl Iterator<Item = DVec2> + 'a {
        let origins = self.origins.iter().zip(&frame.shear);
        origins.map(|(origin, shear)| *origin + *shear)
    }

    /// The detector of lost contact for this recording.
    ///
    /// # Errors
    /// When the elements are no regular pattern, where they should be one.
    fn contact_loss(&self) -> Result<ContactLoss, GraspSlipError> {
        let config = ContactLossConfig::default();
        match self.untouched {
            Untouched::Unknown => Ok(ContactLoss::without_reference()),
            // One load for all of them, which is found for each frame.
            Untouched::Afresh(_) => ContactLoss::from_untouched(1, 1.0, config),
            Untouched::Zero => ContactLoss::from_untouched(self.elements(), 1.0, config),
            Untouched::Pattern(picture) => {
                let count = |frame: &GraspFrame| {
                    self.places(frame).filter(|place| place.is_finite()).count()
                };
                let mut counts: Vec<_> = self.frames.iter().map(count).collect();
                counts.sort_unstable();
                let usual = counts.get(counts.len() / 2).copied().unwrap_or(0);
                // The first frame with the usual number of markers may be touched or not.
                let enough = |frame: &&GraspFrame| count(frame) as f64 >= USUAL * usual as f64;
                let first = self.frames.iter().find(enough);
                let places: Vec<_> = first.into_iter().flat_map(|f| self.places(f)).collect();
                ContactLoss::on_pattern(&places, picture, config)
            }
        }
    }

    /// Standard deviation of the noise of a component of shear, in the unit of the vectors; none where nothing changes, or less than two
    /// frames have vectors.
    fn noise(&self) -> Option<f64> {
        let pairs = self.frames.windows(2);
        let changes = pairs.flat_map(|pair| pair[0].shear.iter().zip(&pair[1].shear));
        let mut changes: Vec<_> = changes
            .flat_map(|(before, now)| (*now - *before).to_array())
            .collect();
        noise_of(&mut changes)
    }
}

/// What the detectors say of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct DetectorTrace {
    /// Of each frame, each detector's number, in the order of [`DETECTORS`]; none where it is unknown. Drag is in the unit of the
    /// vectors.
    pub frames: Vec<[Option<f64>; DETECTORS.len()]>,
    /// The recording's noise in the unit of the vectors, if there is any.
    pub noise: Option<f64>,
    /// Why nothing is known of contact where places should have been a pattern; where each frame is fitted afresh, of the first
    /// that was none.
    pub no_pattern: Option<GraspSlipError>,
}

impl DetectorTrace {
    /// Runs all detectors over a recording.
    ///
    /// # Errors
    /// None that a test would not have found: the detectors' own values are in range.
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
                Untouched::Pattern(_) => loss.update(interval, recording.places(frame)),
                Untouched::Afresh(picture) => {
                    let newest = load_afresh(&frame.shear, picture).unwrap_or_else(|error| {
                        no_pattern.get_or_insert(error);
                        f64::NAN
                    });
                    loss.update(interval, [DVec2::X * newest]);
                    frames.push([None, None, None, loss.score(), None]);
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
            ]);
        }
        Ok(Self {
            frames,
            noise: match recording.untouched {
                Untouched::Afresh(_) => None,
                _ => recording.noise(),
            },
            no_pattern,
        })
    }

    /// Each detector's number for the whole recording.
    pub fn sums(&self) -> [Option<f64>; DETECTORS.len()] {
        std::array::from_fn(|detector| {
            let frames = self.frames.iter().map(move |frame| frame[detector]);
            DETECTORS[detector].sum_up(frames.collect())
        })
    }
}

/// Shear behind a filter, N.
struct FilteredRate(Vec<DVec2>);

impl FilteredRate {
    /// Rates of the filtered shear after the next frame, N/s: of a filter of first order, what it lacks over its time constant.
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

/// Load on the markers at `places` (px) of a single frame, spacings; not a number where too few are told from a lens.
///
/// # Errors
/// When they are no regular pattern.
fn load_afresh(places: &[DVec2], picture: Picture) -> Result<f64, GraspSlipError> {
    let config = ContactLossConfig::default();
    let mut loss = ContactLoss::on_pattern(places, Some(picture), config)?;
    loss.update(0.0, places.iter().copied());
    Ok(loss.load().unwrap_or(f64::NAN))
}

/// Largest of the numbers that are finite.
fn largest(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let finite = numbers.filter(|number| number.is_finite());
    finite.max_by(f64::total_cmp)
}

/// Only rates are asked for.
fn no_thresholds() -> FlagThresholds {
    FlagThresholds {
        touch_force: f64::INFINITY,
        over_force: f64::INFINITY,
        slip_threshold: f64::INFINITY,
    }
}
