//! Coverage and errors of `feeler identify` over plausible hands.
use feeler_lab::config::Experiment;
use feeler_lab::identify::{Trace, probing};
use feeler_lab::sweep::design::Design;
use feeler_lab::sweep::trial::Trials;
use feeler_lab::sweep::{Plan, ranges};
use std::error::Error;
use std::io::Write;
use std::path::Path;
use feeler_lab::experiment::Session;

type AnyError = Box<dyn Error + Send + Sync>;

fn hands(settings: &[String], count: u64, seed: u64) -> Result<Vec<Experiment>, AnyError> {
    let files: [&Path; 0] = [];
    let mut ranges = ranges::load(&files, "cap-closing")?;
    ranges.parameter.retain(|entry| entry.group == "apparatus");
    let experiment = Experiment::load("cap-closing", &[settings, &["sensing=direct".into()]].concat())?;
    let design = Design { rows: count, controls: 0, pairs: 1 };
    let plan = Plan::designed(&experiment, "cap-closing", ranges.parameter, design, seed)?;
    let trials = Trials::new(&plan)?;
    (0..count)
        .map(|trial| {
            let hand = trials.experiment(trial)?;
            let stiffness = hand.config.simulation()?.feeler.normal_stiffness;
            let over_force = 0.505 * (stiffness / 205.0).sqrt();
            Ok(hand.with_settings(&[format!("control.over_force={over_force}")])?)
        })
        .collect()
}

fn main() -> Result<(), AnyError> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [count, seed, out, settings @ ..] = &args[..] else { return Err("COUNT SEED OUT".into()) };
    let mut file = std::io::BufWriter::new(std::fs::File::create(out)?);
    let mut put = |v: f64| file.write_all(&v.to_le_bytes());
    let hands = hands(settings, count.parse()?, seed.parse()?)?;
    for (i, hand) in hands.iter().enumerate() {
        let e = probing(hand)?;
        let trace = match Trace::of_simulation(&e) { Ok(t) => t, Err(error) => { println!("{i}: {error}"); continue } };
        let sim = e.config.simulation()?;
        let f = &sim.feeler;
        let session = Session::new(&e)?;
        let world = session.rig().world();
        let pose = world.state().objects[0].pose;
        let position = pose.position;
        let cap = feeler_lab::experiment::run_facts(&e.config)?.cap_radius;
        println!("{i}: time {:.1}", trace.fingers[0].rows.last().map_or(0.0, |r| r.time));
        for v in [f.normal_stiffness, f.shear_stiffness, f.tip_radius, f.static_friction, f.kinetic_friction, cap, position.x, position.y, sim.servo.lag, sim.direct_sensing.normal_noise, e.config.control.over_force] { put(v)?; }
        let t = &trace.probe;
        for v in [t.press_force, t.slide_force, t.tip_radius[0], t.tip_radius[1], trace.fingers.len() as f64] { put(v)?; }
        for f in &trace.fingers {
            for v in f.approach.to_array().into_iter().chain(f.axis.to_array()) { put(v)?; }
            put(f.rows.len() as f64)?;
            for r in &f.rows {
                for v in [r.time, f64::from(r.step as u8), f64::from(r.place)] { put(v)?; }
                for v in r.command.to_array().into_iter().chain(r.joints.to_array()).chain(r.pose.position.to_array()).chain(r.pose.rotation.to_cols_array()) { put(v)?; }
                for x in &r.forces { for v in x.to_array() { put(v)?; } }
            }
        }
    }
    Ok(())
}
