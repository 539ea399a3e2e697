//! Images of sensors whose markers were once located wrongly, or that have none.

use crate::program::{folder, run};
use crate::recordings::recordings;
use feeler::sensor::fingertip::LocatedLayout;
use glam::DVec2;
use std::fs;
use std::path::{Path, PathBuf};

/// All images in the folder `kind` of the set `real-faults`.
fn pictures(kind: &str, test: &str) -> Vec<PathBuf> {
    let Some(data) = recordings("real-faults", test) else {
        return Vec::new();
    };
    let files = fs::read_dir(data.join(kind)).expect("a folder");
    let files = files.map(|file| file.expect("a file").path());
    let is_picture = |path: &PathBuf| path.extension().is_some_and(|e| e == "png" || e == "jpg");
    let mut pictures: Vec<_> = files.filter(is_picture).collect();
    assert!(!pictures.is_empty(), "no image of {kind}");
    pictures.sort();
    pictures
}

/// Centres of the elements in `picture` (px).
fn located(picture: &Path, test: &str) -> Vec<DVec2> {
    let folder = folder(test);
    run(
        &folder,
        &["locate", picture.to_str().unwrap(), "-o", "layout.toml"],
    )
    .done();
    let text = fs::read_to_string(folder.join("layout.toml")).unwrap();
    let layout = LocatedLayout::from_toml(&text).unwrap();
    layout.elements.iter().map(|e| e.centre_px).collect()
}

#[test]
fn gels_without_markers_are_refused() {
    let test = "gels_without_markers_are_refused";
    for kind in ["few-specks-unmarked", "noise-as-markers"] {
        for picture in pictures(kind, test) {
            let folder = folder(test);
            let arguments = ["locate", picture.to_str().unwrap(), "-o", "layout.toml"];
            let ended = run(&folder, &arguments);
            assert_eq!(ended.status, Some(2), "{picture:?}: {ended:?}");
            assert!(
                ended.stderr.contains("not a pattern of markers"),
                "{ended:?}"
            );
            assert!(!folder.join("layout.toml").exists());
        }
    }
}

/// Whole markers counted by eye.
#[test]
fn surroundings_of_a_gel_are_not_elements() {
    let test = "surroundings_of_a_gel_are_not_elements";
    for picture in pictures("surroundings-as-markers", test) {
        let elements = located(&picture, test).len();
        // The tilted view has about 525 markers.
        let expected = match picture.file_name().and_then(|name| name.to_str()) {
            Some("gelslim-tilted-view.png") => 520..=540,
            _ => 331..=331,
        };
        assert!(expected.contains(&elements), "{picture:?}: {elements}");
    }
}

#[test]
fn markers_of_two_dots_are_located_once() {
    let test = "markers_of_two_dots_are_located_once";
    for picture in pictures("double-dots", test) {
        let elements = located(&picture, test);
        assert!(elements.len() > 220, "{picture:?}: {}", elements.len());
        for (i, a) in elements.iter().enumerate() {
            // The dots of a marker are 5 to 8 px apart, markers 15 px or more.
            let near = elements[..i].iter().find(|b| a.distance(**b) < 10.0);
            assert_eq!(near, None, "{picture:?}: {a}");
        }
    }
}
