//! Chains of joints of a URDF robot.

use feeler::hand::chain::{FrameRow, JointConfig, MimicConfig, RowType};
use roxmltree::{Document, Node};
use std::collections::BTreeSet;

/// Magnitude of both limits of a continuous joint (rad).
const UNLIMITED: f64 = std::f64::consts::TAU;
/// Maximum speed of a joint if the URDF specifies none (rad/s or m/s).
const UNKNOWN_SPEED: f64 = 1.0;

/// Independent joints and frames of a finger.
#[derive(Debug, Default)]
pub(super) struct Finger {
    pub joints: Vec<JointConfig>,
    pub frames: Vec<FrameRow>,
}

/// Returns the chain of joints from the link `base` (default: the root) to the link `tip` of the URDF `text`.
///
/// # Errors
/// Describes what is expected if there is no such chain, or a joint of it is invalid.
pub(super) fn chain(text: &str, base: Option<&str>, tip: &str) -> Result<Finger, String> {
    let document = Document::parse(text).map_err(|error| error.to_string())?;
    let robot = document.root_element();
    if robot.tag_name().name() != "robot" {
        return Err(format!(
            "expected <robot>, got <{}>",
            robot.tag_name().name()
        ));
    }
    let joints: Vec<_> = robot
        .children()
        .filter(|node| node.has_tag_name("joint"))
        .collect();
    unique(&joints, "name", |joint| joint.attribute("name"))?;
    unique(&joints, "child link", |joint| end(joint, "child"))?;
    if base == Some(tip) {
        return Err(format!(
            "expected another link as base, got the tip {tip:?}"
        ));
    }
    let mut path = Vec::new();
    let mut link = tip.to_string();
    while base != Some(link.as_str()) {
        let Some(joint) = joints
            .iter()
            .find(|joint| end(joint, "child") == Some(&link))
        else {
            match base {
                None => break,
                Some(base) => {
                    return Err(format!(
                        "expected a chain from link {base:?} to {tip:?}, it ends at {link:?}"
                    ));
                }
            }
        };
        path.push(*joint);
        link = required(end(joint, "parent"), joint, "parent link")?.to_string();
        if path.len() > joints.len() {
            return Err(format!("the joints above link {tip:?} form a loop"));
        }
    }
    if path.is_empty() {
        let links = robot.children().filter(|node| node.has_tag_name("link"));
        let links: Vec<_> = links.filter_map(|link| link.attribute("name")).collect();
        return Err(format!(
            "no joint leads to link {tip:?}; expected one of {}",
            links.join(", ")
        ));
    }
    let mut finger = Finger::default();
    for joint in path.into_iter().rev() {
        let row = row(&joint, &joints, &mut finger.joints)?;
        finger.frames.push(row);
    }
    Ok(finger)
}

