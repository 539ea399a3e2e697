//! Measures that several claims share, and comparisons between them.

use crate::measures::path_fit::PathFit;
use crate::measures::strokes::StrokeMeasures;
use crate::run::data::RunData;
use crate::run::stroke::Stroke;

/// Strokes in which the cap is closed.
pub(super) const CLOSED: [u32; 2] = [3, 4];
/// Strokes that claims refer to.
const MEASURED: [u32; 3] = [1, 3, 4];

/// Measures of the strokes that claims refer to.
pub(super) struct Measured<'a> {
    pub data: &'a RunData,
    strokes: Vec<MeasuredStroke<'a>>,
}

/// A stroke with a complete MOVE.
pub(super) struct MeasuredStroke<'a> {
    measures: &'a StrokeMeasures,
    /// Path fit of each finger.
    fits: Vec<Option<PathFit>>,
}

impl<'a> Measured<'a> {
    pub fn new(data: &'a RunData, measures: &'a [StrokeMeasures]) -> Self {
        let whole = MEASURED
            .iter()
            .filter_map(|&index| data.whole_stroke(index));
        let measured = whole.filter_map(|stroke| {
            let place = data.strokes.iter().position(|s| s == stroke)?;
            Some((stroke, measures.get(place)?))
        });
        let strokes = measured.map(|(stroke, measures)| MeasuredStroke {
            measures,
            fits: (0..data.fingers.len())
                .map(|finger| PathFit::new(data, stroke, finger))
                .collect(),
        });
        Self {
            data,
            strokes: strokes.collect(),
        }
    }

    fn stroke(&self, index: u32) -> Option<&MeasuredStroke<'a>> {
        let mut strokes = self.strokes.iter();
        strokes.find(|stroke| stroke.measures.index == index)
    }

    pub fn measures(&self, index: u32) -> Option<&StrokeMeasures> {
        Some(self.stroke(index)?.measures)
    }

    pub fn fit(&self, index: u32, finger: usize) -> Option<PathFit> {
        self.stroke(index)?.fits[finger]
    }

    /// Compares a measure between strokes `a` and `b`.
    pub fn compare(
        &self,
        a: u32,
        b: u32,
        measure: impl Fn(&StrokeMeasures) -> Option<f64>,
        comparison: impl Fn(f64, f64) -> Option<f64>,
    ) -> Option<f64> {
        comparison(measure(self.measures(a)?)?, measure(self.measures(b)?)?)
    }

    /// A property of the path fit of every finger in each of `strokes`; `None` unless all of them define it.
    pub fn each_fit(
        &self,
        strokes: &[u32],
        part: impl Fn(PathFit, usize) -> Option<f64>,
    ) -> Option<Vec<f64>> {
        each_finger(self.data, strokes, |_, stroke, finger| {
            part(self.fit(stroke.index, finger)?, finger)
        })
    }
}

/// A measure of every finger in each of `strokes`; `None` unless all of them define it.
pub(super) fn each_finger(
    data: &RunData,
    strokes: &[u32],
    measure: impl Fn(&RunData, &Stroke, usize) -> Option<f64>,
) -> Option<Vec<f64>> {
    let fingers = 0..data.fingers.len();
    let pairs = strokes
        .iter()
        .flat_map(|&stroke| fingers.clone().map(move |f| (stroke, f)));
    pairs
        .map(|(stroke, finger)| measure(data, data.whole_stroke(stroke)?, finger))
        .collect()
}

pub(super) fn least(values: &Option<Vec<f64>>) -> Option<f64> {
    values.as_ref()?.iter().copied().reduce(f64::min)
}

pub(super) fn greatest(values: &Option<Vec<f64>>) -> Option<f64> {
    values.as_ref()?.iter().copied().reduce(f64::max)
}

/// `value / reference`; `None` unless `reference` is above 0.
pub(super) fn ratio(value: f64, reference: f64) -> Option<f64> {
    (reference > 0.0).then(|| value / reference)
}

/// `(to - from) / from`; `None` unless `from` is above 0.
pub(super) fn change(from: f64, to: f64) -> Option<f64> {
    ratio(to - from, from)
}
