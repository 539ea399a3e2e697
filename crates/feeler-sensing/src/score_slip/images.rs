//! Recognizes images of an untouched gel by comparing the images of all recordings.
//!
//! Different grasps press different shapes into a gel, but all of them leave the same untouched image. An image is
//! therefore compared with those of all other groups of recordings: the distance to the nearest of them is small if the
//! gel is untouched. Labels are not used.

use super::scores::Scored;
use feeler::control::grasp_slip::{CoarseImage, ImageLoss};
use feeler_lab::grasps::{DETECTORS, Detector, SlipEvent};
use std::ops::Range;

/// Interval between the images of a recording that serve as references for other recordings (s).
const INTERVAL: f64 = 0.48;
/// Duration at the start of a recording that is ignored (s), because cameras may deliver images of the previous
/// recording first.
const LEFT_OUT: f64 = 0.24;

/// Images and scores of a recording over time.
pub struct Sequence {
    /// Group of the recording.
    pub group: usize,
    /// Range of the recording in the list of [`Scored`].
    pub scored: Range<usize>,
    /// Times of its frames (s).
    pub stamps: Vec<f64>,
    /// Image of each frame; empty for tables.
    pub images: Vec<CoarseImage>,
    /// Scores of its frames in the order of [`DETECTORS`].
    pub scores: Vec<[Option<f64>; DETECTORS.len()]>,
    /// Its slips with a known onset.
    pub slips: Vec<SlipEvent>,
}

impl Sequence {
    /// Returns the times (s) and images, without the first ones, which may belong to the previous recording.
    pub fn valid(&self) -> impl Iterator<Item = (f64, &CoarseImage)> {
        let start = self.stamps.first().copied().unwrap_or(0.0);
        let images = self.stamps.iter().copied().zip(&self.images);
        images.filter(move |(stamp, _)| stamp - start >= LEFT_OUT)
    }

    fn sparse(&self) -> impl Iterator<Item = &CoarseImage> {
        let mut next = f64::NEG_INFINITY;
        self.valid().filter_map(move |(stamp, image)| {
            let is_due = stamp >= next;
            next = if is_due {
                stamp + INTERVAL - 1e-6
            } else {
                next
            };
            is_due.then_some(image)
        })
    }
}

/// Adds the scores of [`Detector::ImageLoss`] to `recordings` and `scored`. Images are compared with those of other
/// groups and of `more` recordings.
pub fn score_images(recordings: &mut [Sequence], more: &[Sequence], scored: &mut [Scored]) {
    let Some(detector) = DETECTORS.iter().position(|d| *d == Detector::ImageLoss) else {
        return;
    };
    let losses = |own| image_losses(own, recordings, more);
    let losses: Vec<_> = recordings.iter().map(losses).collect();
    for (own, losses) in recordings.iter_mut().zip(losses) {
        for (scores, loss) in own.scores.iter_mut().zip(&losses) {
            scores[detector] = *loss;
        }
        for one in scored.get_mut(own.scored.clone()).into_iter().flatten() {
            one.scores[detector] = match one.frame {
                Some(frame) => losses.get(frame).copied().flatten(),
                None => Detector::ImageLoss.sum_up(losses.clone()),
            };
        }
    }
}

/// Computes the image-loss score of each image in `own`. Images are compared with those of other groups in `all` and
/// with those of `more`.
fn image_losses(own: &Sequence, all: &[Sequence], more: &[Sequence]) -> Vec<Option<f64>> {
    let others = all.iter().filter(|other| other.group != own.group);
    let others: Vec<_> = others.chain(more).flat_map(Sequence::sparse).collect();
    let mut scores = vec![None; own.images.len() - own.valid().count()];
    let (mut loss, mut before, mut last) = (ImageLoss::default(), None, 0);
    for (stamp, image) in own.valid() {
        let interval = stamp - before.replace(stamp).unwrap_or(stamp);
        let distance = nearest(image, &others, &mut last).unwrap_or(f64::NAN);
        scores.push(loss.update(interval, distance));
    }
    scores
}

/// Returns the distance to the nearest of `others`. The search starts with the one at index `last`, which is then set
/// to the nearest.
fn nearest(image: &CoarseImage, others: &[&CoarseImage], last: &mut usize) -> Option<f64> {
    let mut least = image.distance(others.get(*last)?);
    for (index, other) in others.iter().enumerate() {
        if let Some(distance) = image.distance_below(other, least) {
            (least, *last) = (distance, index);
        }
    }
    Some(least)
}
