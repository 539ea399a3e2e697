//! Moments compared with closed forms and with a slow, plain computation.

use feeler::sensor::fingertip::{Fingertip, FingertipConfig};
use feeler::sensor::image::Picture;
use feeler::sensor::moments::{ElementMoments, MomentsError};
use glam::DVec2;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;

fn fingertip() -> Fingertip {
    Fingertip::new(&FingertipConfig::default()).unwrap()
}

fn measure(fingertip: &Fingertip, picture: &Picture) -> Vec<ElementMoments> {
    let mut moments = vec![ElementMoments::default(); fingertip.layout.elements.len()];
    fingertip.kernel.measure(picture, &mut moments).unwrap();
    moments
}

fn random_picture(seed: u64) -> Picture {
    let mut picture = Picture::black(640, 480);
    Pcg64::seed_from_u64(seed).fill_bytes(&mut picture.pixels);
    picture
}

/// The definition, pixel by pixel in `f64`.
fn plain_moments(fingertip: &Fingertip, picture: &Picture) -> Vec<ElementMoments> {
    let config = FingertipConfig::default().moments;
    let elements = &fingertip.layout.elements;
    let mut sums = vec![(0.0, DVec2::ZERO); elements.len()];
    for (index, &gray) in picture.pixels.iter().enumerate() {
        let pixel = DVec2::new(
            (index % picture.width) as f64,
            (index / picture.width) as f64,
        );
        let point = fingertip.projection.point_at(pixel).unwrap();
        let nearness = |e: usize| point.dot(elements[e].normal());
        let nearest = (0..elements.len())
            .max_by(|&a, &b| nearness(a).total_cmp(&nearness(b)))
            .unwrap();
        let Some(dewarped) = fingertip.projection.dewarp(pixel, &elements[nearest]) else {
            continue;
        };
        if dewarped.point.length() <= config.subregion_radius {
            let g = f64::from(gray.saturating_sub(config.dark_level)) * dewarped.area;
            sums[nearest].0 += g;
            sums[nearest].1 += g * dewarped.point;
        }
    }
    sums.into_iter()
        .map(|(integrated_gray, first)| ElementMoments {
            integrated_gray,
            centroid: first / integrated_gray,
        })
        .collect()
}

#[test]
fn moments_agree_with_their_definition() {
    let fingertip = fingertip();
    let picture = random_picture(3);
    let fast = measure(&fingertip, &picture);
    for (element, (fast, plain)) in fast
        .iter()
        .zip(plain_moments(&fingertip, &picture))
        .enumerate()
    {
        // f32 has a precision of 6e-8; a lane adds some 200 values, so errors stay below 200 times that.
        let gray = fast.integrated_gray / plain.integrated_gray - 1.0;
        let centroid = (fast.centroid - plain.centroid).length();
        assert!(gray.abs() < 1.2e-5, "element {element}: {gray}");
        assert!(
            centroid < 1.2e-5 * 2.6e-3,
            "element {element}: {centroid} m"
        );
    }
}

/// In an image of one gray value, `G` is proportional to the sub-region's area and the centroid is on the axis.
#[test]
fn sub_regions_are_full_discs_in_their_planes() {
    let fingertip = fingertip();
    let mut picture = Picture::black(640, 480);
    picture.pixels.fill(25);
    for (element, moments) in measure(&fingertip, &picture).iter().enumerate() {
        let expected = PI * 2.6e-3_f64.powi(2);
        // Some 1000 pixels, 110 of them on the rim, each accurate to 0.3 px: 3 px, times four as a margin.
        let error = moments.integrated_gray / expected - 1.0;
        assert!(error.abs() < 0.012, "element {element}: {error}");
        let offset = moments.centroid.length();
        assert!(offset < 0.012 * 2.6e-3, "element {element}: {offset} m");
    }
}

/// A disc painted on the dome over an element, with 8x8 samples per pixel.
fn painted_disc(fingertip: &Fingertip, element: usize, centre: DVec2, radius: f64) -> Picture {
    let mut picture = Picture::black(640, 480);
    let projection = &fingertip.projection;
    let own = &fingertip.layout.elements[element];
    let middle = projection
        .project(projection.lift(centre, own).unwrap())
        .unwrap();
    for (index, gray) in picture.pixels.iter_mut().enumerate() {
        let pixel = DVec2::new((index % 640) as f64, (index / 640) as f64);
        if (pixel - middle).length() > 60.0 {
            continue;
        }
        let samples = (0..64).filter(|s| {
            let offset = DVec2::new(f64::from(s % 8), f64::from(s / 8)) / 8.0 - 0.4375;
            let place = projection.dewarp(pixel + offset, own).unwrap().point;
            (place - centre).length() < radius
        });
        // Pixels of the disc are 200 levels above the dark level, all others are at it.
        *gray = (24.0 + 200.0 * samples.count() as f64 / 64.0).round() as u8;
    }
    picture
}

#[test]
fn a_painted_disc_is_measured_with_its_area_and_centre() {
    let fingertip = fingertip();
    for element in [0, 4, 15, 25, 40] {
        let (centre, radius) = (DVec2::new(0.4e-3, -0.7e-3), 1.2e-3);
        let picture = painted_disc(&fingertip, element, centre, radius);
        let moments = measure(&fingertip, &picture);
        let expected = 200.0 * PI * radius * radius;
        // Some 55 pixels on the edge, each accurate to half a sample in 8: 0.2 % of 200 px or more.
        let error = moments[element].integrated_gray / expected - 1.0;
        assert!(error.abs() < 3e-3, "element {element}: {error}");
        let offset = (moments[element].centroid - centre).length();
        assert!(offset < 3e-3 * radius, "element {element}: {offset} m");
        for (other, moments) in moments.iter().enumerate() {
            let seen = moments.integrated_gray;
            assert!(
                other == element || seen == 0.0,
                "{element} in {other}: {seen}"
            );
        }
    }
}

#[test]
fn images_of_another_size_are_rejected() {
    let fingertip = fingertip();
    let mut moments = vec![ElementMoments::default(); 41];
    let measure = |picture: &Picture, moments: &mut [ElementMoments]| {
        fingertip.kernel.measure(picture, moments).unwrap_err()
    };
    assert!(matches!(
        measure(&Picture::black(320, 240), &mut moments),
        MomentsError::PictureSize { width: 320, .. }
    ));
    let mut short = Picture::black(640, 480);
    short.pixels.pop();
    assert!(matches!(
        measure(&short, &mut moments),
        MomentsError::PictureSize {
            pixels: 307_199,
            ..
        }
    ));
    assert_eq!(
        measure(&Picture::black(640, 480), &mut moments[..40]),
        MomentsError::ElementCount {
            expected: 41,
            actual: 40
        }
    );
}

#[test]
fn a_camera_that_cuts_off_elements_is_rejected() {
    let mut config = FingertipConfig::default();
    config.camera.focal_length_px = 205.0;
    let message = Fingertip::new(&config).unwrap_err().to_string();
    assert!(message.contains("sub-region of element"), "{message}");
    config.camera.focal_length_px = 195.0;
    config.moments.subregion_radius = -1.0;
    assert!(Fingertip::new(&config).is_err());
}
