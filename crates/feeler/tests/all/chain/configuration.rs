//! Configuration of chains: both descriptions, and invalid values.

use super::planar;
use feeler::hand::chain::{Chain, ChainConfig, FrameRow, MimicConfig, RowType};

fn message(change: impl FnOnce(&mut ChainConfig)) -> String {
    let mut config = planar(3);
    change(&mut config);
    Chain::new(&config).unwrap_err().to_string()
}

#[test]
fn invalid_values_are_named() {
    assert_eq!(
        message(|c| c.dh[1].a = 11.0),
        "dh[1].a = 11: expected -10..10 m"
    );
    assert_eq!(
        message(|c| c.base_position[2] = f64::NAN),
        "base_position[2] = NaN: expected -100..100 m"
    );
    assert_eq!(
        message(|c| c.joints[2].lower = 2.0),
        "joints[2].upper = 2: expected more than joints[2].lower = 2"
    );
    assert_eq!(
        message(|c| c.joints[0].speed = 0.0),
        "joints[0].speed = 0: expected above 0 rad/s or m/s"
    );
    assert_eq!(
        message(|c| c.damping_threshold = Some(0.2)),
        "damping_threshold = 0.2: expected 1e-6 of the reach to the reach"
    );
    assert_eq!(
        message(|c| c.dh.iter_mut().for_each(|row| row.a = 0.0)),
        "reach of the chain = 0: expected at least 0.001 m"
    );
    assert_eq!(
        message(|c| {
            c.joints.truncate(1);
            c.dh.truncate(1);
            (c.dh[0].a, c.dh[0].d) = (0.0, 0.1);
        }),
        "number of directions in which the fingertip moves = 0: expected at least 1"
    );
}

#[test]
fn rows_and_joints_must_match() {
    assert_eq!(
        message(|c| c.joints[1].name = "joint 0".to_string()),
        "joints[1].name = \"joint 0\": expected a name that no other joint has"
    );
    assert_eq!(
        message(|c| c.dh[2].joint = Some("joint 3".to_string())),
        "dh[2].joint = \"joint 3\": expected one of the joints joint 0, joint 1, joint 2"
    );
    assert_eq!(
        message(|c| c.dh[2].joint = None),
        "dh[2]: expected a moving row with either joint or mimic"
    );
    assert_eq!(
        message(|c| c.dh[2].row_type = RowType::Fixed),
        "dh[2]: expected a fixed row without joint and mimic"
    );
    assert_eq!(
        message(|c| c.dh[2].joint = Some("joint 1".to_string())),
        "expected a row that joint \"joint 2\" drives, got none"
    );
    let mimic = |multiplier, offset| MimicConfig {
        joint: "joint 1".to_string(),
        multiplier,
        offset,
    };
    assert_eq!(
        message(|c| (c.dh[2].joint, c.dh[2].mimic) = (None, Some(mimic(0.0, 0.0)))),
        "dh[2].mimic.multiplier = 0: expected -100..100, not 0"
    );
    assert_eq!(
        message(|c| (c.dh[2].joint, c.dh[2].mimic) = (None, Some(mimic(1.0, f64::INFINITY)))),
        "dh[2].mimic.offset = inf: expected -10..10 rad or m"
    );
}

#[test]
fn counts_are_limited() {
    assert_eq!(
        message(|c| c.frames.push(FrameRow::default())),
        "expected rows in either dh or frames, got 3 in dh and 1 in frames"
    );
    assert_eq!(
        message(|c| c.joints.clear()),
        "expected 1 to 7 joints, got 0"
    );
    assert_eq!(
        Chain::new(&planar(8)).unwrap_err().to_string(),
        "expected 1 to 7 joints, got 8"
    );
    assert_eq!(
        message(|c| c.dh = vec![c.dh[0].clone(); 17]),
        "expected 1 to 16 moving rows, got 17"
    );
    assert_eq!(
        message(|c| c.dh = vec![c.dh[0].clone(); 33]),
        "expected 1 to 32 rows, got 33"
    );
    assert_eq!(
        message(|c| {
            let axis = [0.0; 3];
            c.dh.clear();
            c.frames.push(FrameRow {
                axis,
                ..FrameRow::default()
            });
        }),
        "length of frames[0].axis = 0: expected 0.001..1000"
    );
}

#[test]
fn unknown_keys_are_refused() {
    let text = toml::to_string(&planar(2)).unwrap();
    assert_eq!(toml::from_str::<ChainConfig>(&text).unwrap(), planar(2));
    for (key, replacement) in [
        ("base_rpy", "base_rpy_deg"),
        ("alpha_deg", "alpha"),
        ("speed", "velocity"),
    ] {
        let changed = text.replace(key, replacement);
        assert_ne!(changed, text);
        assert!(toml::from_str::<ChainConfig>(&changed).is_err(), "{key}");
    }
}

/// A fixed row is a part of the next transform.
#[test]
fn fixed_rows_move_the_next_frame() {
    let config: ChainConfig = toml::from_str(
        r#"
        base_position = [1.0, 0.0, 0.0]
        joints = [
            { name = "turn", lower = -1.0, upper = 1.0, speed = 1.0 },
            { name = "slide", lower = 0.0, upper = 0.1, speed = 0.1 },
        ]
        frames = [
            { type = "fixed", xyz = [0.0, 0.2, 0.0] },
            { joint = "turn", axis = [0.0, 0.0, 1.0] },
            { type = "fixed", xyz = [0.3, 0.0, 0.0] },
            { type = "prismatic", mimic = { joint = "slide", multiplier = -2.0, offset = 0.5 }, axis = [0.0, 1.0, 0.0] },
        ]
        "#,
    )
    .unwrap();
    let chain = Chain::new(&config).unwrap();
    let (position, rotation) = chain.pose(&[0.0, 0.1]);
    assert!(position.abs_diff_eq(glam::DVec3::new(1.3, 0.5, 0.0), 1e-15));
    assert_eq!(rotation, glam::DMat3::IDENTITY);
    let jacobian = chain.jacobian(&[0.0, 0.1]);
    assert!(jacobian[0].abs_diff_eq(glam::DVec3::new(-0.3, 0.3, 0.0), 1e-15));
    assert_eq!(jacobian[1], glam::DVec3::new(0.0, -2.0, 0.0));
    // A joint that drives prismatic rows only by `mimic` counts as an angle, like that of a rack.
    assert_eq!(&chain.is_prismatic()[..2], [false, false]);
    assert_eq!(chain.joint_speed_limit()[..2], [1.0, 0.1]);
}
