//! Prints figures of grip trials.
use feeler::control::task::grip::GripLaw;
use feeler_lab::config::Experiment;
use feeler_lab::grips::GripTrial;

fn main() {
    let mut args = std::env::args().skip(1);
    let law = args.next().unwrap_or("partial-slip".into());
    let count: u64 = args.next().and_then(|c| c.parse().ok()).unwrap_or(100);
    let first: u64 = args.next().and_then(|c| c.parse().ok()).unwrap_or(0);
    let verbose = std::env::var("V").is_ok();
    let settings: Vec<String> = args.collect();
    let law = GripLaw::ALL.into_iter().find(|l| l.name() == law).expect("law");
    let experiment = Experiment::load("crates/feeler-lab/experiments/grip.toml", &settings).expect("file");
    let next = std::sync::atomic::AtomicU64::new(first);
    let trials = std::sync::Mutex::new(Vec::new());
    std::thread::scope(|s| {
        for _ in 0..2 {
            s.spawn(|| loop {
                let seed = next.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
                if seed >= first + count { break; }
                let t = GripTrial::run(&experiment, law, seed * 2654435761 + 12345);
                match t { Ok(t) => trials.lock().unwrap().push((seed, t)), Err(e) => println!("{seed}: {e}") }
            });
        }
    });
    let mut trials = trials.into_inner().unwrap();
    trials.sort_by_key(|t| t.0);
    let mut excess: Vec<f64> = vec![];
    let mut reactions: Vec<f64> = vec![];
    let (mut dropped, mut crushed, mut none) = (0, 0, 0);
    let (mut g, mut l) = (0.0, 0.0);
    for (seed, t) in &trials {
        let m = &t.meter;
        if t.dropped() { dropped += 1; }
        if t.crushed() { crushed += 1; }
        if m.excess().is_finite() && !t.dropped() { excess.push(m.excess()); g += m.excess()*m.mean_least(); l += m.mean_least(); }
        for r in &m.reactions { match r { Some(r) => reactions.push(*r), None => none += 1 } }
        if verbose && (t.dropped() || t.crushed() || m.excess() > 1.6) {
            println!("{seed}: {:?} drop {} crush {} excess {:.2} peak {:.2} of {:.2} least {:.2} mean {:.2} slid {:.1} mm high {:.0} mm reactions {} {:?}",
                t.outcome, t.dropped(), t.crushed(), m.excess(), m.peak, t.object.crush_force(m.peak_least), m.peak_least, m.mean_least(), 1e3*m.slid, 1e3*m.highest, m.reactions.len(), t.object);
        }
    }
    let q = |v: &mut Vec<f64>, p: f64| { v.sort_by(f64::total_cmp); if v.is_empty() { f64::NAN } else { v[((v.len()-1) as f64 * p) as usize] } };
    let mean = excess.iter().sum::<f64>() / excess.len() as f64;
    println!("{} trials: dropped {dropped}, crushed {crushed}; excess mean {mean:.3} median {:.3} p95 {:.3}, of sums {:.3}; reactions {} (none {none}) median {:.1} ms p95 {:.1} ms",
        trials.len(), q(&mut excess, 0.5), q(&mut excess, 0.95), g/l, reactions.len(), 1e3*q(&mut reactions, 0.5), 1e3*q(&mut reactions, 0.95));
}
