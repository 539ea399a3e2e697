//! Figures of a sweep: success rate against a parameter, and distributions of measures.

use super::Figure;
use crate::figures::drawing::canvas::{
    Pen, airy, dots, finger_colour, line, line_in_band, panel, range,
};
use crate::figures::drawing::grid;
use crate::figures::drawing::sheet::tiled;
use crate::page_data::panels::{Colour, Command, Points, Series};
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

/// A varied parameter with a numeric value in each trial.
#[derive(Debug, Clone, PartialEq)]
pub struct Varied {
    /// Name of the parameter.
    pub name: String,
    /// `true` if it was drawn on a logarithmic scale.
    pub logarithmic: bool,
    /// Value in each trial, and whether the trial was a success.
    pub trials: Vec<(f64, bool)>,
}

/// A measure with its values over all trials.
#[derive(Debug, Clone, PartialEq)]
pub struct Measured {
    /// Name and unit.
    pub name: String,
    /// Values of the trials that define it.
    pub values: Vec<f64>,
}

/// Measure of each trial, to be plotted against the varied parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct TrialMeasure {
    /// Name and unit.
    pub name: String,
    /// Trial number and value of each trial, in the order of [`Varied::trials`].
    pub trials: Vec<(u64, Option<f64>)>,
}

/// Number of bins of a parameter's range.
const BINS: usize = 12;
/// Number of bins of a histogram.
const BARS: usize = 24;
/// Maximum number of trials in an interactive panel.
const MAX_TRIALS: usize = 5000;
/// Maximum number of trials in a static figure.
const MAX_DOTS: usize = 300;
const SUCCESS: &str = "success";
const FAILURE: &str = "failure";
/// Number of standard deviations of a 95 % confidence interval.
const Z: f64 = 1.959_964;

/// Wilson's 95 % confidence interval of a success rate.
pub fn wilson(successes: u64, trials: u64) -> (f64, f64) {
    if trials == 0 {
        return (0.0, 1.0);
    }
    let n = trials as f64;
    let rate = successes as f64 / n;
    let shrink = 1.0 + Z * Z / n;
    let centre = (rate + Z * Z / (2.0 * n)) / shrink;
    let half = Z / shrink * (rate * (1.0 - rate) / n + Z * Z / (4.0 * n * n)).sqrt();
    ((centre - half).max(0.0), (centre + half).min(1.0))
}

/// Success rate per bin of a parameter: mean parameter value, and the rate with its interval.
fn rates(varied: &Varied) -> Vec<(f64, [f64; 3])> {
    let Some((low, high)) = range(varied.trials.iter().map(|trial| trial.0)) else {
        return Vec::new();
    };
    let bins = BINS.min((varied.trials.len() / 8).max(2));
    let share = |x: f64| match varied.logarithmic {
        true => (x / low).ln() / (high / low).ln(),
        false => (x - low) / (high - low),
    };
    let mut counts = vec![(0.0, 0, 0); bins];
    for &(x, success) in &varied.trials {
        let bin = (share(x) * bins as f64) as usize;
        let (sum, trials, successes) = &mut counts[bin.min(bins - 1)];
        *sum += x;
        *trials += 1;
        *successes += u64::from(success);
    }
    let counted = counts.into_iter().filter(|(_, trials, _)| *trials > 0);
    counted
        .map(|(sum, trials, successes)| {
            let (lower, upper) = wilson(successes, trials);
            let n = trials as f64;
            (sum / n, [lower, successes as f64 / n, upper])
        })
        .collect()
}

/// Success rate (%) against a parameter, with its 95 % confidence band.
pub(super) fn rate_with_band(varied: &Varied, pen: Pen) -> Vec<Plot> {
    let percent = |(x, rate): (f64, [f64; 3])| (x, rate.map(|part| 100.0 * part));
    line_in_band(rates(varied).into_iter().map(percent), pen).into()
}

/// Panel of a quantity with range `upright` against a parameter.
pub(super) fn parameter_panel(
    varied: &Varied,
    label: &str,
    upright: (f64, f64),
    name: &str,
) -> Layout {
    let along = range(varied.trials.iter().map(|trial| trial.0)).unwrap_or((0.0, 1.0));
    let layout = panel(along, upright, label, name);
    // A range without width has been widened and may not allow a logarithm.
    match varied.logarithmic && 0.0 < along.0 && along.0 < along.1 {
        true => layout.with_log_x(),
        false => layout,
    }
}

