//! Computes forces from a folder of images of the reference fingertip.
//!
//! ```text
//! cargo run --release --example sense_folder -- pictures/ fingertip.calibration.toml
//! ```

use feeler::sensor::calibration::Calibration;
use feeler::sensor::forces::SensingChain;
use feeler::sensor::image::{Camera, CameraError, Frame};
use feeler_sources::PictureFiles;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = arguments.next().ok_or("expected a folder of images")?;
    let file = arguments.next().ok_or("expected a calibration file")?;

    let calibration = Calibration::from_toml(&std::fs::read_to_string(file)?)?;
    let fingertip =
        (calibration.made_for.fingertip.clone()).ok_or("expected a calibration for a fingertip")?;
    let mut sensing = SensingChain::of_fingertip(&fingertip)?.with_calibration(calibration)?;
    let (width, height) = sensing.picture_size();
    let mut camera = PictureFiles::new(&[folder], (width, height), 30.0)?;
    let mut frame = Frame::black(width, height);
    let mut readings = vec![Default::default(); sensing.element_count()];
    loop {
        match camera.capture(&mut frame) {
            Ok(()) => sensing.sense(&frame.picture, &mut readings)?,
            Err(CameraError::Ended { .. }) => return Ok(()),
            Err(error @ CameraError::Unreadable { .. }) => {
                eprintln!("skipped: {error}");
                continue;
            }
            Err(error) => return Err(error.into()),
        }
        let forces = readings.iter().filter_map(|reading| reading.force);
        let compression: f64 = forces.map(|force| force.z).sum();
        println!("frame {}: {compression:.3} N in all", frame.sequence);
    }
}
