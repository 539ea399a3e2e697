//! Prints a trace of one grip trial.
use feeler::control::task::grip::GripLaw;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::Session;
use feeler_lab::grips::GripTrial;

fn main() {
    let mut args = std::env::args().skip(1);
    let law = args.next().unwrap();
    let seed: u64 = args.next().unwrap().parse().unwrap();
    let from: f64 = args.next().unwrap().parse().unwrap();
    let until: f64 = args.next().unwrap().parse().unwrap();
    let every: usize = args.next().unwrap().parse().unwrap();
    let settings: Vec<String> = args.collect();
    let law = GripLaw::ALL.into_iter().find(|l| l.name() == law).expect("law");
    let experiment = Experiment::load("crates/feeler-lab/experiments/grip.toml", &settings).expect("file");
    let (experiment, object) = GripTrial::prepared(&experiment, law, seed * 2654435761 + 12345);
    println!("{object:?}");
    let mut session = Session::new(&experiment).unwrap();
    let mut step = 0;
    while !session.finished() {
        session.step().unwrap();
        let loop_ = session.control_loop();
        let t = loop_.state().stamp;
        step += 1;
        if t < from || t > until || step % every != 0 { continue; }
        let f = loop_.controller().task().findings();
        let world = session.rig().world();
        let index = world.model().object("object").unwrap();
        let table = world.model().object("table").unwrap();
        let p = world.state().objects[index].pose.position;
        let gap = p.z - world.state().objects[table].pose.position.z - 0.04;
        if std::env::var("EL").is_ok() {
            let rot = world.state().objects[index].pose.rotation;
            println!("tilt x-axis {:?}", rot.x_axis);
            for f in &world.state().fingers { for c in f.contacts.iter().filter(|c| c.object == index) {
                let force = f.forces[c.element];
                let nrm = rot * c.anchor.normal;
                let n = -force.dot(nrm);
                let sh = (force + n * nrm).length();
                println!("   el {} F {:.4} {:.4} {:.4} normal {:.3} {:.3} {:.3} n {:.4} ratio {:.3} apparent {:.3}", c.element, force.x, force.y, force.z, nrm.x, nrm.y, nrm.z, n, sh/n, force.z/force.x.abs());
            } }
        }
        println!("{t:.3} {:?} N {:.3} T {:.3} mu {:.3} v {:.2} mm/s  z {:.2} mm y {:.2} gap {:.2} x {:.2} mm", loop_.controller().phase(), f[0].value, f[1].value, f[2].value,
            1e3*loop_.controller().plans()[0].velocity.x, 1e3*(p.z-0.1-object.offset[2]), 1e3*p.y, 1e3*gap, 1e3*loop_.state().joints[0].position[0]);
    }
    println!("{:?} {:?}", session.control_loop().controller().task().outcome(), session.control_loop().controller().stop_reason());
}
