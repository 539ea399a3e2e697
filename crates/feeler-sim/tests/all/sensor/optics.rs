//! Simulated images, compared with their physical model.

use crate::experiment_file::read;
use feeler::sensor::fingertip::{Fingertip, FingertipConfig};
use feeler::sensor::image::Picture;
use feeler::sensor::moments::ElementMoments;
use feeler_sim::optics::{CONES, OpticsConfig, OpticsError, OpticsModel, OpticsScratch, render};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_pcg::Pcg64;
use std::sync::LazyLock;

fn fingertip() -> Fingertip {
    Fingertip::new(&FingertipConfig::default()).unwrap()
}

fn model(fingertip: &Fingertip, config: &OpticsConfig) -> OpticsModel {
    OpticsModel::new(config, &fingertip.layout, &fingertip.projection).unwrap()
}

/// Fingertip of a built-in experiment and its optics.
pub fn of_experiment(name: &str) -> (FingertipConfig, OpticsConfig) {
    let file = format!("experiments/{name}.toml");
    (read(&file, "sensor.fingertip"), read(&file, "sim.optics"))
}

/// Renders an image of 640x480 px with these `forces` (N) on the elements.
pub fn picture(model: &OpticsModel, forces: &[DVec3], seed: u64) -> Picture {
    let mut picture = Picture::black(640, 480);
    let mut rng = Pcg64::seed_from_u64(seed);
    render(
        model,
        &mut OpticsScratch::new(model),
        forces,
        &mut rng,
        &mut picture,
    )
    .unwrap();
    picture
}

/// Displacement of the centroid of the spots' light if no cone lifts off.
fn expected_displacement(config: &OpticsConfig, force: DVec3) -> DVec2 {
    let load = CONES as f64 * config.preload + force.z;
    force.truncate() * (config.lever_height / load + 1.0 / config.shear_stiffness)
}

proptest! {
    /// Within the friction cone no conical feeler lifts off: loads add up, and the displacement is exact.
    #[test]
    fn cones_carry_the_load(
        normal in 0.0..2.0_f64,
        friction in 0.0..0.9_f64,
        direction in 0.0..std::f64::consts::TAU,
    ) {
        static MODEL: LazyLock<OpticsModel> =
            LazyLock::new(|| model(&fingertip(), &OpticsConfig::default()));
        let config = OpticsConfig::default();
        let model = &*MODEL;
        let force = (friction * normal * DVec2::from_angle(direction)).extend(normal);
        let spots = model.spots(force);
        let load: f64 = spots.iter().map(|s| s.load).sum();
        prop_assert!((load - (CONES as f64 * config.preload + normal)).abs() < 1e-12);
        let centroid = spots.iter().map(|s| s.load * s.centre).sum::<DVec2>() / load;
        prop_assert!((centroid - expected_displacement(&config, force)).length() < 1e-12);
    }
}

#[test]
fn no_cone_pulls() {
    let model = model(&fingertip(), &OpticsConfig::default());
    let lifted = model.spots(DVec3::new(1.5, 0.0, 0.0));
    assert!(lifted.iter().all(|spot| spot.load >= 0.0));
    assert!(lifted.iter().any(|spot| spot.radius == 0.0));
    for load in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        let spots = model.spots(DVec3::splat(load));
        assert!(spots.iter().all(|spot| spot.radius <= 0.7e-3), "{spots:?}");
        // Renders without panic.
        picture(&model, &[DVec3::splat(load); 41], 1);
    }
}

