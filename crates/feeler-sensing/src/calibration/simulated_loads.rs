//! Simulated loads, written to disk in the format of laboratory data.

use feeler::sensor::calibration::{COLUMNS, PLACE_COLUMNS};
use feeler::sensor::fingertip::{Fingertip, FingertipConfig};
use feeler::sensor::image::Picture;
use feeler_console::{CommandError, Outputs};
use feeler_report::run::make::create_folder;
use feeler_sim::bench::{CalibrationBenchConfig, take_pictures};
use feeler_sim::optics::OpticsConfig;
use glam::{DVec2, DVec3};
use image::{ExtendedColorType, ImageFormat};
use std::path::Path;

/// File name of the table of loads.
const LOADS: &str = "LOADS.csv";
/// File name of an image of the unloaded fingertip, for `feeler locate`.
const UNTOUCHED: &str = "untouched.png";

/// Writes images of the simulated fingertip under load, with their table of loads. An image without load is saved a
/// second time under the name `UNTOUCHED`.
pub fn write_simulated_loads(
    folder: &Path,
    fingertip: &FingertipConfig,
    optics: &OpticsConfig,
    bench: &CalibrationBenchConfig,
) -> Result<(), CommandError> {
    let failed = |e: &dyn std::fmt::Display| {
        let folder = folder.display();
        format!("--write-loads {folder}: {e}; expected a new, writable folder")
    };
    create_folder(folder).map_err(|e| failed(&e))?;
    // Written last: its rows must not refer to missing images.
    let file =
        Outputs::without_force("another folder").create(&folder.join(LOADS), "--write-loads")?;
    let mut rows = csv::Writer::from_writer(Vec::new());
    rows.write_record(COLUMNS.iter().chain(&PLACE_COLUMNS))
        .map_err(|e| failed(&e))?;
    let seen = Fingertip::seen_elements(fingertip)?;
    let save = |name: &str, picture: &Picture| {
        let path = folder.join(name);
        if path.exists() {
            return Err(failed(&format!("{name} exists already")));
        }
        let (width, height) = (picture.width as u32, picture.height as u32);
        let (gray, png) = (ExtendedColorType::L8, ImageFormat::Png);
        let saved = image::save_buffer_with_format(path, &picture.pixels, width, height, gray, png);
        saved.map_err(|e| failed(&e))
    };
    let mut untouched = false;
    let mut number = 0;
    take_pictures(fingertip, optics, bench, |picture, loads| {
        let name = format!("{number:05}.png");
        number += 1;
        save(&name, picture)?;
        if !untouched && loads.iter().all(|load| load.force() == DVec3::ZERO) {
            save(UNTOUCHED, picture)?;
            untouched = true;
        }
        for (element, (load, seen)) in loads.iter().zip(&seen).enumerate() {
            let DVec3 { x, y, z } = load.force();
            let DVec2 { x: column, y: row } = seen.centre_px;
            rows.serialize((&name, element, x, y, z, column, row, seen.x_angle))
                .map_err(|e| failed(&e))?;
        }
        Ok::<_, CommandError>(())
    })?;
    Ok(file.finish(&rows.into_inner().map_err(|e| failed(&e))?)?)
}
