//! Moments agree with their definition for all instruction sets and irregular sub-regions.

use feeler::sensor::fingertip::{Fingertip, FingertipConfig};
use feeler::sensor::image::{Picture, WeightedPixel, subregion};
use feeler::sensor::moments::{ElementMoments, Instructions, MomentsKernel};
use glam::DVec2;
use proptest::prelude::*;
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::HashSet;

fn measure(kernel: &MomentsKernel, picture: &Picture) -> Vec<ElementMoments> {
    let mut moments = vec![ElementMoments::default(); kernel.element_count()];
    kernel.measure(picture, &mut moments).unwrap();
    moments
}

/// The definition, pixel by pixel in `f64`.
fn plain(picture: &Picture, dark_level: u8, region: &[WeightedPixel]) -> (f64, DVec2) {
    let (mut gray, mut first) = (0.0, DVec2::ZERO);
    for pixel in region {
        let value = picture.pixels[pixel.row * picture.width + pixel.column];
        let weighed = f64::from(value.saturating_sub(dark_level)) * pixel.area;
        gray += weighed;
        first += weighed * pixel.point;
    }
    (gray, first)
}

/// Random image of one kind: any values, only dark and saturated pixels, few bright pixels, or a constant.
fn random_picture(width: usize, height: usize, seed: u64) -> Picture {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut picture = Picture::black(width, height);
    rng.fill_bytes(&mut picture.pixels);
    match seed % 4 {
        0 => {}
        1 => picture
            .pixels
            .iter_mut()
            .for_each(|p| *p = if *p > 127 { 255 } else { 0 }),
        2 => picture
            .pixels
            .iter_mut()
            .for_each(|p| *p = if *p > 250 { *p } else { 0 }),
        _ => picture.pixels.fill(rng.random()),
    }
    picture
}

/// A box of the image without a random share of its pixels, with smooth or arbitrary weights.
fn random_region(
    (width, height): (usize, usize),
    rough: bool,
    rng: &mut Pcg64,
) -> Vec<WeightedPixel> {
    let mut side = |end: usize| {
        let first = rng.random_range(0..end);
        (first, rng.random_range(first..end.min(first + 90)) + 1)
    };
    let ((left, right), (top, bottom)) = (side(width), side(height));
    let kept: f64 = rng.random_range(0.1..=1.0);
    let bend: f64 = rng.random_range(-2e-3..2e-3);
    let mut region = Vec::new();
    for row in top..bottom {
        for column in left..right {
            if rng.random::<f64>() > kept {
                continue;
            }
            let place = DVec2::new((column - left) as f64, (row - top) as f64);
            let area = if rough {
                rng.random_range(0.5..2.0)
            } else {
                1.0 + bend * place.x + 0.5 * bend * place.y
            };
            let point = place * (1.0 + bend * place.x);
            region.push(WeightedPixel {
                column,
                row,
                area,
                point,
            });
        }
    }
    region
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// Sub-regions reach the image's edges and its last pixel, and images may be a single column wide.
    #[test]
    fn all_instructions_give_the_same_moments(
        width in 1..200_usize,
        height in 1..150_usize,
        dark_level: u8,
        rough: bool,
        seed: u64,
    ) {
        let mut rng = Pcg64::seed_from_u64(seed);
        let regions: Vec<_> = (0..4).map(|_| random_region((width, height), rough, &mut rng)).collect();
        let kernel = MomentsKernel::from_subregions((width, height), dark_level, &regions).unwrap();
        let picture = random_picture(width, height, seed);
        let portable = measure(&kernel.clone().with_instructions(Instructions::Portable), &picture);
        for instructions in Instructions::available() {
            let moments = measure(&kernel.clone().with_instructions(instructions), &picture);
            prop_assert_eq!(&moments, &portable, "{:?}", instructions);
            // Memory beyond the image has no effect, regardless of its size.
            let (mut moments, kernel) = (moments, kernel.clone().with_instructions(instructions));
            for next in [&picture.pixels[..], &picture.pixels[..picture.pixels.len() / 2]] {
                kernel.measure_with_prefetch(&picture, next, &mut moments).unwrap();
                prop_assert_eq!(&moments, &portable, "{:?}", instructions);
            }
        }
        let own: Vec<_> = kernel.pixels().collect();
        let expected = regions.iter().flatten().map(|pixel| (pixel.column, pixel.row));
        prop_assert_eq!(HashSet::from_iter(own.clone()), expected.collect::<HashSet<_>>());
        for (moments, region) in portable.iter().zip(&regions) {
            let (gray, first) = plain(&picture, dark_level, region);
            let reach = region.iter().map(|p| p.point.length()).fold(0.0, f64::max);
            // The kernel's error bound per pixel also holds for the sum.
            let error = (moments.integrated_gray - gray).abs();
            prop_assert!(error <= 3e-5 * gray, "G {} for {gray}", moments.integrated_gray);
            if gray > 0.0 {
                let error = (moments.centroid - first / gray).length();
                prop_assert!(error <= 3e-5 * 2.5 * reach, "{error} of {reach}");
            } else {
                prop_assert_eq!(moments.centroid, DVec2::ZERO);
            }
        }
    }
}

