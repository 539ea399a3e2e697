//! Slip on a cap that turns with the fingers until it is closed, by the simulator's truth.

#[path = "../examples/slip_on_a_cap.rs"]
#[allow(dead_code)]
mod slip_on_a_cap;

use slip_on_a_cap::score;

/// 20 seeds find 99.6 % and more precise, 94 % and more noticed (docs/benchmarks.md); 4 know it to some percent.
#[test]
fn missing_shear_tells_slip_on_a_cap_whether_it_turns_or_not() {
    for law in ["tri-axial", "tri-axial-missing-shear"] {
        for (half, counts) in score(law, "direct", 0..4).expect("runs").iter().enumerate() {
            let [paper, still, moving] = counts;
            assert!(moving.precision() > 0.97, "{law}, {half}: {moving:?}");
            assert!(moving.recall() > 0.90, "{law}, {half}: {moving:?}");
            // The paper's threshold is below what an element that sticks to a closed cap shows, so as to press on.
            assert!(paper.precision() < 0.75, "{law}, {half}: {paper:?}");
            if half == 0 {
                // Taking a cap that turns for one that stands still is no better.
                assert!(still.precision() < 0.75, "{law}: {still:?}");
            }
        }
    }
}
