//! Slip detectors for grasps: what they detect and ignore, and that no input corrupts their state.

use assert_no_alloc::assert_no_alloc;
use feeler::control::grasp_slip::{
    Contact, ContactLoss, ContactLossConfig, GraspDrag, GraspDragConfig, GraspSlipError, Picture,
    RegularPattern, noise_of,
};
use glam::{DMat2, DVec2, DVec3};
use proptest::prelude::*;

/// Columns, rows and spacing (px) of the pattern, and its image.
const COLUMNS: usize = 8;
const ROWS: usize = 6;
const SPACING: f64 = 36.0;
const SIZE: (usize, usize) = (320, 240);

fn picture() -> Picture {
    Picture::of_size(SIZE.0, SIZE.1)
}

/// The untouched pattern in the image's middle (px).
fn grid() -> Vec<DVec2> {
    let at = |i: usize| {
        let index = DVec2::new((i % COLUMNS) as f64, (i / COLUMNS) as f64);
        let middle = DVec2::new(COLUMNS as f64 - 1.0, ROWS as f64 - 1.0) / 2.0;
        picture().centre + SPACING * (index - middle)
    };
    (0..COLUMNS * ROWS).map(at).collect()
}

/// Moves, turns and stretches `places` about the image's middle.
fn moved(places: &[DVec2], matrix: DMat2, by: DVec2) -> Vec<DVec2> {
    let centre = picture().centre;
    let places = places.iter();
    places
        .map(|p| centre + matrix * (*p - centre) + by)
        .collect()
}

/// Distorts `places` like a lens with radial distortion k, perspective p and decentring d, relative to half the
/// width.
fn through_lens(places: &[DVec2], k: f64, p: DVec2, d: DVec2) -> Vec<DVec2> {
    let Picture { centre, half_width } = picture();
    let seen = |place: &DVec2| {
        let q = (*place - centre) / half_width;
        let square = q.length_squared();
        let decentred = square * d + 2.0 * q * q.dot(d);
        centre + half_width * (q + k * square * q + p.dot(q) * q + decentred)
    };
    places.iter().map(seen).collect()
}

/// Filtered load of `now`, on the pattern found in `first`.
fn load(first: &[DVec2], now: &[DVec2]) -> f64 {
    let mut loss =
        ContactLoss::on_pattern(first, Some(picture()), ContactLossConfig::default()).unwrap();
    loss.update(0.04, now.iter().copied());
    loss.load().unwrap()
}

fn vector(size: f64) -> impl Strategy<Value = DVec2> {
    [-size..size, -size..size].prop_map(DVec2::from_array)
}

/// Rotation, scale and shear under which neighbours of the grid remain identifiable.
fn matrix() -> impl Strategy<Value = DMat2> {
    (-3.0..3.0_f64, 0.7..1.4_f64, vector(0.1)).prop_map(|(turn, size, shear)| {
        let stretched = DMat2::from_cols(DVec2::new(1.0, shear.x), DVec2::new(shear.y, 1.0));
        DMat2::from_scale_angle(DVec2::splat(size), turn) * stretched
    })
}

