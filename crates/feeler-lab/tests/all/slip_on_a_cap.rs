//! Slip detection on a cap that turns with the fingers until it is closed, compared with ground truth.

#[path = "../../examples/slip_on_a_cap.rs"]
#[allow(dead_code)]
mod example;

use example::score;

/// Over 20 seeds the precision is 88 to 93 % while the cap turns and 99 % once it is closed; recall is 91 to 95 %, and
/// 50 to 64 % for the paper's SLIP (docs/comparing-control-laws.md). Four seeds estimate these to a few per cent. Soft
/// feelers lose less shear in a slip, closer to the noise.
#[test]
fn missing_shear_detects_slip_on_a_turning_or_static_cap() {
    for law in ["tri-axial", "tri-axial-missing-shear"] {
        for (half, counts) in score(law, "direct", 0..4).expect("runs").iter().enumerate() {
            let [paper, still, moving] = counts;
            let precise = [0.82, 0.97][half];
            assert!(moving.precision() > precise, "{law}, {half}: {moving:?}");
            assert!(moving.recall() > 0.87, "{law}, {half}: {moving:?}");
            // The paper's threshold exceeds the shear rate of sticking elements: it is precise but misses many slips.
            assert!(paper.precision() > 0.85, "{law}, {half}: {paper:?}");
            let more = moving.recall() - paper.recall();
            assert!(more > 0.2, "{law}, {half}: {paper:?} {moving:?}");
            if half == 0 {
                // Assuming a static cap while it turns reduces the precision.
                assert!(still.precision() < 0.75, "{law}: {still:?}");
            }
        }
    }
}
