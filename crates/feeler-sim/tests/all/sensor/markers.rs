//! Fingertips with markers: images compared with the elastic model, and the experiments that use them.

use super::optics::{of_experiment, picture};
use crate::experiment_file::text;
use feeler::sensor::calibration::Calibration;
use feeler::sensor::fingertip::Fingertip;
use feeler::sensor::locate::{LocateConfig, Polarity, ReferencePicture, locate};
use feeler::sensor::moments::ElementMoments;
use feeler_sim::bench::{
    CalibrationBenchConfig, CalibrationBenchError, Load, load_simulated, take_pictures,
};
use feeler_sim::optics::{MarkerConfig, OpticsConfig, OpticsError, OpticsModel};
use glam::{DVec2, DVec3};

const FINGERTIPS: [&str; 3] = ["cap-closing-pins", "cap-closing-fibres", "cap-closing-gel"];

fn fingertip(experiment: &str) -> (Fingertip, OpticsConfig) {
    let (fingertip, optics) = of_experiment(experiment);
    (Fingertip::new(&fingertip).unwrap(), optics)
}

fn dark_level(experiment: &str) -> u8 {
    of_experiment(experiment).0.moments.dark_level
}

/// A fingertip without noise and vignetting, with markers modified by `change`.
///
/// Its background equals the gray level from which moments are measured.
fn ideal(experiment: &str, change: impl Fn(&mut MarkerConfig)) -> (Fingertip, OpticsModel) {
    let (fingertip, optics) = fingertip(experiment);
    let mut markers = optics.markers.clone().expect("markers");
    change(&mut markers);
    let config = OpticsConfig {
        read_noise: 0.0,
        shot_noise: 0.0,
        vignetting: 0.0,
        background_gray: f64::from(dark_level(experiment)),
        markers: Some(markers),
        ..optics
    };
    let model = OpticsModel::new(&config, &fingertip.layout, &fingertip.projection).unwrap();
    (fingertip, model)
}

/// Moments of all elements with `force` on only `element`.
fn moments(
    fingertip: &Fingertip,
    model: &OpticsModel,
    element: usize,
    force: DVec3,
) -> Vec<ElementMoments> {
    let count = fingertip.layout.elements.len();
    let mut forces = vec![DVec3::ZERO; count];
    forces[element] = force;
    let mut moments = vec![ElementMoments::default(); count];
    let picture = picture(model, &forces, 1);
    fingertip.kernel.measure(&picture, &mut moments).unwrap();
    moments
}

/// A force on one element moves its marker and its neighbours' according to the elastic model, calculated by hand.
#[test]
fn markers_move_by_forces_on_them_and_on_their_neighbours() {
    const SPREAD: f64 = 2.5e-3;
    let (fingertip, model) = ideal("cap-closing-pins", |markers| {
        markers.spread = SPREAD;
        markers.pin_length = 1e-3;
        markers.nodule_height = 0.0;
    });
    let before = moments(&fingertip, &model, 0, DVec3::ZERO);
    let moved = |force: DVec3, element: usize| {
        let after = moments(&fingertip, &model, 0, force);
        after[element].centroid - before[element].centroid
    };
    // Centroid error of a disc of 1 mm at 7 px/mm, cut off at the dark level: a hundredth of a pixel, 2 um (measured:
    // 1.3 um).
    let tolerance = 2e-6;
    let shear = DVec3::new(0.4, -0.2, 0.0);
    let stiffness = model_stiffness();
    let own = moved(shear, 0);
    assert!(
        (own - shear.truncate() / stiffness.shear).length() < tolerance,
        "{own}"
    );

    // The nearest ring moves by the tangential part of the force in its elements' frames, tilted by 11.25 degrees.
    let layout = &fingertip.layout;
    let distance = layout.tip(1).distance(layout.tip(0));
    let share = (-0.5 * (distance / SPREAD).powi(2)).exp();
    let in_frame = layout.elements[1].rotation.transpose() * layout.elements[0].rotation * shear;
    let expected = share * in_frame.truncate() / stiffness.shear;
    let neighbour = moved(shear, 1);
    assert!(
        (neighbour - expected).length() < tolerance,
        "{neighbour} for {expected}"
    );

    // Compression displaces the neighbour's pin along x of its frame, away from the apex.
    let pressed = DVec3::new(0.0, 0.0, 0.4);
    let away =
        (layout.elements[1].rotation.transpose() * (layout.tip(1) - layout.tip(0))).truncate();
    let expected = share * 1e-3 / SPREAD.powi(2) * away * pressed.z / stiffness.normal;
    let neighbour = moved(pressed, 1);
    assert!(away.x > 0.9 * distance && expected.x > 1e-5);
    assert!(
        (neighbour - expected).length() < tolerance,
        "{neighbour} for {expected}"
    );
}

struct Stiffness {
    normal: f64,
    shear: f64,
}

