//! Tracking markers from frame to frame with 61 and 331 markers in 640x480 px, and matching a single image against
//! the reference.

use divan::{Bencher, black_box};
use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{LocateConfig, ReferencePicture, locate};
use feeler::sensor::track::MarkerTracker;
use glam::DVec2;

const SIZE: (usize, usize) = (640, 480);

fn main() {
    divan::main();
}

/// Dark markers in hexagonal rings around the image centre, where they are dragged by `drag` px.
fn picture(rings: i32, drag: f64) -> Picture {
    let middle = DVec2::new(SIZE.0 as f64, SIZE.1 as f64) / 2.0;
    let spacing = 225.0 / f64::from(rings);
    let radius = 0.25 * spacing;
    let mut picture = Picture::black(SIZE.0, SIZE.1);
    picture.pixels.fill(180);
    for q in -rings..=rings {
        for r in (-rings).max(-q - rings)..=rings.min(-q + rings) {
            let place = DVec2::new(
                f64::from(q) + 0.5 * f64::from(r),
                0.75_f64.sqrt() * f64::from(r),
            );
            let part = 1.0 - (place.length() / f64::from(rings + 1)).powi(2);
            let place = middle + spacing * place + DVec2::new(drag * part, 0.0);
            let reach = radius + 1.0;
            for row in (place.y - reach) as usize..(place.y + reach) as usize + 2 {
                for column in (place.x - reach) as usize..(place.x + reach) as usize + 2 {
                    let distance = place.distance(DVec2::new(column as f64, row as f64));
                    let cover = (radius + 0.5 - distance).clamp(0.0, 1.0);
                    let pixel = &mut picture.pixels[row * SIZE.0 + column];
                    *pixel = (*pixel).min((180.0 - 130.0 * cover) as u8);
                }
            }
        }
    }
    picture
}

fn tracker(rings: i32) -> MarkerTracker {
    let reference = ReferencePicture::mean([&picture(rings, 0.0)]).expect("a picture");
    let located = locate(&reference, &LocateConfig::default()).expect("markers");
    MarkerTracker::new(&LocatedLayout::new(&located)).expect("a tracker")
}

/// Tracks 61 and 331 markers that move back and forth by 1 px per frame.
#[divan::bench(args = [4, 10])]
fn video(bencher: Bencher, rings: i32) {
    let mut tracker = tracker(rings);
    let pictures: Vec<Picture> = (0..20)
        .map(|i| picture(rings, f64::from(10 - (i - 10_i32).abs())))
        .collect();
    let mut next = 0;
    bencher.bench_local(move || {
        next = (next + 1) % pictures.len();
        let markers = tracker
            .track(black_box(&pictures[next]))
            .expect("a picture");
        assert!(markers.iter().all(|marker| marker.confidence > 0.0));
    });
}

/// Matches a single image that is displaced by one spacing.
#[divan::bench(args = [4, 10])]
fn single(bencher: Bencher, rings: i32) {
    let mut tracker = tracker(rings);
    let displaced = picture(rings, 225.0 / f64::from(rings));
    bencher.bench_local(move || {
        tracker
            .match_picture(black_box(&displaced))
            .expect("a picture");
    });
}