/// Success rate (%) against a parameter, with its 95 % confidence band and all trials.
pub fn success_figure(varied: &Varied, number: u32, measured: Option<&TrialMeasure>) -> Figure {
    let pen = Pen::solid(finger_colour(0), 2.0);
    let rate = (
        rate_with_band(varied, pen),
        parameter_panel(varied, &varied.name, (0.0, 100.0), "success (%)"),
    );
    let title = format!("Success rate against {}", varied.name);
    let mut legend = vec![(SUCCESS, pen)];
    let trials = measured.map(|measured| Scatter::new(varied, measured));
    let panels = match &trials {
        None => vec![rate],
        Some(trials) => {
            legend.push((FAILURE, Pen::solid(finger_colour(1), 2.0)));
            vec![rate, trials.drawn(varied)]
        }
    };
    let mut drawing = tiled((number, &title), &legend, panels, 1, 230.0);
    if let (Some(trials), Some(panel)) = (trials, drawing.panels.get_mut(1)) {
        panel.series = trials.answering();
    }
    let caption = match measured {
        None => "Success rate in bins of equal width, with Wilson's 95 % interval.",
        Some(_) => {
            "Top: success rate in bins of equal width, with Wilson's 95 % interval. Bottom: each trial that has the \
            measure. Click a dot to copy the command that repeats the trial."
        }
    };
    Figure::drawn(number, title, caption, Some(drawing))
}

/// Histograms of all measures, in two columns of panels.
pub fn distributions_figure(measures: &[Measured], number: u32) -> Figure {
    let pen = Pen::solid(finger_colour(0), 1.6);
    let histogram = |measured| {
        let (outline, layout) = histogram(measured);
        (vec![line(outline, pen)], layout)
    };
    let panels = measures.iter().map(histogram).collect();
    let (title, legend) = ("Distribution of measures", [("number of trials", pen)]);
    let drawing = tiled((number, title), &legend, panels, 2, 210.0);
    let caption =
        "All trials that define the measure. The digit in front of a measure is the stroke.";
    Figure::drawn(number, title, caption, Some(drawing))
}

/// The trials of a sweep as dots, grouped by success and failure.
struct Scatter<'a> {
    measured: &'a TrialMeasure,
    groups: [Vec<Dot>; 2],
}

/// A trial: number, parameter, measure.
type Dot = (u64, f64, f64);

impl<'a> Scatter<'a> {
    fn new(varied: &Varied, measured: &'a TrialMeasure) -> Self {
        let step = varied.trials.len().div_ceil(MAX_TRIALS).max(1);
        let mut groups = [Vec::new(), Vec::new()];
        let trials = varied.trials.iter().zip(&measured.trials).step_by(step);
        for (&(x, success), &(trial, value)) in trials {
            if let Some(value) = value.filter(|value| value.is_finite()) {
                groups[usize::from(!success)].push((trial, x, value));
            }
        }
        Self { measured, groups }
    }

    fn drawn(&self, varied: &Varied) -> grid::Panel {
        let all = || self.groups.iter().flatten();
        let upright = airy(range(all().map(|dot| dot.2)).unwrap_or((0.0, 1.0)));
        let layout = parameter_panel(varied, &varied.name, upright, &self.measured.name);
        let plots = self.groups.iter().enumerate().map(|(group, trials)| {
            let points: Vec<_> = trials.iter().map(|&(_, x, y)| (x, y)).collect();
            dots(&points, MAX_DOTS, finger_colour(group), 2.4)
        });
        (plots.collect(), layout)
    }

    fn answering(self) -> Vec<Series> {
        let [success, failure] = self.groups.map(|trials: Vec<Dot>| Points {
            command: Some(Command::of_trials("", trials.iter().map(|t| t.0).collect())),
            ..Points::new(trials.iter().map(|&(_, x, y)| (x, y)))
        });
        let series = |name: &str, finger, points| {
            Series::of_points(name, Colour::Finger(finger), points).dotted()
        };
        vec![series(SUCCESS, 0, success), series(FAILURE, 1, failure)]
    }
}

/// Outline of a histogram, and its panel.
fn histogram(measured: &Measured) -> (Vec<(f64, f64)>, Layout) {
    let (low, high) = range(measured.values.iter().copied()).unwrap_or((0.0, 1.0));
    let high = if high > low { high } else { low + 1.0 };
    let width = (high - low) / BARS as f64;
    let mut counts = [0u32; BARS];
    for value in &measured.values {
        let bin = ((value - low) / width) as usize;
        counts[bin.min(BARS - 1)] += 1;
    }
    let mut outline = vec![(low, 0.0)];
    for (bin, &count) in counts.iter().enumerate() {
        let left = low + bin as f64 * width;
        outline.extend([(left, f64::from(count)), (left + width, f64::from(count))]);
    }
    outline.push((high, 0.0));
    let top = f64::from(counts.into_iter().max().unwrap_or(0)).max(1.0);
    let layout = panel((low, high), (0.0, 1.1 * top), &measured.name, "trials").with_ticks(3);
    (outline, layout)
}

#[cfg(test)]
mod tests {
    use super::wilson;

    #[test]
    fn wilson_interval_matches_published_values() {
        // Newcombe (1998), table I: 81 of 263, 15 of 148, 0 of 20.
        for ((successes, trials), (low, high)) in [
            ((81, 263), (0.2553, 0.3662)),
            ((15, 148), (0.0624, 0.1605)),
            ((0, 20), (0.0, 0.1611)),
        ] {
            let (lower, upper) = wilson(successes, trials);
            assert!((lower - low).abs() < 1e-4 && (upper - high).abs() < 1e-4);
        }
    }
}
