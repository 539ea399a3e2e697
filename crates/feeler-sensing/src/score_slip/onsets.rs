//! Onset of slips from labels of frames; onset and loss of the object from images.

use feeler::control::grasp_slip::CoarseImage;
use feeler_lab::grasps::SlipEvent;
use std::collections::BTreeMap;

/// Minimum duration of the state after the loss, and of contact before it (s).
const STATE: f64 = 0.5;
/// Interval over which motion is measured (s).
const INTERVAL: f64 = 0.2;
/// Distance of images (gray levels) below which they show the same state, unless noise is larger.
const SAME: f64 = 1.0;

/// Determines the slip in the images of a grasp whose object is lost in the end. Times are in s.
///
/// With d(t) the distance of an image from the final one, and c(t) that from the latest image at least 0.2 s older:
///
/// - The object is **gone** at the first image from which on d stays at or below the larger of 1 gray level and three times
///   the maximum of d in the last 0.5 s. There must be at least 0.5 s of images before and after, and contact (d above
///   the limit) in at least half of the images of the 0.5 s before.
/// - The **onset** is the first image after the last rest before the loss. An image is at rest if c is at most the larger
///   of 1 gray level and twice the lower quartile of c. Without rest, it is the first image for which c is known.
///
/// Returns `None` if the images do not show the loss. They show any motion of the imprint, also that of an object that
/// is shaken before it slides.
pub fn slip_in_images<'a>(
    images: impl Iterator<Item = (f64, &'a CoarseImage)>,
) -> Option<SlipEvent> {
    let images: Vec<_> = images.collect();
    let (end, last) = *images.last()?;
    let distances: Vec<_> = images.iter().map(|image| image.1.distance(last)).collect();
    let is_final = |index: usize| images[index].0 > end - STATE;
    let noise = (0..images.len()).filter(|index| is_final(*index));
    let noise = noise.map(|index| distances[index]).fold(0.0, f64::max);
    let limit = SAME.max(3.0 * noise);

    let held = distances.iter().rposition(|distance| *distance > limit)?;
    let gone = held + 1;
    let loss = images.get(gone)?.0;
    let before = (0..gone).filter(|index| images[*index].0 >= loss - STATE);
    let in_contact = before.clone().filter(|index| distances[*index] > limit);
    let is_known = loss - images.first()?.0 >= STATE && !is_final(gone);
    if !is_known || 2 * in_contact.count() < before.count() {
        return None;
    }

    let changes = changes(&images);
    let mut sorted = changes.clone();
    sorted.sort_by(|a, b| a.1.total_cmp(&b.1));
    let quiet = SAME.max(2.0 * sorted.get(sorted.len() / 4)?.1);
    let rest = changes
        .iter()
        .rfind(|(index, change)| *index < gone && *change <= quiet);
    let first = changes.first()?.0;
    let onset = rest.map_or(first, |(index, _)| (index + 1).min(gone));
    Some(SlipEvent {
        onset: images[onset].0,
        loss: Some(loss),
        end,
    })
}

/// Distance of each image from the newest one that is at least [`INTERVAL`] older, with the image's index.
fn changes(images: &[(f64, &CoarseImage)]) -> Vec<(usize, f64)> {
    let mut before = 0;
    let changes = images.iter().enumerate();
    let changes = changes.filter_map(|(index, (stamp, image))| {
        let is_old = |index: usize| stamp - images[index].0 >= INTERVAL - 1e-6;
        while is_old(before + 1) && before + 1 < index {
            before += 1;
        }
        is_old(before).then(|| (index, image.distance(images[before].1)))
    });
    changes.collect()
}

/// Returns the slips in labels of frames. Each starts at the first labelled frame with slip after one without, and ends at
/// the last labelled frame with slip before the next one without. The loss is unknown. `stamps` are the times of all
/// frames (s).
pub fn slips_in_labels(labels: &BTreeMap<usize, bool>, stamps: &[f64]) -> Vec<SlipEvent> {
    let known = labels
        .iter()
        .filter_map(|(frame, slip)| Some((*stamps.get(*frame)?, *slip)));
    let known: Vec<_> = known.collect();
    let runs: Vec<_> = known.chunk_by(|a, b| a.1 == b.1).collect();
    let pairs = runs.windows(2).filter(|pair| pair[1][0].1);
    let slips = pairs.map(|pair| SlipEvent {
        onset: pair[1][0].0,
        loss: None,
        end: pair[1][pair[1].len() - 1].0,
    });
    slips.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use feeler::sensor::image::Picture;

    /// Image whose left part of `columns` columns is brighter.
    fn image(columns: usize, brighter: u8) -> CoarseImage {
        let pixels = (0..40 * 30).map(|i| 100 + brighter * u8::from(i % 40 < columns));
        CoarseImage::of(&Picture {
            width: 40,
            height: 30,
            pixels: pixels.collect::<Vec<u8>>(),
        })
    }

    fn in_images(images: &[(f64, CoarseImage)]) -> Option<SlipEvent> {
        slip_in_images(images.iter().map(|(stamp, image)| (*stamp, image)))
    }

    /// Images at 10 Hz: untouched, held from 1 s, in motion from 3 s, gone from 4 s, until 6 s.
    fn grasp() -> Vec<(f64, CoarseImage)> {
        let images = (0..60).map(|index| {
            let image = match index {
                0..10 | 40.. => image(0, 0),
                10..30 => image(20, 30),
                _ => image(20 - 2 * (index - 30).min(8), 30),
            };
            (index as f64 / 10.0, image)
        });
        images.collect()
    }

    #[test]
    fn onset_and_loss_are_those_of_the_images() {
        let slip = in_images(&grasp()).unwrap();
        // The first image in motion is 2 of 40 columns away from rest, above one grey level after 0.2 s.
        assert!((3.0..=3.2).contains(&slip.onset), "{slip:?}");
        assert_eq!((slip.loss, slip.end), (Some(4.0), 5.9));
    }

    #[test]
    fn images_without_a_visible_loss_have_no_onset() {
        let all = grasp();
        assert_eq!(in_images(&[]), None);
        assert_eq!(in_images(&all[..1]), None);
        assert_eq!(in_images(&all[..35]), None);
        assert_eq!(in_images(&all[40..]), None);
        assert_eq!(in_images(&all[..42]), None, "too short afterwards");
        assert_eq!(in_images(&all[37..]), None, "too short before");
    }

    #[test]
    fn slips_of_labels_begin_where_they_change() {
        let labels = [true, false, true, true, false, true]
            .into_iter()
            .enumerate();
        let stamps = [0.0, 0.1, 0.2, 0.3, 0.4];
        let slips = slips_in_labels(&labels.collect(), &stamps);
        let expected = SlipEvent {
            onset: 0.2,
            loss: None,
            end: 0.3,
        };
        assert_eq!(slips, [expected]);
    }
}
