//! Reaction time of the law `pivot` to slip, and its excess of grasp force.
//!
//! ```text
//! cargo run --release -p feeler-lab --example needed_grip -- 610200 200 constant as-needed
//! ```
//!
//! The arguments are FIRST COUNT LOAD [GRIP]. COUNT plausible hands, numbered from FIRST, turn a loaded cap in the
//! experiment `any-hand`, with forces sensed directly. LOAD is `constant`, a thread that resists with 8 mN·m
//! throughout, or `ramp`, a torque that rises from the beginning by 10 mN·m/rad. GRIP is `as-needed` (default) or
//! `firm`. Slip and forces are ground truth of the simulator.
//!
//! A slip begins in the control period in which an element that is pressed with more than F1 slides by more than 20
//! µm, after 100 ms without such an element. Times are measured from the start of that period to the end of the period
//! in which the command moves the finger towards the cap's axis at more than 1 mm/s, or the grasp force is 3 % above
//! its value at the end of the first period.

use feeler::control::Phase;
use feeler::sensor::fingertip::ElementLayout;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Pictures, Session, Truth};
use feeler_sim::contact::FeelerConfig;
use feeler_sim::world::FingerState;
use glam::{DVec2, DVec3};
use std::num::NonZeroU32;

type AnyError = Box<dyn std::error::Error + Send + Sync>;

const USAGE: &str = "usage: needed_grip FIRST COUNT constant|ramp [as-needed|firm]";
/// Control period (s) and F1 (N) of the experiment.
const PERIOD: f64 = 0.01;
const TOUCH_FORCE: f64 = 0.1;
/// Slip distance in a control period above which an element slips (m).
const SLIP_DISTANCE: f64 = 20e-6;
/// Minimum time without slip before an onset, and maximum time to wait for a reaction (s).
const QUIET_TIME: f64 = 0.1;
const LONGEST_WAIT: f64 = 0.3;
/// Grasp force that counts as more grip, relative to the value at the onset.
const MORE_GRIP: f64 = 1.03;
/// Commanded inward velocity that counts as a reaction (m/s).
const INWARD: f64 = 1e-3;
/// Minimum load on a finger for measuring the excess (N).
const MIN_LOAD: f64 = 0.05;

/// Command-line arguments.
pub struct Arguments {
    /// Numbers of the hands.
    pub hands: std::ops::Range<u64>,
    /// Settings of the experiment.
    settings: Vec<String>,
}

impl Arguments {
    /// Parses command-line arguments.
    pub fn parse(arguments: &[String]) -> Result<Self, AnyError> {
        let (first, count, load, grip) = match arguments {
            [first, count, load] => (first, count, load, "as-needed"),
            [first, count, load, grip] => (first, count, load, grip.as_str()),
            _ => return Err(USAGE.into()),
        };
        let number = |text: &String| match text.parse::<NonZeroU32>() {
            Ok(number) => Ok(u64::from(number.get())),
            Err(error) => Err(format!("{text:?}: {error}\n{USAGE}")),
        };
        let (first, count) = (number(first)?, number(count)?);
        let thread = match load.as_str() {
            "constant" => ["seat_angle=20.0", "running_torque=0.008"],
            "ramp" => ["seat_angle=0.0", "seat_stiffness=0.01"],
            _ => return Err(format!("there is no load {load:?}\n{USAGE}").into()),
        };
        let mut settings = vec![format!("control.law={{ pivot = {{ grip = \"{grip}\" }} }}")];
        settings.extend(thread.map(|set| format!("sim.object.cap.motion.thread.{set}")));
        Ok(Self {
            hands: first..first + count,
            settings,
        })
    }

    /// Returns the experiment of a plausible hand with the load and grip of the arguments.
    pub fn experiment(&self, hand: u64) -> Result<Experiment, AnyError> {
        let drawn = Experiment::load("any-hand", &[format!("seed={hand}")])?;
        // Setting plausible_hand prevents another draw, which would replace the load.
        let settings = [&self.settings[..], &[format!("plausible_hand={hand}")]].concat();
        Ok(drawn.with_settings(&settings)?)
    }
}

/// True forces between one finger and the cap after a control period, and the finger's command.
#[derive(Debug, Clone, Copy, Default)]
struct Contact {
    /// Sums of the forces along the cap's normals and tangents (N).
    normal: f64,
    tangential: f64,
    /// Commanded velocity towards the cap's axis (m/s).
    inward: f64,
    slips: bool,
}

/// Reaction to one slip: times since its onset (s). `None` if not yet reached, infinite if not reached within
/// [`LONGEST_WAIT`].
#[derive(Debug, Clone, Copy, Default)]
struct Reaction {
    since: f64,
    normal: f64,
    to_command: Option<f64>,
    to_grip: Option<f64>,
}

impl Reaction {
    fn update(&mut self, contact: Contact) {
        self.since += PERIOD;
        let late = self.since > LONGEST_WAIT;
        let now = if late { f64::INFINITY } else { self.since };
        if late || contact.inward > INWARD {
            self.to_command.get_or_insert(now);
        }
        if late || contact.normal > MORE_GRIP * self.normal {
            self.to_grip.get_or_insert(now);
        }
    }
}

/// Measurements of one finger.
#[derive(Debug, Clone, Default)]
pub struct Finger {
    /// Slip distance of each element (m), and whether it is pressed with more than F1.
    slipped: Vec<f64>,
    pressed: Vec<bool>,
    quiet: f64,
    latest: Option<Reaction>,
    /// Times from slip onset to the command and to more grip (ms).
    pub reactions: Vec<(f64, f64)>,
    /// Grasp force divided by the minimum that holds the load by static friction, minus 1.
    pub excess: Vec<f64>,
}

