//! Measures markers at their predicted positions, and detects those that were mistaken for neighbours.

use super::{MAX_OFF, MarkerTracker, window, window::Look};
use crate::sensor::locate::median;
use glam::DVec2;

/// Like [`MAX_OFF`], but for a marker that is searched for again.
const MAX_OFF_AGAIN: f64 = 0.3;
/// Distance between two markers, relative to their distance in the reference, below which both are at the same spot.
const SAME: f64 = 0.4;
/// Contrast relative to a marker's typical contrast below which the marker is not visible.
const MIN_CONTRAST: f64 = 0.3;

impl MarkerTracker {
    /// Measures every marker at the displacement predicted in `work`. Updates `work` and `found`. Returns the number of
    /// markers that were found in the previous image, but now coincide with another marker.
    pub(super) fn measure(&mut self, pixels: &[u8]) -> usize {
        let mut mistaken = 0;
        for own in 0..self.reference.len() {
            self.looks[own] = self.look(pixels, own, self.work[own]);
        }
        self.typical = self.typical_contrast();
        for own in 0..self.reference.len() {
            let look = self.looks[own];
            let elsewhere = matches!(look, Look::Elsewhere(contrast) if self.shows(own, contrast));
            mistaken += usize::from(self.before[own] && elsewhere);
            self.found[own] = self.take(own, look);
        }
        let known = |tracker: &Self| {
            let both = tracker.before.iter().zip(&tracker.found);
            both.filter(|(before, now)| **before && **now).count()
        };
        let seen = known(self);
        self.one_marker_to_a_spot();
        // A marker that disagrees with its neighbours may do so because one of them is wrong; remove the worst first.
        for limit in [2.0 * MAX_OFF, MAX_OFF] {
            for own in 0..self.reference.len() {
                let off = self.field.off(own, &self.work, &self.found);
                self.found[own] &= off <= limit;
            }
        }
        mistaken += seen - known(self);
        for own in 0..self.reference.len() {
            if !self.found[own] {
                self.look_again(pixels, own);
            }
        }
        mistaken
    }

    /// Searches for a marker at the position predicted from the measured positions of its neighbours.
    fn look_again(&mut self, pixels: &[u8], own: usize) {
        let Some(predicted) = self.field.predict(own, &self.work, &self.found) else {
            self.work[own] = self.markers[own].displacement;
            return;
        };
        let look = self.look(pixels, own, predicted);
        self.found[own] = self.take(own, look)
            && self.field.off(own, &self.work, &self.found) <= MAX_OFF_AGAIN
            && !self.taken(own);
        if !self.found[own] {
            self.work[own] = predicted;
        }
    }

    fn look(&self, pixels: &[u8], own: usize, displacement: DVec2) -> Look {
        let about = self.reference[own] + displacement;
        self.window.look(pixels, self.size, self.polarity, about)
    }

    /// Median contrast at the predicted positions, gray levels; 0 if nothing is visible.
    fn typical_contrast(&mut self) -> f64 {
        let mut count = 0;
        for look in &self.looks {
            if let Look::Seen(seen) = look {
                self.contrasts_seen[count] = seen.contrast;
                count += 1;
            }
        }
        median(&mut self.contrasts_seen[..count])
    }

    /// Returns `true` if `contrast` is sufficient for marker `own`.
    fn shows(&self, own: usize, contrast: f64) -> bool {
        let usual = if self.contrasts[own] > 0.0 {
            self.contrasts[own]
        } else {
            self.typical
        };
        contrast >= (MIN_CONTRAST * usual).max(window::MIN_CONTRAST)
    }

    /// Accepts the measurement `look` for marker `own` if its contrast is sufficient: stores it in `work` and `seen`,
    /// and returns `true`.
    fn take(&mut self, own: usize, look: Look) -> bool {
        match look {
            Look::Seen(seen) if self.shows(own, seen.contrast) => {
                self.work[own] = seen.place - self.reference[own];
                self.seen[own] = seen;
                true
            }
            _ => false,
        }
    }

    /// Resolves conflicts between markers measured at the same spot: the one that agrees less with its neighbours
    /// counts as not found.
    fn one_marker_to_a_spot(&mut self) {
        for own in 0..self.reference.len() {
            for place in 0..self.field.neighbours(own).len() {
                let other = self.field.neighbours(own)[place];
                if other <= own || !(self.found[own] && self.found[other]) || !self.same(own, other)
                {
                    continue;
                }
                let off = |marker| self.field.off(marker, &self.work, &self.found);
                let loser = if off(own) > off(other) { own } else { other };
                self.found[loser] = false;
            }
        }
    }

    /// Returns `true` if another marker was measured at the position of `own`.
    fn taken(&self, own: usize) -> bool {
        let near = self.field.neighbours(own).iter();
        near.copied()
            .any(|other| self.found[other] && self.same(own, other))
    }

    fn same(&self, own: usize, other: usize) -> bool {
        let before = self.reference[own] - self.reference[other];
        let now = before + self.work[own] - self.work[other];
        now.length_squared() < SAME * SAME * before.length_squared()
    }
}
