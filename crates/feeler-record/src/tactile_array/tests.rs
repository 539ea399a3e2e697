use super::*;
use crate::messages::channels::{Flags, Tactile};
use crate::ros::{PointCloud2, Time, WrenchStamped};
use crate::sensed::Elements;
use crate::wire::{Vector3, cdr};
use feeler::sensor::fingertip::SensingElement;
use glam::DMat3;
use proptest::prelude::*;

const TIPS: [DVec3; 3] = [
    DVec3::new(0.018, 0.0, 0.0),
    DVec3::new(0.012, 0.010, -0.008),
    DVec3::new(0.003, -0.012, 0.012),
];
/// Forces as in a tactile frame: compression positive.
const FORCES: [DVec3; 3] = [
    DVec3::new(0.1, -0.2, 0.5),
    DVec3::NAN,
    DVec3::new(0.0, 0.3, -0.4),
];

fn elements() -> Vec<(SensingElement, DVec3)> {
    let element = |tip: DVec3| (SensingElement::facing(tip.normalize()), tip);
    TIPS.map(element).into()
}

/// Array as of a finger of a recording, without values.
fn template() -> TactileArray {
    let turn = |(element, _): (SensingElement, DVec3)| DQuat::from_mat3(&element.rotation).into();
    let shear_rate = TactileChannel {
        name: names::SHEAR_RATE.into(),
        unit: "N/s".into(),
        components: 1,
        ..TactileChannel::default()
    };
    TactileArray {
        positions: TIPS.map(Vector3::from).into(),
        orientations: elements().into_iter().map(turn).collect(),
        channels: vec![
            TactileChannel {
                axes: ELEMENT_AXES,
                ..TactileChannel::of_forces()
            },
            shear_rate,
        ],
        contact_threshold: 0.1,
        slip_threshold: 2.0,
        overload_threshold: 0.45,
        ..TactileArray::unknown(&Header::of("finger_0_dome"))
    }
}

fn recorded() -> (Tactile, Flags) {
    let tactile = Tactile {
        sequence: 7,
        stamp: 1.25,
        forces: FORCES.map(Vector3::from).into(),
    };
    let flags = Flags {
        shear_rate: vec![1.0, 0.0, 3.0],
        ..Flags::default()
    };
    (tactile, flags)
}

fn array() -> TactileArray {
    let (mut array, (tactile, flags)) = (template(), recorded());
    set_recorded(&mut array, &tactile, &flags);
    array
}

fn is_close(a: &[DVec3], b: &[DVec3], tolerance: f64) -> bool {
    let is_same =
        |(a, b): (&DVec3, &DVec3)| (a.is_nan() && b.is_nan()) || a.abs_diff_eq(*b, tolerance);
    a.len() == b.len() && a.iter().zip(b).all(is_same)
}

#[test]
fn recorded_frames_return_unchanged() {
    let (tactile, _) = recorded();
    let back = to_recorded(&array()).expect("a frame");
    assert_eq!((back.sequence, back.stamp), (7, 1.25));
    let forces = |frame: &Tactile| frame.forces.iter().map(|&f| f.into()).collect::<Vec<_>>();
    // Bit for bit, since only a sign was changed twice.
    assert!(is_close(&forces(&back), &forces(&tactile), 0.0), "{back:?}");
}

#[test]
fn forces_act_on_the_sensor_in_its_frame() {
    let mut expected = Elements::new(elements());
    expected.take_forces(&FORCES);
    let forces = array().forces().expect("forces");
    assert!(is_close(&forces, &expected.forces, 1e-15), "{forces:?}");
    // A press on the apex, whose outward normal is x, pushes the sensor along -x.
    assert!(forces[0].x < -0.49, "{forces:?}");
}

#[test]
fn thresholds_determine_contact() {
    assert_eq!(array().contact, [CONTACT | OVERLOAD, 0, SLIP]);
    assert_eq!(array().channels[0].status, [0, INVALID, 0]);
    let mut unknown = template();
    (unknown.contact_threshold, unknown.overload_threshold) = (f64::NAN, f64::NAN);
    let (tactile, flags) = recorded();
    set_recorded(&mut unknown, &tactile, &flags);
    assert_eq!(unknown.contact, [0, 0, SLIP]);
}

