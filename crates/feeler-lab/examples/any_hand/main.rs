//! Success rate of a control law over plausible hands, and the torque it reaches, with caps of different shapes and
//! positions.
//!
//! ```sh
//! cargo run --release --example any_hand -- pivot 200 5000 3
//! cargo run --release --example any_hand -- tri-axial 200 5000 3 middle
//! ```
//!
//! Arguments: the law; number of hands; number of the first hand; runs per hand, which differ in their seeds; and any
//! of the names of [`Variant`] (default: all). A hand is successful if all five claims of any hand pass in each of its
//! runs. The final torque is reported relative to the largest torque that a circular path reaches without overload
//! ([`oracle`]), which takes ten runs per hand and is computed only for the variant `middle`.

mod oracle;
mod variant;

use feeler_lab::config::Experiment;
use feeler_lab::experiment::{Pictures, Session, Truth};
use feeler_report::claims::of_any_hand;
use feeler_report::figures::sweep::wilson;
use std::error::Error;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use variant::Variant;

type AnyError = Box<dyn Error + Send + Sync>;

/// Result of a run.
struct Outcome {
    /// `true` if each claim of any hand passes.
    holds: Vec<bool>,
    /// Final torque of the cap (N·m).
    torque: f64,
    /// `true` if no element was overloaded.
    unharmed: bool,
}

fn main() -> Result<(), AnyError> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [law, hands, first, runs, variants @ ..] = &arguments[..] else {
        return Err("expected: LAW HANDS FIRST_HAND RUNS [VARIANT…]".into());
    };
    let (hands, first, runs) = (
        hands.parse::<u64>()?,
        first.parse::<u64>()?,
        runs.parse::<u64>()?,
    );
    let mut middle = Vec::new();
    println!("| cap | follows | curved | grip | no overload | closed | all five, every run |");
    println!("|---|---|---|---|---|---|---|");
    for variant in Variant::chosen(variants)? {
        let of_hands = in_parallel(first..first + hands, |hand| {
            (0..runs)
                .map(|run| of_run(law, variant, hand, run))
                .collect::<Result<Vec<_>, _>>()
        })?;
        println!("{}", row(variant, &of_hands));
        if variant == Variant::Middle {
            middle = of_hands;
        }
    }
    if !middle.is_empty() {
        let most = in_parallel(first..first + hands, |hand| {
            oracle::largest_torque(&experiment(law, Variant::Middle, hand, 0)?)
        })?;
        let ratio = |(runs, most): (&Vec<Outcome>, Option<f64>)| Some(runs.first()?.torque / most?);
        print_torque(middle.iter().zip(most).filter_map(ratio).collect());
    }
    Ok(())
}

/// Row of the table for a variant.
fn row(variant: Variant, hands: &[Vec<Outcome>]) -> String {
    let share = |holds: &dyn Fn(&Outcome) -> bool| {
        let count = hands.iter().filter(|runs| runs.iter().all(holds)).count();
        let (low, high) = wilson(count as u64, hands.len() as u64);
        let percent = |share: f64| 100.0 * share;
        let part = percent(count as f64 / hands.len() as f64);
        format!("{part:.1} [{:.1}, {:.1}]", percent(low), percent(high))
    };
    let claims = (0..5).map(|claim| share(&|outcome| outcome.holds[claim]));
    let all = share(&|outcome| outcome.holds.iter().all(|holds| *holds));
    let cells: Vec<_> = claims.chain([all]).collect();
    format!("| {} | {} |", variant.name(), cells.join(" | "))
}

/// Runs a hand once. The seed of the run differs from that of the hand, so the position and friction of the bottle
/// vary between runs.
fn of_run(law: &str, variant: Variant, hand: u64, run: u64) -> Result<Outcome, AnyError> {
    let experiment = experiment(law, variant, hand, run)?;
    let mut session = Session::rendering(&experiment, Pictures::Sensed)?;
    outcome(&mut session, &experiment, variant)
}

/// Returns the experiment of a hand under `law`.
fn experiment(law: &str, variant: Variant, hand: u64, run: u64) -> Result<Experiment, AnyError> {
    let draw = ["plausible_hand=-1", "sensing=direct"].map(String::from);
    let draw = [&draw[..], &[format!("seed={hand}")]].concat();
    let drawn = Experiment::load("any-hand", &draw)?;
    let mut settings = variant.settings(&drawn, hand)?;
    // Setting plausible_hand to the seed keeps the drawn hand.
    let seed = hand + 1_000_000 * (run + 1);
    settings.extend([format!("seed={seed}"), format!("plausible_hand={seed}")]);
    settings.push(format!("control.law={law}"));
    Ok(drawn.with_settings(&settings)?)
}

/// Runs a session to its end and evaluates it.
fn outcome(
    session: &mut Session,
    experiment: &Experiment,
    variant: Variant,
) -> Result<Outcome, AnyError> {
    let (_, data) = session.run_in_memory(&experiment.config)?;
    let strokes = data.stroke_measures();
    let claims = of_any_hand(&data, &strokes);
    let mut holds: Vec<_> = claims.iter().map(|claim| claim.holds).collect();
    if variant == Variant::Opening {
        // Replaces the claim about closing: the last stroke must turn the cap by at least half the fingers' angle
        // about it.
        let turn = strokes.last().and_then(|stroke| stroke.cap_turn);
        holds[4] = turn.is_some_and(|turn| turn < -0.15);
    }
    Ok(Outcome {
        unharmed: holds[3],
        holds,
        torque: Truth::of(session).cap_torque.unwrap_or(0.0),
    })
}

fn print_torque(mut ratios: Vec<f64>) {
    ratios.sort_by(f64::total_cmp);
    let at = |part: f64| ratios[((ratios.len() - 1) as f64 * part) as usize];
    if !ratios.is_empty() {
        println!(
            "\ntorque over the oracle's, {} hands: 10 % {:.3}, median {:.3}, 90 % {:.3}",
            ratios.len(),
            at(0.1),
            at(0.5),
            at(0.9)
        );
    }
}

/// Applies `work` to each hand on all processors. Returns the results in order.
fn in_parallel<T: Send>(
    hands: std::ops::Range<u64>,
    work: impl Fn(u64) -> Result<T, AnyError> + Sync,
) -> Result<Vec<T>, AnyError> {
    let (next, results) = (AtomicU64::new(hands.start), Mutex::new(Vec::new()));
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                loop {
                    let hand = next.fetch_add(1, Ordering::Relaxed);
                    if hand >= hands.end {
                        return;
                    }
                    let result = work(hand);
                    results
                        .lock()
                        .expect("no thread panics")
                        .push((hand, result));
                }
            });
        }
    });
    let mut results = results.into_inner().expect("no thread panics");
    results.sort_by_key(|(hand, _)| *hand);
    results.into_iter().map(|(_, result)| result).collect()
}
