//! Configuration of the grip task.

use crate::check::Checker;
use crate::control::feeler_shape::FeelerShape;
use crate::control::task::carry::CarryFinger;
use serde::{Deserialize, Serialize};

/// Parameters of the grip task.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GripConfig {
    /// Law that determines the grip force.
    #[serde(default)]
    pub law: GripLaw,
    /// Grip force with which the fingers grasp the object (N): pressing force of a finger.
    pub grip_force: f64,
    /// Minimum grip force after the load has been detected (N).
    #[serde(default = "default::least_force")]
    pub least_force: f64,
    /// Duration after the first load during which the grip force is at least `grip_force` (s).
    #[serde(default = "default::load_up_time")]
    pub load_up_time: f64,
    /// Maximum grip force (N) under all laws except `policy`.
    pub max_force: f64,
    /// Force above which an element is in contact (N).
    #[serde(default = "default::touch_force")]
    pub touch_force: f64,
    /// Speed of each finger before contact (m/s).
    #[serde(default = "default::search_speed")]
    pub search_speed: f64,
    /// Maximum travel from home without contact (m). If a finger exceeds it, the hand is stopped.
    pub search_limit: f64,
    /// Bandwidth of the force control (1/s): closing speed times contact stiffness, per force error. It should not
    /// exceed a third of the inverse delay from force to motion.
    #[serde(default = "default::bandwidth")]
    pub bandwidth: f64,
    /// Maximum speed of each finger in contact (m/s).
    #[serde(default = "default::press_speed")]
    pub press_speed: f64,
    /// Initial estimate of the contact stiffness (N/m): change of the grip force per closing distance of each finger.
    #[serde(default = "default::stiffness")]
    pub stiffness: f64,
    /// Fraction of the carried load below which the object counts as put down.
    #[serde(default = "default::put_down_share")]
    pub put_down_share: f64,
    /// Duration for which the load must be below that fraction before the object counts as put down (s). It must exceed
    /// the dips in the load of a shaken object.
    #[serde(default = "default::put_down_time")]
    pub put_down_time: f64,
    /// Change of the mean shear of the fingers, after closing, above which the object counts as carried (N).
    #[serde(default = "default::carried_load")]
    pub carried_load: f64,
    /// Duration without contact of a finger after which the object counts as lost (s).
    #[serde(default = "default::lost_time")]
    pub lost_time: f64,
    /// Speed of release (m/s).
    #[serde(default = "default::return_speed")]
    pub return_speed: f64,
    /// Maximum distance from home for a finger to count as returned (m). The default is the distance by which each finger
    /// retracts from the object: fingers that share a motor do not reach home together, because backlash and homing
    /// errors of 1 mm are common in parallel grippers.
    #[serde(default = "default::home_tolerance")]
    pub home_tolerance: f64,
    /// Start position and closing direction of each finger.
    pub finger: Vec<CarryFinger>,
    /// Stiffness and tip radius of the columnar feelers.
    #[serde(default)]
    pub feeler: FeelerShape,
    /// Parameters of the law `partial-slip`. `known-friction` also uses `slip_from`, `slip_gain` and `load_time`.
    #[serde(default)]
    pub partial_slip: PartialSlipConfig,
    /// Parameters of the laws `reflex`, `missing-shear` and `drag`.
    #[serde(default)]
    pub slip_reflex: SlipReflexConfig,
    /// Friction coefficient that the law `known-friction` uses.
    #[serde(default = "default::known_friction")]
    pub known_friction: f64,
    /// Fraction of the friction limit that the load may use under the law `known-friction`.
    #[serde(default = "default::known_utilisation")]
    pub known_utilisation: f64,
    /// Grip force of the law `fixed` (N).
    #[serde(default = "default::fixed_force")]
    pub fixed_force: f64,
}

defaults! {
    least_force: f64 = 0.05,
    load_up_time: f64 = 0.05,
    touch_force: f64 = 0.02,
    search_speed: f64 = 0.02,
    bandwidth: f64 = 30.0,
    press_speed: f64 = 0.06,
    stiffness: f64 = 2000.0,
    put_down_share: f64 = 0.1,
    put_down_time: f64 = 0.15,
    carried_load: f64 = 0.06,
    lost_time: f64 = 0.2,
    return_speed: f64 = 0.04,
    home_tolerance: f64 = super::super::CLEARANCE,
    known_friction: f64 = 0.5,
    known_utilisation: f64 = 0.7,
    fixed_force: f64 = 20.0,
}

/// Law that determines the grip force from load and slip.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum GripLaw {
    /// Load divided by the friction coefficient, which is estimated from partial slip at the edge of the contact.
    #[default]
    PartialSlip,
    /// The paper's reflex: the fingers close at a constant speed while the SLIP flag is raised.
    Reflex,
    /// The reflex with slip detected from missing shear.
    MissingShear,
    /// The reflex with slip detected from drag.
    Drag,
    /// Load divided by a friction coefficient that is known in advance. The force is multiplied by a factor when the
    /// contact slips.
    KnownFriction,
    /// Constant grip force.
    Fixed,
    /// The control law `policy` chooses the velocity of each finger; the task plans to hold its position.
    Policy,
}

impl GripLaw {
    /// All laws that require no file.
    pub const ALL: [Self; 6] = [
        Self::PartialSlip,
        Self::Reflex,
        Self::MissingShear,
        Self::Drag,
        Self::KnownFriction,
        Self::Fixed,
    ];

