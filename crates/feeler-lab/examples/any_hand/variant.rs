//! Caps of other shapes and in other places than the experiment's.

use super::AnyError;
use feeler::control::task::TaskConfig;
use feeler_lab::config::Experiment;
use feeler_sim::shape::ShapeConfig;
use glam::DVec3;
use std::f64::consts::TAU;

/// How a cap differs from that of `any-hand`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// Not at all.
    Middle,
    /// It stands 3 mm off its place, in any direction.
    OffCentre,
    /// Its longest diameter is 10 % longer than its shortest.
    Oval,
    /// It has 120 knurls of 0.3 mm, as caps of PET bottles do.
    Knurled,
    /// Its diameter is 24 to 40 mm.
    Sizes,
    /// It is tightened to 20 mN·m, and to be opened.
    Opening,
    /// Three fingers at 120 degrees turn it, each with the rectangle and base of `any-hand`.
    ThreeFingers,
}

const ALL: [Variant; 7] = [
    Variant::Middle,
    Variant::OffCentre,
    Variant::Oval,
    Variant::Knurled,
    Variant::Sizes,
    Variant::Opening,
    Variant::ThreeFingers,
];

/// Height of all caps, m.
const HEIGHT: f64 = 0.02;
/// Torque to which a cap is tightened that is to be opened, N·m.
const TIGHTENED: f64 = 0.02;

impl Variant {
    /// As on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Middle => "middle",
            Self::OffCentre => "off-centre",
            Self::Oval => "oval",
            Self::Knurled => "knurled",
            Self::Sizes => "sizes",
            Self::Opening => "opening",
            Self::ThreeFingers => "three-fingers",
        }
    }

    /// The experiment that it changes.
    pub fn experiment(self) -> &'static str {
        match self {
            Self::ThreeFingers => "three-fingers",
            _ => "any-hand",
        }
    }

    /// The variants of these names, all if there are none.
    ///
    /// # Errors
    /// If there is no variant of a name.
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

    /// What it sets in the experiment of hand number `hand`.
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
            Self::ThreeFingers => three_fingers(experiment)?,
        })
    }
}

fn radius(experiment: &Experiment) -> f64 {
    match experiment.config.cap().map(|(_, cap, _)| &cap.shape) {
        Some(ShapeConfig::Cylinder { radius, .. }) => *radius,
        _ => f64::NAN,
    }
}

/// A cap that starts on its seat, and strokes the other way.
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

/// The rectangle and base of `any-hand`'s first finger for each finger, turned about the world's z.
fn three_fingers(experiment: &Experiment) -> Result<Vec<String>, AnyError> {
    let two = Experiment::load("any-hand", &[])?;
    let (TaskConfig::Screw(screw), TaskConfig::Screw(of_two)) =
        (&experiment.config.task, &two.config.task)
    else {
        return Err("expected experiments with [task.screw]".into());
    };
    let mut settings = vec![
        format!("task.screw.travel={}", of_two.travel),
        format!("task.screw.search_limit={}", of_two.search_limit),
        "time_limit=90".to_string(),
    ];
    let first = &of_two.finger[0];
    let (approach, stroke) = (DVec3::from(first.approach), DVec3::from(first.stroke));
    let turned = |place: [f64; 3], finger: usize| {
        let (place, own) = (DVec3::from(place), &screw.finger[finger]);
        let along = place.dot(approach) * DVec3::from(own.approach);
        (along + place.dot(stroke) * DVec3::from(own.stroke)).with_z(place.z)
    };
    for finger in 0..screw.finger.len() {
        let home = turned(first.home, finger).to_array();
        settings.push(format!("task.screw.finger.{finger}.home={home:?}"));
        let base = turned(two.config.hand.finger[0].base_position, finger).to_array();
        settings.push(format!("hand.finger.{finger}.base_position={base:?}"));
    }
    Ok(settings)
}
