//! Configuration of laws and tasks in files.

use super::rig::{Config, config};
use feeler::control::law::LawConfig;
use feeler::control::law::best::BestConfig;
use feeler::control::task::TaskConfig;
use feeler::control::task::cap_config::Until;
use feeler::control::{Phase, StopReason};
use serde::Deserialize;

#[derive(Debug, Deserialize)]
struct File {
    law: LawConfig,
}

fn law(text: &str) -> Result<LawConfig, String> {
    toml::from_str::<File>(text)
        .map(|file| file.law)
        .map_err(|error| error.to_string())
}

#[test]
fn a_law_is_given_by_name_or_with_parameters() {
    for name in LawConfig::NAMES {
        let named = law(&format!("law = {name:?}")).expect("a law");
        assert_eq!(named.name(), name);
        assert_eq!(Some(&named), LawConfig::named(name).as_ref());
        let source = named.source().unwrap_or_default();
        assert!(source.lines().count() > 20, "{name}");
        if name != "tri-axial" {
            let table = law(&format!("[law.{name}]")).expect("a law");
            assert_eq!(table, named);
        }
    }
    let tuned = law("law.best = { margin = 1.25 }").expect("a law");
    let expected = BestConfig {
        margin: 1.25,
        ..BestConfig::default()
    };
    assert_eq!(tuned, LawConfig::Best(expected));
    let policy = law("law.policy = { file = \"a.safetensors\" }").expect("a law");
    assert_eq!((policy.name(), policy.source()), ("policy", None));
    for (text, words) in [
        ("law = \"policy\"", "law.policy with a file"),
        ("law.policy = {}", "file"),
        (
            "law.policy = { file = \"a\", model = 1 }",
            "unknown field `model`",
        ),
        (
            "law = \"worst\"",
            "tri-axial, tri-axial-missing-shear, normal-only, open-loop, best",
        ),
        ("law = 3", "a control law: one of tri-axial"),
        ("[law]", "expected exactly one control law"),
        (
            "[law.best]\n[law.open-loop]",
            "expected exactly one control law",
        ),
        ("[law.worst]", "worst"),
    ] {
        let message = law(text).expect_err("refused");
        assert!(message.contains(words), "{text}: {message}");
    }
}

#[test]
fn the_law_pivot_grips_firmly_by_default() {
    let grip = |grip: &str| law(&format!("law.pivot = {{ grip = {grip:?} }}"));
    assert_eq!(grip("firm").ok(), LawConfig::named("pivot"));
    let needed = grip("as-needed").expect("a law");
    assert_ne!(Some(needed), LawConfig::named("pivot"));
    let message = grip("loose").expect_err("refused");
    assert!(message.contains("`firm` or `as-needed`"), "{message}");
}

#[test]
fn tasks_are_created_from_their_configuration() {
    let screw = config().task;
    assert_eq!(
        (screw.name(), screw.strokes(), screw.grasp_force()),
        ("screw", 4, 1.0)
    );
    assert_eq!(screw.homes(), [[-0.038, -0.001, 0.1], [0.038, 0.001, 0.1]]);
    assert!(screw.takes_law());
    let TaskConfig::Screw(mut config) = screw else {
        panic!("a screw task")
    };
    config.until = Until::Closed;
    let closed = TaskConfig::Screw(config);
    assert!(!closed.takes_law());
    // Without a cap configuration, the task only counts strokes.
    assert_eq!(closed.task().outcome(), None);
    assert!(closed.task().findings().is_empty() && !closed.task().failed());
}

const CAP: &str = "
axis = [0.0, 0.0]
grip = 6.0
damage_force = 9.0
grip_gain = 0.002
clearance = 0.002
still_turn = 0.05
most_friction = 1.5
feeler = { normal_stiffness = 2000.0, shear_stiffness = 1000.0, tip_radius = 0.002 }
";

/// With a cap and an end condition, the cap task performs the strokes and has findings from the start.
#[test]
fn a_screw_task_until_closed_is_a_cap_task() {
    let text = include_str!("two-fingers.toml");
    let screw = "[task.screw]\n";
    let until = text.replace(screw, "[task.screw]\nuntil = \"closed\"\n");
    let read = |text: &str| toml::from_str::<Config>(text).expect("a file").task.task();
    let capped = format!("{until}\n[task.screw.cap]\n{CAP}");
    assert_eq!(read(&capped).findings().len(), 6);
    assert_eq!(
        read(&format!("{text}\n[task.screw.cap]\n{CAP}"))
            .findings()
            .len(),
        0
    );
    let task = toml::from_str::<Config>(&capped).expect("a file").task;
    let TaskConfig::Screw(config) = task else {
        panic!("a screw task")
    };
    let cap = config.cap.expect("a cap");
    // The default is one turn.
    assert_eq!((cap.most_turns, cap.open_turns), (1.0, 1.0));
    assert_eq!((cap.softest_seat, cap.least_turns), (0.0, 0.0));
}

#[test]
fn phases_have_their_recorded_numbers_and_names() {
    let names = ["SEARCH", "MOVE", "RELEASE", "RETURN", "DONE", "STOPPED"];
    for ((number, phase), name) in (0..).zip(Phase::ALL).zip(names) {
        assert_eq!(
            (u8::from(phase), Phase::try_from(number)),
            (number, Ok(phase))
        );
        assert_eq!(phase.to_string(), name);
    }
    assert!(Phase::try_from(6).is_err());
}

#[test]
fn missing_data_is_recoverable_and_an_overload_is_not() {
    let stale = StopReason::StaleForces {
        finger: 0,
        age: 1.0,
        limit: 0.5,
    };
    assert!(stale.is_stale() && stale.is_recoverable());
    let missing = StopReason::NoForce {
        finger: 0,
        element: 1,
    };
    assert!(!missing.is_stale() && missing.is_recoverable());
    let infinite = StopReason::NotFinite {
        finger: 0,
        what: "force",
    };
    assert!(!infinite.is_stale() && !infinite.is_recoverable());
}
