//! Numbers of joints compared with `glam::DVec3`, bit for bit, and the rules for other lengths.

use feeler::hand::{JointVector, MAX_JOINTS};
use glam::DVec3;
use proptest::prelude::*;

/// Three numbers of every kind: ordinary, small integers (so that some are equal), subnormal, infinite, NaN.
fn numbers() -> impl Strategy<Value = [f64; 3]> {
    let small = (-2_i8..=2).prop_map(f64::from);
    prop::array::uniform3(prop_oneof![prop::num::f64::ANY, small, Just(-0.0)])
}

/// Bits of each number. All NaN are equal, because Rust does not specify the sign and payload of a computed NaN.
fn bits(numbers: &[f64]) -> Vec<u64> {
    let of = |v: &f64| if v.is_nan() { u64::MAX } else { v.to_bits() };
    numbers.iter().map(of).collect()
}

fn same(ours: JointVector, glams: DVec3) -> Result<(), TestCaseError> {
    prop_assert_eq!(bits(ours.as_slice()), bits(&glams.to_array()));
    Ok(())
}

proptest! {
    #[test]
    fn operations_on_three_joints_are_those_of_glam(a in numbers(), b in numbers(), s in prop::num::f64::ANY) {
        let (x, y) = (JointVector::from(a), JointVector::from(b));
        let (u, v) = (DVec3::from(a), DVec3::from(b));
        for (ours, glams) in [
            (x + y, u + v),
            (x - y, u - v),
            (x * y, u * v),
            (x / y, u / v),
            (x + s, u + s),
            (x - s, u - s),
            (x * s, u * s),
            (x / s, u / s),
            (s * x, s * u),
            (-x, -u),
            (x.abs(), u.abs()),
            (x.min(y), u.min(v)),
            (x.max(y), u.max(v)),
            (x.map(f64::round), u.round()),
        ] {
            same(ours, glams)?;
        }
        let (low, high) = (x.min(y), x.max(y));
        same((s * y).clamp(low, high), (s * v).clamp(u.min(v), u.max(v)))?;
        let (mut changed, mut glams) = (x, u);
        changed += y;
        glams += v;
        changed *= s;
        glams *= s;
        changed -= y;
        glams -= v;
        changed /= s;
        glams /= s;
        same(changed, glams)?;
    }

    #[test]
    fn numbers_of_three_joints_are_those_of_glam(a in numbers(), b in numbers(), precision in 0_usize..6) {
        let (x, y) = (JointVector::from(a), JointVector::from(b));
        let (u, v) = (DVec3::from(a), DVec3::from(b));
        let ours = [x.min_element(), x.max_element(), x.dot(y), x.length(), x.distance(y)];
        let glams = [u.min_element(), u.max_element(), u.dot(v), u.length(), u.distance(v)];
        prop_assert_eq!(bits(&ours), bits(&glams));
        prop_assert_eq!(x.is_finite(), u.is_finite());
        prop_assert_eq!(x.is_nan(), u.is_nan());
        prop_assert_eq!(x == y, u == v);
        prop_assert_eq!(x.to_string(), u.to_string());
        prop_assert_eq!(format!("{x:.precision$}"), format!("{u:.precision$}"));
        prop_assert_eq!(bits(&x.to_array::<3>().unwrap()), bits(&a));
    }

    /// Numbers beyond the length stay 0, also if an operation makes 0 something else.
    #[test]
    fn missing_numbers_are_zero(
        a in prop::collection::vec(prop::num::f64::ANY, 0..=MAX_JOINTS),
        b in prop::collection::vec(prop::num::f64::ANY, 0..=MAX_JOINTS),
        s in prop::num::f64::ANY,
    ) {
        let (x, y) = (JointVector::from_slice(&a).unwrap(), JointVector::from_slice(&b).unwrap());
        prop_assert_eq!(x.len(), a.len());
        for result in [x / y, x * s, x / s, x + s, x.max(y), x.clamp(y, x), -x, x.map(|_| s)] {
            prop_assert!(result.len() <= a.len().max(b.len()));
            for joint in result.len()..MAX_JOINTS {
                prop_assert_eq!(result[joint].to_bits(), 0);
            }
        }
        let sum = x + y;
        prop_assert_eq!(sum.len(), a.len().max(b.len()));
        for joint in 0..sum.len() {
            let number = |numbers: &[f64]| numbers.get(joint).copied().unwrap_or(0.0);
            prop_assert_eq!(bits(&[sum[joint]]), bits(&[number(&a) + number(&b)]));
        }
    }
}

#[test]
fn the_default_acts_as_zero_for_every_number_of_joints() {
    let none = JointVector::default();
    assert!(none.is_empty() && none.is_finite() && !none.is_nan());
    assert_eq!(none, JointVector::zeros(4));
    assert_ne!(none, JointVector::splat(4, 1.0));
    assert_eq!(
        (none.length(), none.min_element(), none.max_element()),
        (0.0, 0.0, 0.0)
    );
    assert_eq!((none[0], none[MAX_JOINTS - 1]), (0.0, 0.0));
    assert_eq!(none.to_array(), Some([0.0; 3]));
    let six = JointVector::splat(6, 2.0);
    assert_eq!((none + six, six.clamp(none, none)), (six, none));
    assert_eq!(none.to_string(), "[]");
}

#[test]
fn other_numbers_of_joints_are_refused() {
    assert_eq!(JointVector::from_slice(&[0.0; MAX_JOINTS + 1]), None);
    assert_eq!(JointVector::splat(4, 1.0).to_array::<3>(), None);
    assert_eq!(JointVector::splat(2, 1.0).to_array(), Some([1.0, 1.0, 0.0]));
    assert_eq!(
        format!("{:?}", JointVector::from([1.0, -0.5])),
        "JointVector(1.0, -0.5)"
    );
}

#[test]
#[should_panic = "index out of bounds"]
fn a_missing_number_cannot_be_set() {
    JointVector::zeros(3)[3] = 1.0;
}