proptest! {
    /// Rounding: squares of some ten spacings cancel to 1e-16 of a few thousand, and the square root is taken.
    #[test]
    fn an_affine_motion_of_the_pattern_is_not_a_load(
        (at_first, later) in (matrix(), matrix()),
        (by, then_by) in (vector(40.0), vector(40.0)),
    ) {
        let (first, now) = (moved(&grid(), at_first, by), moved(&grid(), later, then_by));
        prop_assert!(load(&first, &now) < 1e-6);
    }

    /// Distortion modes are evaluated on the best-fitting plane, which the lens moves by a tenth of its distortion. A
    /// hundredth remains: below 0.002 spacings, a ninth of the threshold.
    #[test]
    fn lens_distortion_is_not_a_load(
        k in -0.06..0.06_f64,
        p in vector(0.03),
        d in vector(0.01),
        (turn, by) in (-0.1..0.1_f64, vector(15.0)),
    ) {
        let seen = through_lens(&moved(&grid(), DMat2::from_angle(turn), by), k, p, d);
        let load = load(&seen, &seen);
        prop_assert!(load < 0.002, "{load}");
    }

    /// The eleven smooth distortion modes explain less than three quarters of the square of a bump that is one
    /// spacing wide.
    #[test]
    fn a_local_deformation_is_a_load(
        (x, y) in (1.5..5.5_f64, 1.5..3.5_f64),
        (size, angle) in (0.05..0.4_f64, 0.0..6.3_f64),
        k in -0.06..0.06_f64,
    ) {
        let untouched = through_lens(&grid(), k, DVec2::ZERO, DVec2::ZERO);
        let middle = grid()[0] + SPACING * DVec2::new(x, y);
        let bump = |place: &DVec2| size * (-(*place - middle).length_squared() / (2.0 * SPACING * SPACING)).exp();
        let bumps: Vec<f64> = grid().iter().map(bump).collect();
        let touched = untouched.iter().zip(&bumps);
        let touched: Vec<_> = touched.map(|(p, b)| *p + SPACING * *b * DVec2::from_angle(angle)).collect();
        let rms = (bumps.iter().map(|b| b * b).sum::<f64>() / bumps.len() as f64).sqrt();
        for first in [&untouched, &touched] {
            let load = load(first, &touched);
            prop_assert!((0.5 * rms..1.01 * rms + 0.002).contains(&load), "{load} of {rms}");
        }
    }

    #[test]
    fn load_is_independent_of_scale(size in 0.01..100.0_f64, push in vector(10.0)) {
        let mut touched = grid();
        touched[19] += push;
        let larger = |places: &[DVec2]| -> Vec<_> { places.iter().map(|p| size * *p).collect() };
        let of = |places: &[DVec2], now: &[DVec2]| {
            let mut loss = ContactLoss::on_pattern(places, None, ContactLossConfig::default()).unwrap();
            loss.update(0.01, now.iter().copied());
            loss.load().unwrap()
        };
        let (own, other) = (of(&grid(), &touched), of(&larger(&grid()), &larger(&touched)));
        prop_assert!((own - other).abs() < 1e-9 * (1.0 + own));
    }

    /// Like a pattern without the missing elements, except for the correction of its degrees of freedom.
    #[test]
    fn missing_elements_are_ignored(
        missing in proptest::collection::hash_set(0..COLUMNS * ROWS, 0..12),
        pushes in proptest::collection::vec(vector(6.0), COLUMNS * ROWS),
    ) {
        let gone = |places: Vec<DVec2>| -> Vec<_> {
            let places = places.into_iter().enumerate();
            places.map(|(i, p)| if missing.contains(&i) { DVec2::NAN } else { p }).collect()
        };
        let pushed = gone(grid().iter().zip(&pushes).map(|(p, push)| *p + *push).collect());
        // Missing elements may make others unreachable.
        let Ok(left) = RegularPattern::of(&gone(grid())) else { return Ok(()) };
        prop_assume!(left.indices().iter().flatten().count() == COLUMNS * ROWS - missing.len());
        let freedom = |n: usize| 1.0 - 11.0 / (2 * n) as f64;
        let made_up = freedom(COLUMNS * ROWS) / freedom(COLUMNS * ROWS - missing.len());
        let (masked, without) = (load(&grid(), &pushed), load(&gone(grid()), &pushed));
        prop_assert!((masked - without * made_up.sqrt()).abs() < 1e-9, "{masked} {without}");
    }

    /// After any stamps and vectors, twenty seconds of valid frames restore the filters.
    #[test]
    fn filters_recover_from_any_input(
        bad in proptest::collection::vec((interval(), number(), number()), 0..40),
    ) {
        let mut loss = ContactLoss::from_untouched(3, 1.0, ContactLossConfig::default()).unwrap();
        let mut pattern = ContactLoss::on_pattern(&grid(), None, ContactLossConfig::default()).unwrap();
        let mut drag = GraspDrag::new(3, 1.0, GraspDragConfig::default()).unwrap();
        for (interval, x, y) in bad {
            let vectors = [DVec2::new(x, y), DVec2::new(y, 0.1), DVec2::splat(0.1)];
            assert_no_alloc(|| {
                loss.update(interval, vectors);
                drag.update(interval, vectors.map(|vector| vector.extend(y)));
                pattern.update(interval, grid_like(DVec2::new(x, y)));
            });
            for number in [loss.load(), pattern.load(), drag.drag()].into_iter().flatten() {
                prop_assert!(number.is_finite() && number >= 0.0);
            }
        }
        for _ in 0..1000 {
            loss.update(0.02, [DVec2::X; 3]);
            pattern.update(0.02, grid_like(DVec2::ZERO));
            drag.update(0.02, [DVec3::X; 3]);
        }
        // exp(-20 / 0.5) of at most 1e6 for the load, and exp(-20 / 1) of it for the drag.
        prop_assert!((loss.load().unwrap() - 1.0).abs() < 1e-9);
        prop_assert!(pattern.load().unwrap() < 1e-9);
        prop_assert!(drag.drag().unwrap() < 1.0, "{:?}", drag.drag());
    }

    #[test]
    fn places_never_panic(places in proptest::collection::vec([number(), number()], 0..60)) {
        let places: Vec<_> = places.into_iter().map(DVec2::from_array).collect();
        let _ = ContactLoss::on_pattern(&places, None, ContactLossConfig::default());
    }
}

