//! Slip on a cap that turns with the fingers until it is closed, by the simulator's truth.

#[path = "../../examples/slip_on_a_cap.rs"]
#[allow(dead_code)]
mod example;

use example::score;

/// 20 seeds find 88 to 93 % precise while the cap turns, 99 % once it is closed, and 91 to 95 % noticed, where the paper's SLIP
/// notices 50 to 64 % (docs/benchmarks.md); 4 know it to some percent. A slip of soft feelers loses less shear, nearer to the noise.
#[test]
fn missing_shear_tells_slip_on_a_cap_whether_it_turns_or_not() {
    for law in ["tri-axial", "tri-axial-missing-shear"] {
        for (half, counts) in score(law, "direct", 0..4).expect("runs").iter().enumerate() {
            let [paper, still, moving] = counts;
            let precise = [0.82, 0.97][half];
            assert!(moving.precision() > precise, "{law}, {half}: {moving:?}");
            assert!(moving.recall() > 0.87, "{law}, {half}: {moving:?}");
            // The paper's threshold is above what an element that sticks shows: it means slip, but misses many.
            assert!(paper.precision() > 0.85, "{law}, {half}: {paper:?}");
            let more = moving.recall() - paper.recall();
            assert!(more > 0.2, "{law}, {half}: {paper:?} {moving:?}");
            if half == 0 {
                // Taking a cap that turns for one that stands still is no better.
                assert!(still.precision() < 0.75, "{law}: {still:?}");
            }
        }
    }
}
