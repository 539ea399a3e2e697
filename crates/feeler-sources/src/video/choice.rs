//! Chooses among the formats and sizes of a camera. Independent of hardware.

use super::coding::Coding;
use super::list::VideoFormat;
use crate::fit::{Fit, FitError};
use std::cmp::Ordering;

/// A format and size of a camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    pub(super) coding: Coding,
    /// Width and height, px.
    pub(super) size: (usize, usize),
    /// Highest frame rate, Hz, if the driver reports it.
    pub(super) rate: Option<f64>,
}

/// Formats and sizes in a camera's list that can be decoded. A range of sizes is represented by its largest size.
pub(super) fn candidates(formats: &[VideoFormat]) -> Vec<Candidate> {
    let mut candidates = Vec::new();
    for coding in Coding::ALL {
        let fourcc = coding.pixels().as_fourcc();
        for format in formats.iter().filter(|f| f.fourcc.as_bytes() == fourcc) {
            candidates.extend(format.sizes.iter().map(|size| Candidate {
                coding,
                size: (size.columns[1] as usize, size.rows[1] as usize),
                rate: size.rates.last().copied(),
            }));
        }
    }
    candidates
}

/// Chooses the candidate from which images of the `wanted` size are made: one that reaches `rate` (Hz), or else the
/// fastest; among these the smallest; among these the first.
///
/// # Errors
/// If no candidate fits: the error of the last one, or `None` if there are no candidates.
pub(super) fn choose(
    candidates: &[Candidate],
    wanted: (usize, usize),
    rate: f64,
) -> Result<(Candidate, Fit), Option<FitError>> {
    let reached = |candidate: &Candidate| candidate.rate.unwrap_or(rate).min(rate);
    let mut best: Option<(Candidate, Fit)> = None;
    let mut why = None;
    for candidate in candidates {
        let fit = match Fit::new(candidate.size, wanted) {
            Ok(fit) => fit,
            Err(error) => {
                why = Some(error);
                continue;
            }
        };
        let is_better = best.is_none_or(|(best, _)| {
            let area = |(columns, rows): (usize, usize)| columns.saturating_mul(rows);
            let faster = reached(candidate).total_cmp(&reached(&best));
            let smaller = area(best.size).cmp(&area(candidate.size));
            faster.then(smaller) == Ordering::Greater
        });
        if is_better {
            best = Some((*candidate, fit));
        }
    }
    best.ok_or(why)
}

#[cfg(test)]
mod tests {
    use super::super::list::VideoSize;
    use super::*;

    fn format(fourcc: &str, sizes: &[(u32, u32, f64)]) -> VideoFormat {
        let size = |&(columns, rows, rate): &(u32, u32, f64)| VideoSize {
            columns: [columns; 2],
            rows: [rows; 2],
            rates: vec![rate / 2.0, rate],
        };
        VideoFormat {
            fourcc: fourcc.into(),
            description: String::new(),
            sizes: sizes.iter().map(size).collect(),
        }
    }

    fn chosen(
        formats: &[VideoFormat],
        wanted: (usize, usize),
        rate: f64,
    ) -> (Coding, (usize, usize)) {
        let (candidate, fit) = choose(&candidates(formats), wanted, rate).expect("a choice");
        assert_eq!((fit.offered(), fit.wanted()), (candidate.size, wanted));
        (candidate.coding, candidate.size)
    }

    #[test]
    fn a_gelsight_mini_has_one_format() {
        let mini = [format("MJPG", &[(3280, 2464, 25.0)])];
        for wanted in [(320, 240), (640, 480), (3280, 2464)] {
            let expected = (Coding::MotionJpeg, (3280, 2464));
            assert_eq!(chosen(&mini, wanted, 60.0), expected);
        }
        let all = candidates(&mini);
        let error = choose(&all, (640, 360), 25.0).expect_err("another shape");
        assert!(error.expect("why").to_string().contains("of their rows"));
        let unknown = candidates(&[format("H264", &[(640, 480, 30.0)])]);
        assert_eq!(choose(&unknown, (640, 480), 30.0), Err(None));
    }

    #[test]
    fn rate_precedes_size_and_size_precedes_format() {
        let webcam = [
            format(
                "MJPG",
                &[(1280, 960, 30.0), (800, 600, 30.0), (1280, 720, 60.0)],
            ),
            format("YUYV", &[(1280, 960, 5.0), (800, 600, 20.0)]),
        ];
        let wanted = (640, 480);
        assert_eq!(
            chosen(&webcam, wanted, 30.0),
            (Coding::MotionJpeg, (800, 600))
        );
        assert_eq!(chosen(&webcam, wanted, 20.0), (Coding::Yuyv, (800, 600)));
        assert_eq!(chosen(&webcam, wanted, 5.0), (Coding::Yuyv, (800, 600)));
        // No candidate reaches the rate: the fastest of the same shape is chosen.
        assert_eq!(
            chosen(&webcam, wanted, 90.0),
            (Coding::MotionJpeg, (800, 600))
        );
        assert_eq!(
            chosen(&webcam, (640, 360), 60.0),
            (Coding::MotionJpeg, (1280, 720))
        );
    }
}