/// Without noise and vignetting, the image's moments are the spots' area and centroid.
#[test]
fn moments_of_the_image_follow_the_load() {
    let fingertip = fingertip();
    let config = OpticsConfig {
        read_noise: 0.0,
        shot_noise: 0.0,
        vignetting: 0.0,
        ..OpticsConfig::default()
    };
    let model = model(&fingertip, &config);
    let measure = |force: DVec3| {
        let mut moments = vec![ElementMoments::default(); 41];
        let picture = picture(&model, &[force; 41], 1);
        fingertip.kernel.measure(&picture, &mut moments).unwrap();
        moments
    };
    let unloaded = measure(DVec3::ZERO);
    for force in [
        DVec3::new(0.0, 0.0, 0.5),
        DVec3::new(0.3, -0.2, 1.0),
        DVec3::new(-0.5, 0.6, 1.5),
    ] {
        for (element, (loaded, unloaded)) in measure(force).iter().zip(&unloaded).enumerate() {
            // The dome is slanted by r_c / R under the cones, which makes discs on it appear smaller by its cosine, 0.5
            // %. The dark level cuts 4 of 170 levels off the edge of each spot, relatively more of small spots: 2 % in
            // total (measured: 1.1 to 2.3 %).
            let light = (190.0 - 24.0) * model.area_per_load() * force.z;
            let growth = (loaded.integrated_gray - unloaded.integrated_gray) / light;
            assert!((growth - 1.0).abs() < 0.03, "element {element}: {growth}");
            // Each spot's weight is thus accurate to 3 %, at a lever of 1.8 mm; errors of opposite spots partly cancel,
            // which leaves 0.02 mm (measured: 0.017 mm).
            let displacement = loaded.centroid - unloaded.centroid;
            let error = (displacement - expected_displacement(&config, force)).length();
            assert!(error < 2e-5, "element {element}: {error} m under {force}");
        }
    }
}

#[test]
fn the_image_depends_only_on_forces_and_seed() {
    let model = model(&fingertip(), &OpticsConfig::default());
    let forces = [DVec3::new(0.1, 0.2, 0.5); 41];
    let first = picture(&model, &forces, 5);
    assert!(first == picture(&model, &forces, 5), "same seed");
    assert!(first != picture(&model, &forces, 6), "another seed");

    // Previous images have no effect.
    let mut again = Picture::black(640, 480);
    let mut scratch = OpticsScratch::new(&model);
    for (forces, seed) in [([DVec3::Z; 41], 9), (forces, 5)] {
        let mut rng = Pcg64::seed_from_u64(seed);
        render(&model, &mut scratch, &forces, &mut rng, &mut again).unwrap();
    }
    assert!(first == again, "same scratch");
}

/// Sensed pixels are identical in partial and complete images.
#[test]
fn sensed_pixels_equal_those_of_the_complete_image() {
    let fingertip = fingertip();
    let whole = model(&fingertip, &OpticsConfig::default());
    let sensed = whole.clone().drawing_only(fingertip.kernel.pixels());
    let forces = [DVec3::new(0.1, 0.2, 0.5); 41];
    let whole = picture(&whole, &forces, 5);
    let sensed = picture(&sensed, &forces, 5);
    let mut moments = [vec![ElementMoments::default(); 41], Vec::new()];
    moments[1] = moments[0].clone();
    for (picture, moments) in [&whole, &sensed].into_iter().zip(&mut moments) {
        fingertip.kernel.measure(picture, moments).unwrap();
    }
    assert_eq!(moments[0], moments[1]);
    assert!(moments[0].iter().all(|m| m.integrated_gray > 0.0));
    for (column, row) in fingertip.kernel.pixels() {
        let at = row * 640 + column;
        assert_eq!(whole.pixels[at], sensed.pixels[at], "{column}, {row}");
    }
    // Most other pixels are not rendered: the corner, and over half of all.
    let black = sensed.pixels.iter().filter(|&&gray| gray == 0).count();
    assert!(sensed.pixels[0] == 0 && black > 640 * 480 / 2, "{black}");
}

