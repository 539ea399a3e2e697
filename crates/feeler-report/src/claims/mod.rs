//! The paper's claims, measured on a run.
//!
//! A claim holds if all its parts hold. A part whose value the recording does not define (a
//! stroke that was not made, too few samples) does not hold, and the claim's text says so.

use super::claim::{Claim, ClaimPart, Relation};
use super::measures::{LaggedCorrelation, distance_between_paths, lagged_correlation};
use super::path_fit::PathFit;
use super::run_data::{RunData, Stroke};
use super::series::{absolute_rate, count_peaks, mean, moving_mean};
use super::stroke_pattern::ALIKE;
use super::strokes::{
    CLOSED_TURN, StrokeMeasures, grasp_force_variation, over_fraction, share, slip_precision,
    slip_skill,
};
use super::thinned::Pressed;
use feeler_record::RunFacts;

/// Strokes that the paper's experiment makes.
const STROKES: u32 = 4;
/// A peak rises above this share of the run's peak…
pub(crate) const PEAK_RISES_ABOVE: f64 = 0.10;
/// …and ends when it falls below this share.
pub(crate) const PEAK_ENDS_BELOW: f64 = 0.05;
/// Length of the moving mean that goes over series before peaks are counted and before torque
/// rate and shear rate are compared, s.
pub const SMOOTHING: f64 = 0.05;
/// Largest lag at which torque rate and shear rate are compared, s.
const MAX_LAG: f64 = 0.05;
/// Share of F2 above which an element might be damaged…
pub const DAMAGE_FORCE: f64 = 1.25;
/// …if it stays there for longer than this, s.
const DAMAGE_TIME: f64 = 0.05;

/// Strokes in which the cap is closed.
const CLOSED: [u32; 2] = [3, 4];
/// Strokes whose measures claims are about.
const MEASURED: [u32; 3] = [1, 3, 4];

/// What several claims are about, measured once.
struct Measured<'a> {
    data: &'a RunData,
    strokes: Vec<MeasuredStroke<'a>>,
}

/// A stroke whose MOVE is over.
struct MeasuredStroke<'a> {
    measures: &'a StrokeMeasures,
    /// Of each finger.
    fits: Vec<Option<PathFit>>,
}

