//! Loads that do not determine a calibration are rejected with messages.

use super::element::{fitted, inputs, made_for, moments, places, record};
use feeler::sensor::calibration::{
    ElementRecord, FullScale, ModelChoice, RecordBuilder, RelativeMoments, fit,
};
use glam::DVec3;

fn good() -> ElementRecord {
    record(&places(20, 1), |i| {
        DVec3::new(i.displacement.x, i.displacement.y, i.growth)
    })
}

/// Error message for two records if `change` is applied to the second.
fn refused(choice: ModelChoice, change: impl Fn(&mut ElementRecord)) -> String {
    let mut records = [good(), good()];
    assert!(fitted(&records, choice).is_ok());
    change(&mut records[1]);
    fitted(&records, choice).expect_err("refused").to_string()
}

#[test]
fn unusable_records_are_rejected() {
    type Change = fn(&mut ElementRecord);
    let cases: [(Change, &str); 9] = [
        (|r| r.unloaded.clear(), "expected at least 1 unloaded image"),
        (|r| r.unloaded[0].integrated_gray = 0.0, "lit without load"),
        (
            |r| r.unloaded[0].integrated_gray = f64::INFINITY,
            "lit without load",
        ),
        (|r| r.unloaded[0].centroid.x = f64::NAN, "lit without load"),
        (|r| r.fitted.clear(), "expected loads, got none"),
        (|r| r.fitted[4].force.y = f64::NAN, "finite forces"),
        (
            |r| r.fitted.iter_mut().for_each(|s| s.force.y = 0.2),
            "vary f_y",
        ),
        (
            |r| r.fitted[3].moments.centroid.x = f64::NAN,
            "finite values",
        ),
        (
            |r| r.fitted = vec![r.fitted[0], r.fitted[3], r.fitted[6]],
            "expected more than",
        ),
    ];
    for choice in [
        ModelChoice::Separable,
        ModelChoice::Coupled,
        ModelChoice::Auto,
    ] {
        for (change, words) in cases {
            let message = refused(choice, change);
            assert!(message.contains(words), "{words}: {message}");
            assert!(message.contains("element 1"), "{message}");
        }
    }
}

#[test]
fn loads_that_do_not_change_the_image_are_rejected() {
    let dead = |record: &mut ElementRecord| {
        for sample in &mut record.fitted {
            sample.moments = moments(RelativeMoments::default());
        }
    };
    let message = refused(ModelChoice::Separable, dead);
    assert!(message.contains("change the image"), "{message}");
    assert!(refused(ModelChoice::Coupled, dead).contains("element 1"));
}

/// Loads at one or two places do not determine three coefficients, regardless of the number of loads.
#[test]
fn fits_require_more_distinct_loads_than_coefficients() {
    let few = |different: usize| {
        move |record: &mut ElementRecord| {
            for (n, sample) in record.fitted.iter_mut().enumerate() {
                let s = 0.1 * (n % different + 1) as f64;
                sample.moments = moments(inputs([s, s, s]));
                sample.force = DVec3::splat(s);
            }
        }
    };
    for different in [1, 2] {
        let message = refused(ModelChoice::Separable, few(different));
        assert!(!message.is_empty());
    }
    let mut record = good();
    few(9)(&mut record);
    assert!(fitted(&[record], ModelChoice::Separable).is_ok());
}

#[test]
fn fits_require_a_record_for_each_element() {
    let error = fit(
        made_for(3),
        &[good()],
        ModelChoice::Separable,
        FullScale::default(),
    );
    let message = error.expect_err("refused").to_string();
    assert!(message.contains('3') && message.contains('1'), "{message}");
}

/// Images without load on an element determine its rest state, images with a load are fitted, and images with an
/// unknown load are ignored.
#[test]
fn records_are_collected_image_by_image() {
    let mut builder = RecordBuilder::new(2);
    let [rest, pressed] = [RelativeMoments::default(), inputs([0.5, 0.1, 0.0])].map(moments);
    builder.add(&[Some(DVec3::ZERO), Some(DVec3::Z)], &[rest, pressed]);
    builder.add(&[None, Some(DVec3::ZERO)], &[pressed, rest]);
    let records = builder.records();
    let counts = |r: &ElementRecord| {
        [
            r.unloaded.len(),
            r.fitted.len(),
            r.cycled.len(),
            r.held_out.len(),
        ]
    };
    assert_eq!(
        records.iter().map(counts).collect::<Vec<_>>(),
        [[1, 0, 1, 0], [1, 1, 2, 0]]
    );
    assert_eq!(records[1].fitted[0].force, DVec3::Z);
    assert_eq!(records[1].fitted[0].moments, pressed);
    assert_eq!(records[0].unloaded, [rest]);
}
