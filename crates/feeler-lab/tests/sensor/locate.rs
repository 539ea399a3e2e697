//! Elements found in pictures whose elements are known.

use feeler::sensor::{
    fingertip::{Fingertip, FingertipConfig},
    frame::Picture,
    locate::{
        LocateConfig, LocateError, LocateWarning, Located, ReferencePicture, locate, sub_regions,
    },
    located_layout::{DomeGeometry, LayoutError, LocatedLayout},
    moments::ElementMoments,
};
use feeler_sim::{
    optics::{OpticsScratch, render},
    optics_config::OpticsConfig,
    optics_model::OpticsModel,
};
use glam::{DVec2, DVec3};
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

/// A picture of soft-edged discs on a background that brightens towards one corner.
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

/// Spots on a hexagonal lattice, turned and jittered, within a circle.
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

    /// Every spot is found, nothing else is, and centres are right to a quarter of a pixel, or 3 %
    /// of the spots' spacing where that is more: what noise of 4 % of the contrast leaves. Spots whose blurred edges
    /// overlap hide part of each other, so that what is left to be seen has another centre.
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
            prop_assert!(off < tolerance, "{} off by {}", centre, off);
        }
        // Sub-regions do not overlap, and hold their own spots.
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

    /// Whatever the picture: an answer or an error, no panic.
    #[test]
    fn any_picture_is_answered(width in 0..40_usize, height in 0..40_usize, seed: u64, levels in 1..256_u32) {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut picture = Picture::black(width, height);
        for pixel in &mut picture.pixels {
            *pixel = (rng.random_range(0..levels)) as u8;
        }
        if let Ok(found) = located(&picture) {
            LocatedLayout::new(&found).kernel().unwrap();
        }
    }

    /// Whatever the text: a layout or an error, no panic.
    #[test]
    fn any_text_is_answered(text in "\\PC*", cut in 0..2000_usize, inserted in "[0-9a-z.=\\[\\]\\-\n]{0,8}") {
        let _ = LocatedLayout::from_toml(&text);
        let mut whole = simulated_layout_text().to_string();
        let at = cut.min(whole.len());
        whole.insert_str(at, &inserted);
        if let Ok(layout) = LocatedLayout::from_toml(&whole) {
            let _ = layout.kernel();
        }
    }
}

fn simulated_layout_text() -> &'static str {
    static TEXT: std::sync::OnceLock<String> = std::sync::OnceLock::new();
    TEXT.get_or_init(|| {
        let config = FingertipConfig::default();
        let found = located(&simulated(&config, &[DVec3::ZERO; 41], 1)).unwrap();
        LocatedLayout::on_dome(&found, dome(&config))
            .unwrap()
            .to_toml()
            .unwrap()
    })
}

fn dome(config: &FingertipConfig) -> DomeGeometry {
    DomeGeometry {
        radius: config.layout.dome_radius,
        camera: config.camera.clone(),
    }
}

fn simulated(config: &FingertipConfig, forces: &[DVec3], seed: u64) -> Picture {
    let (layout, projection) = Fingertip::layout_and_projection(config).unwrap();
    let model = OpticsModel::new(&OpticsConfig::default(), &layout, &projection).unwrap();
    let mut picture = Picture::black(projection.width(), projection.height());
    let (mut scratch, mut rng) = (OpticsScratch::new(&model), Pcg64::seed_from_u64(seed));
    render(&model, &mut scratch, forces, &mut rng, &mut picture).unwrap();
    picture
}

/// The configuration with its camera's picture `times` as large.
fn enlarged(times: f64) -> FingertipConfig {
    let mut config = FingertipConfig::default();
    config.camera.width = (640.0 * times) as usize;
    config.camera.height = (480.0 * times) as usize;
    config.camera.focal_length_px *= times;
    config
}

/// Groups of eight spots are elements, at any resolution; and with the dome's geometry each is where
/// it was put, in the order and with the frame of the sensor's own layout.
#[test]
fn the_simulated_sensor_has_41_elements() {
    for (times, seed) in [(1.0, 1), (1.0, 2), (0.75, 3), (1.5, 4), (2.0, 5)] {
        let config = enlarged(times);
        let (layout, projection) = Fingertip::layout_and_projection(&config).unwrap();
        let found = located(&simulated(&config, &[DVec3::ZERO; 41], seed)).unwrap();
        assert_eq!(
            (found.elements.len(), found.spots_per_element),
            (41, 8),
            "{times}"
        );
        assert_eq!(found.warnings, []);
        let on_dome = LocatedLayout::on_dome(&found, dome(&config)).unwrap();
        let (mut plain_off, mut dome_off) = (0.0_f64, 0.0_f64);
        for (index, (place, element)) in on_dome.elements.iter().zip(&layout.elements).enumerate() {
            let axis = projection.project(layout.tip(index)).unwrap();
            let plain = found.elements.iter().map(|e| e.centre_px);
            plain_off = plain_off.max(distance_to_nearest(axis, plain));
            dome_off = dome_off.max(place.centre_px.distance(axis));
            assert_eq!(place.ring, Some(element.ring));
            // A tenth of a pixel is less than 0.01 mm of the dome's 18 mm.
            let direction = place.direction.unwrap();
            assert!(direction.angle_between(element.normal()) < 6e-4);
        }
        println!("{times}: centres off by {plain_off:.3} px, with the dome known {dome_off:.3} px");
        assert!(dome_off < 0.1, "{times}: {dome_off}");
        // The mean of a rim element's spots is off its axis by 0.76 px in a picture of 640 columns
        // for perspective alone (by projecting its eight cones), and nothing in the picture tells.
        assert!(plain_off < 0.85 * times, "{times}: {plain_off}");
    }
}

