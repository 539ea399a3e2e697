//! Guided presses of the whole fingertip, to verify a calibration; saved as images with FORCES.csv.

use super::folder::Folder;
use super::screen::{Screen, missing_before_loads};
use super::{FORCES, Work};
use feeler::sensor::calibration::{LivePresses, SeenPress, Stage, Wrench};
use feeler::sensor::image::Picture;
use feeler::sensor::moments::ElementMoments;
use feeler_console::CommandError;
use std::path::Path;

pub struct Presses {
    kept: Folder,
    live: LivePresses,
    seen: SeenPress,
    announced: u32,
}

impl Presses {
    /// Opens the new folder at `path`, for `wanted` presses of about `full_scale` (N).
    ///
    /// # Errors
    /// If the folder is not writable, or contains anything. Presses of an earlier session show an earlier state of the
    /// sensor.
    pub fn open(path: &Path, full_scale: f64, wanted: u32) -> Result<Self, CommandError> {
        let (kept, has_rows) = Folder::open(path, FORCES, "picture,f_x,f_y,f_z,recording,time")?;
        if has_rows {
            let path = path.display();
            return Err(format!("{path}: expected a new folder, got one with presses").into());
        }
        Ok(Self {
            kept,
            live: LivePresses::new(full_scale, wanted),
            seen: SeenPress::Nothing,
            announced: wanted,
        })
    }

    /// Describes the current contact.
    fn now(&self) -> String {
        match self.seen {
            SeenPress::Sample(wrench) => format!("{:.2} N", -wrench.force.z),
            SeenPress::Unclear => "press more slowly".into(),
            SeenPress::Nothing => String::new(),
        }
    }
}

impl Work for Presses {
    fn load(&mut self, at: f64, load: Wrench) {
        self.live.wrench(at, load);
    }

    fn is_ready(&self, at: f64) -> bool {
        self.live.is_ready(at)
    }

    fn picture(
        &mut self,
        at: f64,
        picture: &Picture,
        moments: &[ElementMoments],
        _screen: &mut Screen,
    ) -> Result<(), CommandError> {
        let seen = self.live.picture(at, moments);
        if let SeenPress::Sample(wrench) = seen {
            let [x, y, z] = wrench.force.to_array();
            self.kept.add(picture, &format!("{x},{y},{z},live,{at}"))?;
        }
        if seen != SeenPress::Nothing {
            self.seen = seen;
        }
        Ok(())
    }

    fn show(&mut self, screen: &mut Screen) {
        let stage = match self.live.stage() {
            Stage::Untouched { .. } => "do not touch the fingertip",
            Stage::Presses { .. } => {
                "press and release the fingertip three times, to measure the camera's latency"
            }
            Stage::Loads => "press the fingertip slowly at different places, and release it",
        };
        screen.stage(self.live.stage(), stage, self.live.delay());
        let missing = self.live.missing();
        let left = format!("{missing} more presses");
        if missing < self.announced {
            self.announced = missing;
            screen.step(&left);
        }
        if screen.is_due() {
            let now = missing_before_loads(self.live.stage());
            let now = now.unwrap_or_else(|| format!("{left}\n{}", self.now()));
            screen.draw(format!("{stage}\n{now}\n"));
        }
    }

    fn kept(&self) -> &Folder {
        &self.kept
    }

    fn missing(&self) -> Option<String> {
        let missing = self.live.missing();
        (missing > 0).then(|| format!("presses still missing: {missing}"))
    }
}
