//! Requirements on the values of an experiment that involve several of its parts.

use super::experiment_config::ExperimentConfig;
use feeler::check::{Checker, Problem, Requirement};
use feeler::control::task::TaskConfig;
use feeler::control::task::grip::GripLaw;
use feeler::hand::{FingerDescription, MAX_FINGERS};
use feeler_drives::config::DrivesConfig;
use feeler_drives::setup::named_joints;
use feeler_sim::shapes::ShapeConfig;
use feeler_sim::world::SimConfig;

/// Maximum length of a name in bytes. The name becomes part of a folder name.
const MAX_NAME: usize = 64;

/// Returns every value of `config` that is out of range.
///
/// Cameras, finger geometry and optics are checked when they are built.
pub(super) fn check(config: &ExperimentConfig) -> Vec<Problem> {
    checked(config).problems()
}

/// Returns all requirements on the values of `config`.
pub(super) fn requirements(config: &ExperimentConfig) -> Vec<Requirement> {
    checked(config).requirements()
}

fn checked(config: &ExperimentConfig) -> Checker {
    let mut checker = Checker::default();
    let name = &config.name;
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    checker.require(
        "name",
        format!("{name:?}"),
        (1..=MAX_NAME).contains(&name.len()) && name.chars().all(plain),
        &format!("1 to {MAX_NAME} letters, digits, hyphens and underscores"),
    );
    checker.between("time_limit", config.time_limit, 1e-3, 1e5);
    config.sensor.check("sensor", &mut checker);
    check_fingers(config, &mut checker);
    config.control.check(&config.task, &mut checker);
    if let Some(drives) = &config.drives {
        let fingers = config.hand.finger.iter();
        let prismatic: Vec<_> = fingers.map(FingerDescription::is_prismatic).collect();
        drives.check("drives", &prismatic, &mut checker);
        drives.check_period("drives", config.control.period, &mut checker);
        check_task_of_shared_servos(&config.task, drives, &mut checker);
    }
    if let Some(ros2) = &config.ros2 {
        let fingers = config.hand.finger.iter().enumerate();
        let fingers: Vec<_> = fingers
            .map(|(finger, description)| {
                let elements = config.sensor.fingertip(finger).layout.element_count();
                (elements, description.joint_count())
            })
            .collect();
        ros2.check("ros2", &fingers, &mut checker);
    }
    if let Some(sim) = &config.sim {
        check_within_reach(config, sim, &mut checker);
        let fingers = 0..config.hand.finger.len();
        let fingertips: Vec<_> = fingers
            .map(|finger| config.sensor.fingertip(finger))
            .collect();
        let fingers = config.hand.finger.iter();
        let joints: Vec<_> = fingers.map(FingerDescription::joint_count).collect();
        sim.check(&fingertips, &joints, config.control.period, &mut checker);
    }
    checker
}

fn check_fingers(config: &ExperimentConfig, checker: &mut Checker) {
    let (hand, task) = (config.hand.finger.len(), config.task.homes().len());
    checker.require(
        "hand.finger",
        format!("{hand} fingers"),
        (1..=MAX_FINGERS).contains(&hand),
        "1 to 5 fingers",
    );
    checker.require(
        &format!("task.{}.finger", config.task.name()),
        format!("{task} fingers"),
        task == hand,
        &format!("as many fingers as hand.finger ({hand})"),
    );
    let sensors = config.sensor.finger.len();
    checker.require(
        "sensor.finger",
        format!("{sensors} fingers"),
        sensors == 0 || sensors == hand,
        &format!("no fingers, or as many as hand.finger ({hand}); an empty entry uses the values of [sensor]"),
    );
}

/// Requires a task that moves all fingers at the same speed if one servo moves joints of several fingers.
fn check_task_of_shared_servos(task: &TaskConfig, drives: &DrivesConfig, checker: &mut Checker) {
    let moves_alike = match task {
        TaskConfig::Grip(grip) => grip.law != GripLaw::Policy,
        _ => false,
    };
    for (name, _) in named_joints(drives).filter(|(_, drive)| drive.shared) {
        checker.require(
            &format!("drives.finger[{}].joint[{}].shared", name.finger, name.joint),
            "true".to_string(),
            moves_alike,
            "false with this task, which moves the fingers independently; only task.grip with another law than \"policy\" moves them alike",
        );
    }
}

/// Requires at least one object within the workspace of tasks that must touch one. This can be checked only in
/// simulation.
fn check_within_reach(config: &ExperimentConfig, sim: &SimConfig, checker: &mut Checker) {
    if !matches!(
        config.task,
        TaskConfig::Contour(_) | TaskConfig::Carry(_) | TaskConfig::Grip(_)
    ) {
        return;
    }
    let limits = &config.control.limits;
    let (lower, upper) = (limits.workspace_lower, limits.workspace_upper);
    // z is not checked: an object that is pressed from above is below the fingers.
    let inside = |place: [f64; 3]| (0..2).all(|i| (lower[i]..=upper[i]).contains(&place[i]));
    let mut objects = sim.object.values();
    checker.require(
        "sim.object",
        "no object within the fingers' reach".to_string(),
        objects.any(|object| object.shape != ShapeConfig::HalfSpace && inside(object.position)),
        &format!(
            "an object whose position is within control.limits along x and y, {lower:?} to {upper:?}"
        ),
    );
}

#[cfg(test)]
mod tests {
    use crate::config::{BUILT_IN, Experiment};

    /// Every experiment rejects a law that has no effect in its task.
    #[test]
    fn a_law_is_rejected_if_the_task_does_not_use_it() {
        for built_in in BUILT_IN {
            let load = |law: &str| {
                let setting = format!("control.law={law}");
                Experiment::load(built_in.name, &[setting])
            };
            let takes = load("tri-axial")
                .expect("the default")
                .config
                .task
                .takes_law();
            // A law without a required value, such as the force on an element.
            let other = load("normal-only");
            assert_eq!(other.is_ok(), takes, "{}", built_in.name);
            if let Err(error) = other {
                let error = error.to_string();
                for word in [
                    "control.law = \"normal-only\"",
                    "task.",
                    "until = \"strokes\"",
                ] {
                    assert!(
                        error.contains(word),
                        "{}: no {word} in {error}",
                        built_in.name
                    );
                }
            }
        }
        let takes = |name: &str| Experiment::load(name, &[]).map(|e| e.config.task.takes_law());
        assert_eq!(takes("cap-closing").ok(), Some(true));
        assert_eq!(takes("lift").ok(), Some(false));
    }
}
