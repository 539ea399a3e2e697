use super::*;
use crate::sensor::calibration::fit::{ElementRecord, ModelChoice, fit};
use crate::sensor::calibration::live::ForceAxes;
use crate::sensor::calibration::load_range::ELEMENT_RANGE;
use crate::sensor::calibration::loads::RecordBuilder;
use crate::sensor::calibration::{CalibrationTarget, FullScale, LengthUnit};
use glam::DVec2;
use proptest::prelude::*;

const ELEMENTS: usize = 3;
const PICTURES: usize = 60;
const HALF: usize = PICTURES / 2;

/// Uniform pseudo-random numbers from -1 to 1.
fn noise(number: usize) -> f64 {
    let mut state = (number as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    state = (state ^ (state >> 31)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    ((state >> 11) as f64) / ((1_u64 << 52) as f64) - 1.0
}

/// Load on an element in an image, N; zero in every sixth image.
fn load(picture: usize, element: usize) -> DVec3 {
    let [x, y, z] = [0, 1, 2].map(|axis| noise(97 * (9 * picture + 3 * element + axis)));
    match picture % 6 {
        0 => DVec3::ZERO,
        _ => DVec3::new(0.5 * x, 0.5 * y, 1.0 + z),
    }
}

/// Moments of an element that grows by half and moves by one pixel per newton, with a little noise.
fn moments(picture: usize, element: usize) -> ElementMoments {
    let force = load(picture, element);
    let noise = |number: usize| 0.01 * noise(7 * (picture * ELEMENTS + element) + number + 100_000);
    ElementMoments {
        integrated_gray: 1000.0 * (1.0 + 0.5 * force.z + noise(0)),
        centroid: DVec2::new(50.0 + force.x + noise(1), 40.0 + force.y + noise(2)),
    }
}

/// All images, with forces that `table` computes from the image, the element and its load.
fn taken(table: impl Fn(usize, usize, DVec3) -> DVec3) -> RecordBuilder {
    let mut builder = RecordBuilder::new(ELEMENTS);
    for picture in 0..PICTURES {
        let forces = [0, 1, 2].map(|element| Some(table(picture, element, load(picture, element))));
        builder.add(&forces, &[0, 1, 2].map(|element| moments(picture, element)));
    }
    builder
}

fn all_checks(taken: &RecordBuilder) -> Result<(), LoadCheckError> {
    check_numbers(taken.pictures())?;
    check_axes_of_recordings(taken.pictures(), names().iter().map(String::as_str))?;
    check_unloaded(taken.pictures(), names().iter().map(String::as_str))
}

/// Image names of two consecutive recordings.
fn names() -> Vec<String> {
    (0..PICTURES)
        .map(|picture| format!("{}/{picture}.png", ["a", "b"][picture / HALF]))
        .collect()
}

/// Detects every permutation and sign of axes, and returns the axes that convert them.
#[test]
fn detects_every_permutation_and_sign_of_axes() {
    let mut count = 0;
    for order in ["x,y,z", "y,x,z", "z,y,x", "x,z,y", "y,z,x", "z,x,y"] {
        for signs in 0..8 {
            let axis = |(index, axis): (usize, &str)| {
                if signs >> index & 1 == 1 {
                    format!("-{axis}")
                } else {
                    axis.into()
                }
            };
            let name = order
                .split(',')
                .enumerate()
                .map(axis)
                .collect::<Vec<_>>()
                .join(",");
            let axes: ForceAxes = name.parse().unwrap();
            let taken = taken(|_, _, force| axes.to_fingertip(force));
            match check_axes(&taken.records()) {
                Ok(()) => assert_eq!(name, "x,y,z"),
                Err(LoadCheckError::Axes {
                    contradicted,
                    judged,
                    first,
                    axes: Some(seen),
                    ..
                }) => {
                    assert_eq!((contradicted, judged, first), (ELEMENTS, ELEMENTS, 0));
                    assert_eq!(seen.after(axes), ForceAxes::default(), "{name}");
                    count += 1;
                }
                Err(error) => panic!("{name}: {error}"),
            }
        }
    }
    assert_eq!(count, 47);
}

#[test]
fn names_the_likely_cause() {
    for (axes, words) in [
        (
            "x,y,-z",
            "grow where f_z is negative; expected compression, which is positive when pressed: does z point out",
        ),
        (
            "-x,-y,-z",
            "grow where f_z is negative, and move against f_x and f_y; expected forces on the finger: do these act on the object?",
        ),
        (
            "x,-y,z",
            "move against f_y; expected x and y as in the layout: is an axis mirrored",
        ),
        (
            "-x,y,-z",
            "move against f_x, and grow where f_z is negative",
        ),
        (
            "y,x,z",
            "follow f_y, f_x and f_z; expected f_x, f_y and f_z: are axes exchanged?",
        ),
        ("-z,y,x", "follow f_z, f_y and -f_x"),
    ] {
        let axes: ForceAxes = axes.parse().unwrap();
        let error =
            check_axes(&taken(|_, _, force| axes.to_fingertip(force)).records()).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
    // A sensor that dims under compression, or inverted images.
    let mut records = taken(|_, _, force| force).records();
    for sample in records.iter_mut().flat_map(|record| &mut record.fitted) {
        sample.moments.integrated_gray = 2000.0 - sample.moments.integrated_gray;
    }
    let error = check_axes(&records).unwrap_err().to_string();
    assert!(error.contains("shrink where f_z is positive"), "{error}");
}

#[test]
fn detects_a_single_element_in_other_axes() {
    let turned = |_, element, force: DVec3| {
        if element == 1 {
            DVec3::new(-force.y, force.x, force.z)
        } else {
            force
        }
    };
    let error = check_axes(&taken(turned).records()).unwrap_err();
    assert!(
        matches!(
            error,
            LoadCheckError::Axes {
                contradicted: 1,
                first: 1,
                axes: None,
                ..
            }
        ),
        "{error}"
    );
    assert!(error.to_string().contains("x_angle"), "{error}");
}

/// All loads together determine no axes in this case.
#[test]
fn detects_axes_exchanged_in_one_recording() {
    assert_eq!(all_checks(&taken(|_, _, force| force)), Ok(()));
    let exchanged = taken(|picture, _, force| match picture >= HALF {
        true => DVec3::new(force.y, force.x, force.z),
        false => force,
    });
    let error = all_checks(&exchanged).unwrap_err();
    assert!(
        matches!(&error, LoadCheckError::Axes { recording: Some(name), axes: None, .. } if name == "b"),
        "{error}"
    );
    let words = "recording \"b\": in 3 of 3 elements, the first of them 0, the images contradict the loads: the displacement of the \
                 spots along x and y and their growth follow f_y, f_x and f_z";
    assert!(error.to_string().starts_with(words), "{error}");
}

/// A misplaced decimal point or a wrong sign in one of 150 loads, for each model.
#[test]
fn detects_a_mistyped_load() {
    let made_for = CalibrationTarget::layout("a few elements", ELEMENTS, LengthUnit::Pixel);
    let checked = |model, table: &dyn Fn(usize, usize, DVec3) -> DVec3| {
        let taken = taken(table);
        let records = taken.records();
        let full_scale = FullScale::of_loads(&records);
        let calibration = fit(made_for.clone(), &records, model, full_scale).unwrap();
        let names = names();
        check_outliers(
            &calibration,
            taken.pictures(),
            names.iter().map(String::as_str),
        )
    };
    for model in [ModelChoice::Separable, ModelChoice::Coupled] {
        assert_eq!(checked(model, &|_, _, force| force), Ok(None));
        for (axis, factor) in [(2, 10.0), (2, 0.1), (0, -1.0), (1, 100.0)] {
            let element = 1;
            let is_large = |&p: &usize| {
                load(p, element)
                    .abs()
                    .cmpgt(DVec3::new(0.25, 0.2, 1.2))
                    .all()
            };
            let large = (0..PICTURES).find(is_large).unwrap();
            let own = load(large, element)[axis];
            let checked = checked(model, &|p, e, mut force| {
                if (p, e) == (large, element) {
                    force[axis] *= factor;
                }
                force
            });
            let is_refused = checked.is_err();
            // Only a load that exceeds all others is rejected.
            assert_eq!(is_refused, factor >= 10.0);
            let (Err(found) | Ok(Some(found))) = checked else {
                panic!("{model:?}, axis {axis} times {factor}: {checked:?}");
            };
            let LoadCheckError::Outlier {
                picture,
                element,
                column,
                given,
                predicted,
                ..
            } = found
            else {
                panic!("{found}");
            };
            assert_eq!(
                (&picture, element, column),
                (&names()[large], 1, COLUMNS[axis])
            );
            assert_eq!(given, factor * own);
            assert!((predicted - own).abs() < 0.1, "{predicted}, {own}");
        }
    }
}

#[test]
fn detects_exchanged_elements() {
    let taken = taken(|picture, element, _| load(picture, [0, 2, 1][element]));
    let error = check_numbers(taken.pictures()).unwrap_err();
    assert!(
        matches!(
            error,
            LoadCheckError::Number {
                element: 1,
                shown: 2,
                ..
            }
        ),
        "{error}"
    );
}

#[test]
fn accepts_loads_that_determine_nothing() {
    // Few loads; collinear loads; loads unrelated to the images.
    let mut few = RecordBuilder::new(ELEMENTS);
    let turned = taken(|_, _, force| -force);
    for picture in &turned.pictures()[..7] {
        few.add(&picture.forces, &picture.moments);
    }
    assert_eq!(all_checks(&few), Ok(()));
    let line = taken(|_, _, force| DVec3::new(-0.3, 0.2, 1.0) * force.z);
    assert_eq!(check_axes(&line.records()), Ok(()));
    let unrelated = taken(|picture, element, _| load(picture + 1000, element));
    assert_eq!(check_axes(&unrelated.records()), Ok(()));
    assert_eq!(check_numbers(unrelated.pictures()), Ok(()));
    assert_eq!(all_checks(&RecordBuilder::new(0)), Ok(()));
    assert_eq!(check_axes(&[ElementRecord::default()]), Ok(()));
}

#[test]
fn magnitudes_have_a_range() {
    let check = |force: f64| {
        check_magnitude(
            "an element",
            [DVec3::Z, force * DVec3::X].into_iter().skip(1),
            ELEMENT_RANGE,
        )
    };
    assert!(check(0.0).is_ok() && check(0.02).is_ok() && check(19.0).is_ok());
    let error = check(1234.567).unwrap_err().to_string();
    assert_eq!(
        error,
        "the largest load on an element is 1230 N; expected 0.01 to 20 N, as soft silicone bears about 1 N/mm²: are these mN?"
    );
    assert!(
        check(0.002)
            .unwrap_err()
            .to_string()
            .ends_with("are these kN?")
    );
}

/// Either the forces or the images of recording b have an offset.
#[test]
fn zeros_of_recordings_are_compared() {
    let made_for = CalibrationTarget::layout("a few elements", ELEMENTS, LengthUnit::Pixel);
    let offsets = |offset: DVec3| {
        let taken = taken(|picture, _, force| {
            if picture >= HALF {
                force + offset
            } else {
                force
            }
        });
        let calibration = fit(
            made_for.clone(),
            &taken.records(),
            ModelChoice::Separable,
            FullScale::default(),
        )
        .unwrap();
        check_offsets(
            &calibration,
            taken.pictures(),
            names().iter().map(String::as_str),
        )
    };
    assert_eq!(offsets(DVec3::ZERO), Ok(()));
    match offsets(DVec3::new(0.0, -0.2, 0.0)).unwrap_err() {
        LoadCheckError::Offset {
            column,
            one,
            other,
            offset,
            ..
        } => {
            assert_eq!((column, &*one, &*other), ("f_y", "a", "b"));
            assert!((offset - 0.2).abs() < 0.02, "{offset}");
        }
        error => panic!("{error}"),
    }
    let shifted = |shift: f64| {
        let mut builder = RecordBuilder::new(ELEMENTS);
        for (number, picture) in taken(|_, _, force| force).pictures().iter().enumerate() {
            let mut moments = picture.moments.clone();
            moments
                .iter_mut()
                .for_each(|m| m.centroid.x += shift * (number / HALF) as f64);
            builder.add(&picture.forces, &moments);
        }
        check_unloaded(builder.pictures(), names().iter().map(String::as_str))
    };
    // A shift of 0.3 px in a range of 1 px under load, which the shift itself widens by up to 0.3 px, with noise of a
    // few hundredths.
    assert_eq!(shifted(0.05), Ok(()));
    assert!(
        matches!(shifted(0.3), Err(LoadCheckError::Unloaded { percent, .. }) if (22.0..31.0).contains(&percent))
    );
}

proptest! {
    /// The checks terminate for arbitrary numbers.
    #[test]
    fn any_numbers_are_checked(numbers in proptest::collection::vec(proptest::array::uniform6(any::<f64>()), 0..40)) {
        let mut builder = RecordBuilder::new(1);
        for [x, y, z, gray, column, row] in numbers {
            let moments = ElementMoments { integrated_gray: gray, centroid: DVec2::new(column, row) };
            builder.add(&[Some(DVec3::new(x, y, z))], &[moments]);
            builder.add(&[Some(DVec3::ZERO)], &[moments]);
        }
        let _ = all_checks(&builder);
    }
}
