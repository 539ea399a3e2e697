//! `feeler locate`.

use crate::program::{folder, run};
use feeler::sensor::fingertip::LocatedLayout;
use image::{GrayImage, Luma};
use std::fs;
use std::path::Path;

/// Writes an image of `5 x 4` round spots.
fn write_spots(path: &Path, offset: f32) {
    let picture = GrayImage::from_fn(150, 120, |x, y| {
        let near = |v: u32| ((v as f32 + offset + 12.5) % 25.0 - 12.5).powi(2);
        let inside = (12..138).contains(&x) && (12..113).contains(&y);
        let lit = inside && near(x) + near(y) < 18.0;
        Luma([if lit { 180 } else { 10 }])
    });
    picture.save(path).unwrap();
}

#[test]
fn locate_writes_a_layout_and_a_preview() {
    let folder = folder("locate-writes");
    write_spots(&folder.join("a.png"), 0.0);
    write_spots(&folder.join("b.png"), 0.0);
    let arguments = [
        "locate",
        "a.png",
        "b.png",
        "-o",
        "layout.toml",
        "--preview",
        "found.png",
    ];
    let out = run(&folder, &arguments).done();
    assert!(out.contains("20 elements"), "{out}");
    let text = fs::read_to_string(folder.join("layout.toml")).unwrap();
    let layout = LocatedLayout::from_toml(&text).unwrap();
    assert_eq!(
        (layout.elements.len(), layout.width, layout.height),
        (20, 150, 120)
    );
    let preview = image::open(folder.join("found.png")).unwrap();
    assert!(preview.width() >= 150 && preview.width().is_multiple_of(150));
}

#[test]
fn dome_options_add_directions() {
    let folder = folder("locate-dome");
    write_spots(&folder.join("a.png"), 0.0);
    let dome = [
        "--dome-radius",
        "0.02",
        "--focal-length-px",
        "60",
        "--standoff",
        "0.001",
    ];
    let arguments = [&["locate", "a.png", "-o", "layout.toml"], &dome[..]].concat();
    run(&folder, &arguments).done();
    let text = fs::read_to_string(folder.join("layout.toml")).unwrap();
    let layout = LocatedLayout::from_toml(&text).unwrap();
    let directions = layout.elements.iter().filter_map(|e| e.direction);
    assert_eq!(directions.filter(|d| d.is_normalized()).count(), 20);
}

#[test]
fn invalid_input_is_refused_and_nothing_is_written() {
    let folder = folder("locate-refuses");
    write_spots(&folder.join("good.png"), 0.0);
    GrayImage::new(64, 48)
        .save(folder.join("black.png"))
        .unwrap();
    GrayImage::from_pixel(64, 48, Luma([255]))
        .save(folder.join("white.png"))
        .unwrap();
    GrayImage::from_pixel(64, 48, Luma([90]))
        .save(folder.join("gray.png"))
        .unwrap();
    let whole = fs::read(folder.join("good.png")).unwrap();
    fs::write(folder.join("cut.png"), &whole[..whole.len() / 2]).unwrap();
    fs::write(folder.join("text.png"), "no picture").unwrap();
    let refused = |arguments: &[&str], words: &[&str]| {
        let arguments = [&["locate", "-o", "layout.toml"], arguments].concat();
        run(&folder, &arguments).refused(words);
        assert!(!folder.join("layout.toml").exists(), "{arguments:?}");
    };
    refused(&["black.png"], &["black"]);
    refused(&["white.png"], &["white"]);
    refused(&["gray.png"], &["no element found"]);
    refused(&["cut.png"], &["cut.png"]);
    refused(&["text.png"], &["text.png"]);
    refused(&["none.png"], &["none.png"]);
    refused(&["good.png", "gray.png"], &["gray.png", "150x120", "64x48"]);
    refused(&["good.png", "--spot-diameter", "0"], &["spot_diameter"]);
    refused(&["good.png", "--region-radius", "NaN"], &["region_radius"]);
    refused(
        &["good.png", "--dome-radius", "0.02"],
        &["--focal-length-px"],
    );
    let behind = ["--dome-radius=0.02", "--focal-length-px=60"];
    for standoff in [["--standoff", "-0.01"], ["--standoff", "nan"]] {
        let arguments = [&["good.png"], &behind[..], &standoff].concat();
        refused(&arguments, &["--standoff", "0 m or more"]);
    }
    refused(
        &["good.png", "--dome", "cap-closing"],
        &["640x480", "150x120"],
    );
    refused(&["good.png", "--dome", "nothing.toml"], &["nothing.toml"]);
    let elsewhere = run(&folder, &["locate", "good.png", "-o", "none/layout.toml"]);
    elsewhere.refused(&["--output", "none/layout.toml"]);
}
