//! Clouds of forces: published clouds are read back, and invalid ones rejected.

use feeler::sensor::fingertip::SensingElement;
use feeler_record::ros::PointCloud2;
use feeler_record::sensed::{Elements, taxels};
use feeler_ros2::{CloudError, read_forces};
use glam::DVec3;
use proptest::prelude::*;

const TIPS: [DVec3; 3] = [
    DVec3::new(0.018, 0.0, 0.0),
    DVec3::new(0.012, 0.010, -0.008),
    DVec3::new(0.003, -0.012, 0.012),
];

/// Cloud of forces (N), each in the frame of its element.
fn cloud(forces: &[DVec3]) -> PointCloud2 {
    let elements = TIPS.map(|tip| (SensingElement::facing(tip.normalize()), tip));
    let mut elements = Elements::new(elements.into());
    let mut cloud = taxels(0, &elements);
    elements.take_forces(forces);
    elements.fill(&mut cloud, |_| false);
    cloud
}

#[test]
fn forces_are_read_back_in_element_frames() {
    let forces = [
        DVec3::new(0.1, -0.2, 0.5),
        DVec3::NAN,
        DVec3::new(0.0, 0.3, -0.4),
    ];
    let mut read = [DVec3::ZERO; 3];
    read_forces(&cloud(&forces), &mut read).expect("forces");
    // The cloud contains 32-bit numbers.
    assert!(read[0].abs_diff_eq(forces[0], 1e-6), "{read:?}");
    assert!(read[1].is_nan(), "{read:?}");
    assert!(read[2].abs_diff_eq(forces[2], 1e-6), "{read:?}");
}

#[test]
fn rows_of_clouds_may_be_padded() {
    let forces = [0.5, 0.4, 0.3].map(|z| DVec3::new(0.1, 0.2, z));
    let flat = cloud(&forces);
    let mut padded = flat.clone();
    (padded.width, padded.height, padded.row_step) = (1, 3, 40);
    let rows = flat.data.chunks_exact(28);
    padded.data = rows.flat_map(|row| [row, &[0xFF; 12]].concat()).collect();
    let mut read = [[DVec3::ZERO; 3]; 2];
    for (cloud, read) in [&flat, &padded].into_iter().zip(&mut read) {
        read_forces(cloud, read).expect("forces");
    }
    assert_eq!(read[0], read[1]);
    assert!(read[0][2].abs_diff_eq(forces[2], 1e-6), "{read:?}");
}

#[test]
fn invalid_clouds_are_rejected() {
    let good = cloud(&[DVec3::ONE; 3]);
    let refused = |change: &dyn Fn(&mut PointCloud2)| {
        let mut cloud = good.clone();
        change(&mut cloud);
        read_forces(&cloud, &mut [DVec3::ZERO; 3]).expect_err("a rejected cloud")
    };
    let points = refused(&|cloud| cloud.width = 4);
    assert!(matches!(
        points,
        CloudError::Points {
            expected: 3,
            width: 4,
            ..
        }
    ));
    assert_eq!(
        refused(&|cloud| cloud.is_bigendian = true),
        CloudError::BigEndian
    );
    assert_eq!(
        refused(&|cloud| cloud.fields[3].name = "f".into()),
        CloudError::Field("fx")
    );
    assert_eq!(
        refused(&|cloud| cloud.fields[0].offset = u32::MAX),
        CloudError::Field("x")
    );
    assert_eq!(
        refused(&|cloud| cloud.fields[0].datatype = 2),
        CloudError::Field("x")
    );
    let bytes = refused(&|cloud| cloud.data.truncate(83));
    assert_eq!(
        bytes,
        CloudError::Bytes {
            expected: 84,
            actual: 83
        }
    );
}

proptest! {
    #[test]
    fn arbitrary_clouds_do_not_panic(
        height in 0..4_u32, width in any::<u32>(), few in 0..4_u32, point_step in any::<u32>(), short in 0..64_u32,
        offsets in proptest::collection::vec(prop_oneof![0..64_u32, any::<u32>()], 8), kind in 0..9_u8,
        data in proptest::collection::vec(any::<u8>(), 0..200),
    ) {
        for (width, point_step) in [(width, point_step), (few, short)] {
            let mut cloud = cloud(&[DVec3::ONE; 3]);
            (cloud.height, cloud.width, cloud.point_step) = (height, width, point_step);
            cloud.data.clone_from(&data);
            for (field, &offset) in cloud.fields.iter_mut().zip(&offsets) {
                (field.offset, field.datatype) = (offset, if kind == 0 { 7 } else { kind });
            }
            let points = (height as usize * few as usize).min(16);
            let _ = read_forces(&cloud, &mut vec![DVec3::ZERO; points]);
        }
    }
}