impl Finger {
    /// Computes the contact of `finger` with a cap whose axis is at `axis` (m, in W). `velocity` is the commanded
    /// velocity (m/s, in W).
    fn contact(
        &mut self,
        finger: &FingerState,
        layout: &ElementLayout,
        feeler: &FeelerConfig,
        axis: DVec2,
        velocity: DVec3,
    ) -> Contact {
        let mut contact = Contact::default();
        let (position, rotation) = (finger.tip.position, finger.tip.rotation);
        let outward = (position.truncate() - axis).normalize_or_zero();
        contact.inward = -velocity.truncate().dot(outward);
        self.slipped.resize(finger.forces.len(), 0.0);
        self.pressed.resize(finger.forces.len(), false);
        for (index, &force) in finger.forces.iter().enumerate() {
            let element = rotation * layout.elements[index].normal();
            let along = force.dot(element) * element;
            let across = force - along;
            let yielded = along / feeler.normal_stiffness + across / feeler.shear_stiffness;
            let tip = position + rotation * layout.tip(index) - yielded;
            let normal = (tip.truncate() - axis).normalize_or_zero();
            contact.normal -= force.truncate().dot(normal);
            contact.tangential += normal.perp_dot(force.truncate());
            let pressed = along.length() > TOUCH_FORCE;
            let distance = finger.slipped[index] - self.slipped[index];
            contact.slips |= pressed && self.pressed[index] && distance > SLIP_DISTANCE;
            (self.slipped[index], self.pressed[index]) = (finger.slipped[index], pressed);
        }
        contact
    }

    /// Adds a control period. `turns` is `true` if the finger turned the cap.
    fn add(&mut self, contact: Contact, static_friction: f64, turns: bool) {
        // Discard the slip if the stroke ends before the reaction.
        self.latest = self.latest.filter(|_| turns);
        if let Some(latest) = &mut self.latest {
            latest.update(contact);
            if let (Some(command), Some(grip)) = (latest.to_command, latest.to_grip) {
                self.reactions.push((1e3 * command, 1e3 * grip));
                self.latest = None;
            }
        } else if turns && contact.slips && self.quiet > QUIET_TIME - 0.5 * PERIOD {
            self.latest = Some(Reaction {
                since: PERIOD,
                normal: contact.normal,
                ..Reaction::default()
            });
        }
        self.quiet = f64::from(u8::from(!contact.slips)) * (self.quiet + PERIOD);
        let load = contact.tangential.abs();
        if turns && load > MIN_LOAD {
            let holding = load / static_friction;
            self.excess.push(contact.normal / holding - 1.0);
        }
    }
}

/// Runs `experiment`. Returns the measurements of each finger, and the angle by which the cap turned (rad).
pub fn run(experiment: &Experiment) -> Result<(Vec<Finger>, f64), AnyError> {
    let feeler = &experiment.config.simulation()?.feeler;
    let mut session = Session::rendering(experiment, Pictures::Sensed)?;
    let cap = session.rig().world().model().object("cap");
    let cap = cap.ok_or("the experiment has no cap")?;
    let mut fingers = vec![Finger::default(); session.layouts().len()];
    while !session.finished() {
        session.step()?;
        let world = session.rig().world();
        let controller = session.control_loop().controller();
        let turns = controller.phase() == Phase::Move;
        let axis = world.state().objects[cap].pose.position.truncate();
        let states = world.state().fingers.iter().zip(session.layouts());
        let commands = controller.fingers().iter().map(|finger| finger.velocity);
        for ((finger, (state, layout)), velocity) in fingers.iter_mut().zip(states).zip(commands) {
            let contact = finger.contact(state, layout, feeler, axis, velocity);
            finger.add(contact, feeler.static_friction, turns);
        }
    }
    let angle = Truth::of(&session).cap_angle.unwrap_or(f64::NAN);
    Ok((fingers, angle.abs()))
}

/// Returns the quantile of `values` at probability `part` (0 to 1); NaN if there are no values.
pub fn quantile(values: impl IntoIterator<Item = f64>, part: f64) -> f64 {
    let mut values: Vec<f64> = values.into_iter().collect();
    values.sort_by(f64::total_cmp);
    let index = part * values.len().saturating_sub(1) as f64;
    values.get(index.round() as usize).map_or(f64::NAN, |&v| v)
}

fn main() -> Result<(), AnyError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let arguments = Arguments::parse(&arguments)?;
    let (mut reactions, mut excess, mut angles) = (vec![], vec![], vec![]);
    for hand in arguments.hands.clone() {
        let (fingers, angle) = run(&arguments.experiment(hand)?)?;
        let samples = fingers.iter().flat_map(|finger| finger.excess.clone());
        excess.push(100.0 * quantile(samples, 0.5));
        reactions.extend(fingers.into_iter().flat_map(|finger| finger.reactions));
        angles.push(angle);
    }
    let slips = reactions.len();
    println!("{slips} slips; times in ms; inf: more than 300 ms");
    let print = |name: &str, values: Vec<f64>| {
        let [median, high] = [0.5, 0.95].map(|part| quantile(values.iter().copied(), part));
        println!("{name:<44} median {median:4.0}  p95 {high:4.0}");
    };
    let prompt = reactions.iter().filter(|(command, _)| *command < 25.0);
    let prompt: Vec<f64> = prompt.map(|(_, grip)| *grip).collect();
    let share = 100.0 * prompt.len() as f64 / slips as f64;
    let (commands, grips) = reactions.into_iter().unzip();
    print("slip to command", commands);
    print("slip to more grip", grips);
    print(&format!("  if commanded by 20 ms ({share:.0} %)"), prompt);
    print("median excess of the grip of a hand, %", excess);
    println!("cap turned by {:.2} rad, median", quantile(angles, 0.5));
    Ok(())
}
