//! Rendered images of a scene.

use super::support::{environment, told};
use std::path::Path;

const SIZE: (usize, usize) = (480, 360);

/// Number of pixels in the warm colours of pressed elements.
fn pressed(rgb: &[u8]) -> usize {
    let warm = |pixel: &&[u8]| i32::from(pixel[0]) > i32::from(pixel[2]) + 10;
    rgb.chunks_exact(3).filter(warm).count()
}

#[test]
fn pressed_elements_are_drawn_in_another_colour() {
    let mut environment = environment("cap-closing", &[]);
    let mut rgb = vec![0; 3 * SIZE.0 * SIZE.1];
    environment.reset(Some(0)).expect("an episode");
    environment.render(SIZE, &mut rgb).expect("a picture");
    assert_eq!(pressed(&rgb), 0);
    let mut action = vec![0.0; environment.action_len()];
    while told(&environment, "peak_force_n") < 0.4 {
        environment.guide(&mut action).expect("an action");
        environment.step(&action).expect("a step");
    }
    environment.render(SIZE, &mut rgb).expect("a picture");
    assert!(pressed(&rgb) > 0);
    // Saved for inspection.
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("cap-closing.png");
    let (width, height) = (SIZE.0 as u32, SIZE.1 as u32);
    image::save_buffer(&file, &rgb, width, height, image::ColorType::Rgb8).expect("a file");
}

#[test]
fn a_buffer_too_small_for_the_image_is_rejected() {
    let environment = environment("lift", &[]);
    let error = environment
        .render((4, 3), &mut [0; 35])
        .expect_err("too little");
    assert!(
        error
            .to_string()
            .contains("4 x 3 pixels needs 36 bytes, got 35"),
        "{error}"
    );
    assert!(environment.render((0, 0), &mut []).is_ok());
}
