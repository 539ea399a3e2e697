//! Markers in a video.

use super::scene::{SPACING, displaced, picture, tracker, worst};
use feeler::sensor::image::Picture;
use feeler::sensor::locate::Polarity;
use feeler::sensor::track::TrackError;
use glam::DVec2;

/// Maximum error (px): at most a tenth of a pixel from edges of 2 px at 0.4 of 150 grey levels, noise of 2 and
/// neighbours in the window, and more where the background has a slope. A swap is an error of a spacing, 24 px.
const EXACT: f64 = 0.4;

/// Maximum error of predicted markers (px). An affine field through the neighbours ignores the field's curvature,
/// which for a drag of 30 px is 2 30/165² = 0.0022 px/px² in each direction: half of that times the square of the
/// spacing, in both directions, is 1.3 px. If all neighbours are on one side, extrapolation adds as much again.
const FORETOLD: f64 = 0.1 * SPACING;

#[test]
fn markers_are_tracked_beyond_their_neighbours_places_and_back() {
    for polarity in [Polarity::Bright, Polarity::Dark] {
        let (mut tracker, places) = tracker(polarity);
        let seen = vec![1.0; places.len()];
        for frame in 0..=80 {
            // 36 px, which is one and a half spacings, and a rotation, and back.
            let part = (std::f64::consts::PI * f64::from(frame) / 80.0).sin();
            let there =
                |place: &DVec2| displaced(*place, part * DVec2::new(34.0, -12.0), 0.1 * part, 0.0);
            let truth: Vec<DVec2> = places.iter().map(there).collect();
            let picture = picture(polarity, &truth, &seen, frame as u64 + 1);
            let markers = tracker.track(&picture).unwrap();
            let (error, _) = worst(markers, &truth, 0.0);
            assert!(error < EXACT, "{polarity}, frame {frame}: {error} px");
            assert!(
                markers.iter().all(|marker| marker.confidence > 0.3),
                "frame {frame}"
            );
            for (marker, place) in markers.iter().zip(&places) {
                assert!((marker.place - marker.displacement).distance(*place) < EXACT);
            }
        }
    }
}

#[test]
fn hidden_markers_are_predicted_reported_as_lost_and_found_again() {
    let (mut tracker, places) = tracker(Polarity::Dark);
    for frame in 0..60 {
        let part = f64::from(frame) / 60.0;
        let truth: Vec<DVec2> = places
            .iter()
            .map(|place| displaced(*place, part * DVec2::new(30.0, 10.0), 0.0, 0.0))
            .collect();
        // Every ninth marker is hidden for a third of the time.
        let hidden = |index: usize| index % 9 == 4 && (20..40).contains(&frame);
        let seen: Vec<f64> = (0..places.len())
            .map(|i| if hidden(i) { 0.0 } else { 1.0 })
            .collect();
        let picture = picture(Polarity::Dark, &truth, &seen, frame as u64 + 1);
        let markers = tracker.track(&picture).unwrap();
        for (index, (marker, truth)) in markers.iter().zip(&truth).enumerate() {
            let error = marker.place.distance(*truth);
            if hidden(index) {
                assert_eq!(marker.confidence, 0.0, "frame {frame}, marker {index}");
                assert!(
                    error < FORETOLD,
                    "frame {frame}, marker {index}: {error} px"
                );
            } else {
                assert!(marker.confidence > 0.3, "frame {frame}, marker {index}");
                assert!(error < EXACT, "frame {frame}, marker {index}: {error} px");
            }
        }
    }
}

#[test]
fn fading_markers_keep_their_identity() {
    let (mut tracker, places) = tracker(Polarity::Bright);
    for frame in 0..100 {
        let faded = 1.0 - 0.006 * f64::from(frame);
        let seen: Vec<f64> = (0..places.len())
            .map(|i| if i % 2 == 0 { faded } else { 1.0 })
            .collect();
        let picture = picture(Polarity::Bright, &places, &seen, frame as u64 + 1);
        let (error, count) = worst(tracker.track(&picture).unwrap(), &places, 0.2);
        assert!(
            error < EXACT && count == places.len(),
            "frame {frame}: {error} px, {count}"
        );
    }
}

/// The whole pattern jumps by about a spacing between two frames. Markers with high confidence have the correct
/// identity, or the tracker reports that they are lost.
#[test]
fn a_jump_does_not_swap_markers_silently() {
    for step in [8.0, 14.0, 20.0, 26.0, 34.0] {
        let (mut tracker, places) = tracker(Polarity::Dark);
        let seen = vec![1.0; places.len()];
        tracker
            .track(&picture(Polarity::Dark, &places, &seen, 1))
            .unwrap();
        let truth: Vec<DVec2> = places
            .iter()
            .map(|place| displaced(*place, DVec2::new(step, 0.3 * step), 0.0, 0.0))
            .collect();
        let after = picture(Polarity::Dark, &truth, &seen, 2);
        let markers = tracker.track(&after).unwrap();
        let (error, count) = worst(markers, &truth, 0.5);
        assert!(
            error < 0.5 * SPACING,
            "step {step}: {error} px in {count} sure markers"
        );
        // The reference alone identifies all markers.
        let (error, _) = worst(tracker.match_picture(&after).unwrap(), &truth, 0.0);
        assert!(error < EXACT, "step {step}: {error} px");
        let (error, _) = worst(tracker.track(&after).unwrap(), &truth, 0.0);
        assert!(error < EXACT, "step {step}: {error} px");
    }
}

#[test]
fn a_black_image_loses_all_markers_and_the_next_valid_one_finds_them() {
    let (mut tracker, places) = tracker(Polarity::Bright);
    let seen = vec![1.0; places.len()];
    let good = picture(Polarity::Bright, &places, &seen, 1);
    tracker.track(&good).unwrap();
    assert_eq!(tracker.found(), places.len());
    tracker
        .track(&Picture::black(good.width, good.height))
        .unwrap();
    assert!(tracker.is_lost() && tracker.found() == 0);
    assert!(
        tracker
            .markers()
            .iter()
            .all(|m| m.confidence == 0.0 && m.place.is_finite())
    );
    tracker.track(&good).unwrap();
    assert_eq!(tracker.found(), places.len());
}

#[test]
fn images_of_another_size_are_rejected() {
    let (mut tracker, _) = tracker(Polarity::Bright);
    let refused = tracker.track(&Picture::black(64, 64)).unwrap_err();
    assert!(matches!(
        refused,
        TrackError::PictureSize {
            actual: (64, 64),
            ..
        }
    ));
    assert!(refused.to_string().contains("400x360"), "{refused}");
}
