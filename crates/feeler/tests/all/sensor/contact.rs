//! Contact estimates against closed forms: Hertz pressure, its torsion limit, and Mindlin's incipient slip.

use assert_no_alloc::assert_no_alloc;
use feeler::glam::{DVec2, DVec3, Vec3Swizzles as _};
use feeler::sensor::contact::{Contact, ContactEstimator};
use feeler::sensor::fingertip::{ElementLayout, LayoutConfig, SensingElement};
use feeler::sensor::forces::NO_FORCE;
use feeler::sensor::taxel::TaxelLayout;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;

/// Spacing of the grid, m.
const SPACING: f64 = 0.001;
/// Taxels along each side of the grid.
const SIDE: usize = 15;
/// Compressive force on the contact, N.
const LOAD: f64 = 20.0;
const FRICTION: f64 = 0.6;

/// A plane grid of taxels that face x of `T`.
fn grid() -> TaxelLayout {
    let middle = 0.5 * (SIDE - 1) as f64;
    let place = |index: usize| SPACING * (index as f64 - middle);
    let taxels: String = (0..SIDE * SIDE)
        .map(|i| {
            format!(
                "[[taxel]]\nplace = [0.0, {:.6}, {:.6}]\n",
                place(i % SIDE),
                place(i / SIDE)
            )
        })
        .collect();
    let head = "version = 1\nname = \"grid\"\nunit = \"N\"\nrate = 100.0\n\
                columns = { x = \"{n}x\", y = \"{n}y\", z = \"{n}z\" }\n";
    TaxelLayout::from_toml(&format!("{head}{taxels}")).expect("a valid layout")
}

/// Traction at a place: shear along y and z of `T`, and pressure (Pa).
type Traction = dyn Fn(DVec2) -> DVec3;

/// Force on each taxel of the grid: the integral of a traction over its square, by the midpoint rule with 20 x 20
/// points (the error is below that of the estimates by two orders of magnitude).
fn forces(layout: &TaxelLayout, traction: &Traction) -> Vec<DVec3> {
    const POINTS: usize = 20;
    let step = SPACING / POINTS as f64;
    let within = |index: usize| step * (index as f64 + 0.5) - 0.5 * SPACING;
    let of_taxel = |(element, place): (SensingElement, DVec3)| {
        let points =
            (0..POINTS * POINTS).map(|i| DVec2::new(within(i % POINTS), within(i / POINTS)));
        let sum: DVec3 = points.map(|point| traction(place.yz() + point)).sum();
        // `traction` gives the force on the skin by the object: shear in T, pressure along -x of T.
        let on_skin = step * step * DVec3::new(-sum.z, sum.x, sum.y);
        let local = element.rotation.transpose() * on_skin;
        local.with_z(-local.z)
    };
    layout.elements().map(of_taxel).collect()
}

/// Hertz pressure of [`LOAD`] on an ellipse with these semi-axes along `direction` and across it, around `centre`.
fn hertz(centre: DVec2, semi_axes: [f64; 2], direction: DVec2) -> impl Fn(DVec2) -> f64 {
    let [a, b] = semi_axes;
    let peak = 1.5 * LOAD / (PI * a * b);
    move |place| {
        let off = place - centre;
        let (along, across) = (off.dot(direction) / a, off.dot(direction.perp()) / b);
        peak * (1.0 - along * along - across * across).max(0.0).sqrt()
    }
}

fn estimate(layout: &TaxelLayout, forces: &[DVec3], touch: f64) -> Contact {
    ContactEstimator::new(layout.elements(), touch)
        .estimate(forces)
        .expect("a contact")
}