fn model_stiffness() -> Stiffness {
    let markers = fingertip("cap-closing-pins").1.markers.expect("markers");
    Stiffness {
        normal: markers.normal_stiffness,
        shear: markers.shear_stiffness,
    }
}

/// A marker that is pressed in is nearer to the pinhole and appears larger by the ratio of distances, dark or bright.
#[test]
fn a_pressed_marker_appears_larger() {
    for experiment in ["cap-closing-pins", "cap-closing-gel"] {
        let (fingertip, model) = ideal(experiment, |markers| markers.normal_stiffness = 500.0);
        let middle = match experiment {
            "cap-closing-gel" => 31,
            _ => 0,
        };
        let gray = |normal: f64| {
            let force = DVec3::new(0.0, 0.0, normal);
            moments(&fingertip, &model, middle, force)[middle].integrated_gray
        };
        let depth = fingertip
            .projection
            .pinhole()
            .distance(fingertip.layout.tip(middle));
        let (sunk, before) = (0.5 / 500.0, gray(0.0));
        let expected = (depth / (depth - sunk)).powi(2);
        let grown = gray(0.5) / before;
        // The blurred edge does not grow and is partly cut off at the dark level: a fifth of the growth of 7 %.
        assert!(
            (grown - expected).abs() < 0.2 * (expected - 1.0),
            "{experiment}: {grown} for {expected}"
        );
    }
}

/// Fibres do not move: their brightness measures compression, and its distribution within an element measures shear.
#[test]
fn fibres_brighten_with_compression_and_towards_shear() {
    let (fingertip, model) = ideal("cap-closing-fibres", |markers| markers.variation = 0.0);
    let optics = fingertip_markers("cap-closing-fibres");
    let before = moments(&fingertip, &model, 0, DVec3::ZERO);
    let after = moments(&fingertip, &model, 0, DVec3::new(0.0, 0.0, 0.5));
    // All four are on a circle, where the skin's indentation is smaller.
    let share = (-0.5 * (optics.circle_radius / optics.spread).powi(2)).exp();
    let brighter = 1.0 + optics.brightening * share * 0.5 / optics.normal_stiffness;
    let grown = after[0].integrated_gray / before[0].integrated_gray;
    // They are also slightly nearer.
    let depth = fingertip
        .projection
        .pinhole()
        .distance(fingertip.layout.tip(0));
    let nearer = (depth / (depth - share * 0.5 / optics.normal_stiffness)).powi(2);
    let brighter = brighter * nearer;
    // Without noise, all pixels of a spot round equally: by half a level of 112, before and after.
    let rounding = 2.0 * 0.5 / 112.0;
    assert!(
        (grown - brighter).abs() < rounding,
        "{grown} for {brighter}"
    );
    let shear = DVec3::new(0.3, 0.0, 0.5);
    let sheared = moments(&fingertip, &model, 0, shear)[0].centroid - after[0].centroid;
    assert!(
        sheared.x > 1e-5 && sheared.y.abs() < 0.05 * sheared.x,
        "{sheared}"
    );
}

fn fingertip_markers(experiment: &str) -> MarkerConfig {
    fingertip(experiment).1.markers.expect("markers")
}

/// `feeler locate` finds the actual elements in the untouched image with noise of each fingertip.
#[test]
fn the_elements_are_located_in_the_image() {
    let expected = [
        (127, 1, Polarity::Bright),
        (37, 4, Polarity::Bright),
        (63, 1, Polarity::Dark),
    ];
    for (experiment, (elements, spots, polarity)) in FINGERTIPS.into_iter().zip(expected) {
        let (fingertip, optics) = fingertip(experiment);
        let model = OpticsModel::new(&optics, &fingertip.layout, &fingertip.projection).unwrap();
        let untouched = vec![DVec3::ZERO; elements];
        let reference = ReferencePicture::mean([&picture(&model, &untouched, 1)]).unwrap();
        let located = locate(&reference, &LocateConfig::default()).unwrap();
        let found = (
            located.elements.len(),
            located.spots_per_element,
            located.polarity,
        );
        assert_eq!(
            found,
            (elements, spots, polarity),
            "{experiment}: {:?}",
            located.warnings
        );
        let centres = located.elements.iter().map(|element| element.centre_px);
        for (centre, index) in centres.zip(0..) {
            let tips = (0..elements)
                .filter_map(|element| fingertip.projection.project(fingertip.layout.tip(element)));
            let off = tips
                .map(|tip| tip.distance(centre))
                .fold(f64::INFINITY, f64::min);
            assert!(off < 1.5, "{experiment}: element {index} is {off} px off");
        }
    }
}

