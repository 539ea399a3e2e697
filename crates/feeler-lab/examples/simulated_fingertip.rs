//! Calibrates a simulated fingertip, presses on three of its elements and reads the forces back.
//!
//! ```text
//! cargo run --release --example simulated_fingertip -- [picture.png]
//! ```

use feeler::sensor::calibration::CalibrationReport;
use feeler::sensor::fingertip::{Fingertip, FingertipConfig};
use feeler::sensor::forces::{OpticalSensor, TactileFrame, TactileSensor};
use feeler::sensor::image::{Camera, CameraError, Frame};
use feeler_sim::bench::{CalibrationBenchConfig, calibrate_simulated};
use feeler_sim::optics::{OpticsConfig, OpticsModel, OpticsScratch, render};
use glam::DVec3;
use rand::SeedableRng;
use rand_pcg::Pcg64;

/// A camera that observes a fingertip under constant forces.
struct StillCamera {
    model: OpticsModel,
    scratch: OpticsScratch,
    rng: Pcg64,
    forces: Vec<DVec3>,
    exposures: u64,
}

impl Camera for StillCamera {
    fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
        let (model, scratch) = (&self.model, &mut self.scratch);
        render(
            model,
            scratch,
            &self.forces,
            &mut self.rng,
            &mut frame.picture,
        )
        .map_err(|_| CameraError::Ended {
            count: self.exposures,
        })?;
        frame.sequence = self.exposures;
        self.exposures += 1;
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let config = FingertipConfig::default();
    let optics = OpticsConfig::default();
    let calibration = calibrate_simulated(&config, &optics, &CalibrationBenchConfig::default())?;
    println!("{}", CalibrationReport::new(&calibration));

    let fingertip = Fingertip::new(&config)?;
    let model = OpticsModel::new(&optics, &fingertip.layout, &fingertip.projection)?;
    let mut forces = vec![DVec3::ZERO; fingertip.layout.elements.len()];
    forces[0] = DVec3::new(0.0, 0.0, 1.0);
    forces[3] = DVec3::new(0.4, 0.0, 1.0);
    forces[26] = DVec3::new(0.0, 0.8, 1.9);
    let camera = StillCamera {
        scratch: OpticsScratch::new(&model),
        model,
        rng: Pcg64::seed_from_u64(2),
        forces: forces.clone(),
        exposures: 0,
    };

    let mut sensor = OpticalSensor::new(camera, &config, calibration)?;
    let mut reading = TactileFrame::unloaded(sensor.element_count());
    sensor.read(&mut reading)?;
    for (element, (pressed, read)) in forces.iter().zip(&reading.forces).enumerate() {
        if *pressed != DVec3::ZERO {
            println!("element {element}: pressed with {pressed} N, read {read:.3} N");
        }
    }

    if let Some(path) = std::env::args().nth(1) {
        let picture = &sensor.frame().picture;
        image::save_buffer(
            path,
            &picture.pixels,
            picture.width as u32,
            picture.height as u32,
            image::ColorType::L8,
        )?;
    }
    Ok(())
}
