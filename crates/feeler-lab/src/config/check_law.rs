//! What every value of a control law must be.

use super::ExperimentConfig;
use super::check_touch_tasks::check_feeler;
use super::checker::Checker;
use feeler::control::controller::ControlConfig;
use feeler::control::law::LawConfig;
use feeler::control::law::best::BestConfig;
use feeler::control::task::TaskConfig;

/// Coefficients of friction that anything could have.
const FRICTION: (f64, f64) = (0.01, 10.0);

/// A law where the task takes one.
pub(super) fn check_law_of_task(config: &ExperimentConfig, checker: &mut Checker) {
    let (law, task) = (&config.control.law, &config.task);
    checker.require(
        "control.law",
        format!("{:?}", law.name()),
        task.takes_law() || *law == LawConfig::default(),
        &format!(
            "{:?}, the default, because task.{} controls its contact forces itself; only {} takes another law",
            LawConfig::default().name(),
            task.name(),
            TaskConfig::WITH_LAW,
        ),
    );
}

pub(super) fn check_law(control: &ControlConfig, checker: &mut Checker) {
    let table = format!("control.law.{}", control.law.name());
    let key = |field: &str| format!("{table}.{field}");
    match &control.law {
        LawConfig::TriAxial => {}
        LawConfig::TriAxialMissingShear(law) => {
            checker.positive(&key("threshold"), law.threshold);
            check_feeler(&table, &law.feeler, checker);
        }
        LawConfig::NormalOnly(law) => {
            checker.between(&key("friction"), law.friction, FRICTION.0, FRICTION.1);
            checker.not_negative(&key("tangential_load"), law.tangential_load);
            checker.not_negative(&key("gain"), law.gain);
            checker.not_negative(&key("pressing_speed"), law.pressing_speed);
        }
        LawConfig::OpenLoop(law) => {
            checker.between(&key("squeeze"), law.squeeze, 0.0, 0.1);
            checker.not_negative(&key("squeeze_speed"), law.squeeze_speed);
        }
        LawConfig::Best(law) => check_best(law, control, key, checker),
    }
}

fn check_best(
    law: &BestConfig,
    control: &ControlConfig,
    key: impl Fn(&str) -> String,
    checker: &mut Checker,
) {
    checker.between(&key("friction"), law.friction, FRICTION.0, FRICTION.1);
    checker.between(&key("learning_rate"), law.learning_rate, 0.0, 1.0);
    checker.between(&key("margin"), law.margin, 1.0, 100.0);
    checker.not_negative(&key("least_grasp_force"), law.least_grasp_force);
    let (touch, over) = (control.touch_force, control.over_force);
    checker.require(
        &key("element_force"),
        law.element_force.to_string(),
        law.element_force > touch && law.element_force <= over,
        &format!(
            "more than control.touch_force (F1) = {touch}, at most control.over_force (F2) = {over}"
        ),
    );
    checker.between(&key("slip_share"), law.slip_share, 0.0, 1.0);
    checker.not_negative(&key("gain"), law.gain);
    checker.not_negative(&key("pressing_speed"), law.pressing_speed);
}

#[cfg(test)]
mod tests {
    use crate::config::{BUILT_IN, Experiment};

    /// No experiment takes a law that would change nothing.
    #[test]
    fn a_law_is_refused_where_the_task_takes_none() {
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
            let best = load("best");
            assert_eq!(best.is_ok(), takes, "{}", built_in.name);
            if let Err(error) = best {
                let error = error.to_string();
                for word in ["control.law = \"best\"", "task.", "until = \"strokes\""] {
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
