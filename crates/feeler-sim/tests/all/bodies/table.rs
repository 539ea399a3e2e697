//! Free bodies without fingers: falling, resting, and sticking or sliding on an incline.

use super::scene::{GRAVITY, cuboid, empty, fixed, free, run, world};
use feeler_sim::shapes::shape::ShapeConfig;
use glam::DVec3;

#[test]
fn a_free_body_falls_with_gravity() {
    let mut sim = empty();
    let body = free(cuboid(0.03, 0.03, 0.03), 0.05, 0.5);
    sim.object.insert("box".into(), body);
    let mut world = world(&sim);
    let time = 0.2;
    run(&mut world, time);
    let fall = -world.state().objects[0].pose.position.z;
    // Velocity is integrated before position, which is half a step ahead, up to rounding.
    let expected = 0.5 * GRAVITY * time * (time + sim.step);
    assert!(
        (fall - expected).abs() < 1e-12,
        "expected {expected} m, got {fall} m"
    );
}

#[test]
fn a_box_rests_on_its_table_for_a_minute() {
    let mut sim = empty();
    sim.object
        .insert("table".into(), fixed(ShapeConfig::HalfSpace));
    let mut body = free(cuboid(0.03, 0.04, 0.05), 0.05, 0.5);
    body.position = [0.0, 0.0, 0.025];
    sim.object.insert("box".into(), body);
    let mut world = world(&sim);
    run(&mut world, 60.0);
    let pose = world.state().objects[0].pose;
    // The box may settle only by the compliance of its contacts, g / (2 pi 1000 Hz)².
    let moved = pose.position - DVec3::new(0.0, 0.0, 0.025);
    assert!(moved.length() < 1e-6, "moved by {moved} m");
    assert!((pose.rotation.z_axis - DVec3::Z).length() < 1e-5);
}

/// Distance (m) that a block slides within `seconds` down a plane tilted by `angle` (rad), with friction `mu`.
fn slid(angle: f64, mu: f64, seconds: f64) -> f64 {
    let mut sim = empty();
    let tilt = [0.0, angle.to_degrees(), 0.0];
    let mut plane = fixed(ShapeConfig::HalfSpace);
    plane.orientation_deg = tilt;
    sim.object.insert("plane".into(), plane);
    let mut block = free(cuboid(0.04, 0.04, 0.02), 0.05, mu);
    block.orientation_deg = tilt;
    block.position = (0.010 * DVec3::new(angle.sin(), 0.0, angle.cos())).to_array();
    sim.object.insert("block".into(), block);
    let mut world = world(&sim);
    let index = world.model().object("block").expect("the block");
    let start = world.state().objects[index].pose.position;
    run(&mut world, seconds);
    let way = world.state().objects[index].pose.position - start;
    way.dot(DVec3::new(angle.cos(), 0.0, -angle.sin()))
}

#[test]
fn a_block_on_an_incline_sticks_or_slides_by_coulombs_law() {
    let time = 0.4;
    for mu in [0.2, 0.5, 0.9] {
        for part in [0.5_f64, 0.9, 0.98] {
            let way = slid((part * mu).atan(), mu, 10.0);
            assert!(
                way.abs() < 1e-5,
                "crept by {way} m at {part} of tan a = {mu}"
            );
        }
        for part in [1.02_f64, 1.1, 1.5, 2.0] {
            let angle = (part * mu).atan();
            let acceleration = GRAVITY * (angle.sin() - mu * angle.cos());
            let expected = 0.5 * acceleration * time * time;
            let way = slid(angle, mu, time);
            // First-order integration: at most the distance of one step, plus settling.
            let tolerance = 0.003 * expected + 2e-5;
            assert!(
                (way - expected).abs() < tolerance,
                "at {part} of tan a = {mu}: expected {expected} m, got {way} m"
            );
        }
    }
}

/// A cube with sides of 30 mm as an OBJ file in millimetres.
const CUBE: &str = "\
v -15 -15 -15\nv 15 -15 -15\nv 15 15 -15\nv -15 15 -15\nv -15 -15 15\nv 15 -15 15\nv 15 15 15\nv -15 15 15
f 1 3 2\nf 1 4 3\nf 5 6 7\nf 5 7 8\nf 1 2 6\nf 1 6 5\nf 2 3 7\nf 2 7 6\nf 3 4 8\nf 3 8 7\nf 4 1 5\nf 4 5 8\n";

#[test]
fn a_free_mesh_rests_on_its_table_with_the_mass_of_its_volume() {
    let file = std::env::temp_dir().join(format!("feeler-cube-{}.obj", std::process::id()));
    std::fs::write(&file, CUBE).expect("a file");
    let mut sim = empty();
    sim.object
        .insert("table".into(), fixed(ShapeConfig::HalfSpace));
    let shape = ShapeConfig::Mesh {
        file: file.clone(),
        scale: 0.001,
    };
    let mut mesh = free(shape, 0.027, 0.5);
    mesh.position = [0.0, 0.0, 0.02];
    sim.object.insert("cube".into(), mesh);
    let mut world = world(&sim);
    std::fs::remove_file(&file).expect("the file");
    run(&mut world, 1.0);
    let height = world.state().objects[0].pose.position.z;
    // The cube falls 5 mm and settles into its contact like the box.
    assert!((height - 0.015).abs() < 2e-6, "{height} m");
    let mass = world.model().objects[0]
        .shape
        .mass_properties(1000.0)
        .mass();
    assert!((mass - 0.027).abs() < 1e-9, "{mass} kg");
}