impl<'a> Measured<'a> {
    fn new(data: &'a RunData, measures: &'a [StrokeMeasures]) -> Self {
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

    fn measures(&self, index: u32) -> Option<&StrokeMeasures> {
        Some(self.stroke(index)?.measures)
    }

    fn fit(&self, index: u32, finger: usize) -> Option<PathFit> {
        self.stroke(index)?.fits[finger]
    }

    /// A measure of one stroke against that of another.
    fn compare(
        &self,
        a: u32,
        b: u32,
        measure: impl Fn(&StrokeMeasures) -> Option<f64>,
        comparison: impl Fn(f64, f64) -> Option<f64>,
    ) -> Option<f64> {
        comparison(measure(self.measures(a)?)?, measure(self.measures(b)?)?)
    }

    /// A part of how well every finger's path fits in each of `strokes`; none unless all define it.
    fn each_fit(
        &self,
        strokes: &[u32],
        part: impl Fn(PathFit, usize) -> Option<f64>,
    ) -> Option<Vec<f64>> {
        each_finger(self.data, strokes, |stroke, finger| {
            part(self.fit(stroke.index, finger)?, finger)
        })
    }
}

/// The claims, in the order of the paper, about a run whose strokes measure `strokes`. What needs an instrument that the rig does not have
/// is not measured.
pub fn claims(data: &RunData, strokes: &[StrokeMeasures]) -> Vec<Claim> {
    let measured = Measured::new(data, strokes);
    vec![
        four_peaks(data),
        first_stroke_torque_rises(data),
        closed_after_third(&measured),
        shear_rate_marks_closing(&measured),
        bumps_in_step(data),
        slip_means_slip(data),
        path_follows_contour(&measured),
        path_is_curved(&measured),
        grip_levels_off(data),
        path_saturates(&measured),
        no_damage(data),
    ]
}

fn four_peaks(data: &RunData) -> Claim {
    let window = samples(data, SMOOTHING);
    let peaks = |values: Vec<f64>| {
        let count = count_peaks(
            &moving_mean(&values, window),
            PEAK_RISES_ABOVE,
            PEAK_ENDS_BELOW,
        );
        count.map(|count| count as f64)
    };
    let (grasp_force, torque) = match &data.thinned {
        Some(thinned) => {
            let count = |peaks: Option<usize>| peaks.map(|count| count as f64);
            (
                count(thinned.grasp_force_peaks),
                count(thinned.torque_peaks),
            )
        }
        None => {
            let rows = 0..data.time.len();
            let grasp_force = peaks(rows.map(|row| data.grasp_force(row)).collect());
            (grasp_force, torque_over_strokes(data).and_then(peaks))
        }
    };
    let bound = f64::from(STROKES);
    Claim::new(
        "four-peaks",
        "Grasp force and torque each show four peaks.",
        vec![
            ClaimPart::new("peaks of grasp force", grasp_force, Relation::Equals, bound),
            ClaimPart::new("peaks of torque", torque, Relation::Equals, bound),
        ],
    )
}

/// Torque from the torque sensor's first sample on, N·m; none unless that comes before the first MOVE, and with it before
/// the first peak.
fn torque_over_strokes(data: &RunData) -> Option<Vec<f64>> {
    let torque = data.torque.as_ref()?;
    let first = torque.iter().position(|torque| torque.is_finite())?;
    let mut moves = data.strokes.iter().filter(|s| !s.moving.is_empty());
    let in_time = moves.next().is_none_or(|s| first <= s.moving.start);
    in_time.then(|| torque[first..].to_vec())
}

fn first_stroke_torque_rises(data: &RunData) -> Claim {
    let thirds = data.whole_stroke(1).map(|stroke| {
        let moving = stroke.moving.clone();
        let third = moving.len() / 3;
        (
            moving.start..moving.start + third,
            moving.end - third..moving.end,
        )
    });
    let first_and_last = |value: &dyn Fn(usize) -> f64| {
        let (first, last) = thirds.clone()?;
        Some((mean(first.map(value))?, mean(last.map(value))?))
    };
    let torque = data.torque.as_ref();
    let torque = torque.and_then(|torque| first_and_last(&|row| torque[row]));
    let torque = torque.and_then(|(a, b)| ratio(b, a));
    let grasp_force = first_and_last(&|row| data.grasp_force(row)).and_then(|(a, b)| change(a, b));
    Claim::new(
        "first-stroke-torque-rises",
        "In stroke 1 torque rises while grasp force stays level.",
        vec![
            ClaimPart::new(
                "torque, last third of MOVE to first third",
                torque,
                Relation::AtLeast,
                2.0,
            ),
            ClaimPart::new(
                "change of mean grasp force from first third to last",
                grasp_force,
                Relation::Within,
                0.30,
            ),
        ],
    )
}

fn closed_after_third(measured: &Measured) -> Claim {
    let peak_torque = measured.compare(3, 4, |m| m.peak_torque, change);
    let peak_grasp = measured.compare(3, 4, |m| m.peak_grasp_force, change);
    let cap_turn = measured.compare(1, 4, |m| m.cap_turn, |first, fourth| ratio(fourth, first));
    Claim::new(
        "closed-after-third",
        "Strokes 3 and 4 are alike: the cap is closed after the third.",
        vec![
            ClaimPart::new(
                "change of peak torque from stroke 3 to 4",
                peak_torque,
                Relation::Within,
                ALIKE,
            ),
            ClaimPart::new(
                "change of peak grasp force from stroke 3 to 4",
                peak_grasp,
                Relation::Within,
                ALIKE,
            ),
            ClaimPart::new(
                "cap turn, stroke 4 to stroke 1",
                cap_turn,
                Relation::AtMost,
                CLOSED_TURN,
            ),
        ],
    )
}

fn shear_rate_marks_closing(measured: &Measured) -> Claim {
    let marked = measured.compare(1, 4, |m| m.peak_shear_rate, |a, b| ratio(b, a));
    Claim::new(
        "shear-rate-marks-closing",
        "The shear rate is marked in stroke 4, not in stroke 1.",
        vec![ClaimPart::new(
            "99th percentile of the largest element's shear rate over MOVE, stroke 4 to stroke 1",
            marked,
            Relation::AtLeast,
            2.0,
        )],
    )
}

fn bumps_in_step(data: &RunData) -> Claim {
    let stretches: Option<Vec<_>> = [3, 4]
        .map(|index| rates(data, data.whole_stroke(index)?))
        .into_iter()
        .collect();
    let max_lag = (MAX_LAG / data.facts.control_period).round() as usize;
    let best: Option<LaggedCorrelation> =
        stretches.and_then(|stretches| lagged_correlation(&stretches, max_lag));
    let lag = best.map(|best| f64::from(best.lag) * data.facts.control_period);
    Claim::new(
        "bumps-in-step",
        "Bumps of shear rate and of torque are in step (MOVE of strokes 3 and 4).",
        vec![
            ClaimPart::new(
                "correlation of |d torque/dt| with the shear rate",
                best.map(|best| best.correlation),
                Relation::AtLeast,
                0.4,
            ),
            ClaimPart::new("lag of torque", lag, Relation::Within, MAX_LAG).in_unit("s"),
        ],
    )
}

/// Shear rate and absolute torque rate over MOVE, treated alike: each is the absolute difference
/// of one control step to the next (the shear rate is so by its definition), then goes through
/// the same centred moving mean of [`SMOOTHING`], which takes out the noise of the A/D converter
/// that a difference brings up. The torque sensor's own delay is left to the lag. None without a torque sensor.
pub fn rates(data: &RunData, stroke: &Stroke) -> Option<(Vec<f64>, Vec<f64>)> {
    let first = stroke.moving.start.max(1);
    let rows = first..stroke.moving.end.max(first);
    let window = samples(data, SMOOTHING);
    let shear: Vec<f64> = rows.clone().map(|row| data.shear_rate(row)).collect();
    let torque = data.torque.as_ref()?.get(first - 1..rows.end)?;
    let torque = absolute_rate(torque, data.facts.control_period);
    Some((moving_mean(&shear, window), moving_mean(&torque, window)))
}

/// SLIP against what the simulator knows: raised where a feeler slips, and not all the time.
fn slip_means_slip(data: &RunData) -> Claim {
    let precision = each_finger(data, &CLOSED, |stroke, finger| {
        slip_precision(&data.fingers[finger], stroke)
    });
    // Where feelers slip most of the time, a flag that is always up is right most of the time.
    let skill = each_finger(data, &CLOSED, |stroke, finger| {
        slip_skill(&data.fingers[finger], stroke)
    });
    let raised = each_finger(data, &CLOSED, |stroke, finger| {
        share(
            stroke
                .moving
                .clone()
                .map(|row| data.fingers[finger].slip[row]),
        )
    });
    Claim::new(
        "slip-means-slip",
        "SLIP is raised where a feeler slips (MOVE of strokes 3 and 4; each finger).",
        vec![
            ClaimPart::new(
                "least precision of SLIP against the true slip",
                least(&precision),
                Relation::AtLeast,
                0.9,
            ),
            ClaimPart::new(
                "least gain in precision over a flag raised at random, of what there is to gain",
                least(&skill),
                Relation::AtLeast,
                0.5,
            ),
            ClaimPart::new(
                "least share of MOVE with SLIP",
                least(&raised),
                Relation::AtLeast,
                0.10,
            ),
            ClaimPart::new(
                "greatest share of MOVE with SLIP",
                greatest(&raised),
                Relation::AtMost,
                0.60,
            ),
        ],
    )
}

/// The distance R of the dome's centre from the cap's axis stays the same: against what it would have done on the planned
/// line, and against stroke 1, where the cap turns along. See [`PathFit`].
fn path_follows_contour(measured: &Measured) -> Claim {
    let to_line = measured.each_fit(&CLOSED, |fit, _| ratio(fit.radius_std, fit.line_radius_std));
    let to_first = measured.each_fit(&CLOSED, |fit, finger| {
        ratio(fit.radius_std, measured.fit(1, finger)?.radius_std)
    });
    Claim::new(
        "path-follows-contour",
        "Once closed, the fingertips go round the cap's axis at a constant distance R (strokes 3 and 4; each finger).",
        vec![
            ClaimPart::new(
                "greatest std of R relative to the planned line's",
                greatest(&to_line),
                Relation::AtMost,
                0.35,
            ),
            ClaimPart::new(
                "greatest std of R relative to stroke 1's",
                greatest(&to_first),
                Relation::AtMost,
                0.5,
            ),
        ],
    )
}

/// The path bends as the arc about the cap's axis does, which no straight line does, however tilted. See
/// [`PathFit::curvature`].
fn path_is_curved(measured: &Measured) -> Claim {
    let curvature = |strokes: &[u32]| measured.each_fit(strokes, |fit, _| Some(fit.curvature));
    let (closed, first) = (curvature(&CLOSED), curvature(&[1]));
    Claim::new(
        "path-is-curved",
        "The straight segment becomes a curve that fits the cap (each finger).",
        vec![
            ClaimPart::new(
                "least curvature relative to the arc's, strokes 3 and 4",
                least(&closed),
                Relation::AtLeast,
                0.5,
            ),
            ClaimPart::new(
                "greatest curvature relative to the arc's, strokes 3 and 4",
                greatest(&closed),
                Relation::AtMost,
                1.5,
            ),
            ClaimPart::new(
                "greatest curvature relative to the arc's, stroke 1",
                greatest(&first),
                Relation::AtMost,
                0.4,
            ),
        ],
    )
}

/// The grip that slips have built up is limited by OVER, within the window of [`PathFit`].
fn grip_levels_off(data: &RunData) -> Claim {
    let variation = each_finger(data, &CLOSED, |stroke, finger| {
        grasp_force_variation(data, stroke, finger)
    });
    let over = each_finger(data, &CLOSED, |stroke, finger| {
        over_fraction(data, stroke, finger)
    });
    Claim::new(
        "grip-levels-off",
        "Once closed, the grasp force levels off, limited by OVER (strokes 3 and 4; each finger).",
        vec![
            ClaimPart::new(
                "greatest std of the grasp force relative to its mean",
                greatest(&variation),
                Relation::AtMost,
                0.2,
            ),
            ClaimPart::new(
                "least share of the window with OVER",
                least(&over),
                Relation::AtLeast,
                0.03,
            ),
            ClaimPart::new(
                "greatest share of the window with OVER",
                greatest(&over),
                Relation::AtMost,
                0.50,
            ),
        ],
    )
}

fn path_saturates(measured: &Measured) -> Claim {
    let data = measured.data;
    let paths = |index, finger: usize| {
        let stroke = data.whole_stroke(index)?;
        Some(&data.fingers[finger].position[stroke.moving.clone()])
    };
    let distances: Option<Vec<f64>> = (0..data.fingers.len())
        .map(|finger| distance_between_paths(paths(3, finger)?, paths(4, finger)?))
        .collect();
    let distance = distances.and_then(mean);
    let bend = measured.measures(4).and_then(|m| m.path_inward_bend);
    let share = distance.zip(bend).and_then(|(d, bend)| ratio(d, bend));
    Claim::new(
        "path-saturates",
        "The path's modification saturates after closing.",
        vec![ClaimPart::new(
            "RMS distance between the paths of strokes 3 and 4, to stroke 4's bend",
            share,
            Relation::AtMost,
            0.15,
        )],
    )
}

pub(super) fn no_damage(data: &RunData) -> Claim {
    let limit = damage_limit(&data.facts);
    let longest = longest_above(data, limit);
    Claim::new(
        "no-damage",
        "OVER protects the elements.",
        vec![
            ClaimPart::new(
                "longest time of an element above 1.25 F2",
                longest,
                Relation::AtMost,
                DAMAGE_TIME,
            )
            .in_unit("s"),
        ],
    )
}

/// The force (N) above which an element might be damaged.
pub(crate) fn damage_limit(facts: &RunFacts) -> f64 {
    DAMAGE_FORCE * facts.over_force_threshold
}

/// Longest time of an element pressed harder than `limit` (N), s; none where no forces are known.
pub(super) fn longest_above(data: &RunData, limit: f64) -> Option<f64> {
    let longest = match &data.thinned {
        Some(thinned) => thinned.longest_above(limit),
        None => {
            let mut pressed = Pressed::new(limit, data.fingers.len());
            for row in 0..data.time.len() {
                pressed.take_row(data, row);
            }
            pressed.longest()
        }
    };
    longest.map(|rows| rows as f64 * data.facts.control_period)
}

/// A measure of every finger in each of `strokes`; none unless all define it.
fn each_finger(
    data: &RunData,
    strokes: &[u32],
    measure: impl Fn(&Stroke, usize) -> Option<f64>,
) -> Option<Vec<f64>> {
    let fingers = 0..data.fingers.len();
    let pairs = strokes
        .iter()
        .flat_map(|&stroke| fingers.clone().map(move |f| (stroke, f)));
    pairs
        .map(|(stroke, finger)| measure(data.whole_stroke(stroke)?, finger))
        .collect()
}

fn least(values: &Option<Vec<f64>>) -> Option<f64> {
    values.as_ref()?.iter().copied().reduce(f64::min)
}

fn greatest(values: &Option<Vec<f64>>) -> Option<f64> {
    values.as_ref()?.iter().copied().reduce(f64::max)
}

/// `value / reference`; none unless the reference is above 0.
fn ratio(value: f64, reference: f64) -> Option<f64> {
    (reference > 0.0).then(|| value / reference)
}

/// `(to - from) / from`; none unless `from` is above 0.
fn change(from: f64, to: f64) -> Option<f64> {
    ratio(to - from, from)
}

/// The odd number of samples nearest to a time, at least 1.
pub(crate) fn samples(data: &RunData, time: f64) -> usize {
    let samples = (time / data.facts.control_period).round().clamp(1.0, 1e6) as usize;
    samples | 1
}
