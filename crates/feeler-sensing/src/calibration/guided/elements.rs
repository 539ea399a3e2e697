//! Guided loading of one element after another, saved as images with LOADS.csv.

use super::folder::Folder;
use super::guide::Guide;
use super::screen::Screen;
use super::{LOADS, Work};
use feeler::sensor::calibration::{
    COLUMNS, Coverage, ForceAxes, FullScale, Goal, LiveCalibration, ModelChoice, PLACE_COLUMNS,
    Seen, Wrench,
};
use feeler::sensor::image::Picture;
use feeler::sensor::moments::ElementMoments;
use feeler_console::CommandError;
use feeler_lab::sensor::{LoadsFile, SensorGeometry};
use glam::{DVec2, DVec3};
use std::path::Path;

pub struct Elements<'a> {
    sensor: &'a SensorGeometry,
    kept: Folder,
    calibration: LiveCalibration,
    guide: Guide<'a>,
}

impl<'a> Elements<'a> {
    /// Opens the folder at `path`, which may contain the results of an earlier session.
    ///
    /// # Errors
    /// If the folder is not writable, or its contents are unrelated or belong to another sensor.
    pub fn open(
        path: &Path,
        sensor: &'a SensorGeometry,
        goal: Goal,
        model: ModelChoice,
    ) -> Result<Self, CommandError> {
        let columns: Vec<&str> = COLUMNS.iter().chain(&PLACE_COLUMNS).copied().collect();
        let (mut kept, has_rows) = Folder::open(path, LOADS, &columns.join(","))?;
        let mut coverage = vec![Coverage::default(); sensor.seen.len()];
        if has_rows {
            let loads = LoadsFile::read(kept.table(), &sensor.seen, ForceAxes::default())?;
            kept.count(loads.picture_count());
            loads.each_force(|element, force| {
                coverage[element].count(force, &goal);
            });
        }
        let full_scale = FullScale {
            normal: goal.normal,
            shear: goal.shear,
        };
        Ok(Self {
            sensor,
            kept,
            calibration: LiveCalibration::new(sensor.frames.clone(), goal, coverage),
            guide: Guide::new(sensor, full_scale, model),
        })
    }

    /// Returns the number of incomplete elements.
    fn left(&self) -> usize {
        let elements = self.calibration.coverage().iter();
        elements.filter(|element| !element.is_complete()).count()
    }
}

impl Work for Elements<'_> {
    fn load(&mut self, at: f64, load: Wrench) {
        self.calibration.force(at, load.force);
    }

    fn is_ready(&self, at: f64) -> bool {
        self.calibration.is_ready(at)
    }

    fn picture(
        &mut self,
        at: f64,
        picture: &Picture,
        moments: &[ElementMoments],
        screen: &mut Screen,
    ) -> Result<(), CommandError> {
        let seen = self.calibration.picture(at, moments);
        match seen {
            Seen::Untouched => self.kept.add(picture, ",0,0,0,,,")?,
            Seen::Sample { element, force } => {
                let DVec3 { x, y, z } = force;
                let seen = self.sensor.seen[element];
                let (DVec2 { x: column, y: row }, angle) = (seen.centre_px, seen.x_angle);
                let values = format!("{element},{x},{y},{z},{column},{row},{angle}");
                self.kept.add(picture, &values)?;
                self.guide.sample(element, force, moments);
            }
            Seen::Nothing | Seen::Unclear | Seen::Enough { .. } => {}
        }
        self.guide.seen(&seen, screen);
        Ok(())
    }

    fn show(&mut self, screen: &mut Screen) {
        self.guide.show(&self.calibration, screen);
    }

    fn kept(&self) -> &Folder {
        &self.kept
    }

    fn missing(&self) -> Option<String> {
        let (left, all) = (self.left(), self.sensor.kernel.element_count());
        (left > 0).then(|| format!("{left} of {all} elements need more"))
    }
}
