//! Elements located in images of discs with known centres.

use feeler::sensor::fingertip::LocatedLayout;
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{
    LocateConfig, LocateError, LocateWarning, Located, ReferencePicture, locate, sub_regions,
};
use glam::DVec2;
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, Normal};
use rand_pcg::Pcg64;

fn located(picture: &Picture) -> Result<Located, LocateError> {
    locate(
        &ReferencePicture::mean([picture])?,
        &LocateConfig::default(),
    )
}

/// Image of soft-edged discs on a background that brightens towards one corner.
#[derive(Debug, Clone)]
struct Scene {
    size: (usize, usize),
    background: f64,
    slope: f64,
    contrast: f64,
    radius: f64,
    blur: f64,
    noise: f64,
    centres: Vec<DVec2>,
    seed: u64,
}

impl Scene {
    fn picture(&self) -> Picture {
        let mut rng = Pcg64::seed_from_u64(self.seed);
        let noise = Normal::new(0.0, self.noise).unwrap();
        let mut picture = Picture::black(self.size.0, self.size.1);
        for (index, pixel) in picture.pixels.iter_mut().enumerate() {
            let place = DVec2::new((index % self.size.0) as f64, (index / self.size.0) as f64);
            let cover = |c: &DVec2| {
                ((self.radius + self.blur - c.distance(place)) / (2.0 * self.blur)).clamp(0.0, 1.0)
            };
            let lit = self.centres.iter().map(cover).fold(0.0, f64::max);
            let across = place.dot(DVec2::ONE) / (self.size.0 + self.size.1) as f64;
            let gray = self.background + self.slope * across + self.contrast * lit;
            *pixel = (gray + noise.sample(&mut rng)).round().clamp(0.0, 255.0) as u8;
        }
        picture
    }
}

/// Rotated and jittered spots on a hexagonal lattice within a circle.
fn hexagonal(spacing: f64, rings: i32, turn: f64, jitter: f64, seed: u64) -> (usize, Vec<DVec2>) {
    let mut rng = Pcg64::seed_from_u64(seed);
    let reach = spacing * (f64::from(rings) + 1.5);
    let mut centres = Vec::new();
    for q in -rings..=rings {
        for r in -rings..=rings {
            if (q + r).abs() <= rings {
                let place = DVec2::new(
                    f64::from(q) + 0.5 * f64::from(r),
                    f64::from(r) * 0.75_f64.sqrt(),
                );
                let off = DVec2::new(rng.random::<f64>() - 0.5, rng.random::<f64>() - 0.5);
                let place = spacing * (DVec2::from_angle(turn).rotate(place) + jitter * off);
                centres.push(place + reach);
            }
        }
    }
    ((2.0 * reach) as usize, centres)
}

fn distance_to_nearest(place: DVec2, others: impl Iterator<Item = DVec2>) -> f64 {
    others
        .map(|o| o.distance(place))
        .fold(f64::INFINITY, f64::min)
}