/// Dewarped sums of the reference fingertip, and of one with a finer camera, over images of all kinds: `G` to 1e-4 of
/// itself, the centroid to 0.2 µm.
#[test]
fn dewarped_sums_agree_with_the_definition() {
    for scale in [1, 2] {
        let mut config = FingertipConfig::default();
        config.camera.width *= scale;
        config.camera.height *= scale;
        config.camera.focal_length_px *= scale as f64;
        config.camera.radial_distortion = [[-0.05, 0.004], [0.0, 0.0]][scale - 1];
        let fingertip = Fingertip::new(&config).unwrap();
        let radius = config.moments.subregion_radius;
        let (layout, projection) = (&fingertip.layout, &fingertip.projection);
        let regions: Vec<_> = (0..layout.elements.len())
            .map(|element| subregion(layout, projection, element, radius).unwrap())
            .collect();
        let (mut worst_gray, mut worst_centroid) = (0.0_f64, 0.0_f64);
        for seed in 0..100 {
            let picture = random_picture(config.camera.width, config.camera.height, seed);
            let moments = measure(&fingertip.kernel, &picture);
            for (moments, region) in moments.iter().zip(&regions) {
                let (gray, first) = plain(&picture, config.moments.dark_level, region);
                if gray > 0.0 {
                    worst_gray = worst_gray.max((moments.integrated_gray / gray - 1.0).abs());
                    let error = (moments.centroid - first / gray).length();
                    worst_centroid = worst_centroid.max(error);
                }
            }
        }
        println!("worst G {worst_gray:.2e}, worst centroid {worst_centroid:.2e} m");
        assert!(worst_gray < 1e-4, "{worst_gray}");
        assert!(worst_centroid < 0.2e-6, "{worst_centroid} m");
    }
}

/// A single bright pixel at any place, whose error no average compensates.
#[test]
fn each_single_pixel_is_measured_correctly() {
    let config = FingertipConfig::default();
    let fingertip = Fingertip::new(&config).unwrap();
    let radius = config.moments.subregion_radius;
    let mut picture = Picture::black(640, 480);
    let (mut worst_gray, mut worst_centroid) = (0.0_f64, 0.0_f64);
    for element in [0, 3, 12, 23, 40] {
        let region = subregion(&fingertip.layout, &fingertip.projection, element, radius).unwrap();
        for pixel in &region {
            let index = pixel.row * 640 + pixel.column;
            picture.pixels[index] = 255;
            let moments = measure(&fingertip.kernel, &picture)[element];
            picture.pixels[index] = 0;
            let gray = 231.0 * pixel.area;
            worst_gray = worst_gray.max((moments.integrated_gray / gray - 1.0).abs());
            worst_centroid = worst_centroid.max((moments.centroid - pixel.point).length());
        }
    }
    println!("worst G {worst_gray:.2e}, worst centroid {worst_centroid:.2e} m");
    assert!(worst_gray < 1e-4, "{worst_gray}");
    assert!(worst_centroid < 0.2e-6, "{worst_centroid} m");
}
