//! Elements that are groups of eight spots.

use super::spots::{Spots, found, grid};
use feeler::sensor::locate::{LocateConfig, LocateWarning};
use glam::DVec2;
use std::f64::consts::TAU;

/// Radius of the circle of a group's spots (px).
const CIRCLE: f64 = 9.0;
const SIGMA: f64 = 1.6;
const SIZE: (usize, usize) = (255, 215);

fn middles() -> Vec<DVec2> {
    grid(DVec2::new(27.0, 27.0), 40.0, 6, 5)
}

fn group(middle: DVec2) -> impl Iterator<Item = DVec2> {
    (0..8).map(move |n| middle + CIRCLE * DVec2::from_angle(TAU * f64::from(n) / 8.0 + 0.2))
}

#[test]
fn groups_of_one_size_are_elements() {
    let spots: Vec<DVec2> = middles().into_iter().flat_map(group).collect();
    let picture = Spots::alike(&spots, SIGMA).picture(SIZE);
    let located = found(&picture, &LocateConfig::default()).expect("elements");
    assert_eq!((located.elements.len(), located.spots_per_element), (30, 8));
    assert_eq!(located.warnings, []);
    assert!(
        (located.spacing_px - 40.0).abs() < 0.3,
        "{}",
        located.spacing_px
    );
    for (element, middle) in located.elements.iter().zip(middles()) {
        assert!(element.centre_px.distance(middle) < 0.1, "{middle}");
        assert_eq!(element.spots_px.len(), 8);
        for spot in group(middle) {
            assert!(
                element.spots_px.iter().any(|s| s.distance(spot) < 0.2),
                "{spot}"
            );
        }
        assert!(
            (element.radius_px - 20.0).abs() < 0.3,
            "{}",
            element.radius_px
        );
    }
    // A sub-region contains all of its spots, regardless of the configured radius.
    let narrow = LocateConfig {
        region_radius: 0.2,
        ..LocateConfig::default()
    };
    let located = found(&picture, &narrow).expect("elements");
    let room = CIRCLE + 1.5 * located.spot_diameter_px;
    assert!(
        (located.elements[8].radius_px - room).abs() < 0.2,
        "{}",
        located.elements[8].radius_px
    );
}

/// Corners of a pentagon.
fn five(middle: DVec2) -> impl Iterator<Item = DVec2> {
    (0..5).map(move |n| middle + CIRCLE * DVec2::from_angle(TAU * f64::from(n) / 5.0 + 0.2))
}

#[test]
fn incomplete_groups_are_named_and_stray_spots_are_left_out() {
    let mut spots: Vec<DVec2> = middles().into_iter().flat_map(five).collect();
    // Element 4 lacks one spot.
    spots.remove(4 * 5 + 3);
    let picture = Spots::alike(&spots, SIGMA).picture(SIZE);
    let located = found(&picture, &LocateConfig::default()).expect("elements");
    assert_eq!((located.elements.len(), located.spots_per_element), (30, 5));
    let incomplete = LocateWarning::Incomplete {
        element: 4,
        expected: 5,
        actual: 4,
    };
    assert_eq!(located.warnings, [incomplete]);

    spots.push(DVec2::new(330.0, 100.0));
    let picture = Spots::alike(&spots, SIGMA).picture((360, 215));
    let located = found(&picture, &LocateConfig::default()).expect("elements");
    assert_eq!(located.elements.len(), 30);
    let left_out =
        |w: &LocateWarning| matches!(w, LocateWarning::LeftOut { spots_px } if spots_px.len() == 1);
    assert!(
        located.warnings.iter().any(left_out),
        "{:?}",
        located.warnings
    );
}

/// Splitting this group and all others in two would give complete groups of four.
#[test]
fn a_group_without_two_spots_does_not_split_the_others() {
    let mut spots: Vec<DVec2> = middles().into_iter().flat_map(group).collect();
    spots.drain(4 * 8 + 2..4 * 8 + 4);
    let picture = Spots::alike(&spots, SIGMA).picture(SIZE);
    let located = found(&picture, &LocateConfig::default()).expect("elements");
    assert_eq!((located.elements.len(), located.spots_per_element), (30, 8));
    let incomplete = LocateWarning::Incomplete {
        element: 4,
        expected: 8,
        actual: 6,
    };
    assert_eq!(located.warnings, [incomplete]);
}

#[test]
fn a_group_with_an_additional_spot_is_named_as_merged() {
    let mut spots: Vec<DVec2> = middles().into_iter().flat_map(group).collect();
    spots.push(middles()[11]);
    let config = LocateConfig {
        element_diameter_px: Some(22.0),
        ..LocateConfig::default()
    };
    let located = found(&Spots::alike(&spots, SIGMA).picture(SIZE), &config).expect("elements");
    assert_eq!((located.elements.len(), located.spots_per_element), (30, 8));
    let [
        LocateWarning::Merged {
            element: 11,
            centre_px,
            times,
        },
    ] = located.warnings[..]
    else {
        panic!("{:?}", located.warnings)
    };
    assert!(centre_px.distance(middles()[11]) < 0.2);
    assert_eq!(times, 9.0 / 8.0);
}

/// The configured diameter determines which spots form an element.
#[test]
fn the_size_of_elements_is_configurable() {
    let spots: Vec<DVec2> = middles().into_iter().flat_map(group).collect();
    let picture = Spots::alike(&spots, SIGMA).picture(SIZE);
    let count = |diameter: f64| {
        let config = LocateConfig {
            element_diameter_px: Some(diameter),
            ..LocateConfig::default()
        };
        let located = found(&picture, &config).expect("elements");
        (located.elements.len(), located.spots_per_element)
    };
    // The spots of a group are 6.9 px from their neighbours and 18 px from the opposite ones.
    assert_eq!(count(4.0), (240, 1));
    assert_eq!(count(18.5), (30, 8));
    assert_eq!(count(30.0), (30, 8));
}

/// A lattice is not split into groups, although it could be in several ways.
#[test]
fn spots_on_a_lattice_are_elements_themselves() {
    let lattice = grid(DVec2::splat(15.3), 14.0, 14, 12);
    let located = found(
        &Spots::alike(&lattice, 1.8).picture((215, 190)),
        &LocateConfig::default(),
    )
    .expect("elements");
    assert_eq!(
        (located.elements.len(), located.spots_per_element),
        (168, 1)
    );
}
