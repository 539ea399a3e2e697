//! Locating elements in rendered images with known elements.

use feeler::sensor::fingertip::{
    DomeGeometry, Fingertip, FingertipConfig, LayoutError, LocatedLayout,
};
use feeler::sensor::image::Picture;
use feeler::sensor::locate::{LocateConfig, LocateError, Located, ReferencePicture, locate};
use feeler::sensor::moments::ElementMoments;
use feeler_sim::optics::{OpticsConfig, OpticsModel, OpticsScratch, render};
use glam::{DVec2, DVec3};
use proptest::prelude::*;
use rand::SeedableRng;
use rand_pcg::Pcg64;

fn located(picture: &Picture) -> Result<Located, LocateError> {
    locate(
        &ReferencePicture::mean([picture])?,
        &LocateConfig::default(),
    )
}

fn distance_to_nearest(place: DVec2, others: impl Iterator<Item = DVec2>) -> f64 {
    others
        .map(|o| o.distance(place))
        .fold(f64::INFINITY, f64::min)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any text gives a layout or an error and never panics.
    #[test]
    fn parsing_any_text_does_not_panic(text in "\\PC*", cut in 0..2000_usize, inserted in "[0-9a-z.=\\[\\]\\-\n]{0,8}") {
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

/// The default configuration with the camera's image enlarged by `times`.
fn enlarged(times: f64) -> FingertipConfig {
    let mut config = FingertipConfig::default();
    config.camera.width = (640.0 * times) as usize;
    config.camera.height = (480.0 * times) as usize;
    config.camera.focal_length_px *= times;
    config
}

/// Groups of eight spots are located as elements at any resolution. With the dome's geometry each has the position,
/// index and frame of the sensor's layout.
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
        // By perspective alone, the mean of a rim element's spots is 0.76 px off its axis in an image of 640 columns
        // (from projecting its eight cones), which cannot be determined from the image.
        assert!(plain_off < 0.85 * times, "{times}: {plain_off}");
    }
}

/// A located layout measures the same moments as the sensor's layout, up to differences of the sub-regions: the
/// centroid of an unloaded element is on its axis.
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
        // 0.05 mm: half a pixel of a centre, and differences at the sub-regions' edges.
        assert!(moments.centroid.length() < 5e-5, "{moments:?} {expected:?}");
        let ratio = moments.integrated_gray / expected.integrated_gray;
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    }
}

#[test]
fn a_layout_round_trips_and_its_hash_identifies_it() {
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
        ("version = 1", "version = 9", "version 1, got 9"),
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
fn a_wrong_dome_is_rejected() {
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

#[test]
fn given_parameters_are_used() {
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
}