#[test]
fn elliptical_hertz_contacts_have_their_centre_area_axes_and_load() {
    let layout = grid();
    let mut random = Pcg64::seed_from_u64(7);
    for _ in 0..20 {
        let centre = SPACING
            * DVec2::new(
                random.random_range(-1.0..1.0),
                random.random_range(-1.0..1.0),
            );
        let axes = [
            random.random_range(3.0..4.5) * SPACING,
            random.random_range(1.5..2.5) * SPACING,
        ];
        let direction = DVec2::from_angle(random.random_range(0.0..PI));
        let pressure = hertz(centre, axes, direction);
        let forces = forces(&layout, &move |place| DVec3::new(0.0, 0.0, pressure(place)));
        let contact = estimate(&layout, &forces, 1e-9);
        let off = (contact.centre.yz() - centre).length();
        // Two orders of magnitude below the spacing; sampling a smooth function at its cells' centres.
        assert!(
            off < 0.01 * SPACING && off < 2.0 * contact.centre_error,
            "{off}"
        );
        assert!((contact.force - DVec3::new(-LOAD, 0.0, 0.0)).length() < 1e-2 * LOAD);
        assert!((contact.normal - DVec3::X).length() < 1e-12 && contact.torsion.abs() < 1e-12);
        let ellipse = contact.ellipse.expect("the grid resolves the extent");
        for (actual, expected) in ellipse.semi_axes.iter().zip(axes) {
            // At 1.5 spacings the moments of grouped data differ by 3 % from Sheppard's.
            assert!(
                (actual / expected - 1.0).abs() < 0.03,
                "{actual} {expected}"
            );
        }
        assert!((ellipse.area() / (PI * axes[0] * axes[1]) - 1.0).abs() < 0.04);
        assert!(ellipse.direction.yz().dot(direction).abs() > 0.999);
    }
}

#[test]
fn a_twisted_contact_has_the_torsion_of_full_slip() {
    let layout = grid();
    let radius = 4.0 * SPACING;
    let pressure = hertz(DVec2::ZERO, [radius, radius], DVec2::X);
    // The object turns counterclockwise when looking at the skin from outside (from y towards z of T).
    let forces = forces(&layout, &move |place| {
        (FRICTION * pressure(place) * place.normalize_or_zero().perp()).extend(pressure(place))
    });
    let contact = estimate(&layout, &forces, 1e-9);
    // Integral of friction times pressure times radius (Johnson, equation 7.54).
    let expected = 3.0 * PI / 16.0 * FRICTION * LOAD * radius;
    // Shear within a cell turns; at 4 spacings this is 2 %.
    assert!(
        (contact.torsion / expected - 1.0).abs() < 0.02,
        "{} {expected}",
        contact.torsion
    );
}

/// Tractions of Cattaneo and Mindlin: a Hertz contact whose tangential force is a `part` of that of full slip
/// (Johnson, equations 7.26 to 7.28).
fn mindlin(radius: f64, part: f64) -> impl Fn(DVec2) -> DVec3 {
    let sticking = radius * (1.0 - part).cbrt();
    let root = |of: f64, place: DVec2| (of * of - place.length_squared()).max(0.0).sqrt();
    let scale = 1.5 * LOAD / (PI * radius.powi(3));
    move |place| {
        let pressure = scale * root(radius, place);
        DVec3::new(
            FRICTION * (pressure - scale * root(sticking, place)),
            0.0,
            pressure,
        )
    }
}

#[test]
fn the_share_of_sliding_elements_is_mindlins() {
    let layout = grid();
    let radius = 6.0 * SPACING;
    let mut estimator = ContactEstimator::new(layout.elements(), 1e-9).with_friction(FRICTION);
    for percent in (0..=100).step_by(5) {
        let part = f64::from(percent) / 100.0;
        let traction = mindlin(radius, part);
        let forces = forces(&layout, &traction);
        let contact = estimator.estimate(&forces).expect("a contact");
        let actual = contact.sliding.expect("friction is known");
        let expected = 1.0 - (1.0 - part).powf(2.0 / 3.0);
        // Elements on the boundary of the stick zone may count as either: up to 19 of 113 after the first step, half of
        // them wrongly. Elements on the edge of the contact add to those that slide.
        assert!(
            (actual - expected).abs() < 0.12,
            "{part} {actual} {expected}"
        );
    }
}

