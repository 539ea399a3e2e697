//! Grip `as-needed` of the control law `pivot`, on hands other than those of the documentation.

#[path = "../../examples/needed_grip.rs"]
#[allow(dead_code)]
mod example;

use example::{Arguments, quantile, run};

/// Median time from slip to increased grip (ms), and median excess of the grip, over three hands.
fn measured(grip: &str) -> (f64, f64) {
    let arguments = ["20000", "3", "constant", grip].map(String::from);
    let arguments = Arguments::parse(&arguments).expect("arguments");
    let (mut times, mut excess) = (vec![], vec![]);
    for hand in arguments.hands.clone() {
        let experiment = arguments.experiment(hand).expect("an experiment");
        let (fingers, _) = run(&experiment).expect("a run");
        for finger in fingers {
            times.extend(finger.reactions.iter().map(|reaction| reaction.1));
            excess.extend(finger.excess);
        }
    }
    (quantile(times, 0.5), quantile(excess, 0.5))
}

/// 200 hands have 20 ms and 24 % with grip `as-needed`, and 220 ms and 350 % with the firm grip (docs/benchmarks.md).
#[test]
fn a_grip_as_needed_reacts_to_slip_and_is_much_lighter_than_a_firm_one() {
    let (time, excess) = measured("as-needed");
    assert!(time < 35.0 && excess < 0.6, "{time} {excess}");
    let (time, excess) = measured("firm");
    assert!(time > 50.0 && excess > 1.5, "{time} {excess}");
}
