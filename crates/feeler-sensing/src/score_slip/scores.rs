//! `scores.csv`: the score and verdict of each detector for each recording or frame.

use feeler_lab::grasps::{DETECTORS, Detector, SlipEvent, Verdict};

/// File name of the table.
pub const SCORES: &str = "scores.csv";

/// A recording or one of its frames, with its label and the detectors' scores.
pub struct Scored {
    pub recording: String,
    pub frame: Option<usize>,
    pub group: usize,
    pub slip: bool,
    /// Scores in the order of [`DETECTORS`].
    pub scores: [Option<f64>; DETECTORS.len()],
    /// Noise of its recording, in the unit of the vectors.
    pub own_noise: Option<f64>,
    /// Verdicts with thresholds chosen on the other groups.
    pub verdicts: [Option<Verdict>; DETECTORS.len()],
    /// Verdicts with thresholds chosen only on the recordings of `--thresholds-from`.
    pub verdicts_by_others: [Option<Verdict>; DETECTORS.len()],
    /// Slip of a whole recording, if its onset is known.
    pub event: Option<SlipEvent>,
    /// Time of each detector's alarm for this slip (s), in the order of [`DETECTORS`].
    pub alarms: [Option<f64>; DETECTORS.len()],
}

/// Writes the table, one row per recording (or frame) and detector. If `by_others`, includes the verdicts of
/// `--thresholds-from`. Includes times of slips if any are known.
pub fn scores_csv(scored: &[Scored], of_frames: bool, by_others: bool) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let header = [
        "recording",
        "frame",
        "group",
        "slip",
        "detector",
        "score",
        "threshold",
        "says_slip",
        "other_threshold",
        "says_slip_by_other",
        "onset",
        "loss",
        "alarm",
    ];
    let has_onsets = scored.iter().any(|one| one.event.is_some());
    let used = |column: &usize| match column {
        1 => of_frames,
        8 | 9 => by_others,
        10.. => has_onsets,
        _ => true,
    };
    let mut write = |row: [String; 13]| {
        let cells = row.iter().enumerate().filter(|(column, _)| used(column));
        // Writing to memory cannot fail.
        let _ = writer.write_record(cells.map(|(_, cell)| cell));
    };
    write(header.map(String::from));
    let applicable = applicable_detectors(scored);
    for one in scored {
        for &(index, detector) in &applicable {
            let number = |number: Option<f64>| number.map_or(String::new(), |n| n.to_string());
            let threshold = |verdict: Option<Verdict>| number(verdict.map(|v| v.threshold));
            let says = |verdict: Option<Verdict>| {
                verdict.map_or(String::new(), |v| u8::from(v.says_slip).to_string())
            };
            let (verdict, by_others) = (one.verdicts[index], one.verdicts_by_others[index]);
            write([
                one.recording.clone(),
                one.frame.map_or(String::new(), |frame| frame.to_string()),
                one.group.to_string(),
                u8::from(one.slip).to_string(),
                detector.key().into(),
                number(one.scores[index]),
                threshold(verdict),
                says(verdict),
                threshold(by_others),
                says(by_others),
                number(one.event.map(|event| event.onset)),
                number(one.event.and_then(|event| event.loss)),
                number(one.alarms[index]),
            ]);
        }
    }
    let bytes = writer.into_inner().unwrap_or_default();
    String::from_utf8_lossy(&bytes).into_owned()
}

/// Returns the detectors with their indices in [`DETECTORS`], without image loss if it has no scores.
pub fn applicable_detectors(scored: &[Scored]) -> Vec<(usize, Detector)> {
    let has = |index: usize| scored.iter().any(|one| one.scores[index].is_some());
    let all = DETECTORS.into_iter().enumerate();
    let applicable = all.filter(|&(index, detector)| detector != Detector::ImageLoss || has(index));
    applicable.collect()
}