#[test]
fn friction_is_found_from_a_contact_that_begins_to_slide() {
    let layout = grid();
    let mut estimator = ContactEstimator::new(layout.elements(), 0.01);
    let mut contact = None;
    for percent in 0..=90 {
        let traction = mindlin(6.0 * SPACING, f64::from(percent) / 100.0);
        let forces = forces(&layout, &traction);
        contact = assert_no_alloc(|| estimator.estimate(&forces));
        let friction = contact.and_then(|contact| contact.friction);
        assert!(percent > 5 || friction.is_none(), "nothing slides yet");
    }
    let contact = contact.expect("a contact");
    let friction = contact.friction.expect("the edge slides");
    // Elements at the boundary of the stick zone are partly sticking and count with less.
    assert!((friction / FRICTION - 1.0).abs() < 0.05, "{friction}");
    assert!(contact.sliding > Some(0.5));
    estimator.restart();
    let contact = estimator.estimate(&forces(&layout, &mindlin(6.0 * SPACING, 0.9)));
    assert_eq!(contact.and_then(|contact| contact.friction), None);
}

#[test]
fn pressing_harder_gives_no_estimate_of_friction() {
    let layout = grid();
    let mut estimator = ContactEstimator::new(layout.elements(), 0.01);
    let pressure = hertz(DVec2::ZERO, [6.0 * SPACING; 2], DVec2::X);
    // The ratio of shear to compression is below friction and constant, so nothing slides.
    let loaded = forces(&layout, &move |place| {
        DVec3::new(0.3, 0.0, 1.0) * pressure(place)
    });
    for step in 1..=40 {
        let scale = f64::from(step) / 40.0;
        let forces: Vec<_> = loaded.iter().map(|&force| scale * force).collect();
        let contact = estimator.estimate(&forces);
        assert_eq!(contact.and_then(|contact| contact.friction), None);
    }
}

