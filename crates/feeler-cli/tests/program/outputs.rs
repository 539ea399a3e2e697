//! No command overwrites an input, or an existing file without `--force`.

use crate::program::{folder, run, summary};
use image::{GrayImage, Luma};
use std::fs;
use std::path::Path;

fn spots(path: &Path) {
    let picture = GrayImage::from_fn(150, 120, |x, y| {
        let near = |v: u32| ((v as f32 + 12.5) % 25.0 - 12.5).powi(2);
        let inside = (12..138).contains(&x) && (12..113).contains(&y);
        Luma([if inside && near(x) + near(y) < 18.0 {
            180
        } else {
            10
        }])
    });
    picture.save(path).unwrap();
}

/// Asserts that the command is refused with `words` and changes no file in `folder`.
fn refused_without_change(folder: &Path, arguments: &[&str], words: &[&str]) {
    let list = || {
        let files = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().path());
        let files = files.filter(|path| path.is_file());
        let mut files: Vec<_> = files.map(|p| (p.clone(), fs::read(p).unwrap())).collect();
        files.sort();
        files
    };
    let before = list();
    run(folder, arguments).refused(words);
    assert!(before == list(), "{arguments:?} changed the folder");
}

#[test]
fn locate_does_not_overwrite_images_and_layouts() {
    let folder = folder("outputs-locate");
    spots(&folder.join("a.png"));
    let input = ["the file is an input"];
    for force in [&[][..], &["--force"]] {
        let with = |arguments: &[&'static str]| [&["locate", "a.png"], arguments, force].concat();
        refused_without_change(&folder, &with(&["-o", "a.png"]), &input);
        refused_without_change(&folder, &with(&["-o", "./a.png"]), &input);
        let preview = with(&["-o", "l.toml", "--preview", "a.png"]);
        refused_without_change(&folder, &preview, &input);
        let twice = with(&["-o", "l.toml", "--preview", "./l.toml"]);
        refused_without_change(
            &folder,
            &twice,
            &["--preview", "the output of another option"],
        );
    }
    run(&folder, &["locate", "a.png", "-o", "l.toml"]).done();
    let again = ["locate", "a.png", "-o", "l.toml"];
    refused_without_change(
        &folder,
        &again,
        &["--output l.toml", "exists already", "--force"],
    );
    run(&folder, &[&again[..], &["--force"]].concat()).done();
    fs::write(folder.join("p.png"), "mine").unwrap();
    let preview = ["locate", "a.png", "-o", "m.toml", "--preview", "p.png"];
    refused_without_change(&folder, &preview, &["--preview p.png", "exists already"]);
}

#[test]
fn calibrate_does_not_overwrite_loads_images_and_calibrations() {
    let folder = folder("outputs-calibrate");
    let simulated = ["calibrate", "--simulated", "--loads=10"];
    let write = ["--write-loads=.", "-o", "c.toml"];
    run(&folder, &[&simulated[..], &write].concat()).done();
    for force in [&[][..], &["--force"]] {
        for output in ["LOADS.csv", "00001.png"] {
            let onto = [&["calibrate", "LOADS.csv", "-o", output], force].concat();
            refused_without_change(
                &folder,
                &onto,
                &["--output", output, "the file is an input"],
            );
        }
    }
    let again = [&simulated[..], &["-o", "c.toml"]].concat();
    refused_without_change(&folder, &again, &["--output c.toml", "exists already"]);
    fs::remove_file(folder.join("c.toml")).unwrap();
    // The page next to it is an output, too.
    refused_without_change(&folder, &again, &["--output c.html", "exists already"]);
    run(&folder, &[&again[..], &["--force"]].concat()).done();
}

#[test]
fn init_writes_a_valid_experiment_and_overwrites_nothing() {
    let folder = folder("outputs-init");
    let said = run(&folder, &["init", "my.toml"]).done();
    assert!(
        said.contains("my.toml") && said.contains("feeler run my.toml"),
        "{said}"
    );
    let text = fs::read_to_string(folder.join("my.toml")).unwrap();
    assert!(text.contains("name = \"my\"") && text.contains("# N, F1"));
    assert!(text.lines().count() <= 60, "{text}");
    run(&folder, &["check", "my.toml"]).done();
    run(&folder, &["init", "full.toml", "--full"]).done();
    let full = fs::read_to_string(folder.join("full.toml")).unwrap();
    let built_in = include_str!("../../../feeler-lab/experiments/cap-closing.toml");
    assert_eq!(
        full,
        built_in.replace("name = \"cap-closing\"", "name = \"full\"")
    );
    let (rig, _) = text.split_once("[sim]").unwrap();
    fs::write(folder.join("rig.toml"), rig).unwrap();
    let said = run(&folder, &["check", "rig.toml"]).done();
    assert!(said.contains("real rig"), "{said}");
    let direct = ["run", "my.toml", "--sensing=direct", "--out=run"];
    let said = run(&folder, &direct).done();
    // The outcome, followed by the results.
    let lines: Vec<_> = said.lines().skip(1).collect();
    assert_eq!(lines[0], "done", "{said}");
    for word in ["final torque", "cap turned by", "peak element force"] {
        assert!(lines[1].contains(word), "{said}");
    }
    refused_without_change(
        &folder,
        &["init", "my.toml"],
        &["my.toml", "exists already"],
    );
    // An existing identical calibration is used by the second experiment, too.
    run(&folder, &["init", "second.toml", "--from", "lift"]).done();
    let calibration = "reference-fingertip.coupled.calibration.toml";
    fs::write(folder.join(calibration), "mine").unwrap();
    refused_without_change(
        &folder,
        &["init", "third.toml"],
        &[calibration, "another calibration"],
    );
    for (arguments, words) in [
        (["init", "my"], ["my: ", "ends in .toml"]),
        (["init", "a b.toml"], ["name = \"a b\"", "letters"]),
        (["init", "none/my.toml"], ["none/my.toml", "folder"]),
    ] {
        refused_without_change(&folder, &arguments, &words);
    }
    let unknown = ["init", "x.toml", "--from=nothing"];
    refused_without_change(&folder, &unknown, &["--from nothing", "cap-closing"]);
}

#[test]
fn other_laws_are_checked_against_the_claims_of_any_hand() {
    let folder = folder("outputs-best");
    let start = ["run", "cap-closing", "--sensing=direct"];
    let best = ["--set=control.law=best", "--out=best"];
    let said = run(&folder, &[&start[..], &best].concat()).done();
    assert!(
        said.contains("of 5 claims of any hand pass") && said.contains("final torque"),
        "{said}"
    );
    let page = fs::read_to_string(folder.join("best/report.html")).unwrap();
    assert!(!page.contains("claims of the paper") && page.contains("Done."));
    assert!(page.contains("Claims of any hand") && page.contains("hand-follows-cap"));
    let summary = summary(&folder.join("best"));
    assert_eq!(summary["claims"].as_array().map(Vec::len), Some(0));
    assert_eq!(summary["hand_claims"].as_array().map(Vec::len), Some(5));
    let said = run(&folder, &[&start[..], &["--out=paper"]].concat()).done();
    assert!(said.contains("11 of 11 claims of the paper pass"), "{said}");
}
