//! `feeler run --record-frames` and `feeler replay`.

use crate::program::{Ended, folder, run};
use feeler_record::sensed::TACTILE;
use feeler_record::{MessageSink, Recorder, Recording, SensedWriter, Tactile, topics};
use std::fs;
use std::path::Path;

/// Runs the reference experiment with `arguments` to the folder `run`. The run may end before the task is done.
fn make_run(folder: &Path, arguments: &[&str]) {
    let arguments = [&["run", "cap-closing", "--out", "run"], arguments].concat();
    let ended = run(folder, &arguments);
    assert!(matches!(ended.status, Some(0 | 1)), "{ended:?}");
    assert_eq!(ended.stderr, "");
}

fn replay(folder: &Path, run_name: &str, arguments: &[&str]) -> Ended {
    run(folder, &[&["replay", run_name], arguments].concat())
}

/// Numbers of compared and of differing values in the row `kind` of the output.
fn counts(said: &str, kind: &str) -> Option<(u64, u64)> {
    let mut rows = said.lines().map(|line| line.split_whitespace());
    let mut row = rows.find(|row| row.clone().next() == Some(kind))?;
    let mut number = || row.next()?.parse().ok();
    number(); // the kind itself
    Some((number()?, number()?))
}

/// Asserts the output of an exact replay of `steps` steps from images.
fn assert_same_from_frames(said: &str, steps: u64) {
    for (kind, expected) in [
        ("forces", 2 * steps),
        ("flags", 2 * steps),
        ("phases", steps),
        ("commands", 2 * steps),
    ] {
        assert_eq!(counts(said, kind), Some((expected, 0)), "{said}");
    }
    assert!(said.contains("bit for bit"), "{said}");
}