fn scenes() -> impl Strategy<Value = Scene> {
    let shape = (
        6.0..30.0_f64,
        2..7_i32,
        0.0..1.0_f64,
        0.0..0.15_f64,
        0.2..0.32_f64,
    );
    let light = (
        0.0..60.0_f64,
        0.0..40.0_f64,
        40.0..150.0_f64,
        0.0..0.04_f64,
        0.5..1.5_f64,
    );
    (shape, light, any::<u64>()).prop_map(|(shape, light, seed)| {
        let (spacing, rings, turn, jitter, fill) = shape;
        let (background, slope, contrast, noise, blur) = light;
        let (side, centres) = hexagonal(spacing, rings, turn, jitter, seed);
        Scene {
            size: (side, side + 7),
            background,
            slope,
            contrast,
            radius: fill * spacing,
            blur,
            noise: noise * contrast,
            centres,
            seed,
        }
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// All spots and nothing else are found. Centres are accurate to a quarter of a pixel, or to 3 % of the spots'
    /// spacing if that is more, with noise of 4 % of the contrast. Spots with overlapping blurred edges hide parts of
    /// each other, which shifts their centres.
    #[test]
    fn all_spots_and_nothing_else(scene in scenes()) {
        let found = located(&scene.picture()).unwrap();
        prop_assert_eq!(found.elements.len(), scene.centres.len());
        prop_assert_eq!(found.spots_per_element, 1);
        let tolerance = f64::max(0.25, 0.03 * found.spacing_px);
        for &centre in &scene.centres {
            let others = scene.centres.iter().copied().filter(|&other| other != centre);
            if distance_to_nearest(centre, others) < 2.0 * (scene.radius + scene.blur) {
                continue;
            }
            let off = distance_to_nearest(centre, found.elements.iter().map(|e| e.centre_px));
            prop_assert!(off < tolerance, "{} has an error of {}", centre, off);
        }
        // Sub-regions do not overlap, and contain their own spots.
        let discs: Vec<_> = found.elements.iter().map(|e| (e.centre_px, e.radius_px)).collect();
        let regions = sub_regions(found.size, &discs);
        let mut pixels: Vec<_> = regions.iter().flatten().collect();
        let count = pixels.len();
        pixels.sort();
        pixels.dedup();
        prop_assert_eq!(pixels.len(), count);
        for (element, region) in found.elements.iter().zip(&regions) {
            let centre = element.centre_px.round();
            prop_assert!(region.contains(&(centre.x as usize, centre.y as usize)));
        }
    }

    /// Any image gives a result or an error without a panic.
    #[test]
    fn any_image_gives_a_result_or_an_error(width in 0..40_usize, height in 0..40_usize, seed: u64, levels in 1..256_u32) {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut picture = Picture::black(width, height);
        for pixel in &mut picture.pixels {
            *pixel = (rng.random_range(0..levels)) as u8;
        }
        if let Ok(found) = located(&picture) {
            LocatedLayout::new(&found).kernel().unwrap();
        }
    }
}

fn spots(centres: &[DVec2], size: (usize, usize), contrast: f64) -> Picture {
    Scene {
        size,
        background: 12.0,
        slope: 0.0,
        contrast,
        radius: 4.0,
        blur: 1.0,
        noise: 1.0,
        centres: centres.to_vec(),
        seed: 3,
    }
    .picture()
}

#[test]
fn images_without_elements_are_rejected() {
    let black = Picture::black(64, 48);
    assert!(matches!(located(&black), Err(LocateError::Black { .. })));
    let mut white = black.clone();
    white.pixels.fill(255);
    assert!(matches!(located(&white), Err(LocateError::White { .. })));
    let empty = spots(&[], (320, 240), 0.0);
    assert!(matches!(
        located(&empty),
        Err(LocateError::NoElement { .. })
    ));
    let gray = Picture {
        pixels: vec![90; 64 * 48],
        ..black.clone()
    };
    assert!(matches!(located(&gray), Err(LocateError::NoElement { .. })));
    let small = Picture::black(8, 8);
    assert!(matches!(located(&small), Err(LocateError::TooSmall { .. })));
    let none = ReferencePicture::mean([]);
    assert!(matches!(none, Err(LocateError::NoPicture)));
    let two_sizes = ReferencePicture::mean([&black, &Picture::black(48, 64)]);
    assert!(matches!(two_sizes, Err(LocateError::PictureSize { .. })));
}

#[test]
fn fewer_than_six_spots_are_elements_only_if_their_diameter_is_given() {
    let centres = [DVec2::new(80.3, 61.8), DVec2::new(40.0, 80.0)];
    let picture = spots(&centres, (160, 120), 100.0);
    let error = located(&picture).unwrap_err().to_string();
    assert!(error.contains("at least 6 spots, got 2"), "{error}");
    let config = LocateConfig {
        spot_diameter_px: Some(8.0),
        ..LocateConfig::default()
    };
    let found = locate(&ReferencePicture::mean([&picture]).unwrap(), &config).unwrap();
    assert_eq!(found.elements.len(), 2);
    assert_elements_at(&found, &centres);
}

/// A gel without markers: light that differs across the image, noise, specks of dust, and dents.
fn unmarked(seed: u64) -> Picture {
    let mut rng = Pcg64::seed_from_u64(seed);
    let noise = Normal::new(0.0, rng.random_range(0.3..2.0)).unwrap();
    let (width, height) = (320, 240);
    // Broad lamps, and specks and dents: place, radius (px), gray levels.
    let mut bumps = Vec::new();
    let mut add = |count: usize, radius: std::ops::Range<f64>, gray: f64| {
        for _ in 0..count {
            let place = DVec2::new(
                rng.random_range(0.0..width as f64),
                rng.random_range(0.0..height as f64),
            );
            let strength = gray * (2.0 * rng.random::<f64>() - 1.0);
            bumps.push((place, rng.random_range(radius.clone()), strength));
        }
    };
    add(3, 80.0..200.0, 60.0);
    add((seed % 40) as usize, 0.8..4.0, 40.0);
    add((seed % 7) as usize, 6.0..30.0, 30.0);
    let mut picture = Picture::black(width, height);
    for (index, pixel) in picture.pixels.iter_mut().enumerate() {
        let place = DVec2::new((index % width) as f64, (index / width) as f64);
        let bump = |&(centre, radius, strength): &(DVec2, f64, f64)| {
            strength * (-0.5 * (place - centre).length_squared() / (radius * radius)).exp()
        };
        let gray = 120.0 + bumps.iter().map(bump).sum::<f64>();
        *pixel = (gray + noise.sample(&mut rng)).round().clamp(0.0, 255.0) as u8;
    }
    picture
}

#[test]
fn specks_and_dents_of_an_unmarked_gel_are_no_pattern() {
    // None of 300 bounds the probability of a false alarm to 1 % with 95 % confidence.
    for seed in 0..300 {
        let found = located(&unmarked(seed));
        assert!(
            found.is_err(),
            "image {seed}: {:?}",
            found.map(|l| l.elements.len())
        );
    }
}

/// A grid of `columns` x 8 places, 22 px apart.
fn grid(columns: usize) -> Vec<DVec2> {
    let place =
        |i: usize| 22.0 * DVec2::new((i % columns) as f64 + 1.0, (i / columns) as f64 + 1.0);
    (0..8 * columns).map(place).collect()
}

/// Asserts that one element lies within 0.5 px of each of the `centres`, and no other.
fn assert_elements_at(found: &Located, centres: &[DVec2]) {
    let elements: Vec<DVec2> = found.elements.iter().map(|e| e.centre_px).collect();
    for centre in centres {
        let distance = distance_to_nearest(*centre, elements.iter().copied());
        assert!(distance < 0.5, "no element at {centre}: {distance} px");
    }
    assert_eq!(elements.len(), centres.len(), "{:?}", found.warnings);
}

#[test]
fn small_grids_and_rows_are_not_grouped() {
    for (columns, rows) in [(4, 2), (6, 2), (4, 3), (7, 1), (8, 1)] {
        let place =
            |i: usize| 30.0 * DVec2::new((i % columns) as f64 + 1.0, (i / columns) as f64 + 1.0);
        let centres: Vec<DVec2> = (0..columns * rows).map(place).collect();
        let size = (30 * (columns + 1), 30 * (rows + 1));
        assert_elements_at(&located(&spots(&centres, size, 100.0)).unwrap(), &centres);
    }
}

#[test]
fn scattered_dots_of_equal_size_are_rarely_a_pattern() {
    let accepted = (0..40).filter(|&seed| {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut centres: Vec<DVec2> = Vec::new();
        while centres.len() < 15 + (seed as usize % 4) * 20 {
            let place = DVec2::new(rng.random_range(12.0..308.0), rng.random_range(12.0..228.0));
            // Dots of 8 px that do not touch.
            if distance_to_nearest(place, centres.iter().copied()) > 10.0 {
                centres.push(place);
            }
        }
        located(&spots(&centres, (320, 240), 100.0)).is_ok()
    });
    // Among some dozen dots, an even spacing is not impossible: the stated rate of false alarms is 5 %.
    assert!(accepted.count() <= 2);
}

#[test]
fn markers_of_two_joined_dots_are_one_element_each() {
    let centres = grid(12);
    for distance in [5.0, 6.0, 7.0] {
        let along = |i: usize| DVec2::from_angle(0.1 * (i % 5) as f64) * 0.5 * distance;
        let pairs = centres.iter().enumerate();
        let dots: Vec<DVec2> = pairs
            .flat_map(|(i, c)| [*c - along(i), *c + along(i)])
            .collect();
        let found = located(&spots(&dots, (300, 210), 100.0)).unwrap();
        assert_elements_at(&found, &centres);
    }
}

#[test]
fn specks_and_the_texture_of_a_housing_are_not_elements() {
    let centres = grid(12);
    let size = (420, 210);
    let mut picture = spots(&centres, size, 100.0);
    let mut rng = Pcg64::seed_from_u64(5);
    let noise = Normal::new(0.0, 12.0).unwrap();
    for row in 0..size.1 {
        for column in 310..size.0 {
            let gray = 60.0 + noise.sample(&mut rng);
            picture.pixels[row * size.0 + column] = gray as u8;
        }
    }
    // A glint of a few pixels beside a marker, and one between markers.
    for (column, row) in [(96, 96), (143, 121)] {
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            picture.pixels[(row + dy) * size.0 + column + dx] = 200;
        }
    }
    let found = located(&picture).unwrap();
    assert_elements_at(&found, &centres);
    let ignored = |w: &LocateWarning| matches!(w, LocateWarning::LeftOut { .. });
    assert!(found.warnings.iter().any(ignored), "{:?}", found.warnings);
}

#[test]
fn merged_and_saturated_elements_are_named() {
    let grid = |i: usize| 24.0 * DVec2::new((i % 6) as f64 + 1.0, (i / 6) as f64 + 1.0);
    let mut centres: Vec<DVec2> = (0..30).map(grid).collect();
    let found = located(&spots(&centres, (170, 146), 300.0)).unwrap();
    let saturated = |w: &LocateWarning| matches!(w, LocateWarning::Saturated { elements } if elements.len() == 30);
    assert!(found.warnings.iter().any(saturated), "{:?}", found.warnings);
    // Element 14 has moved so close to its neighbour that both form one bright patch.
    centres[15] = centres[14] + DVec2::new(5.0, 0.0);
    let found = located(&spots(&centres, (170, 146), 120.0)).unwrap();
    let merged = |w: &LocateWarning| matches!(w, LocateWarning::Merged { element: 14, .. });
    assert!(found.warnings.iter().any(merged), "{:?}", found.warnings);
    assert_eq!(found.elements.len(), 29);
}

#[test]
fn invalid_diameters_are_rejected() {
    let reference = ReferencePicture::mean([&spots(&[DVec2::new(80.0, 60.0)], (160, 120), 100.0)]);
    let reference = reference.unwrap();
    for wrong in [f64::NAN, -1.0, 0.0, 1e9] {
        let config = LocateConfig {
            spot_diameter_px: Some(wrong),
            ..LocateConfig::default()
        };
        let error = locate(&reference, &config);
        assert!(
            matches!(error, Err(LocateError::OutOfRange { .. })),
            "{wrong}"
        );
    }
}