/// The grid with its first element displaced by `push`, as an iterator that does not allocate.
fn grid_like(push: DVec2) -> impl Iterator<Item = DVec2> {
    (0..COLUMNS * ROWS).map(move |i| {
        let index = DVec2::new((i % COLUMNS) as f64, (i / COLUMNS) as f64);
        let push = if i == 0 { push } else { DVec2::ZERO };
        SPACING * index + push
    })
}

fn number() -> impl Strategy<Value = f64> {
    prop_oneof![6 => -2.0..2.0, 1 => any::<f64>(), 1 => Just(f64::NAN), 1 => Just(1e300)]
}

fn interval() -> impl Strategy<Value = f64> {
    prop_oneof![4 => 0.001..0.1, 1 => any::<f64>(), 1 => Just(0.0), 1 => Just(-3.0), 1 => Just(1e9), 1 => Just(f64::NAN)]
}

#[test]
fn hexagonal_offset_and_narrow_grids_are_found() {
    for (second, aspect) in [(0.5, 0.75_f64.sqrt()), (0.3, 1.0), (0.0, 1.3)] {
        let at = |i: usize| {
            let (column, row) = ((i % 7) as f64, (i / 7) as f64);
            SPACING * DVec2::new(column + second * row, aspect * row)
        };
        let places: Vec<_> = (0..42).map(at).collect();
        let pattern = RegularPattern::of(&places).unwrap();
        assert_eq!(
            pattern.indices().iter().flatten().count(),
            42,
            "{second} {aspect}"
        );
        assert!(load(&places, &places) < 1e-9);
    }
}

#[test]
fn irregular_patterns_are_rejected() {
    let of = |places: &[DVec2]| ContactLoss::on_pattern(places, None, ContactLossConfig::default());
    // Rings, as on the paper's fingertip.
    let ring = |n: usize, r: f64| {
        (0..n).map(move |i| r * DVec2::from_angle(std::f64::consts::TAU * i as f64 / n as f64))
    };
    let rings: Vec<_> = ring(1, 0.0)
        .chain(ring(8, 50.0))
        .chain(ring(12, 100.0))
        .chain(ring(20, 150.0))
        .collect();
    let refused = of(&rings).unwrap_err();
    assert!(
        matches!(refused, GraspSlipError::NotAGrid { elements: 41, .. }),
        "{refused}"
    );
    let scattered: Vec<_> = (0..60_u32)
        .map(|i| {
            // Halton points: evenly distributed without a regular pattern.
            let radical = |base: u32| {
                (0..6)
                    .fold((i + 1, 1.0 / f64::from(base), 0.0), |(n, part, sum), _| {
                        (
                            n / base,
                            part / f64::from(base),
                            sum + part * f64::from(n % base),
                        )
                    })
                    .2
            };
            300.0 * DVec2::new(radical(2), radical(3))
        })
        .collect();
    let refused = of(&scattered).unwrap_err();
    assert!(
        matches!(refused, GraspSlipError::NotAGrid { .. }),
        "{refused}"
    );
    assert_eq!(
        of(&grid()[..11]).unwrap_err(),
        GraspSlipError::TooFew { actual: 11 }
    );
    let line: Vec<_> = (0..20).map(|i| DVec2::new(f64::from(i), 0.0)).collect();
    assert!(of(&line).is_err());
    let two_rows: Vec<_> = grid()[..2 * COLUMNS].to_vec();
    let refused = of(&two_rows).unwrap_err();
    assert!(
        matches!(refused, GraspSlipError::TooNarrow { .. }),
        "{refused}"
    );
    let same = [DVec2::ONE; 40];
    assert!(of(&same).is_err());
    let config = ContactLossConfig {
        time_constant: 0.0,
        ..ContactLossConfig::default()
    };
    let refused = ContactLoss::from_untouched(3, -1.0, config)
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("scale = -1") && refused.contains("time_constant = 0"),
        "{refused}"
    );
    assert!(GraspDrag::new(3, f64::NAN, GraspDragConfig::default()).is_err());
}