#[test]
fn run_with_images_replays_from_frames_and_from_forces() {
    let folder = folder("replay");
    make_run(&folder, &["--record-frames", "--set=time_limit=1.2"]);
    let said = replay(&folder, "run", &["--from", "frames"]).done();
    assert_same_from_frames(&said, 121);
    let said = replay(&folder, "run/recording.mcap", &["--from", "forces"]).done();
    assert_eq!(counts(&said, "forces"), None);
    assert_eq!(counts(&said, "commands"), Some((242, 0)));

    // Of a truncated recording, the complete part is replayed. Its file name is arbitrary.
    let whole = fs::read(folder.join("run/recording.mcap")).unwrap();
    fs::write(folder.join("torn.mcap"), &whole[..whole.len() / 3]).unwrap();
    let torn = replay(&folder, "torn.mcap", &["--from=frames"]);
    assert!(torn.stdout.contains("bit for bit"), "{torn:?}");
    let (compared, _) = counts(&torn.stdout, "forces").unwrap();
    assert!(compared > 40 && compared < 100, "{torn:?}");
    torn.refused(&["torn.mcap: the recording is incomplete", "replayed up to"]);
    // A recording that is truncated before the first step has no steps; before the experiment, it has no configuration.
    let name = b"experiment.toml";
    let mut places = whole.windows(name.len());
    let experiment = places.position(|bytes| bytes == name).unwrap();
    let cuts = [
        (60_000, "no complete control step"),
        (experiment + 100, "the experiment"),
    ];
    for (length, words) in cuts {
        fs::write(folder.join("torn.mcap"), &whole[..length]).unwrap();
        replay(&folder, "torn.mcap", &["--from=frames"]).refused(&[words]);
    }
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn law_with_separate_slip_detection_replays_from_forces() {
    let folder = folder("replay-own-slip");
    make_run(
        &folder,
        &[
            "--sensing=direct",
            "--set=control.law=tri-axial-missing-shear",
        ],
    );
    let said = replay(&folder, "run", &["--from=forces"]).done();
    assert!(said.contains("bit for bit"), "{said}");
    let (compared, differing) = counts(&said, "commands").expect("commands");
    assert!(compared > 2000 && differing == 0, "{said}");
    // Under both laws the recorded SLIP is the paper's, but the resulting commands differ.
    let other = replay(
        &folder,
        "run",
        &["--from=forces", "--set=control.law=tri-axial"],
    );
    assert_eq!(counts(&other.stdout, "flags").map(|c| c.1), Some(0));
    assert!(counts(&other.stdout, "commands").is_some_and(|c| c.1 > 0));
    fs::remove_dir_all(folder).unwrap();
}

#[test]
fn run_with_faults_replays() {
    const FAULTS: &str = "--set=sim.fault=[\
        {from=0.2, kind.dead_element={finger=0, element=0}}, \
        {from=0.3, kind.stuck_rows={finger=0, first=100, count=20, gray=90}}, \
        {from=0.3, until=0.36, kind.frozen_frame={finger=1}}, \
        {from=0.4, kind.dropped_frames={finger=1, probability=0.5}}, \
        {from=0.5, kind.camera_latency={finger=0, delay=0.02}}, \
        {from=0.6, kind.servo_stall={finger=0, joint=1}}]";
    let folder = folder("replay-faults");
    make_run(
        &folder,
        &["--record-frames", FAULTS, "--set=time_limit=0.9"],
    );
    let recording = Recording::read(folder.join("run/recording.mcap")).unwrap();
    let steps = recording.task.len() as u64;
    // Dropped frames are not recorded.
    assert!(recording.fingers[1].pictures.len() < recording.fingers[1].tactile.len());
    let said = replay(&folder, "run", &["--from=frames"]).done();
    assert_same_from_frames(&said, steps);
    let said = replay(&folder, "run", &["--from=forces"]).done();
    assert_eq!(counts(&said, "flags"), Some((2 * steps, 0)));
    fs::remove_dir_all(folder).unwrap();
}

/// Writes the recorded forces and commands again, with changes.
fn rewrite(recording: &Recording, path: &Path, change: impl FnOnce(&mut Recording)) {
    let mut changed = recording.clone();
    change(&mut changed);
    let mut recorder = Recorder::create(path, &changed.facts, &changed.experiment).unwrap();
    for (finger, record) in changed.fingers.iter().enumerate() {
        for message in &record.tactile {
            recorder.write(topics::tactile(finger), message).unwrap();
        }
        for message in &record.flags {
            recorder.write(topics::flags(finger), message).unwrap();
        }
        for message in &record.joints {
            recorder.write(topics::joints(finger), message).unwrap();
        }
        for message in &record.command {
            recorder.write(topics::command(finger), message).unwrap();
        }
    }
    for message in &changed.task {
        recorder.write(topics::TASK, message).unwrap();
    }
    recorder.finish(None).unwrap();
}

#[test]
fn differences_are_counted_and_reported() {
    let folder = folder("replay-differs");
    make_run(&folder, &["--sensing=direct", "--set=time_limit=2"]);
    let recording = Recording::read(folder.join("run/recording.mcap")).unwrap();
    let path = folder.join("other.mcap");
    rewrite(&recording, &path, |_| {});
    replay(&folder, "other.mcap", &["--from=forces"]).done();
    // Change one bit of one force.
    rewrite(&recording, &path, |recording| {
        let force = &mut recording.fingers[1].tactile[150].forces[0].x;
        *force = f64::from_bits(force.to_bits() ^ 1 << 20);
    });
    let ended = replay(&folder, "other.mcap", &["--from=forces"]);
    assert_eq!((ended.status, &*ended.stderr), (Some(1), ""), "{ended:?}");
    let said = "first difference of flags: step 150 (1.500 s), finger 1, ";
    assert!(ended.stdout.contains(said), "{ended:?}");
    assert!(!ended.stdout.contains("bit for bit"), "{ended:?}");
    let (compared, differing) = counts(&ended.stdout, "flags").unwrap();
    // The shear rates to this frame and from it differ.
    assert_eq!((compared, differing), (402, 2), "{ended:?}");
    // Change a command, so that it differs from that of the control law.
    rewrite(&recording, &path, |recording| {
        let velocity = &mut recording.fingers[0].command[7].joint_velocity[2];
        *velocity = f64::from_bits(velocity.to_bits() ^ 1);
    });
    let ended = replay(&folder, "other.mcap", &["--from=forces"]);
    assert_eq!(counts(&ended.stdout, "commands"), Some((402, 1)));
    let said = "first difference of commands: step 7 (0.070 s), finger 0, joint_velocity[2]: ";
    assert!(ended.stdout.contains(said), "{ended:?}");
}

#[test]
fn replay_with_other_settings_changes_the_flags() {
    let folder = folder("replay-what-if");
    make_run(&folder, &["--sensing=direct", "--set=time_limit=3"]);
    let setting = "--set=control.slip_threshold=1.0";
    let said = replay(&folder, "run", &["--from=forces", setting, "--out=new"]).done();
    let (compared, differing) = counts(&said, "flags").unwrap();
    assert!(0 < differing && differing < compared, "{said}");
    assert!(said.contains("new/report.html"), "{said}");
    // The replay has a separate recording with the new settings, which refers to the original.
    let new = Recording::read(folder.join("new/recording.mcap")).unwrap();
    let old = Recording::read(folder.join("run/recording.mcap")).unwrap();
    assert!(new.complete);
    assert_eq!(new.facts.replay_of.as_deref(), Some(old.digest.as_str()));
    assert_eq!(new.facts.slip_threshold, 1.0);
    assert!(new.experiment.contains("slip_threshold = 1.0"));
    for (new, old) in new.fingers.iter().zip(&old.fingers) {
        assert_eq!((&new.tactile, &new.joints), (&old.tactile, &old.joints));
        assert_ne!(new.flags, old.flags);
    }
    assert_eq!(
        (&new.cap, &new.torque_sensor),
        (&old.cap, &old.torque_sensor)
    );
    // It contains the same messages for viewers as the recording of a run.
    let for_viewers = |run: &str| {
        let file = fs::read(folder.join(run).join("recording.mcap")).unwrap();
        let summary = mcap::Summary::read(&file).unwrap().unwrap();
        let counts = summary.stats.unwrap().channel_message_counts;
        [
            "/tf",
            "/tf_static",
            "/robot_description",
            "/joint_states",
            "/scene",
        ]
        .map(|topic| {
            let channels = summary.channels.values();
            let channel = channels.into_iter().find(|channel| channel.topic == topic);
            counts[&channel.unwrap().id]
        })
    };
    assert_eq!(for_viewers("new"), for_viewers("run"));
    assert!(for_viewers("new").iter().all(|&count| count > 0));
    let page = fs::read_to_string(folder.join("new/report.html")).unwrap();
    assert!(page.contains("This run is a replay.") && page.contains(old.digest.as_str()));
    // It can be replayed like any other recording.
    replay(&folder, "new", &["--from=forces"]).done();
    // Nothing is overwritten.
    let again = replay(&folder, "run", &["--from=forces", "--out=new"]);
    again.refused(&["--out new", "already contains a run"]);
}

#[test]
fn impossible_replays_are_refused() {
    let folder = folder("replay-refused");
    make_run(&folder, &["--sensing=direct", "--set=time_limit=0.1"]);
    let out = ["--from=frames", "--out=new"];
    let ended = replay(&folder, "run", &out);
    ended.refused(&["no images of finger 0", "--record-frames", "--from forces"]);
    assert!(!folder.join("new").exists());
    replay(&folder, "nowhere", &["--from=forces"]).refused(&["nowhere", "recording.mcap"]);
    replay(&folder, "run", &[]).refused(&["--from"]);
    replay(&folder, "run", &["--from=above"]).refused(&["frames", "forces"]);
    for (setting, words) in [
        (
            "control.period=0.02",
            "control.period (s): 0.01 in the recording",
        ),
        (
            "sensor.fingertip.layout.rings.1.elements=7",
            "elements of finger 0: 41",
        ),
        ("control.slip_threshold=-1", "control.slip_threshold"),
        ("control.slip=1", "--set control.slip=1"),
    ] {
        let setting = ["--from=forces", "--set", setting];
        replay(&folder, "run", &setting).refused(&[words]);
    }
    // Recordings of other data, and files that are not recordings.
    let mut sensed = SensedWriter::create(folder.join("sensed.mcap"), None).unwrap();
    sensed.write(TACTILE, &Tactile::default()).unwrap();
    sensed.finish().unwrap();
    fs::write(folder.join("words.mcap"), "hello").unwrap();
    for (file, word) in [("sensed.mcap", "feeler.run"), ("words.mcap", "MCAP magic")] {
        replay(&folder, file, &["--from=forces"]).refused(&[file, word]);
    }
    let arguments = ["run", "cap-closing", "--sensing=direct", "--record-frames"];
    run(&folder, &arguments).refused(&["--record-frames", "sensing = \"image\""]);
    assert!(!folder.join("runs").exists());
}
