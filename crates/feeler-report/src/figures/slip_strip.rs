//! Strip that shows SLIP and, below it, true slip over time.

use crate::figures::drawing::canvas::{CAP, exact_panel, finger_colour};
use crate::figures::drawing::grid::Panel;
use crate::measures::strokes::TRUE_SLIP;
use crate::run::data::RunData;
use crate::run::finger_columns::FingerColumns;
use kuva::plot::BandPlot;
use kuva::render::layout::TickFormat;
use kuva::render::plots::Plot;
use std::ops::Range;
use std::sync::Arc;

/// Height of a lane.
const HEIGHT: f64 = 16.0;
/// Margin above and below the lanes.
const MARGIN: f64 = 4.0;
/// Half height of an event relative to its lane.
const HALF: f64 = 0.38;

/// State of a lane for a finger at a row; `None` if unknown.
type Event = fn(&FingerColumns, usize) -> Option<bool>;

/// A lane: name, colour and filled time spans.
type Lane = (&'static str, &'static str, Vec<(f64, f64)>);

/// Strip over these rows with two lanes per finger (one if true slip is unknown), and its height.
pub fn slip_strip(data: &RunData, rows: Range<usize>, time: (f64, f64)) -> (f64, Panel) {
    let mut lanes: Vec<Lane> = Vec::new();
    for (f, finger) in data.fingers.iter().enumerate() {
        let events: [(&str, &str, Event); 2] = [
            ("SLIP", finger_colour(f), |finger, row| {
                finger.slip.get(row).copied()
            }),
            ("true slip", CAP, |finger, row| {
                Some((*finger.slipped.get(row)?)? > TRUE_SLIP)
            }),
        ];
        let known = events.map(|(name, colour, event)| {
            let spans = spans(&data.time, rows.clone(), |row| event(finger, row));
            spans.map(|spans| (name, colour, spans))
        });
        lanes.extend(known.into_iter().flatten());
    }
    let count = lanes.len() as f64;
    // From top to bottom. The middle of a lane is an integer, at which a tick label shows its name.
    let names: Vec<_> = lanes.iter().rev().map(|lane| lane.0).collect();
    let name = move |tick: f64| {
        let lane = names.get(tick.round() as usize);
        lane.filter(|_| tick >= 0.0)
            .map_or(String::new(), |name| (*name).into())
    };
    let layout = exact_panel(time, (-0.5, count - 0.5), "", "")
        .with_y_tick_step(1.0)
        .with_y_tick_format(TickFormat::Custom(Arc::new(name)))
        .with_tick_size(12)
        .with_force_margins_y(MARGIN, MARGIN);
    let middles = (1..=lanes.len()).rev().map(|lane| lane as f64 - 1.0);
    let plots = lanes.iter().zip(middles).map(|(lane, y)| draw(lane, y));
    let height = HEIGHT * count + 2.0 * MARGIN;
    (height, (plots.collect(), layout))
}

/// One lane, filled around the height `middle`.
fn draw((_, colour, spans): &Lane, middle: f64) -> Plot {
    let (mut x, mut half) = (Vec::new(), Vec::new());
    for (start, end) in spans {
        x.extend([start, start, end, end]);
        half.extend([0.0, HALF, HALF, 0.0]);
    }
    let lower: Vec<_> = half.iter().map(|half| middle - half).collect();
    let upper: Vec<_> = half.iter().map(|half| middle + half).collect();
    let band = BandPlot::new(x.into_iter().copied(), lower, upper);
    Plot::Band(band.with_color(*colour).with_opacity(1.0))
}

/// Time spans (s) in which `event` is true; its value at a row applies from the previous row to this row. `None` if it
/// is unknown at any row.
fn spans(
    time: &[f64],
    rows: Range<usize>,
    event: impl Fn(usize) -> Option<bool>,
) -> Option<Vec<(f64, f64)>> {
    let mut spans: Vec<(f64, f64)> = Vec::new();
    let first = *time.get(rows.start)?;
    let mut before = first;
    for row in rows {
        let now = *time.get(row)?;
        if event(row)? {
            match spans.last_mut() {
                Some(last) if last.1 == before => last.1 = now,
                _ => spans.push((before, now)),
            }
        }
        before = now;
    }
    Some(spans)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn consecutive_events_are_one_span_from_the_previous_row() {
        let time = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let up = [false, false, true, true, false, true];
        let of = |rows| spans(&time, rows, |row| Some(up[row]));
        assert_eq!(of(0..6), Some(vec![(1.0, 3.0), (4.0, 5.0)]));
        assert_eq!(of(0..2), Some(Vec::new()));
        assert_eq!(of(7..9), None);
        assert_eq!(
            spans(&time, 0..6, |row| (row != 3).then_some(true)),
            None,
            "an event that is not always known"
        );
    }
}
