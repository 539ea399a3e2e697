//! Model checking of the protocol: explores sequences of delayed, lost and duplicated messages, and of ending and
//! starting programs.
//!
//! The model uses the real inboxes. Its steps call the same functions as the programs (`take`, `verdict`, `may_begin`,
//! `hand_ahead`, `drive`, `echo_at`), on encoded messages. Only the loops that call them are modelled: the work of a
//! hand, a rig and a sensor program in a control period.
//!
//! `FEELER_MODEL_DEPTH` is the number of periods that are searched exhaustively (default 4), `FEELER_MODEL_STATES` the
//! number of states that random walks visit.

mod periods;
mod rig;

use crate::how_many::how_many;
use periods::{Fate, Happening, Period};
use rig::{Rig, Violation};
use stateright::{Checker, HasDiscoveries, Model, Property, UniformChooser};
use std::hash::{Hash, Hasher};

/// State of all programs in a control period.
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
        // Two initial states: before the hand starts, and while it moves.
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
        let always = SOUND.into_iter();
        let always = always.map(|(name, holds)| Property::always(name, holds));
        let sometimes = [
            Property::sometimes("a hand moves", |_: &Self, case: &Case| case.0.moves()),
            Property::sometimes("another hand moves", |_: &Self, case: &Case| {
                case.0.moves() && case.0.has_second_hand()
            }),
        ];
        always.chain(sometimes).collect()
    }
}

/// Predicate on a state.
type ActiveStops = fn(&Protocol, &Case) -> bool;

/// Invariants, by name.
const SOUND: [(&str, ActiveStops); 4] = [
    ("no hand moves on stale data", |_, case| {
        without(case, Violation::MovedOnStaleData)
    }),
    ("no two hands move one rig", |_, case| {
        without(case, Violation::TwoHands)
    }),
    ("no stop is lost", |_, case| {
        without(case, Violation::MovedWhileStopped)
    }),
    ("no drive moves without its hand", |_, case| {
        without(case, Violation::DroveOnByItself)
    }),
];

fn without(case: &Case, violation: Violation) -> bool {
    !case.0.violations.contains(&violation)
}

fn assert_sound(checked: &impl Checker<Protocol>) {
    for (name, _) in SOUND {
        checked.assert_no_discovery(name);
    }
}

#[test]
fn invariants_hold_in_all_short_sequences() {
    let depth = how_many("FEELER_MODEL_DEPTH", 4);
    let searched = Protocol
        .checker()
        .threads(2)
        .target_max_depth(depth)
        .spawn_dfs()
        .join();
    println!(
        "{} states, {} of them unique",
        searched.state_count(),
        searched.unique_state_count()
    );
    assert_sound(&searched);
    assert!(searched.discovery("a hand moves").is_some());
}

#[test]
fn invariants_hold_on_long_random_walks() {
    let states = how_many("FEELER_MODEL_STATES", 100_000);
    let walked = Protocol
        .checker()
        .threads(2)
        .target_state_count(states)
        .target_max_depth(400)
        .finish_when(HasDiscoveries::AnyFailures)
        .spawn_simulation(1, UniformChooser)
        .join();
    assert_sound(&walked);
    assert!(walked.discovery("another hand moves").is_some());
}
