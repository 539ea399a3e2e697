//! No command writes over an input, or over an existing file unless told to.

use crate::program::{folder, run};
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

/// Asserts that the command is refused with these words and changes nothing in the folder.
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
fn locate_keeps_pictures_and_layouts() {
    let folder = folder("outputs-locate");
    spots(&folder.join("a.png"));
    let input = ["it is an input"];
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
            &["--preview", "written for another option"],
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
fn calibrate_keeps_loads_pictures_and_calibrations() {
    let folder = folder("outputs-calibrate");
    let simulated = ["calibrate", "--simulated", "--loads=10"];
    let write = ["--write-loads=.", "-o", "c.toml"];
    run(&folder, &[&simulated[..], &write].concat()).done();
    for force in [&[][..], &["--force"]] {
        for output in ["LOADS.csv", "00001.png"] {
            let onto = [&["calibrate", "LOADS.csv", "-o", output], force].concat();
            refused_without_change(&folder, &onto, &["--output", output, "it is an input"]);
        }
    }
    let again = [&simulated[..], &["-o", "c.toml"]].concat();
    refused_without_change(&folder, &again, &["--output c.toml", "exists already"]);
    fs::remove_file(folder.join("c.toml")).unwrap();
    // The page beside it is a result, too.
    refused_without_change(&folder, &again, &["--output c.html", "exists already"]);
    run(&folder, &[&again[..], &["--force"]].concat()).done();
}
