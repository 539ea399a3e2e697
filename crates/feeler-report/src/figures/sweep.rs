//! Figures of a sweep: success rate against a parameter, and how measures are distributed.

use super::super::sweep_page::{Measured, Varied};
use super::canvas::{Pen, finger_colour, frame, line, panel, range};
use kuva::plot::BandPlot;
use kuva::render::figure::Figure as Panels;
use kuva::render::layout::Layout;
use kuva::render::plots::Plot;

/// Bins of a parameter's range.
const BINS: usize = 12;
/// Bins of a histogram.
const BARS: usize = 24;
/// Standard deviations of a 95 % confidence interval.
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

/// Success rate in bins of a parameter: the middle of each, and the rate's interval and value.
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

/// A rate against a parameter, %, within its 95 % confidence band.
pub(super) fn rate_with_band(varied: &Varied, pen: Pen) -> Vec<Plot> {
    let rates = rates(varied);
    let percent = |which: usize| rates.iter().map(move |(_, rate)| 100.0 * rate[which]);
    let x = || rates.iter().map(|(x, _)| *x);
    let band = BandPlot::new(x(), percent(0), percent(2))
        .with_color(pen.colour)
        .with_opacity(0.2);
    vec![Plot::Band(band), line(x().zip(percent(1)), pen)]
}

/// Success rate against a parameter, %, with its 95 % confidence band.
pub fn success_figure(varied: &Varied, number: u32) -> String {
    let pen = Pen::solid(finger_colour(0), 2.0);
    let plots = rate_with_band(varied, pen);
    let (low, high) = range(varied.trials.iter().map(|trial| trial.0)).unwrap_or((0.0, 1.0));
    let layout = panel((low, high), (0.0, 100.0), &varied.name, "success (%)");
    let panels = Panels::new(1, 1)
        .with_plots(vec![plots])
        .with_layouts(vec![layout]);
    let title = format!("Success rate against {}", varied.name);
    let band = Pen {
        width: 10.0,
        ..Pen::solid("#cce3f0", 10.0)
    };
    let legend = [("share of trials", pen), ("95 % confidence", band)];
    frame(number, &title, &legend, panels, 270.0)
}

/// How often each measure took which value, in two columns of panels.
pub fn distributions_figure(measures: &[Measured], number: u32) -> String {
    let pen = Pen::solid(finger_colour(0), 1.6);
    let (mut plots, mut layouts) = (Vec::new(), Vec::new());
    for measured in measures {
        let (outline, layout) = histogram(measured);
        plots.push(vec![line(outline, pen)]);
        layouts.push(layout);
    }
    let rows = measures.len().div_ceil(2).max(1);
    let panels = Panels::new(rows, 2)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_spacing(6.0)
        .with_padding(6.0);
    let legend = [("number of trials", pen)];
    frame(
        number,
        "Distribution of measures",
        &legend,
        panels,
        210.0 * rows as f64,
    )
}

/// The outline of a histogram, and the panel that holds it.
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
    fn wilsons_interval_is_that_of_the_textbook() {
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
