//! The paper's claims, evaluated on recordings of the reference experiment.

use crate::whole_runs::{folder, run};
use feeler_lab::experiment::Pictures;
use feeler_report::run::make::make;

/// Descriptions of the claims that fail for `seed`.
fn broken_claims(sensing: &str, seed: u64) -> Vec<String> {
    let folder = folder(&format!("reference-{sensing}-{seed}"));
    let settings = [format!("sensing={sensing}"), format!("seed={seed}")];
    run(&settings, Pictures::Sensed, &folder);
    let report = make(&folder).expect("a report");
    assert!(report.complete, "{:?}", report.problem);
    assert_eq!(report.claims().len(), 11);
    let broken = report.claims().iter().filter(|claim| !claim.holds);
    broken
        .map(|claim| {
            format!(
                "seed {seed}: {}: {:?}, bound {:?}",
                claim.id, claim.value, claim.bound
            )
        })
        .collect()
}

#[test]
fn all_claims_pass_for_seeds_0_to_19_with_direct_sensing() {
    let broken: Vec<_> = (0..20)
        .flat_map(|seed| broken_claims("direct", seed))
        .collect();
    assert!(broken.is_empty(), "{broken:#?}");
}

/// Runs with images are slow, so the twenty are shared between two threads.
#[test]
fn all_claims_pass_for_seeds_0_to_19_with_image_sensing() {
    let half = |seeds: std::ops::Range<u64>| {
        let broken = seeds.flat_map(|seed| broken_claims("image", seed));
        broken.collect::<Vec<_>>()
    };
    let broken = std::thread::scope(|scope| {
        let first = scope.spawn(|| half(0..10));
        [half(10..20), first.join().expect("ten runs")].concat()
    });
    assert!(broken.is_empty(), "{broken:#?}");
}
