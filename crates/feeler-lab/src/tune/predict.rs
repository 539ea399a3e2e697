//! Predicted success rate of settings, from simulations of draws that the search did not use.

use super::TuneError;
use super::judge::{CLAIMS, Margins, judge_all};
use super::search::{Problem, score};
use super::settings::Settings;

/// Results of simulating the same settings over several draws.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Prediction {
    /// Margin of each evaluated claim, for each run.
    pub margins: Vec<Margins>,
    /// Drawn values of each run.
    pub values: Vec<Vec<f64>>,
}

impl Prediction {
    /// Simulates `settings`, or the experiment's own settings if `None`, over the draws 0 to `count - 1`. Returns
    /// `None` if the problem's `stop` was set meanwhile.
    ///
    /// # Errors
    /// If no valid experiment can be drawn, or a run fails.
    pub fn new(
        problem: &Problem<'_>,
        settings: Option<&Settings>,
        count: u64,
    ) -> Result<Option<Self>, TuneError> {
        let (mut experiments, mut values) = (Vec::new(), Vec::new());
        for index in 0..count {
            let mut draw = problem.uncertainty.draw(index)?;
            if let Some(settings) = settings {
                settings.apply(&mut draw.experiment.config, problem.hand.pivot);
            }
            experiments.push(draw.experiment);
            values.push(draw.values);
        }
        let margins = judge_all(&experiments, problem.jobs, problem.stop)?;
        Ok(margins.map(|margins| Self { margins, values }))
    }

    /// Number of runs in which all claims pass.
    pub fn successes(&self) -> u64 {
        self.margins.iter().filter(|margins| margins.hold()).count() as u64
    }

    /// Mean score of the runs, which is the objective of the search.
    pub fn score(&self) -> f64 {
        score(&self.margins)
    }

    /// Returns the quantile of the margin of claim `claim` at probability `p` (0 to 1).
    pub fn quantile(&self, claim: usize, p: f64) -> Option<f64> {
        debug_assert!(claim < CLAIMS);
        let mut margins: Vec<f64> = self.margins.iter().map(|m| m.0[claim]).collect();
        margins.sort_by(f64::total_cmp);
        let last = margins.len().checked_sub(1)?;
        margins.get((p * last as f64).round() as usize).copied()
    }

    /// Fraction of runs in which all claims pass, for the lowest, middle and highest third of the uncertain value
    /// `index`.
    pub fn thirds(&self, index: usize) -> [f64; 3] {
        let value = |run: usize| self.values[run][index];
        let mut order: Vec<usize> = (0..self.margins.len()).collect();
        order.sort_by(|&a, &b| value(a).total_cmp(&value(b)));
        let ends = |third: usize| third * order.len() / 3;
        std::array::from_fn(|third| {
            let runs = &order[ends(third)..ends(third + 1)];
            let held = runs.iter().filter(|&&run| self.margins[run].hold());
            held.count() as f64 / runs.len().max(1) as f64
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tune::judge::FAILED;

    #[test]
    fn thirds_show_the_effect_of_a_value() {
        let good = Margins([0.1; CLAIMS]);
        let prediction = Prediction {
            margins: vec![good, FAILED, good, FAILED, good, good],
            values: [3.0, 9.0, 1.0, 8.0, 2.0, 4.0].map(|v| vec![v]).into(),
        };
        assert_eq!(prediction.thirds(0), [1.0, 1.0, 0.0]);
        assert_eq!(prediction.successes(), 4);
        assert_eq!(prediction.quantile(0, 0.0), Some(-1.0));
    }
}
