//! What every value of a fault must be: that what it breaks is there, above all.

use super::ExperimentConfig;
use super::checker::Checker;
use feeler_sim::config::SimConfig;
use feeler_sim::fault::{FaultConfig, FaultKind};
use feeler_sim::object::MotionConfig;

/// Most faults: each is looked at in every step.
const MAX_FAULTS: usize = 256;
/// Longest latency, control periods: so many exposures are kept.
const MAX_LATE_PERIODS: f64 = 1000.0;
/// Joints of a finger.
const JOINTS: usize = 3;

pub(super) fn check_faults(config: &ExperimentConfig, sim: &SimConfig, checker: &mut Checker) {
    let faults = &sim.fault;
    checker.require(
        "sim.fault",
        format!("{} faults", faults.len()),
        faults.len() <= MAX_FAULTS,
        &format!("at most {MAX_FAULTS}"),
    );
    for (index, fault) in faults.iter().enumerate() {
        let key = format!("sim.fault[{index}]");
        check_times(&key, fault, checker);
        let fingers = config.hand.finger.len();
        if let Some(finger) = fault.kind.finger() {
            let key = format!("{key}.kind.{}.finger", name(&fault.kind));
            index_below(&key, finger, fingers, "fingers of hand.finger", checker);
        }
        let key = format!("{key}.kind.{}", name(&fault.kind));
        check_kind(&key, &fault.kind, (config, sim), checker);
    }
}

fn check_times(key: &str, fault: &FaultConfig, checker: &mut Checker) {
    checker.not_negative(&format!("{key}.from"), fault.from);
    if let Some(until) = fault.until {
        checker.require(
            &format!("{key}.until"),
            until.to_string(),
            until.is_finite() && until > fault.from,
            &format!("more than {key}.from = {}, or no until at all", fault.from),
        );
    }
}

fn check_kind(
    key: &str,
    kind: &FaultKind,
    (config, sim): (&ExperimentConfig, &SimConfig),
    checker: &mut Checker,
) {
    match kind {
        &FaultKind::DeadElement { finger, element } => {
            let elements = config.sensor.fingertip(finger).layout.element_count();
            let what = format!("elements of finger {finger}");
            index_below(&format!("{key}.element"), element, elements, &what, checker);
        }
        &FaultKind::StuckRows {
            finger,
            first,
            count,
            ..
        } => {
            let rows = config.sensor.fingertip(finger).camera.height;
            let what = format!("rows of the picture of finger {finger}");
            index_below(&format!("{key}.first"), first, rows, &what, checker);
            let left = rows.saturating_sub(first);
            checker.require(
                &format!("{key}.count"),
                count.to_string(),
                (1..=left).contains(&count) || first >= rows,
                &format!("1 to {left}: the picture has {rows} rows, and the first is {first}"),
            );
        }
        FaultKind::FrozenFrame { .. } => {}
        &FaultKind::DroppedFrames { probability, .. } => {
            checker.between(&format!("{key}.probability"), probability, 0.0, 1.0);
        }
        &FaultKind::CameraLatency { delay, .. } => {
            let most = (MAX_LATE_PERIODS * config.control.period).min(10.0);
            checker.between(&format!("{key}.delay"), delay, 0.0, most);
        }
        &FaultKind::ServoStall { joint, .. } => {
            index_below(&format!("{key}.joint"), joint, JOINTS, "joints", checker);
        }
        &FaultKind::Backlash { joint, angle, .. } => {
            index_below(&format!("{key}.joint"), joint, JOINTS, "joints", checker);
            checker.between(&format!("{key}.angle"), angle, 0.0, 1.0);
        }
        FaultKind::FrictionDrop { object, factor } => {
            checker.between(&format!("{key}.factor"), *factor, 0.0, 1.0);
            let Some(object) = object else { return };
            let names: Vec<_> = sim.object.keys().map(String::as_str).collect();
            checker.require(
                &format!("{key}.object"),
                format!("{object:?}"),
                names.contains(&object.as_str()),
                &format!("the name of an object: {}", names.join(", ")),
            );
        }
        FaultKind::MassChange { object, mass, over } => {
            checker.positive(&format!("{key}.mass"), *mass);
            checker.not_negative(&format!("{key}.over"), *over);
            let objects = sim.object.iter();
            let free = objects.filter(|(_, o)| matches!(o.motion, MotionConfig::Free(_)));
            let names: Vec<_> = free.map(|(name, _)| name.as_str()).collect();
            checker.require(
                &format!("{key}.object"),
                format!("{object:?}"),
                names.contains(&object.as_str()),
                &format!("the name of a free object: {}", names.join(", ")),
            );
        }
    }
}

/// Requires an index into so many things.
fn index_below(key: &str, index: usize, count: usize, what: &str, checker: &mut Checker) {
    checker.require(
        key,
        index.to_string(),
        index < count,
        &format!(
            "0 to {}: there are {count} {what}, counted from 0",
            count.saturating_sub(1)
        ),
    );
}

/// The key of a kind.
fn name(kind: &FaultKind) -> &'static str {
    match kind {
        FaultKind::DeadElement { .. } => "dead_element",
        FaultKind::StuckRows { .. } => "stuck_rows",
        FaultKind::FrozenFrame { .. } => "frozen_frame",
        FaultKind::DroppedFrames { .. } => "dropped_frames",
        FaultKind::CameraLatency { .. } => "camera_latency",
        FaultKind::ServoStall { .. } => "servo_stall",
        FaultKind::Backlash { .. } => "backlash",
        FaultKind::FrictionDrop { .. } => "friction_drop",
        FaultKind::MassChange { .. } => "mass_change",
    }
}