/// A load far below a double's resolution at the preload is rendered spot by spot and must give the same image as the
/// table used for unloaded elements.
#[test]
fn unloaded_elements_are_rendered_as_under_the_smallest_load() {
    let model = model(&fingertip(), &OpticsConfig::default());
    for loaded in [0, 1, 5, 40] {
        let with = |others: DVec3| {
            let mut forces = [others; 41];
            // Scattered over the dome.
            for element in (0..loaded).map(|index| (3 + 17 * index) % 41) {
                forces[element] = DVec3::new(0.3, -0.2, 1.0);
            }
            picture(&model, &forces, 7)
        };
        let expected = with(DVec3::splat(1e-300));
        assert!(with(DVec3::ZERO) == expected, "{loaded} loaded");
    }
}

/// The image of a seed is bit-identical in all builds. Update the digest after intended changes of the image.
#[test]
fn the_image_of_a_seed_is_unchanged() {
    let optics = OpticsConfig {
        read_noise: 1.0,
        shot_noise: 0.07,
        ..OpticsConfig::default()
    };
    let model = model(&fingertip(), &optics);
    let picture = picture(&model, &[DVec3::new(0.1, 0.2, 0.5); 41], 5);
    // FNV-1a.
    let digest = picture
        .pixels
        .iter()
        .fold(0xcbf2_9ce4_8422_2325_u64, |digest, &gray| {
            (digest ^ u64::from(gray)).wrapping_mul(0x100_0000_01b3)
        });
    assert_eq!(digest, 0xee2f_cc07_e156_40a8, "{digest:#x}");
}

/// Mean and variance of a corner of the dome without spots, over many images.
#[test]
fn noise_is_as_strong_as_configured() {
    let fingertip = fingertip();
    for (background, read, shot) in [(20.0, 1.5, 0.1), (100.0, 0.0, 0.3), (60.0, 2.0, 0.0)] {
        let config = OpticsConfig {
            background_gray: background,
            vignetting: 0.0,
            read_noise: read,
            shot_noise: shot,
            ..OpticsConfig::default()
        };
        let model = model(&fingertip, &config);
        let picture = picture(&model, &[DVec3::ZERO; 41], 17);
        let dark: Vec<f64> = picture
            .pixels
            .chunks(640)
            .flat_map(|row| row[..64].iter().map(|&gray| f64::from(gray)))
            .collect();
        let count = dark.len() as f64;
        let mean = dark.iter().sum::<f64>() / count;
        let variance = dark.iter().map(|g| (g - mean).powi(2)).sum::<f64>() / count;
        // Rounding to whole levels adds a variance of 1/12. Tolerances are four standard errors.
        let expected = read * read + shot * shot * background + 1.0 / 12.0;
        let mean_error = 4.0 * (expected / count).sqrt();
        assert!((mean - background).abs() < mean_error, "mean {mean}");
        let variance_error = 4.0 * expected * (2.0 / count).sqrt();
        assert!(
            (variance - expected).abs() < variance_error,
            "{variance} {expected}"
        );
    }
}

#[test]
fn invalid_optics_are_rejected() {
    let fingertip = fingertip();
    let config = OpticsConfig {
        poisson_ratio: 0.7,
        ..OpticsConfig::default()
    };
    let error = OpticsModel::new(&config, &fingertip.layout, &fingertip.projection).unwrap_err();
    assert_eq!(
        error.to_string(),
        "poisson_ratio must lie between 0 and 0.5, got 0.7"
    );

    let model = model(&fingertip, &OpticsConfig::default());
    let mut scratch = OpticsScratch::new(&model);
    let mut rng = Pcg64::seed_from_u64(1);
    let mut small = Picture::black(64, 48);
    let forces = [DVec3::ZERO; 41];
    let error = render(&model, &mut scratch, &forces, &mut rng, &mut small).unwrap_err();
    assert!(matches!(error, OpticsError::PictureSize { width: 64, .. }));
    let mut fitting = Picture::black(640, 480);
    let error = render(&model, &mut scratch, &forces[1..], &mut rng, &mut fitting).unwrap_err();
    assert_eq!(
        error,
        OpticsError::ElementCount {
            expected: 41,
            actual: 40
        }
    );
}
