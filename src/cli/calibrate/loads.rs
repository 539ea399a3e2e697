//! Loads on disk: pictures and the CSV that says what was on the elements in each.

use super::CommandError;
use crate::cli::sensor_geometry::SensorGeometry;
use crate::sensor::calibration_fit::ElementRecord;
use crate::sensor::fingertip::FingertipConfig;
use crate::sensor::loads::{COLUMNS, RecordBuilder, read_loads};
use crate::sensor::moments::ElementMoments;
use crate::sim::calibration_bench::{CalibrationBenchConfig, take_pictures};
use crate::sim::optics_config::OpticsConfig;
use crate::sources::picture::read_picture;
use glam::DVec3;
use image::{ExtendedColorType, ImageFormat};
use std::fs::{self, File};
use std::path::Path;

/// Name of the file of loads in the folder that simulated loads are written to.
const LOADS: &str = "LOADS.csv";

/// Reads a file of loads and takes the moments of all pictures in it.
pub fn read(csv: &Path, sensor: &SensorGeometry) -> Result<Vec<ElementRecord>, CommandError> {
    let name = csv.display();
    let file = File::open(csv)
        .map_err(|e| format!("{name}: {e}; expected a CSV file of {}", COLUMNS.join(",")))?;
    let kernel = &sensor.kernel;
    let elements = kernel.element_count();
    let pictures = read_loads(file, elements).map_err(|e| format!("{name}: {e}"))?;
    let mut builder = RecordBuilder::new(elements);
    let mut moments = vec![ElementMoments::default(); elements];
    let folder = csv.parent().unwrap_or(Path::new(""));
    let (width, height) = sensor.size;
    for loaded in pictures {
        let refused = |what: String| {
            let (line, picture) = (loaded.line, &loaded.picture);
            format!(
                "{name}: line {line}: picture = {picture:?}: {what}; expected a picture of \
                 {width}x{height} px"
            )
        };
        let read = read_picture(&folder.join(&loaded.picture));
        let picture = read.map_err(|e| refused(e.to_string()))?;
        if (picture.width, picture.height) != (width, height) {
            let size = format!("it has {}x{} px", picture.width, picture.height);
            return Err(refused(size).into());
        }
        kernel.measure(&picture, &mut moments)?;
        builder.add(&loaded.forces, &moments);
    }
    Ok(builder.finish())
}

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
    if folder.join(LOADS).exists() {
        return Err(failed(&format!("there is a {LOADS} already")).into());
    }
    let mut rows = csv::Writer::from_path(folder.join(LOADS)).map_err(|e| failed(&e))?;
    rows.write_record(COLUMNS).map_err(|e| failed(&e))?;
    let mut number = 0;
    take_pictures(fingertip, optics, bench, |picture, loads| {
        let name = format!("{number:05}.png");
        number += 1;
        let (width, height) = (picture.width as u32, picture.height as u32);
        let (path, gray) = (folder.join(&name), ExtendedColorType::L8);
        image::save_buffer_with_format(
            path,
            &picture.pixels,
            width,
            height,
            gray,
            ImageFormat::Png,
        )
        .map_err(|e| failed(&e))?;
        for (element, load) in loads.iter().enumerate() {
            let DVec3 { x, y, z } = load.force();
            rows.serialize((&name, element, x, y, z))
                .map_err(|e| failed(&e))?;
        }
        Ok::<_, CommandError>(())
    })?;
    rows.flush().map_err(|e| failed(&e))?;
    Ok(())
}
