//! Simulated loads, written to disk as a laboratory's would be.

use super::CommandError;
use crate::part_file::{Outputs, Overwrite};
use feeler::sensor::fingertip::FingertipConfig;
use feeler::sensor::loads::COLUMNS;
use feeler_sim::calibration_bench::{CalibrationBenchConfig, take_pictures};
use feeler_sim::optics_config::OpticsConfig;
use glam::DVec3;
use image::{ExtendedColorType, ImageFormat};
use std::fs;
use std::path::Path;

/// Name of the file of loads in the folder that simulated loads are written to.
const LOADS: &str = "LOADS.csv";

/// Writes pictures of the simulated fingertip under load, and the file of loads.
pub fn write_simulated(
    folder: &Path,
    fingertip: &FingertipConfig,
    optics: &OpticsConfig,
    bench: &CalibrationBenchConfig,
) -> Result<(), CommandError> {
    let failed = |e: &dyn std::fmt::Display| {
        let folder = folder.display();
        format!("--write-loads {folder}: {e}; expected a new folder that can be written to")
    };
    fs::create_dir_all(folder).map_err(|e| failed(&e))?;
    // Written last: its rows may name pictures only when all are there.
    let keep = Overwrite { force: false };
    let file = Outputs::new(keep, []).create(&folder.join(LOADS), "--write-loads")?;
    let mut rows = csv::Writer::from_writer(Vec::new());
    rows.write_record(COLUMNS).map_err(|e| failed(&e))?;
    let mut number = 0;
    take_pictures(fingertip, optics, bench, |picture, loads| {
        let name = format!("{number:05}.png");
        number += 1;
        let path = folder.join(&name);
        if path.exists() {
            return Err(failed(&format!("there is a {name} already")).into());
        }
        let (width, height) = (picture.width as u32, picture.height as u32);
        let gray = ExtendedColorType::L8;
        let saved = image::save_buffer_with_format(
            path,
            &picture.pixels,
            width,
            height,
            gray,
            ImageFormat::Png,
        );
        saved.map_err(|e| failed(&e))?;
        for (element, load) in loads.iter().enumerate() {
            let DVec3 { x, y, z } = load.force();
            rows.serialize((&name, element, x, y, z))
                .map_err(|e| failed(&e))?;
        }
        Ok::<_, CommandError>(())
    })?;
    file.finish(&rows.into_inner().map_err(|e| failed(&e))?)
}
