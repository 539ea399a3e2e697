//! Images of markers displaced by a smooth field.

use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{LocateConfig, Polarity, ReferencePicture, locate};
use feeler::sensor::track::{MarkerTracker, TrackedMarker};
use glam::DVec2;
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;

pub const SIZE: (usize, usize) = (400, 360);
pub const SPACING: f64 = 24.0;
const RADIUS: f64 = 5.0;
/// Noise in grey levels.
const NOISE: f64 = 2.0;

/// Markers on a hexagonal lattice within a circle.
pub fn places() -> Vec<DVec2> {
    let middle = DVec2::new(SIZE.0 as f64, SIZE.1 as f64) / 2.0;
    let mut places = Vec::new();
    for row in -7..=7_i32 {
        for column in -8..=8_i32 {
            let place = DVec2::new(
                SPACING * (f64::from(column) + 0.5 * f64::from(row.rem_euclid(2))),
                SPACING * 0.75_f64.sqrt() * f64::from(row),
            );
            if place.length() < 150.0 {
                places.push(middle + place + DVec2::new(0.3, 0.2));
            }
        }
    }
    places
}

/// Image of markers at `places`, with uneven light. `seen` contains each marker's fraction of the full contrast.
pub fn picture(polarity: Polarity, places: &[DVec2], seen: &[f64], seed: u64) -> Picture {
    let mut random = Pcg64::seed_from_u64(seed);
    let noise = Normal::new(0.0, NOISE).unwrap();
    let mut picture = Picture::black(SIZE.0, SIZE.1);
    let mut cover = vec![0.0; SIZE.0 * SIZE.1];
    for (place, seen) in places.iter().zip(seen) {
        let reach = RADIUS + 1.5;
        let (low, high) = (*place - reach, *place + reach + 1.0);
        let inside = |low: f64, high: f64, end: usize| {
            (low.max(0.0) as usize)..(high.max(0.0) as usize).min(end)
        };
        for row in inside(low.y, high.y, SIZE.1) {
            for column in inside(low.x, high.x, SIZE.0) {
                let distance = place.distance(DVec2::new(column as f64, row as f64));
                let own = seen * ((RADIUS + 1.0 - distance) / 2.0).clamp(0.0, 1.0);
                let cover: &mut f64 = &mut cover[row * SIZE.0 + column];
                *cover = cover.max(own);
            }
        }
    }
    for (index, (pixel, cover)) in picture.pixels.iter_mut().zip(cover).enumerate() {
        let across = (index % SIZE.0) as f64 / SIZE.0 as f64;
        let gray = match polarity {
            Polarity::Bright => 30.0 + 30.0 * across + 150.0 * cover,
            Polarity::Dark => (120.0 + 90.0 * across) * (1.0 - 0.7 * cover),
        };
        *pixel = (gray + noise.sample(&mut random)).round().clamp(0.0, 255.0) as u8;
    }
    picture
}

/// Tracker of the markers located in the reference image, and their true places in its order.
pub fn tracker(polarity: Polarity) -> (MarkerTracker, Vec<DVec2>) {
    let places = places();
    let reference = picture(polarity, &places, &vec![1.0; places.len()], 0);
    let reference = ReferencePicture::mean([&reference]).unwrap();
    let located = locate(&reference, &LocateConfig::default()).unwrap();
    assert_eq!(
        (located.elements.len(), located.polarity),
        (places.len(), polarity)
    );
    let true_place = |centre: DVec2| {
        let nearest = places
            .iter()
            .min_by(|a, b| a.distance(centre).total_cmp(&b.distance(centre)));
        *nearest.unwrap()
    };
    let ordered = located
        .elements
        .iter()
        .map(|e| true_place(e.centre_px))
        .collect();
    let layout = LocatedLayout::new(&located);
    (MarkerTracker::new(&layout).unwrap(), ordered)
}

/// Distance from the middle beyond which nothing moves (px).
const REACH: f64 = 165.0;

/// Displaces `place` by a contact that drags the middle by `drag` (px), turns it and presses it, and does not affect
/// the rim.
pub fn displaced(place: DVec2, drag: DVec2, turn: f64, press: f64) -> DVec2 {
    let middle = DVec2::new(SIZE.0 as f64, SIZE.1 as f64) / 2.0;
    let offset = place - middle;
    let part = (1.0 - (offset.length() / REACH).powi(2)).max(0.0);
    let turned = DVec2::from_angle(turn * part).rotate(offset) * (1.0 + press * part);
    middle + turned + part * drag
}

/// Largest error (px) of the markers with at least this `confidence`, and their number.
pub fn worst(markers: &[TrackedMarker], truth: &[DVec2], confidence: f64) -> (f64, usize) {
    let sure = markers
        .iter()
        .zip(truth)
        .filter(|(marker, _)| marker.confidence >= confidence);
    sure.fold((0.0, 0), |(worst, count), (marker, truth)| {
        (f64::max(worst, marker.place.distance(*truth)), count + 1)
    })
}
