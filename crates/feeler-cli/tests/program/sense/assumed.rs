//! Images without a layout: the built-in fingertip is assumed only if they can be of it.

use super::rendered::{image, pictures, save};
use crate::program::{folder, run};
use image::{GrayImage, Luma};
use std::fs;

/// Width and height of the fingertip's images (px).
const SIZE: (u32, u32) = (640, 480);

#[test]
fn assumed_fingertip_is_reported() {
    let folder = folder("sense-assumed");
    // Untouched, pressed all over, and with a slightly dimmer lamp.
    let mut pictures = pictures(3);
    for pixel in &mut pictures[2].picture.pixels {
        *pixel = (f64::from(*pixel) * 0.97) as u8;
    }
    save(&pictures, &folder.join("pictures"));
    for frame in 0..3 {
        let picture = format!("pictures/frame{frame}.png");
        let ended = run(&folder, &["sense", &picture]);
        assert_eq!(ended.status, Some(0), "{ended:?}");
        let said = "assuming the fingertip of cap-closing";
        assert_eq!(ended.stderr.matches(said).count(), 1, "{ended:?}");
    }
    let named = ["sense", "pictures", "--experiment", "cap-closing"];
    let ended = run(&folder, &named);
    assert!(
        !ended.stderr.contains("assuming the fingertip"),
        "{ended:?}"
    );
}

#[test]
fn images_of_other_fingertips_are_refused_with_instructions() {
    let folder = folder("sense-assumed-not");
    let refused = |name: &str, picture: GrayImage| {
        fs::create_dir_all(folder.join(name)).unwrap();
        picture.save(folder.join(name).join("a.png")).unwrap();
        let words = ["cap-closing", "assumed", "feeler locate", "--layout"];
        let all = ["sense", name, "-o", "out.csv"];
        run(&folder, &all).refused(&words);
        assert!(!folder.join("out.csv").exists() && !folder.join("out.csv.part").exists());
    };
    let of = |gray: &dyn Fn(f64, f64) -> f64| {
        GrayImage::from_fn(SIZE.0, SIZE.1, |x, y| {
            Luma([gray(f64::from(x), f64::from(y)).clamp(0.0, 255.0) as u8])
        })
    };
    for gray in (0..=255).step_by(51) {
        refused("even", of(&|_, _| f64::from(gray)));
    }
    // A gel under a lamp, brightest in the middle.
    for peak in [60.0, 200.0] {
        refused("gel", of(&|x, y| peak - 0.2 * (x - 320.0).hypot(y - 240.0)));
    }
    // White pins on black, with various spacings, one of them in the middle of the image.
    for spacing in [16, 24, 36, 52] {
        for radius in [2.0, 5.0] {
            let s = f64::from(spacing);
            let off = |x: f64, middle: f64| (x - middle + 0.5 * s).rem_euclid(s) - 0.5 * s;
            let pin = |x, y| off(x, 320.0).hypot(off(y, 240.0)) <= radius;
            refused("pins", of(&|x, y| if pin(x, y) { 255.0 } else { 0.0 }));
        }
    }
    // The fingertip, but shifted farther than any load displaces an element.
    let tip = image(&pictures(1)[0].picture).to_luma8();
    let mut moved = GrayImage::new(SIZE.0, SIZE.1);
    image::imageops::overlay(&mut moved, &tip, 30, 0);
    refused("moved", moved);
    refused("small", image::imageops::thumbnail(&tip, 320, 240));
    // The first image decides, and unreadable images are skipped.
    fs::write(folder.join("even/0.png"), "no picture").unwrap();
    run(&folder, &["sense", "even"]).refused(&["skipped: even/0.png", "feeler locate"]);
}
