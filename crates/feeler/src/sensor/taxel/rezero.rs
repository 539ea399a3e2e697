//! Measures the zero again while nothing is in contact with the skin.

use super::ZeroRule;
use glam::DVec3;

/// Mean of the readings during a time without contact and motion. Does not allocate.
#[derive(Debug, Clone)]
pub struct StillTime {
    rule: ZeroRule,
    /// Times of the first and the latest row, s.
    span: Option<(f64, f64)>,
    /// Mean of each taxel's valid values, and their number.
    means: Vec<(DVec3, u32)>,
    /// First valid values of each taxel.
    first: Vec<DVec3>,
}

impl StillTime {
    pub fn new(rule: ZeroRule, taxels: usize) -> Self {
        Self {
            rule,
            span: None,
            means: vec![(DVec3::ZERO, 0); taxels],
            first: vec![DVec3::NAN; taxels],
        }
    }

    pub fn restart(&mut self) {
        self.span = None;
        self.means.fill((DVec3::ZERO, 0));
        self.first.fill(DVec3::NAN);
    }

    /// Adds a row of `values` at time `stamp` (s). `longest` is the largest magnitude of all readings. Returns `true`
    /// if the duration is sufficient for the means to become the new zero.
    pub fn add(&mut self, stamp: f64, values: &[DVec3], scales: &[DVec3], longest: f64) -> bool {
        if longest > self.rule.untouched {
            self.restart();
            return false;
        }
        let is_forward = self.span.is_none_or(|(_, latest)| stamp >= latest);
        if !is_forward || self.moves(values, scales) {
            self.restart();
        }
        let (begin, _) = self.span.unwrap_or((stamp, stamp));
        self.span = Some((begin, stamp));
        let taxels = self.means.iter_mut().zip(&mut self.first).zip(values);
        for (((mean, count), first), &value) in taxels.filter(|(_, value)| !value.is_nan()) {
            *count += 1;
            *mean += (value - *mean) / f64::from(*count);
            if first.is_nan() {
                *first = value;
            }
        }
        stamp - begin >= self.rule.after
    }

    /// Returns `true` if a value differs too much from the first one of its taxel.
    fn moves(&self, values: &[DVec3], scales: &[DVec3]) -> bool {
        let taxels = values.iter().zip(&self.first).zip(scales);
        let mut changes = taxels.map(|((value, first), &scale)| ((value - first) / scale).abs());
        changes.any(|change| change.max_element() > self.rule.still)
    }

    /// Mean value of a taxel; `None` if it had no valid value.
    pub fn mean(&self, taxel: usize) -> Option<DVec3> {
        let (mean, count) = self.means[taxel];
        (count > 0).then_some(mean)
    }
}
