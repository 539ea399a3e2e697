//! Variants of the cap and the hand.

use super::AnyError;
use feeler::control::task::TaskConfig;
use feeler_lab::config::Experiment;
use feeler_sim::shapes::ShapeConfig;
use glam::{DMat3, DVec3};
use std::f64::consts::TAU;

/// Difference from the experiment `any-hand`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// No difference.
    Middle,
    /// The cap is displaced by 3 mm in any direction.
    OffCentre,
    /// The longest diameter of the cap is 10 % larger than the shortest.
    Oval,
    /// The cap has 120 knurls of 0.3 mm, like caps of PET bottles.
    Knurled,
    /// The diameter of the cap is 24 to 40 mm.
    Sizes,
    /// The cap is tightened to 20 mN·m and must be opened.
    Opening,
    /// The rubber of one finger is twice as stiff as that of the other.
    UnequalStiffness,
    /// Only the first finger of `any-hand` turns the cap.
    OneFinger,
    /// Three fingers like the first one of `any-hand`, at 120 degrees.
    ThreeFingers,
    /// Five fingers like the first one of `any-hand`, at 72 degrees.
    FiveFingers,
}

const ALL: [Variant; 10] = [
    Variant::Middle,
    Variant::OffCentre,
    Variant::Oval,
    Variant::Knurled,
    Variant::Sizes,
    Variant::Opening,
    Variant::UnequalStiffness,
    Variant::OneFinger,
    Variant::ThreeFingers,
    Variant::FiveFingers,
];

/// Height of all caps (m).
const HEIGHT: f64 = 0.02;
/// Initial torque of a cap that must be opened (N·m).
const TIGHTENED: f64 = 0.02;

impl Variant {
    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Middle => "middle",
            Self::OffCentre => "off-centre",
            Self::Oval => "oval",
            Self::Knurled => "knurled",
            Self::Sizes => "sizes",
            Self::Opening => "opening",
            Self::UnequalStiffness => "unequal-stiffness",
            Self::OneFinger => "one-finger",
            Self::ThreeFingers => "three-fingers",
            Self::FiveFingers => "five-fingers",
        }
    }

    /// Returns the variants with these names, or all if there are no names.
    ///
    /// # Errors
    /// If a name is unknown.
    pub fn chosen(names: &[String]) -> Result<Vec<Self>, AnyError> {
        if names.is_empty() {
            return Ok(ALL.into());
        }
        let known = ALL.map(Self::name).join(", ");
        let named = |name: &String| {
            let found = ALL.into_iter().find(|variant| variant.name() == name);
            found.ok_or_else(|| format!("no variant {name:?}: expected one of {known}").into())
        };
        names.iter().map(named).collect()
    }

    /// Returns the settings of this variant for the hand with number `hand`.
    pub fn settings(self, experiment: &Experiment, hand: u64) -> Result<Vec<String>, AnyError> {
        let shape = "sim.object.cap.shape";
        let radius = radius(experiment);
        // Golden-ratio steps cover a range evenly.
        let spread = (hand as f64 * 0.618_033_988_749_895).fract();
        Ok(match self {
            Self::Middle => Vec::new(),
            Self::OffCentre => {
                let (y, x) = (TAU * spread).sin_cos();
                let (x, y) = (0.003 * x, 0.003 * y);
                vec![format!("sim.object.cap.position=[{x},{y},0.1]")]
            }
            Self::Oval => vec![format!(
                "{shape}={{knurled_cylinder={{radius={radius},height={HEIGHT},knurls=0,depth=0.0,ovality=0.0476}}}}"
            )],
            Self::Knurled => vec![format!(
                "{shape}={{knurled_cylinder={{radius={radius},height={HEIGHT},knurls=120,depth=0.0003}}}}"
            )],
            Self::Sizes => {
                let radius = 0.012 + 0.008 * spread;
                vec![format!(
                    "{shape}={{cylinder={{radius={radius},height={HEIGHT}}}}}"
                )]
            }
            Self::Opening => opening(experiment),
            Self::UnequalStiffness => unequal_stiffness(experiment)?,
            Self::OneFinger => around(experiment, 1)?,
            Self::ThreeFingers => around(experiment, 3)?,
            Self::FiveFingers => around(experiment, 5)?,
        })
    }
}

fn radius(experiment: &Experiment) -> f64 {
    match experiment.config.cap().map(|(_, cap, _)| &cap.shape) {
        Some(ShapeConfig::Cylinder { radius, .. }) => *radius,
        _ => f64::NAN,
    }
}

/// Settings for a cap that starts on its seat, and for strokes in the opening direction.
fn opening(experiment: &Experiment) -> Vec<String> {
    let mut settings = Vec::new();
    if let Some((_, _, thread)) = experiment.config.cap() {
        let angle = -(TIGHTENED - thread.running_torque) / thread.seat_stiffness;
        settings.push(format!("sim.object.cap.motion.thread.seat_angle={angle}"));
    }
    if let TaskConfig::Screw(screw) = &experiment.config.task {
        for (index, finger) in screw.finger.iter().enumerate() {
            let key = format!("task.screw.finger.{index}");
            settings.push(format!("{key}.home.1={}", -finger.home[1]));
            settings.push(format!("{key}.stroke.1={}", -finger.stroke[1]));
        }
    }
    settings
}

/// Settings that double the stiffness of the second finger's rubber, along and across.
fn unequal_stiffness(experiment: &Experiment) -> Result<Vec<String>, AnyError> {
    let feeler = &experiment.config.simulation()?.feeler;
    let count = experiment.fingertip(Some(1))?.layout.element_count();
    let elements: Vec<usize> = (0..count).collect();
    let (normal, shear) = (2.0 * feeler.normal_stiffness, 2.0 * feeler.shear_stiffness);
    Ok(vec![format!(
        "sim.element=[{{finger=1,elements={elements:?},normal_stiffness={normal:?},shear_stiffness={shear:?}}}]"
    )])
}

/// Settings for `count` copies of the first finger, with base and path, evenly spaced about the z axis of the world.
fn around(experiment: &Experiment, count: usize) -> Result<Vec<String>, AnyError> {
    let TaskConfig::Screw(screw) = &experiment.config.task else {
        return Err("expected an experiment with [task.screw]".into());
    };
    let base = experiment.config.hand.finger[0].three_joints();
    let base = base.ok_or("expected a finger with three joints")?;
    let path = &screw.finger[0];
    let (mut fingers, mut paths) = (Vec::new(), Vec::new());
    for finger in 0..count {
        let angle = TAU * finger as f64 / count as f64;
        let turned =
            |place: [f64; 3]| (DMat3::from_rotation_z(angle) * DVec3::from(place)).to_array();
        // Bases are not rotated; a finger faces the object by the range of its first joint.
        let mut own = base.clone();
        own.base_position = turned(base.base_position);
        own.joint_lower_deg[0] += angle.to_degrees();
        own.joint_upper_deg[0] += angle.to_degrees();
        fingers.push(toml::Value::try_from(own)?.to_string());
        let mut own = path.clone();
        own.home = turned(path.home);
        own.approach = turned(path.approach);
        own.stroke = turned(path.stroke);
        paths.push(toml::Value::try_from(own)?.to_string());
    }
    Ok(vec![
        format!("hand.finger=[{}]", fingers.join(",")),
        format!("task.screw.finger=[{}]", paths.join(",")),
        "control.limits.workspace_lower=[-0.06,-0.06,0.07]".into(),
        "control.limits.workspace_upper=[0.06,0.06,0.13]".into(),
    ])
}