#[test]
fn clouds_return_geometry_forces_and_contact() {
    let mut array = array();
    array.channels[0].status[2] = SATURATED;
    let cloud = to_cloud(&array).expect("a cloud");
    let back = from_cloud(&cloud).expect("an array");
    // Numbers are rounded to 32 bits.
    let numbers = |list: &[Vector3]| list.iter().map(|&v| v.into()).collect::<Vec<DVec3>>();
    assert!(is_close(&numbers(&back.positions), &TIPS, 1e-9));
    let forces = [&array, &back].map(|array| array.forces_in_element_frames().expect("forces"));
    assert!(is_close(&forces[0], &forces[1], 1e-7), "{forces:?}");
    assert_eq!(back.channels[0].status, [0, INVALID, SATURATED]);
    // Overload is lost, and the rest of the description.
    assert_eq!(back.contact, [CONTACT, 0, SLIP]);
    assert_eq!(back.header, array.header);
    assert!(back.rate.is_nan() && back.contact_threshold.is_nan() && back.sequence == 0);
}

#[test]
fn clouds_without_orientations_face_away_from_the_origin() {
    let mut cloud = to_cloud(&array()).expect("a cloud");
    cloud.fields.retain(|field| !field.name.starts_with('q'));
    let back = from_cloud(&cloud).expect("an array");
    let forces = back.forces_in_element_frames().expect("forces");
    let own = array().forces_in_element_frames().expect("forces");
    assert!(is_close(&forces, &own, 1e-7), "{forces:?}");
}

#[test]
fn rows_of_clouds_may_be_padded() {
    let flat = to_cloud(&array()).expect("a cloud");
    let mut padded = flat.clone();
    (padded.width, padded.height, padded.row_step) = (1, 3, 50);
    padded.data = (flat.data.chunks_exact(44))
        .flat_map(|point| [point, &[9; 6]].concat())
        .collect();
    // The last row needs no padding.
    padded.data.truncate(2 * 50 + 44);
    let arrays = [&flat, &padded].map(|cloud| format!("{:?}", from_cloud(cloud)));
    assert_eq!(arrays[0], arrays[1]);
}

#[test]
fn invalid_clouds_are_rejected_with_a_reason() {
    let refused = |change: fn(&mut PointCloud2)| {
        let mut cloud = to_cloud(&array()).expect("a cloud");
        change(&mut cloud);
        from_cloud(&cloud).expect_err("an error")
    };
    assert_eq!(refused(|c| c.is_bigendian = true), ArrayError::BigEndian);
    assert_eq!(
        refused(|c| c.fields[3].name = "f".into()),
        ArrayError::Field("fx")
    );
    assert!(matches!(
        refused(|c| c.width = u32::MAX),
        ArrayError::Count { actual: 132, .. }
    ));
    assert!(matches!(
        refused(|c| c.data[..4].copy_from_slice(&f32::NAN.to_le_bytes())),
        ArrayError::Pose { element: 0, .. }
    ));
}

#[test]
fn wrench_is_the_sum_about_the_origin() {
    let mut elements = Elements::new(elements());
    elements.take_forces(&FORCES);
    let expected = elements.wrench();
    let WrenchStamped { header, wrench } = to_wrench(&array()).expect("a wrench");
    let close = |a: Vector3, b: Vector3| DVec3::from(a).abs_diff_eq(b.into(), 1e-15);
    assert!(close(wrench.force, expected.force) && close(wrench.torque, expected.torque));
    assert_eq!(header, array().header);
    // Back: one element with the force, without the torque.
    let back = from_wrench(&WrenchStamped { header, wrench });
    let again = to_wrench(&back).expect("a wrench");
    assert_eq!(again.wrench.force, wrench.force);
    assert_eq!(DVec3::from(again.wrench.torque), DVec3::ZERO);
}

