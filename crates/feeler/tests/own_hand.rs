//! The example of a hand of one's own, and what the loop does about missed periods.

#[allow(dead_code, reason = "its main is the example's")]
#[path = "../examples/own_hand.rs"]
mod own_hand;

use feeler::control::phase::Phase;

#[test]
fn the_example_touches_the_wall_and_comes_home() {
    let (phase, force) = own_hand::touch_and_stroke().expect("a run");
    assert_eq!(phase, Phase::Done);
    // It moves on at 0.5 N, and presses no deeper than it comes in the steps until it has turned.
    assert!((0.5..1.0).contains(&force), "{force} N");
}
