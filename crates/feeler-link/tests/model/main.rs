//! A model of the protocol: every order in which messages can come, be late and get lost, and programs can end and start
//! again, as far as the checker goes.
//!
//! The model holds the programs' own inboxes. Its steps call what the programs call (`take`, `verdict`, `may_begin`,
//! `hand_ahead`, `drive`, `echo_at`), on bytes as they go over the network, so it cannot say otherwise than the code.
//! Only what calls them in a loop is written anew: what a hand, a rig and a sensor program do in a control period.
//!
//! `FEELER_MODEL_DEPTH` says how many periods are searched exhaustively (4 unless said otherwise), `FEELER_MODEL_STATES`
//! how many states random walks visit.

mod periods;
mod rig;

use periods::{Fate, Happening, Period};
use rig::{Rig, Violation};
use stateright::{Checker, HasDiscoveries, Model, Property, UniformChooser};
use std::hash::{Hash, Hasher};

/// Everything that is the case in a control period.
#[derive(Debug, Clone)]
struct Case(Box<Rig>);

impl PartialEq for Case {
    fn eq(&self, other: &Self) -> bool {
        format!("{:?}", self.0) == format!("{:?}", other.0)
    }
}

impl Hash for Case {
    fn hash<H: Hasher>(&self, state: &mut H) {
        format!("{:?}", self.0).hash(state);
    }
}

struct Protocol;

impl Model for Protocol {
    type State = Case;
    type Action = Period;

    fn init_states(&self) -> Vec<Case> {
        // Neither begun, nor at work: both beginnings are searched.
        vec![Case(Box::new(Rig::new())), Case(Box::new(Rig::at_work()))]
    }

    fn actions(&self, case: &Case, actions: &mut Vec<Period>) {
        let calm = Fate::Calm;
        actions.extend(Happening::all(&case.0).map(|happening| Period {
            happening,
            fate: calm,
        }));
        let disturbed = Fate::disturbed();
        actions.extend(disturbed.map(|fate| Period {
            happening: Happening::Nothing,
            fate,
        }));
    }

    fn next_state(&self, case: &Case, period: Period) -> Option<Case> {
        let mut next = case.0.clone();
        next.go_through(period);
        Some(Case(next))
    }

    fn properties(&self) -> Vec<Property<Self>> {
        fn without(case: &Case, violation: Violation) -> bool {
            !case.0.violations.contains(&violation)
        }
        vec![
            Property::always("no hand moves on stale data", |_, case: &Case| {
                without(case, Violation::MovedOnStaleData)
            }),
            Property::always("no two hands move one rig", |_, case: &Case| {
                without(case, Violation::TwoHands)
            }),
            Property::always("no stop is lost", |_, case: &Case| {
                without(case, Violation::MovedWhileStopped)
            }),
            Property::always("no drive moves on by itself", |_, case: &Case| {
                without(case, Violation::DroveOnByItself)
            }),
            Property::sometimes("a hand moves", |_, case: &Case| case.0.moves()),
            Property::sometimes("another hand moves", |_, case: &Case| {
                case.0.moves() && case.0.has_second_hand()
            }),
        ]
    }
}

fn number(variable: &str, default: usize) -> usize {
    let said = std::env::var(variable).ok();
    said.map_or(default, |said| {
        said.parse()
            .unwrap_or_else(|_| panic!("{variable}: a number"))
    })
}

#[test]
fn nothing_goes_wrong_in_any_order_of_events() {
    let depth = number("FEELER_MODEL_DEPTH", 4);
    let searched = Protocol
        .checker()
        .threads(2)
        .target_max_depth(depth)
        .spawn_dfs()
        .join();
    println!(
        "{} states, {} of them different",
        searched.state_count(),
        searched.unique_state_count()
    );
    for property in [
        "no hand moves on stale data",
        "no two hands move one rig",
        "no stop is lost",
        "no drive moves on by itself",
    ] {
        searched.assert_no_discovery(property);
    }
    assert!(searched.discovery("a hand moves").is_some());
}

#[test]
fn nothing_goes_wrong_on_long_ways() {
    let states = number("FEELER_MODEL_STATES", 100_000);
    let walked = Protocol
        .checker()
        .threads(2)
        .target_state_count(states)
        .target_max_depth(400)
        .finish_when(HasDiscoveries::AnyFailures)
        .spawn_simulation(1, UniformChooser)
        .join();
    for property in [
        "no hand moves on stale data",
        "no two hands move one rig",
        "no stop is lost",
        "no drive moves on by itself",
    ] {
        walked.assert_no_discovery(property);
    }
    assert!(walked.discovery("another hand moves").is_some());
}
