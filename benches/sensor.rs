//! What a sensor costs per frame: drawing its picture in the simulation, and reading it.

use divan::{Bencher, black_box};
use feeler::{
    sensor::{
        fingertip::{Fingertip, FingertipConfig},
        frame::Picture,
        moments::ElementMoments,
    },
    sim::{
        optics::{OpticsScratch, render},
        optics_config::OpticsConfig,
        optics_model::OpticsModel,
    },
};
use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64;

fn main() {
    divan::main();
}

fn model(fingertip: &Fingertip) -> OpticsModel {
    OpticsModel::new(
        &OpticsConfig::default(),
        &fingertip.layout,
        &fingertip.projection,
    )
    .expect("the default optics fit the default fingertip")
}

fn fingertip() -> Fingertip {
    Fingertip::new(&FingertipConfig::default()).expect("the default fingertip makes sense")
}

/// `loaded` elements under 1 N and a little shear.
fn forces(loaded: usize) -> Vec<DVec3> {
    let mut forces = vec![DVec3::ZERO; 41];
    forces[..loaded].fill(DVec3::new(0.3, -0.2, 1.0));
    forces
}

#[divan::bench]
fn moments_of_a_frame(bencher: Bencher) {
    let fingertip = fingertip();
    let model = model(&fingertip);
    let mut picture = Picture::black(640, 480);
    let mut rng = Pcg64::seed_from_u64(1);
    render(
        &model,
        &mut OpticsScratch::new(&model),
        &forces(5),
        &mut rng,
        &mut picture,
    )
    .expect("sizes fit");
    let mut moments = vec![ElementMoments::default(); 41];
    bencher.bench_local(|| {
        fingertip
            .kernel
            .measure(black_box(&picture), black_box(&mut moments))
    });
}

#[divan::bench(args = [0, 5, 41])]
fn picture_with_loaded_elements(bencher: Bencher, loaded: usize) {
    let fingertip = fingertip();
    let model = model(&fingertip);
    let mut scratch = OpticsScratch::new(&model);
    let mut picture = Picture::black(640, 480);
    let mut rng = Pcg64::seed_from_u64(1);
    let forces = forces(loaded);
    bencher.bench_local(|| {
        render(
            &model,
            &mut scratch,
            black_box(&forces),
            &mut rng,
            black_box(&mut picture),
        )
    });
}
