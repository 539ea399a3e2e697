//! The simulated world as a library: build it from an experiment, step it, read forces, torque and poses.
//!
//! ```text
//! cargo run --release --example world
//! ```

use feeler_lab::config::Experiment;
use feeler_lab::experiment::world;
use glam::DVec3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let experiment = Experiment::load("cap-closing", &[])?;
    let mut world = world(&experiment)?;
    for _ in 0..1000 {
        world.command(0, [0.0, 0.2, -0.4].into()); // rad/s
        world.step()?;
    }
    let mut forces = [DVec3::ZERO; 41];
    world.element_forces(0, &mut forces);
    let pressed: f64 = forces.iter().map(|force| force.z).sum();
    println!(
        "finger 0 presses with {pressed:.3} N, {} feelers touch",
        world.state().fingers[0].contacts.len()
    );
    println!(
        "fingertip at {:.4} m",
        world.state().fingers[0].tip.position
    );
    println!(
        "cap at {:.4} m, turned by {:.4} rad",
        world.state().objects[0].pose.position,
        world.state().objects[0].turn.angle
    );
    println!("torque on the bottle {:.5} N m", world.read_torque().torque);
    Ok(())
}