/// Checks that `value`, called `what` in the error, differs between all joints.
fn unique<'a, 'i>(
    joints: &'a [Node<'a, 'i>],
    what: &str,
    value: impl Fn(&'a Node<'a, 'i>) -> Option<&'a str>,
) -> Result<(), String> {
    let mut known = BTreeSet::new();
    match joints
        .iter()
        .filter_map(value)
        .find(|value| !known.insert(*value))
    {
        None => Ok(()),
        Some(value) => Err(format!(
            "expected a different {what} for each joint, got {value:?} twice"
        )),
    }
}

/// Name of the link at an `end` of a joint, `parent` or `child`.
fn end<'a>(joint: &Node<'a, '_>, end: &str) -> Option<&'a str> {
    child(joint, end)?.attribute("link")
}

fn child<'a, 'i>(node: &Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    node.children().find(|child| child.has_tag_name(name))
}

/// Returns the name of a joint for messages.
fn name_of<'a>(joint: &Node<'a, '_>) -> &'a str {
    joint.attribute("name").unwrap_or("without a name")
}

fn required<T>(value: Option<T>, joint: &Node, what: &str) -> Result<T, String> {
    value.ok_or_else(|| format!("joint {:?}: expected a {what}", name_of(joint)))
}

/// Converts a joint to a row of the chain. Adds the independent joint that moves it to `known`.
fn row(joint: &Node, all: &[Node], known: &mut Vec<JointConfig>) -> Result<FrameRow, String> {
    let name = name_of(joint);
    let origin = child(joint, "origin");
    let kind = joint.attribute("type").unwrap_or_default();
    let mut row = FrameRow {
        xyz: vector(origin, "xyz", joint)?.unwrap_or_default(),
        rpy: vector(origin, "rpy", joint)?.unwrap_or_default(),
        row_type: match kind {
            "fixed" => RowType::Fixed,
            "revolute" | "continuous" => RowType::Revolute,
            "prismatic" => RowType::Prismatic,
            _ => {
                return Err(format!(
                    "joint {name:?}: expected fixed, revolute, continuous or prismatic, got {kind:?}"
                ));
            }
        },
        ..FrameRow::default()
    };
    if row.row_type == RowType::Fixed {
        return Ok(row);
    }
    if let Some(axis) = vector(child(joint, "axis"), "xyz", joint)? {
        row.axis = axis;
    }
    match child(joint, "mimic") {
        None => row.joint = Some(add(joint, known)?),
        Some(mimic) => {
            let (driver, multiplier, offset) = followed(joint, &mimic, all)?;
            row.mimic = Some(MimicConfig {
                joint: add(&driver, known)?,
                multiplier,
                offset,
            });
        }
    }
    Ok(row)
}

/// Resolves a mimic joint: returns the independent joint that it follows, directly or through other mimic joints, with
/// the total multiplier and offset.
fn followed<'a, 'i>(
    joint: &Node,
    mimic: &Node,
    all: &[Node<'a, 'i>],
) -> Result<(Node<'a, 'i>, f64, f64), String> {
    let (mut ratio, mut offset) = (1.0, 0.0);
    let (mut follower, mut mimic) = (*joint, *mimic);
    for _ in 0..=all.len() {
        let name = mimic.attribute("joint").unwrap_or_default();
        let driver = all
            .iter()
            .find(|joint| joint.attribute("name") == Some(name));
        let driver = driver.ok_or_else(|| {
            let follower = name_of(&follower);
            format!("joint {follower:?}: expected the name of a joint of this robot in <mimic joint=\"...\">, got {name:?}")
        })?;
        offset += ratio * number(mimic, "offset", &follower)?.unwrap_or(0.0);
        ratio *= number(mimic, "multiplier", &follower)?.unwrap_or(1.0);
        match child(driver, "mimic") {
            Some(next) => (follower, mimic) = (*driver, next),
            None if driver.attribute("type") == Some("fixed") => {
                return Err(format!(
                    "joint {:?} follows {name:?}: expected a joint that moves, got a fixed one",
                    name_of(&follower)
                ));
            }
            None => return Ok((*driver, ratio, offset)),
        }
    }
    Err(format!(
        "joint {:?}: its <mimic> leads back to itself",
        name_of(joint)
    ))
}

/// Adds an independent joint to `known` unless it is already there. Returns its name.
fn add(joint: &Node, known: &mut Vec<JointConfig>) -> Result<String, String> {
    let name = required(joint.attribute("name"), joint, "name")?.to_string();
    if known.iter().any(|other| other.name == name) {
        return Ok(name);
    }
    let (lower, upper) = match joint.attribute("type") {
        Some("continuous") => (-UNLIMITED, UNLIMITED),
        _ => {
            let expected = "<limit lower=\"...\" upper=\"...\">";
            let lower = required(limit(joint, "lower")?, joint, expected)?;
            (lower, required(limit(joint, "upper")?, joint, expected)?)
        }
    };
    let speed = limit(joint, "velocity")?.filter(|speed| *speed != 0.0);
    if let Some(speed) = speed.filter(|speed| speed.is_nan() || *speed < 0.0) {
        return Err(format!(
            "joint {name:?}: expected a velocity above 0, got {speed}"
        ));
    }
    known.push(JointConfig {
        name: name.clone(),
        lower,
        upper,
        speed: speed.unwrap_or(UNKNOWN_SPEED),
    });
    Ok(name)
}

/// Returns the attribute `key` of a joint's `<limit>`, or `None` if it is missing.
fn limit(joint: &Node, key: &str) -> Result<Option<f64>, String> {
    match child(joint, "limit") {
        Some(limit) => number(limit, key, joint),
        None => Ok(None),
    }
}

/// Parses three numbers from the attribute `key`, or returns `None` if it is missing.
fn vector(node: Option<Node>, key: &str, joint: &Node) -> Result<Option<[f64; 3]>, String> {
    let Some(text) = node.and_then(|node| node.attribute(key)) else {
        return Ok(None);
    };
    let numbers: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
    let three = numbers
        .ok()
        .and_then(|numbers| <[f64; 3]>::try_from(numbers).ok());
    required(
        three,
        joint,
        &format!("{key} of three numbers, got {text:?}"),
    )
    .map(Some)
}

/// Parses a number from the attribute `key`, or returns `None` if it is missing.
fn number(node: Node, key: &str, joint: &Node) -> Result<Option<f64>, String> {
    let Some(text) = node.attribute(key) else {
        return Ok(None);
    };
    let number = text.trim().parse().ok();
    required(number, joint, &format!("number in {key}, got {text:?}")).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use feeler::hand::FingerGeometry;
    use feeler::hand::chain::ChainConfig;
    use feeler::hand::{JointVector, fingertip_pose};
    use glam::DVec3;

    /// A palm with a finger of two joints and a coupled one, and a wheel.
    const ROBOT: &str = r#"<?xml version="1.0"?>
        <robot name="r">
          <link name="palm"/><link name="one"/><link name="two"/><link name="three"/><link name="tip"/><link name="hub"/>
          <joint name="bend" type="revolute"><parent link="palm"/><child link="one"/>
            <origin xyz="0.1 0 0"/><axis xyz="0 0 1"/><limit lower="-0.5" upper="1.5" velocity="2" effort="1"/></joint>
          <joint name="pull" type="prismatic"><parent link="one"/><child link="two"/>
            <origin xyz="0.05 0 0" rpy="0 0 0"/><limit lower="0" upper="0.02" velocity="0.1" effort="1"/></joint>
          <joint name="follow" type="revolute"><parent link="two"/><child link="three"/>
            <axis xyz="0 0 1"/><mimic joint="bend" multiplier="0.5" offset="0.1"/></joint>
          <joint name="end" type="fixed"><parent link="three"/><child link="tip"/><origin xyz="0.03 0 0"/></joint>
          <joint name="wheel" type="continuous"><parent link="palm"/><child link="hub"/><axis xyz="0 1 0"/></joint>
        </robot>"#;

    fn geometry(chain: Finger) -> FingerGeometry {
        let config = ChainConfig {
            joints: chain.joints,
            frames: chain.frames,
            ..toml::from_str("base_position = [0.0, 0.0, 0.0]\njoints = []").unwrap()
        };
        FingerGeometry::chain(&config).unwrap()
    }

    #[test]
    fn a_chain_ends_at_the_tip_link() {
        let geometry = geometry(chain(ROBOT, None, "tip").unwrap());
        assert_eq!(geometry.joint_count(), 2);
        assert_eq!(geometry.joint_lower().as_slice(), [-0.5, 0.0]);
        assert_eq!(geometry.joint_speed_limit().as_slice(), [2.0, 0.1]);
        let (bend, pull) = (0.4_f64, 0.01);
        let (position, _) = fingertip_pose(&geometry, JointVector::from([bend, pull]));
        let along = |angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0);
        let expected =
            DVec3::X * 0.1 + along(bend) * (0.05 + pull) + along(1.5 * bend + 0.1) * 0.03;
        assert!(position.abs_diff_eq(expected, 1e-15), "{position}");
    }

    #[test]
    fn a_joint_may_follow_a_follower() {
        // `pull` follows `follow`, which follows `bend`.
        let follower = "<mimic joint=\"follow\" multiplier=\"0.02\" offset=\"0.001\"/></joint>\n          <joint name=\"follow\"";
        let robot = ROBOT.replace("</joint>\n          <joint name=\"follow\"", follower);
        let geometry = geometry(chain(&robot, None, "tip").unwrap());
        assert_eq!(geometry.joint_count(), 1);
        let positions: Vec<_> = geometry.frame_positions(JointVector::from([0.4])).collect();
        let expected = [0.4, 0.02 * (0.5 * 0.4 + 0.1) + 0.001, 0.5 * 0.4 + 0.1];
        for (position, expected) in positions.iter().zip(expected) {
            assert!((position - expected).abs() < 1e-15, "{positions:?}");
        }
    }

    #[test]
    fn a_chain_may_start_below_the_root() {
        let finger = chain(ROBOT, Some("one"), "two").unwrap();
        let names: Vec<_> = finger
            .joints
            .iter()
            .map(|joint| joint.name.as_str())
            .collect();
        assert_eq!((names, finger.frames.len()), (vec!["pull"], 1));
        let wheel = chain(ROBOT, None, "hub").unwrap();
        assert_eq!(
            [wheel.joints[0].lower, wheel.joints[0].upper],
            [-UNLIMITED, UNLIMITED]
        );
    }

    #[test]
    fn what_is_not_a_finger_is_refused() {
        let refused = |text: &str, base, tip: &str, words: &str| {
            let error = chain(text, base, tip).unwrap_err();
            assert!(error.contains(words), "{error}");
        };
        refused("<robot", None, "tip", "root node");
        refused("<a/>", None, "tip", "expected <robot>, got <a>");
        refused(ROBOT, None, "thumb", "expected one of palm, one, two");
        refused(ROBOT, Some("hub"), "tip", "it ends at \"palm\"");
        refused(
            &ROBOT.replace("0.1 0 0", "0.1 x 0"),
            None,
            "tip",
            "\"bend\": expected a xyz of three numbers",
        );
        refused(
            &ROBOT.replace("prismatic", "floating"),
            None,
            "tip",
            "got \"floating\"",
        );
        refused(
            &ROBOT.replace("joint=\"bend\"", "joint=\"no\""),
            None,
            "tip",
            "got \"no\"",
        );
        refused(
            &ROBOT.replace("lower=\"-0.5\"", ""),
            None,
            "tip",
            "expected a <limit",
        );
        let twice = ROBOT.replace("name=\"pull\"", "name=\"bend\"");
        refused(&twice, None, "tip", "got \"bend\" twice");
        refused(ROBOT, Some("tip"), "tip", "another link as base");
        let own = ROBOT.replace("mimic joint=\"bend\"", "mimic joint=\"follow\"");
        refused(&own, None, "tip", "leads back to itself");
        let fixed = ROBOT.replace("mimic joint=\"bend\"", "mimic joint=\"end\"");
        refused(&fixed, None, "tip", "got a fixed one");
        refused(
            &ROBOT.replace("velocity=\"2\"", "velocity=\"nan\""),
            None,
            "tip",
            "above 0, got NaN",
        );
        let circle = ROBOT.replace("<parent link=\"palm\"/>", "<parent link=\"tip\"/>");
        refused(&circle, None, "tip", "loop");
    }
}