#[test]
fn invalid_arrays_are_rejected_with_a_reason() {
    let refused = |change: fn(&mut TactileArray)| {
        let mut array = array();
        change(&mut array);
        array.forces().expect_err("an error").to_string()
    };
    let expect = |change, words: &str| {
        let said = refused(change);
        assert!(said.contains(words), "{said}");
    };
    expect(|a| a.orientations.truncate(2), "3 entries in orientations");
    expect(|a| a.areas.push(1.0), "3 entries in areas, got 1");
    expect(|a| a.contact.truncate(2), "3 entries in contact");
    expect(
        |a| a.channels[0].values.truncate(8),
        "9 entries in values of the channel \"force\", got 8",
    );
    expect(|a| a.channels[1].variances.push(0.0), "3 entries in varian");
    expect(|a| a.channels[0].name = "raw".into(), "no channel of this");
    expect(|a| a.channels[0].unit = "mN".into(), "components in \"mN\"");
    expect(|a| a.channels[0].axes = 2, "in axes 2");
    expect(|a| a.orientations[1].w += 1.0, "element 1");
    expect(|a| a.positions[2].x = f64::NAN, "element 2");
}

#[test]
fn sensor_axes_are_converted() {
    let array = array();
    let mut turned = array.clone();
    turned.channels[0].axes = SENSOR_AXES;
    let forces = array.forces().expect("forces");
    turned.channels[0].values = forces.iter().flat_map(|f| f.to_array()).collect();
    let own = turned.forces_in_element_frames().expect("forces");
    let expected = array.forces_in_element_frames().expect("forces");
    assert!(is_close(&own, &expected, 1e-15), "{own:?}");
}

#[test]
fn setting_a_sample_describes_it_anew() {
    let mut array = array();
    array.set_sample(
        Time { sec: 2, nanosec: 5 },
        8,
        [DVec3::ZERO; 3].into_iter(),
        &[0.0; 3],
    );
    assert_eq!((array.sequence, array.header.seconds()), (8, 2.000000005));
    assert_eq!(
        (&array.contact[..], &array.channels[0].status[..]),
        (&[0; 3][..], &[0; 3][..])
    );
    array.check().expect("a valid array");
}

#[test]
fn orientation_of_the_message_is_that_of_the_element() {
    for ((element, _), orientation) in elements().into_iter().zip(array().orientations) {
        let rotation = DMat3::from_quat(DQuat::from(orientation));
        assert!(rotation.abs_diff_eq(element.rotation, 1e-15));
    }
}

proptest! {
    #[test]
    fn any_bytes_are_read_or_rejected(
        noise in proptest::collection::vec((0_usize..2000, any::<u8>()), 0..20), cut in 0_usize..2000,
    ) {
        let mut bytes = Vec::new();
        cdr::encode(&array(), &mut bytes).expect("an encoded array");
        for (at, byte) in noise {
            let at = at % bytes.len();
            bytes[at] = byte;
        }
        bytes.truncate(bytes.len().saturating_sub(cut / 10));
        if let Ok(array) = cdr::decode::<TactileArray>(&bytes) {
            let _ = (array.forces(), to_wrench(&array), to_recorded(&array));
            if let Ok(cloud) = to_cloud(&array) {
                let _ = from_cloud(&cloud);
            }
        }
    }

    #[test]
    fn any_cloud_is_read_or_rejected(
        [height, width, point_step, row_step] in any::<[u32; 4]>(), small in any::<[u8; 4]>(), is_small in any::<bool>(),
        offsets in proptest::collection::vec(prop_oneof![0..64_u32, any::<u32>()], 14), kind in 0..9_u8,
        data in proptest::collection::vec(any::<u8>(), 0..300),
    ) {
        let mut cloud = to_cloud(&array()).expect("a cloud");
        cloud.data = data;
        [cloud.height, cloud.width, cloud.point_step, cloud.row_step] = match is_small {
            true => small.map(|byte| u32::from(byte % 50)),
            false => [height, width, point_step, row_step],
        };
        for (field, offset) in cloud.fields.iter_mut().zip(offsets) {
            field.offset = offset;
            if kind > 0 {
                field.datatype = kind;
            }
        }
        if let Ok(array) = from_cloud(&cloud) {
            prop_assert_eq!(array.elements() as u64, u64::from(cloud.width) * u64::from(cloud.height));
        }
    }
}