/// Loads are applied to patches: all elements of a patch bear the same load, independent of their frames.
#[test]
fn loads_are_applied_to_patches() {
    let (fingertip, optics) = of_experiment("cap-closing-pins");
    let bench = CalibrationBenchConfig {
        cycles: 1,
        ..CalibrationBenchConfig::of_fingertip(&fingertip, &optics, 10)
    };
    assert!(bench.contact_radius > 0.0 && bench.largest_normal < 1.0);
    let mut patches = Vec::new();
    take_pictures(&fingertip, &optics, &bench, |_, loads| {
        let mut normals: Vec<f64> = loads.iter().map(|load| load.force().z).collect();
        normals.sort_by(f64::total_cmp);
        normals.dedup();
        let unloaded = loads.iter().filter(|&&load| load == Load::None).count();
        patches.push((normals.len(), unloaded));
        Ok::<_, CalibrationBenchError>(())
    })
    .unwrap();
    // First all elements are unloaded, then some tens of patches bear one load each, and finally all bear the cycle's
    // loads.
    assert_eq!(patches[0], (1, 127));
    assert_eq!(patches.last().unwrap().0, 1);
    let between = &patches[bench.unloaded..patches.len() - 4];
    assert!(
        between
            .iter()
            .all(|&(loads, unloaded)| (5..60).contains(&loads) && unloaded == 0),
        "{between:?}"
    );
}

/// `feeler calibrate --simulated` reproduces the calibrations committed with the experiments.
#[test]
fn the_calibrations_are_reproducible() {
    for experiment in FINGERTIPS {
        let (fingertip, optics) = of_experiment(experiment);
        let committed = text(&format!("experiments/{experiment}.calibration.toml"));
        let committed = Calibration::from_toml(&committed).unwrap();
        let bench = CalibrationBenchConfig::of_fingertip(&fingertip, &optics, 150);
        let records = load_simulated(&fingertip, &optics, &bench).unwrap();
        let made_for = feeler::sensor::fingertip::CalibrationTarget::fingertip(&fingertip).unwrap();
        let model = feeler::sensor::calibration::ModelChoice::Auto;
        let made =
            feeler::sensor::calibration::fit(made_for, &records, model, bench.full_scale).unwrap();
        assert_eq!(committed.made_for, made.made_for, "{experiment}");
        for (element, record) in records.iter().enumerate() {
            for sample in record.held_out.iter().take(20) {
                let forces =
                    [&committed, &made].map(|c| c.elements[element].force(&sample.moments));
                // Sine and cosine differ in the last bit between machines, which the fit amplifies; a change of optics
                // or loads exceeds 1e-3.
                let off = forces[0].distance(forces[1]);
                assert!(off < 1e-6, "{experiment}, element {element}: {forces:?}");
            }
        }
    }
}

#[test]
fn invalid_markers_are_rejected() {
    let (fingertip, optics) = fingertip("cap-closing-gel");
    let refused = |change: &dyn Fn(&mut MarkerConfig)| {
        let mut markers = optics.markers.clone().expect("markers");
        change(&mut markers);
        let config = OpticsConfig {
            markers: Some(markers),
            ..optics.clone()
        };
        match OpticsModel::new(&config, &fingertip.layout, &fingertip.projection) {
            Err(OpticsError::OutOfRange { name, .. }) => name,
            other => panic!("{:?}", other.err()),
        }
    };
    assert_eq!(refused(&|m| m.radius = 0.0), "markers.radius");
    assert_eq!(refused(&|m| m.per_element = 0), "markers.per_element");
    assert_eq!(
        refused(&|m| m.normal_stiffness = f64::NAN),
        "markers.normal_stiffness"
    );
    assert_eq!(refused(&|m| m.spread = -1e-3), "markers.spread");
}

/// Invalid forces are rendered without panic.
#[test]
fn any_force_is_rendered() {
    for experiment in FINGERTIPS {
        let (fingertip, model) = ideal(experiment, |_| ());
        for load in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -50.0] {
            let forces = vec![DVec3::splat(load); fingertip.layout.elements.len()];
            picture(&model, &forces, 1);
        }
    }
}

/// The spacing of a grid along the dome equals its spacing in the plane.
#[test]
fn a_grid_is_centred_on_the_apex() {
    let layout = of_experiment("cap-closing-gel").0.layout;
    let (fingertip, _) = fingertip("cap-closing-gel");
    let grid = layout.grid.as_ref().expect("a grid");
    let normal = |index: usize| fingertip.layout.elements[index].normal();
    let middle = grid.columns * grid.rows / 2;
    assert!(normal(middle).distance(DVec3::X) < 1e-12);
    let beside = normal(middle + 1);
    let angle = grid.spacing / layout.dome_radius;
    assert!(DVec2::new(beside.y, beside.z).distance(DVec2::new(angle.sin(), 0.0)) < 1e-12);
    let below = normal(middle + grid.columns);
    assert!(DVec2::new(below.y, below.z).distance(DVec2::new(0.0, angle.sin())) < 1e-12);
}
