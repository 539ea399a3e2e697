//! A custom rig without `[sim]`, controlled by `feeler hand`: the example `own_rig` and its experiment.

#[path = "../../../examples/own_rig.rs"]
mod example;

use super::faults::{GOES_ON, NO_HURRY};
use crate::ports::unused_endpoint;
use crate::program::{feeler, folder, run};
use crate::rig::{QUARTER, Running, alone, reasons};
use feeler_lab::config::Experiment;
use feeler_link::transport::{Link, LinkConfig, Network};
use feeler_record::Recording;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

const SETTINGS: [&str; 2] = [GOES_ON, NO_HURRY];

#[test]
fn hand_controls_a_custom_rig_and_writes_a_report() {
    let _alone = alone();
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/own_rig.toml");
    let file = file.to_str().expect("a path");
    let folder = folder("link-own-rig");
    run(&folder, &["check", file]).done();
    let experiment = Experiment::load(file, &SETTINGS.map(Into::into)).expect("own_rig");
    assert!(experiment.config.sim.is_none());
    let endpoint = unused_endpoint();
    let config = LinkConfig {
        rig: experiment.config.name.clone(),
        connect: vec![endpoint.clone()],
        ..LinkConfig::default()
    };
    let over = AtomicBool::new(false);
    let (status, said) = std::thread::scope(|scope| {
        scope.spawn(|| {
            let network: Arc<dyn Network> = Arc::new(Link::open(&config).expect("a network"));
            example::serve(
                &experiment,
                &network,
                QUARTER.parse().expect("a number"),
                &over,
            )
            .expect("a rig");
        });
        let listen = format!("--listen={endpoint}");
        let mut arguments = vec!["hand", file, &listen, "--speed", QUARTER, "--out=run"];
        arguments.extend(SETTINGS.iter().flat_map(|setting| ["--set", setting]));
        let mut hand = Running::start(&folder, "hand", feeler(&folder, &arguments));
        let ended = hand.wait();
        over.store(true, Ordering::Relaxed);
        ended
    });
    assert_eq!(status, Some(0), "{said}");
    let recording = Recording::read(folder.join("run/recording.mcap")).expect("a recording");
    assert!(recording.torque_sensor.is_empty() && recording.cap.is_empty());
    let pressed = recording.fingers[0].flags.iter().map(|f| f.grasp_force);
    let most = pressed.fold(0.0, f64::max);
    assert!((0.4..2.0).contains(&most), "{most} N");
    let summary = std::fs::read_to_string(folder.join("run/summary.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
    assert_eq!(summary["state"], "done", "{summary}");
    // A stop splits the stroke into two entries.
    let strokes = summary["strokes"].as_array().expect("strokes");
    let first = strokes.iter().filter(|stroke| stroke["index"] == 1);
    assert!(!strokes.is_empty() && first.count() == strokes.len());
    let stops = reasons(&recording).len();
    assert!(strokes.len() <= 1 + stops, "{stops} stops, {summary}");
    // No cap is turned, so none of the paper's claims apply.
    assert_eq!(summary["claims"].as_array().map(Vec::len), Some(0));
    assert!(folder.join("run/report.html").exists());
}