#[test]
fn stated_errors_contain_the_true_centre_and_radius_of_noisy_contacts() {
    let layout = grid();
    let mut random = Pcg64::seed_from_u64(11);
    // A third of the threshold, as documented; the mean force on a touching element is ten times as large.
    let noise = 0.05;
    let normal = |random: &mut Pcg64| (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>();
    let (mut tried, mut centres, mut radii) = (0.0, 0.0, 0.0);
    for _ in 0..200 {
        let centre = SPACING
            * DVec2::new(
                random.random_range(-1.0..1.0),
                random.random_range(-1.0..1.0),
            );
        let radius = random.random_range(2.0..4.0) * SPACING;
        let pressure = hertz(centre, [radius, radius], DVec2::X);
        let mut forces = forces(&layout, &move |place| DVec3::new(0.0, 0.0, pressure(place)));
        for force in &mut forces {
            *force += noise
                * DVec3::new(
                    normal(&mut random),
                    normal(&mut random),
                    normal(&mut random),
                );
        }
        let contact = estimate(&layout, &forces, 3.0 * noise);
        let ellipse = contact.ellipse.expect("the grid resolves the extent");
        for axis in 0..2 {
            tried += 1.0;
            let off = (contact.centre.yz() - centre).to_array()[axis].abs();
            centres += f64::from(off < 2.0 * contact.centre_error);
            let off = (ellipse.semi_axes[axis] - radius).abs();
            radii += f64::from(off < 2.0 * ellipse.errors[axis]);
        }
    }
    assert!(
        centres / tried >= 0.95 && radii / tried >= 0.9,
        "{} {}",
        centres / tried,
        radii / tried
    );
}

#[test]
fn a_press_on_the_dome_is_on_its_surface_along_the_pressing_direction() {
    let layout = ElementLayout::new(&LayoutConfig::default());
    let mut estimator = ContactEstimator::new(layout.places(), 0.01);
    let direction = DVec3::new(1.0, 0.3, -0.2).normalize();
    // Compression falls off with the angle to the direction, which is symmetric about it.
    let forces: Vec<_> = layout
        .elements
        .iter()
        .map(|element| DVec3::new(0.0, 0.0, (element.normal().dot(direction) - 0.8).max(0.0)))
        .collect();
    let contact = estimator.estimate(&forces).expect("a contact");
    assert!((contact.centre.length() - layout.dome_radius).abs() < 1e-12);
    // The elements are 7 mm apart and the mean over few of them is biased: half a spacing is the worst.
    assert!((contact.centre / layout.dome_radius).angle_between(direction) < 0.1);
    assert!(
        (contact.centre - layout.dome_radius * direction).length() < 3.0 * contact.centre_error
    );
    assert!(contact.normal.angle_between(direction) < 0.1);
}

#[test]
fn nothing_touches_without_compression_or_valid_forces() {
    let layout = ElementLayout::new(&LayoutConfig::default());
    let mut estimator = ContactEstimator::new(layout.places(), 0.1);
    let mut forces = vec![DVec3::new(5.0, 5.0, 0.09); layout.elements.len()];
    assert_eq!(estimator.estimate(&forces), None);
    forces.fill(NO_FORCE);
    assert_eq!(estimator.estimate(&forces), None);
    forces.fill(DVec3::new(0.0, 0.0, f64::INFINITY));
    assert_eq!(estimator.estimate(&forces), None);
    // Two elements have a centre between them, but no extent.
    forces.fill(NO_FORCE);
    (forces[1], forces[2]) = (DVec3::Z, DVec3::Z);
    let contact = estimator.estimate(&forces).expect("two elements touch");
    assert_eq!(
        (contact.touching, contact.ellipse, contact.sliding),
        (2, None, None)
    );
}

#[test]
fn separate_contacts_both_count_and_pulled_elements_do_not() {
    let layout = grid();
    let mut forces = vec![DVec3::ZERO; SIDE * SIDE];
    // Two places 10 mm apart.
    let (one, other) = (SIDE + 2, SIDE + 12);
    (forces[one].z, forces[other].z) = (2.0, 1.9);
    let contact = estimate(&layout, &forces, 0.1);
    assert_eq!((contact.touching, contact.force.x), (2, -3.9));
    forces[one + 1].z = -1.9;
    let contact = estimate(&layout, &forces, 0.1);
    assert_eq!((contact.touching, contact.force.x), (2, -3.9));
    // An element with little more than the threshold is noise.
    forces[7 * SIDE + 7].z = 0.15;
    assert_eq!(estimate(&layout, &forces, 0.1).touching, 2);
}

#[test]
fn elements_on_a_line_and_opposite_ones_have_no_extent() {
    let layout = grid();
    let mut forces = vec![DVec3::ZERO; SIDE * SIDE];
    forces[..5].fill(DVec3::Z);
    assert_eq!(estimate(&layout, &forces, 0.1).ellipse, None);
    let places = [DVec3::X, DVec3::NEG_X, DVec3::new(-0.9, 0.2, 0.0)]
        .map(|outward| (SensingElement::facing(outward.normalize()), 0.005 * outward));
    let mut estimator = ContactEstimator::new(places, 0.1).with_friction(FRICTION);
    let contact = estimator.estimate(&[DVec3::Z, 0.6 * DVec3::Z, 0.6 * DVec3::Z]);
    let contact = contact.expect("the forces do not cancel");
    assert_eq!((contact.ellipse, contact.sliding), (None, Some(0.0)));
    assert!(contact.centre.length() < 0.02);
}

#[test]
fn another_contact_is_not_compared_with_the_last() {
    let layout = grid();
    let mut estimator = ContactEstimator::new(layout.elements(), 0.01);
    let traction = |part| forces(&layout, &mindlin(6.0 * SPACING, part));
    estimator.estimate(&traction(0.0));
    assert_eq!(estimator.estimate(&vec![DVec3::ZERO; SIDE * SIDE]), None);
    // Sliding elements that were touched before with the same forces would look still.
    let contact = estimator.estimate(&traction(0.5)).expect("a contact");
    assert_eq!(contact.friction, None);
}

#[test]
fn noise_does_not_slide() {
    let layout = grid();
    let mut random = Pcg64::seed_from_u64(3);
    let noise = 0.05;
    let pressure = hertz(DVec2::ZERO, [4.0 * SPACING; 2], DVec2::X);
    let loaded = forces(&layout, &move |place| DVec3::new(0.0, 0.0, pressure(place)));
    let mut estimator =
        ContactEstimator::new(layout.elements(), 3.0 * noise).with_friction(FRICTION);
    for _ in 0..100 {
        let mut axis = || noise * (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>();
        let noisy: Vec<_> = loaded
            .iter()
            .map(|&f| f + DVec3::new(axis(), axis(), axis()))
            .collect();
        let contact = estimator.estimate(&noisy).expect("a contact");
        // At nine standard errors of compression, a ratio of 0.57 needs five of shear.
        assert_eq!(contact.sliding, Some(0.0));
    }
}