/// A located layout takes the same moments as the one that the sensor was made with, as far as the
/// sub-regions are the same: the centroid of an unloaded element is on its axis.
#[test]
fn moments_of_a_located_dome_are_in_metres() {
    let config = FingertipConfig::default();
    let picture = simulated(&config, &[DVec3::ZERO; 41], 1);
    let layout = LocatedLayout::from_toml(simulated_layout_text()).unwrap();
    let mut moments = vec![ElementMoments::default(); 41];
    layout
        .kernel()
        .unwrap()
        .measure(&picture, &mut moments)
        .unwrap();
    let mut expected = moments.clone();
    let fingertip = Fingertip::new(&config).unwrap();
    fingertip.kernel.measure(&picture, &mut expected).unwrap();
    for (moments, expected) in moments.iter().zip(&expected) {
        // 0.05 mm: half a pixel of a centre, and what else differs in the sub-regions' rims.
        assert!(moments.centroid.length() < 5e-5, "{moments:?} {expected:?}");
        let ratio = moments.integrated_gray / expected.integrated_gray;
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    }
}

#[test]
fn a_layout_survives_its_file_and_its_hash_tells_it() {
    let layout = LocatedLayout::from_toml(simulated_layout_text()).unwrap();
    let again = LocatedLayout::from_toml(&layout.to_toml().unwrap()).unwrap();
    assert_eq!(again, layout);
    let hash = layout.hash().unwrap();
    assert_eq!((hash.len(), again.hash().unwrap()), (64, hash.clone()));
    let commented = format!("# a comment\n{}", simulated_layout_text());
    assert_eq!(
        LocatedLayout::from_toml(&commented)
            .unwrap()
            .hash()
            .unwrap(),
        hash
    );
    let mut other = layout.clone();
    other.elements[7].radius_px += 0.01;
    assert_ne!(other.hash().unwrap(), hash);
    for (from, to, words) in [
        ("version = 1", "version = 9", "version 1 expected, got 9"),
        ("width = 640", "width = 0", "width, height"),
        ("width = 640", "width = 641", "dome.camera"),
        ("radius_px = ", "radius_px = -", "radius_px"),
        ("centre_px = [", "centre_px = [nan, 1.0]#", "centre_px"),
        (
            "direction = [",
            "direction = [1.0, 1.0, 0.0]#",
            "a unit vector",
        ),
        ("radius = ", "radius = -", "dome_radius"),
        ("dark_level", "darkness", "darkness"),
    ] {
        let text = layout.to_toml().unwrap().replacen(from, to, 1);
        let error = LocatedLayout::from_toml(&text).unwrap_err().to_string();
        assert!(error.contains(words), "{to}: {error}");
    }
}

#[test]
fn a_wrong_dome_is_refused() {
    let config = FingertipConfig::default();
    let found = located(&simulated(&config, &[DVec3::ZERO; 41], 1)).unwrap();
    let mut other = dome(&config);
    other.camera.width = 320;
    assert!(matches!(
        LocatedLayout::on_dome(&found, other),
        Err(LayoutError::Unusable { .. })
    ));
    let mut other = dome(&config);
    other.camera.standoff = 0.02;
    assert!(matches!(
        LocatedLayout::on_dome(&found, other),
        Err(LayoutError::Dome(_))
    ));
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
fn pictures_without_elements_are_refused() {
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
fn a_single_element_is_found() {
    let found = located(&spots(&[DVec2::new(80.3, 61.8)], (160, 120), 100.0)).unwrap();
    assert_eq!(found.elements.len(), 1);
    assert!(found.elements[0].centre_px.distance(DVec2::new(80.3, 61.8)) < 0.25);
}

#[test]
fn merged_and_saturated_elements_are_named() {
    let grid = |i: usize| 24.0 * DVec2::new((i % 6) as f64 + 1.0, (i / 6) as f64 + 1.0);
    let mut centres: Vec<DVec2> = (0..30).map(grid).collect();
    let found = located(&spots(&centres, (170, 146), 300.0)).unwrap();
    let saturated = |w: &LocateWarning| matches!(w, LocateWarning::Saturated { elements } if elements.len() == 30);
    assert!(found.warnings.iter().any(saturated), "{:?}", found.warnings);
    // Element 14 has drawn its neighbour close, so that they are one bright patch.
    centres[15] = centres[14] + DVec2::new(5.0, 0.0);
    let found = located(&spots(&centres, (170, 146), 120.0)).unwrap();
    let merged = |w: &LocateWarning| matches!(w, LocateWarning::Merged { element: 14, .. });
    assert!(found.warnings.iter().any(merged), "{:?}", found.warnings);
    assert_eq!(found.elements.len(), 29);
}

#[test]
fn what_is_said_beforehand_is_checked_and_used() {
    let config = FingertipConfig::default();
    let picture = simulated(&config, &[DVec3::ZERO; 41], 1);
    let reference = ReferencePicture::mean([&picture]).unwrap();
    let with = |spot_diameter_px, element_diameter_px| LocateConfig {
        spot_diameter_px,
        element_diameter_px,
        ..LocateConfig::default()
    };
    let small = locate(&reference, &with(Some(5.0), Some(2.0))).unwrap();
    assert_eq!(small.elements.len(), 41 * 8);
    for wrong in [f64::NAN, -1.0, 0.0, 1e9] {
        let error = locate(&reference, &with(Some(wrong), None));
        assert!(
            matches!(error, Err(LocateError::OutOfRange { .. })),
            "{wrong}"
        );
    }
}
