//! Sub-regions compared with their definition, and the mean of several images.

use feeler::sensor::image::Picture;
use feeler::sensor::locate::{
    LocateConfig, LocateError, MeanPicture, ReferencePicture, locate, sub_regions,
};
use glam::DVec2;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;

proptest! {
    /// Each pixel belongs to the nearest disc that contains it.
    #[test]
    fn a_pixel_belongs_to_the_nearest_disc_that_contains_it(
        width in 1..40_usize,
        height in 1..40_usize,
        discs in prop::collection::vec((-5.0..45.0, -5.0..45.0, 0.3..15.0_f64), 0..6),
    ) {
        let discs: Vec<_> = discs.into_iter().map(|(x, y, r)| (DVec2::new(x, y), r)).collect();
        let mut expected = vec![Vec::new(); discs.len()];
        for row in 0..height {
            for column in 0..width {
                let from = |disc: &(DVec2, f64)| disc.0.distance(DVec2::new(column as f64, row as f64));
                let about = (0..discs.len()).filter(|&i| from(&discs[i]) <= discs[i].1);
                if let Some(own) = about.min_by(|&a, &b| from(&discs[a]).total_cmp(&from(&discs[b]))) {
                    expected[own].push((column, row));
                }
            }
        }
        prop_assert_eq!(sub_regions((width, height), &discs), expected);
    }
}

/// Image with Gaussian noise of this standard deviation around gray value 100.
fn noisy(deviation: f64, seed: u64) -> Picture {
    let mut rng = Pcg64::seed_from_u64(seed);
    let noise = Normal::new(100.0, deviation).expect("a distribution");
    let mut picture = Picture::black(160, 120);
    for pixel in &mut picture.pixels {
        *pixel = noise.sample(&mut rng).round().clamp(0.0, 255.0) as u8;
    }
    picture
}

#[test]
fn noise_is_that_of_a_single_image() {
    for deviation in [2.0, 8.0] {
        for count in [1, 9] {
            let pictures: Vec<_> = (0..count).map(|seed| noisy(deviation, seed)).collect();
            let reference = ReferencePicture::mean(&pictures).expect("a reference");
            assert_eq!(reference.pictures, pictures.len());
            // A fifth of 4661 values determines the standard deviation to 3 %; neighbours share pixels.
            let ratio = reference.noise() / deviation;
            assert!(
                (ratio - 1.0).abs() < 0.12,
                "{count} of {deviation}: {ratio}"
            );
        }
    }
}

/// Slopes are detail, not noise. The smallest noise is that of rounding.
#[test]
fn a_slope_is_not_noise() {
    let mut picture = Picture::black(64, 48);
    for (index, pixel) in picture.pixels.iter_mut().enumerate() {
        *pixel = (2 * (index % 64) + index / 64) as u8;
    }
    let reference = ReferencePicture::mean([&picture]).expect("a reference");
    assert_eq!(reference.noise(), 0.29);
}

#[test]
fn the_mean_is_computed_per_pixel() {
    let mut rng = Pcg64::seed_from_u64(3);
    let mut pictures = vec![Picture::black(16, 17); 3];
    for pixel in pictures.iter_mut().flat_map(|p| &mut p.pixels) {
        *pixel = rng.random();
    }
    let reference = ReferencePicture::mean(&pictures).expect("a reference");
    assert_eq!((reference.width, reference.height), (16, 17));
    assert!(!reference.two_level);
    for (index, &gray) in reference.gray.iter().enumerate() {
        let sum: u32 = pictures.iter().map(|p| u32::from(p.pixels[index])).sum();
        // Single precision.
        assert!((f64::from(gray) - f64::from(sum) / 3.0).abs() < 2e-5);
    }
}

#[test]
fn two_level_requires_black_and_white_in_all_images() {
    let two_level = |values: [u8; 2]| {
        let pictures = values.map(|value| {
            let mut picture = Picture::black(16, 16);
            picture.pixels[5] = value;
            picture
        });
        ReferencePicture::mean(&pictures)
            .expect("a reference")
            .two_level
    };
    assert!(two_level([255, 0]));
    for gray in [1, 128, 254] {
        assert!(!two_level([gray, 255]) && !two_level([0, gray]), "{gray}");
    }
}

#[test]
fn small_images_and_images_of_different_sizes_are_rejected() {
    let mut mean = MeanPicture::default();
    for (width, height) in [(15, 16), (16, 15), (0, 0)] {
        let error = mean.add(&Picture::black(width, height));
        assert_eq!(error, Err(LocateError::TooSmall { width, height }));
    }
    assert!(mean.add(&Picture::black(16, 16)).is_ok());
    for (width, height) in [(16, 17), (17, 16)] {
        let error = mean.add(&Picture::black(width, height));
        assert!(matches!(error, Err(LocateError::PictureSize { .. })));
    }
    let mut short = Picture::black(16, 16);
    short.pixels.pop();
    assert!(matches!(
        mean.add(&short),
        Err(LocateError::PictureSize { pixels: 255, .. })
    ));
    assert!(MeanPicture::default().add(&short).is_err());
    assert_eq!(mean.finish().expect("a reference").pictures, 1);
}

#[test]
fn configuration_out_of_range_is_rejected() {
    let mut picture = Picture::black(40, 30);
    picture.pixels.fill(90);
    let reference = ReferencePicture::mean([&picture]).expect("a reference");
    let refused = |config: &LocateConfig| {
        let error = locate(&reference, config).expect_err("there is no element");
        matches!(error, LocateError::OutOfRange { .. })
    };
    let spot = |diameter| LocateConfig {
        spot_diameter_px: Some(diameter),
        ..LocateConfig::default()
    };
    let element = |diameter| LocateConfig {
        element_diameter_px: Some(diameter),
        ..LocateConfig::default()
    };
    let region = |region_radius| LocateConfig {
        region_radius,
        ..LocateConfig::default()
    };
    // Limits: half of the shorter side for spots, and the whole shorter side for elements.
    assert!(refused(&spot(0.99)) && !refused(&spot(1.0)));
    assert!(refused(&spot(15.01)) && !refused(&spot(15.0)));
    assert!(refused(&element(0.99)) && !refused(&element(1.0)));
    assert!(refused(&element(30.01)) && !refused(&element(30.0)));
    assert!(refused(&region(0.09)) && !refused(&region(0.1)));
    assert!(refused(&region(2.01)) && !refused(&region(2.0)));
}