#[test]
fn contact_is_held_until_the_load_vanishes_and_unknown_without_reference() {
    let config = ContactLossConfig {
        time_constant: 0.01,
        threshold: 0.1,
    };
    let mut loss = ContactLoss::from_untouched(2, 1.0, config).unwrap();
    assert_eq!(
        (loss.contact(), loss.load(), loss.score()),
        (Contact::Unknown, None, None)
    );
    let mut felt = |load: f64| {
        (0..50)
            .map(|_| loss.update(0.01, [DVec2::X * load; 2]))
            .last()
    };
    assert_eq!(felt(0.12), Some(Contact::Untouched));
    assert_eq!(felt(0.2), Some(Contact::Held));
    assert_eq!(felt(0.12), Some(Contact::Held));
    assert_eq!(felt(0.08), Some(Contact::Lost));
    assert_eq!(felt(0.12), Some(Contact::Lost));
    assert_eq!(felt(0.2), Some(Contact::Held));
    assert!((loss.score().unwrap() + 0.2_f64.ln()).abs() < 1e-9);
    // With too few valid elements, the state does not change.
    let mut three = ContactLoss::from_untouched(3, 1.0, config).unwrap();
    assert_eq!(
        three.update(0.01, [DVec2::NAN, DVec2::NAN, DVec2::X]),
        Contact::Unknown
    );
    loss.restart();
    assert_eq!(loss.contact(), Contact::Unknown);
    let mut unknown = ContactLoss::without_reference();
    assert_eq!(unknown.update(0.01, [DVec2::X]), Contact::Unknown);
    assert_eq!(unknown.score(), None);
}

/// Response to a step of u = 1 with both filters in continuous time: D = s / (s - f) (exp(-t / s) - exp(-t / f)).
/// Frames of 1 ms delay it by about one frame, 2 % of the fast time constant.
#[test]
fn drag_has_the_step_response_of_its_two_filters() {
    let GraspDragConfig { fast, slow } = GraspDragConfig::default();
    let mut drag = GraspDrag::new(4, 0.5, GraspDragConfig::default()).unwrap();
    drag.update(0.0, [DVec3::ZERO; 4]);
    for frame in 1..=3000 {
        let t = f64::from(frame) * 1e-3;
        // The invalid element is ignored.
        let (shear, press) = (DVec3::new(0.3, 0.4, 0.0), DVec3::new(0.0, 0.0, 0.5));
        let found = drag
            .update(1e-3, [shear, press, DVec3::NAN, shear])
            .unwrap();
        let expected = slow / (slow - fast) * ((-t / slow).exp() - (-t / fast).exp());
        assert!(
            (found - expected).abs() < 0.02,
            "{t} s: {found}, not {expected}"
        );
    }
}

#[test]
fn a_returning_element_has_the_state_of_the_elapsed_time() {
    let run = |missing: bool| {
        let mut drag = GraspDrag::new(2, 1.0, GraspDragConfig::default()).unwrap();
        for frame in 0..400 {
            // It moves while it is invalid and then rests at another place.
            let second = if frame < 100 { DVec3::ZERO } else { DVec3::X };
            let seen = if missing && (100..300).contains(&frame) {
                DVec3::NAN
            } else {
                second
            };
            drag.update(0.01, [DVec3::ZERO, seen]);
        }
        drag.drag().unwrap()
    };
    let (seen, missed) = (run(false), run(true));
    // After three seconds, a twentieth of the step is left in the slow mean of the element that was always valid.
    assert!(seen < 0.1 && missed < 0.25, "{seen} {missed}");
}

#[test]
fn noise_estimates_are_robust_against_jumps() {
    use rand::SeedableRng;
    use rand_distr::{Distribution, Normal};
    let mut random = rand_pcg::Pcg64::seed_from_u64(1);
    let normal = Normal::new(0.0, 2.0_f64.sqrt() * 3.0).unwrap();
    let mut changes: Vec<f64> = (0..10_000).map(|_| normal.sample(&mut random)).collect();
    changes.extend([1e6; 300]);
    changes.extend([f64::NAN; 300]);
    // The median's standard error is 1.6 %, and 300 jumps shift it by 2.5 %.
    let noise = noise_of(&mut changes).unwrap();
    assert!((noise - 3.0).abs() < 0.15, "{noise}");
    assert_eq!((noise_of(&mut []), noise_of(&mut [0.0; 5])), (None, None));
    assert_eq!(noise_of(&mut [f64::NAN]), None);
}
