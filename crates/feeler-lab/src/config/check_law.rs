//! What every value of a control law must be.

use super::check_touch_tasks::check_feeler;
use super::checker::Checker;
use feeler::control::controller::ControlConfig;
use feeler::control::law::LawConfig;
use feeler::control::law::best::BestConfig;

/// Coefficients of friction that anything could have.
const FRICTION: (f64, f64) = (0.01, 10.0);

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
