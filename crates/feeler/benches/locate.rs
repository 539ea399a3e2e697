//! Locating markers: 330 in 640x480 px, 63 in 320x240 px (as in videos of a marker gel), and 330 in 20 megapixels
//! with pixel-scale noise.

use divan::{Bencher, black_box};
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{LocateConfig, ReferencePicture, locate, locate_again};
use glam::DVec2;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn main() {
    divan::main();
}

/// Dark markers in rows on a background with noise of this amplitude, in grey levels.
fn picture(
    (width, height): (usize, usize),
    (columns, rows): (usize, usize),
    noise: f64,
) -> Picture {
    let mut random = Pcg64Mcg::seed_from_u64(7);
    let spacing = (width as f64 / (columns + 1) as f64).min(height as f64 / (rows + 1) as f64);
    let radius = 0.25 * spacing;
    let mut gray = vec![180.0_f32; width * height];
    for marker in 0..columns * rows {
        let place = DVec2::new((marker % columns) as f64, (marker / columns) as f64);
        let place = spacing * (place + 1.0);
        let reach = radius + 1.0;
        for row in (place.y - reach) as usize..(place.y + reach) as usize + 2 {
            for column in (place.x - reach) as usize..(place.x + reach) as usize + 2 {
                let distance = place.distance(DVec2::new(column as f64, row as f64));
                let cover = (radius + 0.5 - distance).clamp(0.0, 1.0);
                gray[row * width + column] -= (130.0 * cover) as f32;
            }
        }
    }
    let mut pixels = vec![0; width * height];
    for (pixel, gray) in pixels.iter_mut().zip(&gray) {
        *pixel = (f64::from(*gray) + random.random_range(-noise..=noise)) as u8;
    }
    Picture {
        width,
        height,
        pixels,
    }
}

fn located(bencher: Bencher, size: (usize, usize), markers: (usize, usize), noise: f64) {
    let picture = picture(size, markers, noise);
    bencher.bench_local(|| {
        let reference = ReferencePicture::mean([black_box(&picture)]).expect("a picture");
        let located = locate(&reference, &LocateConfig::default()).expect("markers");
        assert_eq!(located.elements.len(), markers.0 * markers.1);
    });
}

#[divan::bench]
fn video_of_63_markers(bencher: Bencher) {
    located(bencher, (320, 240), (9, 7), 6.0);
}

/// Locates the markers again, starting from a previous result for a similar image.
#[divan::bench]
fn video_of_63_markers_again(bencher: Bencher) {
    let picture = picture((320, 240), (9, 7), 6.0);
    let config = LocateConfig::default();
    let reference = ReferencePicture::mean([&picture]).expect("a picture");
    let before = locate(&reference, &config).expect("markers");
    bencher.bench_local(|| {
        let reference = ReferencePicture::mean([black_box(&picture)]).expect("a picture");
        let located = locate_again(&reference, &config, &before).expect("markers");
        assert_eq!(located.elements.len(), 63);
    });
}

#[divan::bench]
fn picture_of_330_markers(bencher: Bencher) {
    located(bencher, (640, 480), (22, 15), 6.0);
}

/// By noise amplitude, in grey levels.
#[divan::bench(args = [0.0, 10.0, 40.0], sample_count = 5)]
fn twenty_megapixels(bencher: Bencher, noise: f64) {
    located(bencher, (5472, 3648), (22, 15), noise);
}