    /// Name of the law in experiment files.
    pub fn name(self) -> &'static str {
        match self {
            Self::PartialSlip => "partial-slip",
            Self::Reflex => "reflex",
            Self::MissingShear => "missing-shear",
            Self::Drag => "drag",
            Self::KnownFriction => "known-friction",
            Self::Fixed => "fixed",
            Self::Policy => "policy",
        }
    }
}

/// Parameters of the law `partial-slip`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct PartialSlipConfig {
    /// Fraction of the friction limit that the load may use.
    pub utilisation: f64,
    /// Fraction of the pressing force carried by each group of elements; the groups' ratios of shear to pressing force
    /// are compared.
    pub group_share: f64,
    /// Fraction of the friction limit above which gross slip is assumed.
    pub slip_from: f64,
    /// Maximum factor on the grip force during gross slip.
    pub slip_gain: f64,
    /// Initial friction coefficient, until a larger one is estimated.
    pub least_friction: f64,
    /// Pressing force above which an element is used to estimate friction (N).
    pub least_pressing: f64,
    /// Time constant of the mean force of an element (s).
    pub filter_time: f64,
    /// Time constant with which the friction estimate rises (s).
    pub friction_time: f64,
    /// Time constant with which the friction estimate falls if the present ratio at the edge is smaller (s).
    pub forget_time: f64,
    /// Time constant with which the estimated load falls (s).
    pub load_time: f64,
}

impl Default for PartialSlipConfig {
    fn default() -> Self {
        Self {
            utilisation: 0.81,
            group_share: 0.2,
            slip_from: 0.88,
            slip_gain: 3.0,
            least_friction: 0.2,
            least_pressing: 0.01,
            filter_time: 0.03,
            friction_time: 0.012,
            forget_time: 10.0,
            load_time: 0.1,
        }
    }
}

/// Parameters of the laws that close the fingers while slip is detected.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SlipReflexConfig {
    /// Speed at which each finger closes while slip is detected (m/s); v_r in the paper.
    pub speed: f64,
    /// Missing shear from which an element counts as slipping (N), for `missing-shear`.
    pub missing_shear: f64,
    /// Drag from which the object counts as slipping (N), for `drag`.
    pub drag: f64,
}

impl Default for SlipReflexConfig {
    fn default() -> Self {
        Self {
            speed: 0.003,
            missing_shear: 0.0098,
            drag: 0.02,
        }
    }
}

impl GripConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let positive = [
            ("touch_force", self.touch_force),
            ("least_force", self.least_force),
            ("load_up_time", self.load_up_time),
            ("search_speed", self.search_speed),
            ("search_limit", self.search_limit),
            ("bandwidth", self.bandwidth),
            ("press_speed", self.press_speed),
            ("stiffness", self.stiffness),
            ("put_down_time", self.put_down_time),
            ("carried_load", self.carried_load),
            ("lost_time", self.lost_time),
            ("return_speed", self.return_speed),
            ("home_tolerance", self.home_tolerance),
            ("known_friction", self.known_friction),
            ("known_utilisation", self.known_utilisation),
            ("fixed_force", self.fixed_force),
        ];
        checker.all_positive(key, &positive);
        let share = self.put_down_share;
        checker.between(&format!("{key}.put_down_share"), share, 0.0, 0.9);
        let grip_force = ("grip_force", self.grip_force);
        checker.more_than(key, grip_force, ("touch_force", self.touch_force));
        checker.more_than(key, ("max_force", self.max_force), grip_force);
        let fingers = self.finger.len();
        checker.require(
            &format!("{key}.finger"),
            format!("{fingers} fingers"),
            fingers >= 2,
            "at least 2 fingers that press against each other",
        );
        for (index, finger) in self.finger.iter().enumerate() {
            checker.vector(&format!("{key}.finger[{index}].home"), finger.home);
            checker.direction(&format!("{key}.finger[{index}].approach"), finger.approach);
        }
        self.feeler.check(&format!("{key}.feeler"), checker);
        self.partial_slip
            .check(&format!("{key}.partial_slip"), checker);
        self.slip_reflex
            .check(&format!("{key}.slip_reflex"), checker);
    }
}

impl PartialSlipConfig {
    fn check(&self, key: &str, checker: &mut Checker) {
        let shares = [
            ("utilisation", self.utilisation),
            ("group_share", self.group_share),
            ("slip_from", self.slip_from),
        ];
        for (field, share) in shares {
            checker.between(&format!("{key}.{field}"), share, 0.01, 1.0);
        }
        let positive = [
            ("least_friction", self.least_friction),
            ("least_pressing", self.least_pressing),
            ("filter_time", self.filter_time),
            ("friction_time", self.friction_time),
            ("forget_time", self.forget_time),
            ("load_time", self.load_time),
        ];
        checker.all_positive(key, &positive);
        checker.between(&format!("{key}.slip_gain"), self.slip_gain, 1.0, 10.0);
    }
}

impl SlipReflexConfig {
    fn check(&self, key: &str, checker: &mut Checker) {
        let positive = [
            ("speed", self.speed),
            ("missing_shear", self.missing_shear),
            ("drag", self.drag),
        ];
        checker.all_positive(key, &positive);
    }
}
