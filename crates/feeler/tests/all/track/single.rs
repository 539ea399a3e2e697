//! Markers in single images, matched with the reference only.

use super::scene::{SPACING, displaced, picture, tracker, worst};
use feeler::sensor::image::Picture;
use feeler::sensor::locate::Polarity;
use glam::DVec2;
use proptest::prelude::*;

/// Maximum error (px): markers of 12 px pushed to a distance of 12 px include a pixel of each other's edge, whereas a
/// swap is an error of 24 px.
const TOUCHING: f64 = 1.0;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    /// Any drag, rotation and pressure within the field's reach, up to one and a half spacings.
    #[test]
    fn displacements_beyond_the_spacing_are_measured(
        drag in 0.0..1.5_f64,
        way in 0.0..std::f64::consts::TAU,
        turn in -0.25..0.25_f64,
        press in -0.08..0.05_f64,
        seed in 1..1000_u64,
    ) {
        let drag = drag * SPACING * DVec2::from_angle(way);
        let (error, missing) = match_displaced(drag, turn, press, seed);
        prop_assert!(error < TOUCHING, "{} px", error);
        prop_assert_eq!(missing, 0);
    }
}

/// Displaces all markers and hides every 17th. Returns the largest error (px) of the markers found, and the number of
/// visible markers that were not found.
fn match_displaced(drag: DVec2, turn: f64, press: f64, seed: u64) -> (f64, usize) {
    let (mut tracker, places) = tracker(Polarity::Dark);
    let truth: Vec<DVec2> = places
        .iter()
        .map(|place| displaced(*place, drag, turn, press))
        .collect();
    let seen: Vec<f64> = (0..places.len())
        .map(|i| if i % 17 == 5 { 0.0 } else { 1.0 })
        .collect();
    let picture = picture(Polarity::Dark, &truth, &seen, seed);
    let markers = tracker.match_picture(&picture).unwrap();
    let (error, found) = worst(markers, &truth, 0.01);
    let visible = seen.iter().filter(|&&seen| seen > 0.0).count();
    (error, visible.saturating_sub(found))
}

/// Two of about 10,000 random displacements at which markers along the edge exchanged spots: beside a hidden marker,
/// and in a chain of four.
#[test]
fn chains_of_swapped_markers_at_the_edge_are_reversed() {
    for (drag, turn, press, seed) in [
        (
            DVec2::new(-0.6420702795931189, 8.349155700437182),
            -0.19357969089929986,
            0.0,
            1,
        ),
        (
            DVec2::new(-4.477448815163342, 32.519574408505015),
            -0.24225285612435365,
            -0.012976641590854626,
            393,
        ),
    ] {
        let (error, missing) = match_displaced(drag, turn, press, seed);
        assert!(error < TOUCHING, "{error} px");
        assert_eq!(missing, 0);
    }
}

#[test]
fn matching_is_independent_of_earlier_images() {
    let (mut fresh, places) = tracker(Polarity::Bright);
    let mut used = fresh.clone();
    let seen = vec![1.0; places.len()];
    let far: Vec<DVec2> = places
        .iter()
        .map(|place| displaced(*place, DVec2::new(-20.0, 25.0), 0.1, 0.0))
        .collect();
    used.match_picture(&picture(Polarity::Bright, &far, &seen, 3))
        .unwrap();
    let near = picture(Polarity::Bright, &places, &seen, 4);
    let expected: Vec<DVec2> = fresh
        .match_picture(&near)
        .unwrap()
        .iter()
        .map(|m| m.place)
        .collect();
    let told: Vec<DVec2> = used
        .match_picture(&near)
        .unwrap()
        .iter()
        .map(|m| m.place)
        .collect();
    assert_eq!(expected, told);
}

#[test]
fn an_image_without_markers_is_rejected() {
    let (mut tracker, _) = tracker(Polarity::Bright);
    let refused = tracker
        .match_picture(&Picture::black(400, 360))
        .unwrap_err();
    assert!(refused.to_string().contains("black"), "{refused}");
}
