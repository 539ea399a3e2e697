//! A recording of any length as columns, in memory that has a bound: read from its file, or made while it is recorded.
//!
//! It is taken part by part, and what is aligned is let go of. A run of ordinary length has all its rows in the
//! end, as [`RunData::new`] would give them. Of a longer one, every stroke is measured from all of its rows when it is
//! over; claims about the whole run are measured row by row as they come. Then rows are let go of: all are kept of the strokes that
//! the paper's claims are about; of the rest, cells of time keep their first and last row and those where
//! forces, rates and torque are least and greatest (`rows_that_stay`).

mod letting_go;
mod over_all;
mod recorder;

pub use recorder::RunRecorder;

use super::cap::{Felt, FeltStroke};
use super::contact::Contact;
use super::run_data::{RunData, Stroke, findings, keep, split_strokes};
use super::strokes::StrokeMeasures;
use super::thinned::Thinned;
use feeler_record::{RecordError, Recording, SAME_TIME};
use letting_go::{
    has_many_messages, kept_rows, moved, row_size, rows_of_cells, shifted, thin_messages,
};
use over_all::OverAll;
use std::ops::Range;
use std::path::Path;

/// Memory that rows may take, bytes: about three and a half minutes of two fingers of 41 elements at 100 Hz.
const MEMORY: usize = 48 << 20;
/// Fewest and most rows that are kept before some are let go of.
const ROWS: (usize, usize) = (1_000, 30_000);
/// A message may stand so much later in the file than those of its time, s.
const LATE: f64 = 5.0;
/// Strokes that the paper's claims and figures are about.
const CLAIMED: u32 = 4;

/// Reads the recording at `path` and its columns. `progress` is told the share of the file that was read, 0 to 1. What
/// the recording returned still holds is its facts, its end, its newest messages, and what was found out.
///
/// # Errors
/// As of [`Recording::read`].
pub fn read(
    path: impl AsRef<Path>,
    progress: &mut dyn FnMut(f64),
) -> Result<(Recording, RunData), RecordError> {
    read_within(path, MEMORY, progress)
}

/// The same with rows that may take so much memory, bytes, as far as there may be so few.
///
/// # Errors
/// As of [`read`].
pub fn read_within(
    path: impl AsRef<Path>,
    memory: usize,
    progress: &mut dyn FnMut(f64),
) -> Result<(Recording, RunData), RecordError> {
    let mut run = None;
    let mut recording = Recording::read_in_parts(path, &mut |recording, share| {
        let run = run.get_or_insert_with(|| LongRun::new(recording, memory));
        run.take(recording, recording.readable_until - LATE);
        progress(share);
    })?;
    let run = run.unwrap_or_else(|| LongRun::new(&recording, memory));
    let data = run.finish(&mut recording);
    Ok((recording, data))
}

/// A run on its way.
struct LongRun {
    /// The rows that are kept.
    data: RunData,
    /// Which of all rows each is, and the number of its stroke.
    places: Vec<usize>,
    numbers: Vec<u32>,
    /// Rows so far.
    count: usize,
    /// Memory that rows may take, bytes, and how many that are of those that come now.
    memory: usize,
    most: usize,
    /// Length of a cell, s; none while all rows are kept.
    cell: Option<f64>,
    /// Control steps at the recording's beginning that are rows already.
    aligned: usize,
    /// The strokes that are over, in rows of all.
    strokes: Vec<Stroke>,
    /// The first row that is kept and of no stroke that is over.
    open: usize,
    /// Whether rows from there on were let go of.
    open_is_thinned: bool,
    measures: Vec<StrokeMeasures>,
    felt: Vec<FeltStroke>,
    too_long: Vec<u32>,
    over_all: OverAll,
    /// Rows that `over_all` has of those that are kept: all that are older than the newest that were let go of.
    measured: usize,
    contact: Contact,
}

impl LongRun {
    fn new(recording: &Recording, memory: usize) -> Self {
        let data = RunData::empty(recording);
        Self {
            memory,
            most: ROWS.1,
            over_all: OverAll::new(&data),
            measured: 0,
            data,
            places: Vec::new(),
            numbers: Vec::new(),
            count: 0,
            cell: None,
            aligned: 0,
            strokes: Vec::new(),
            open: 0,
            open_is_thinned: false,
            measures: Vec::new(),
            felt: Vec::new(),
            too_long: Vec::new(),
            contact: Contact::default(),
        }
    }

    /// Takes what is there of the time up to `until`, s, of which no more comes, and lets go of it.
    fn take(&mut self, recording: &mut Recording, until: f64) {
        let tasks = recording.task.iter();
        let known = tasks
            .take_while(|task| task.stamp <= until + SAME_TIME)
            .count();
        if known > self.aligned {
            self.align(recording, known);
        }
        self.contact.take(recording, until);
        recording.forget_until(until);
        // The newest of those that are rows stays.
        self.aligned = known.min(1);
        if has_many_messages(recording) {
            self.close_strokes(recording);
            let open = self.data.time.get(self.open);
            thin_messages(recording, open.copied().unwrap_or(until));
        }
    }

    /// Makes rows of the control steps before `end` that are none yet.
    fn align(&mut self, recording: &Recording, end: usize) {
        let before = self.data.time.len();
        let steps = self.aligned..end;
        self.data.append(recording, steps, &mut self.numbers);
        let rows = self.data.time.len() - before;
        self.places.extend((self.count..).take(rows));
        self.count += rows;
        self.most = (self.memory / row_size(&self.data)).clamp(ROWS.0, ROWS.1);
        if self.data.time.len() > self.most {
            self.close_strokes(recording);
            self.thin();
        }
    }

    /// Measures the strokes that are over: after whose last row others have come.
    fn close_strokes(&mut self, recording: &Recording) {
        let open = self.open;
        let count = self.numbers.len();
        for stroke in split_strokes(&self.numbers[open..], &self.data.phase[open..]) {
            let stroke = moved(&stroke, |rows| shifted(rows, open));
            if stroke.rows.end == count {
                // It may go on.
                self.open_is_thinned &= self.open == stroke.rows.start;
                self.open = stroke.rows.start;
                return;
            }
            self.close(recording, &stroke);
        }
        self.open = count;
        self.open_is_thinned = false;
    }

    fn close(&mut self, recording: &Recording, stroke: &Stroke) {
        let measures = StrokeMeasures::new(&self.data, stroke);
        let is_thinned = self.open_is_thinned && stroke.rows.start == self.open;
        self.measures.push(match is_thinned {
            true => measures.of_extremes(),
            false => measures,
        });
        self.too_long.extend(is_thinned.then_some(stroke.index));
        if !stroke.moving.is_empty() {
            let felt = Felt::new(recording);
            (self.felt).push(FeltStroke::new(&felt, &self.data, stroke));
        }
        let places = &self.places;
        let of_all = |rows: &Range<usize>| match rows.clone().next_back() {
            Some(last) => places[rows.start]..places[last] + 1,
            None => places[rows.start]..places[rows.start],
        };
        self.strokes.push(Stroke {
            whole: stroke.whole && !is_thinned,
            ..moved(stroke, of_all)
        });
    }

    /// Lets go of rows: of those that claims are about a quarter of what there is room for may stay, of the stroke that
    /// is not measured yet an eighth, of the rest a half.
    fn thin(&mut self) {
        self.take_over_all();
        let pinned = self.pinned();
        let most = (self.strokes.len(), self.most / 2);
        let (stay, cell) = rows_of_cells(&self.data, &pinned, most, self.cell);
        self.cell = Some(cell);
        self.open = stay.partition_point(|&row| row < self.open);
        self.data.keep(&stay);
        keep(&mut self.places, &stay);
        keep(&mut self.numbers, &stay);
        self.measured = self.numbers.len();
    }

    /// Measures what is measured of all rows of those that were not yet.
    fn take_over_all(&mut self) {
        let rows = self.measured..self.data.time.len();
        let place = self.count - rows.len();
        self.over_all.take(&self.data, rows, place);
    }

    /// Rows that stay: those of the strokes that claims are about, with the row before each, and of the stroke that is
    /// not measured yet.
    fn pinned(&mut self) -> Vec<Range<usize>> {
        let mut pinned = Vec::new();
        let mut room = self.most / 4;
        for stroke in self.strokes.iter_mut().filter(|s| s.index <= CLAIMED) {
            let rows = kept_rows(&self.places, &stroke.rows);
            stroke.whole &= rows.len() == stroke.rows.len() && rows.len() <= room;
            if stroke.whole {
                room -= rows.len();
                pinned.push(rows.start.saturating_sub(1)..rows.end);
            }
        }
        let open = self.open..self.data.time.len();
        self.open_is_thinned |= open.len() > self.most / 8;
        if !self.open_is_thinned {
            pinned.push(open);
        }
        pinned
    }

    fn finish(mut self, recording: &mut Recording) -> RunData {
        self.align(recording, recording.task.len());
        self.contact.take(recording, f64::INFINITY);
        self.data.findings = findings(recording);
        self.data.longest_loss = self.contact.longest_loss();
        if self.cell.is_none() {
            self.data.strokes = split_strokes(&self.numbers, &self.data.phase);
            return self.data;
        }
        // The last stroke is over, whatever would have come.
        let open = self.open;
        for stroke in split_strokes(&self.numbers[open..], &self.data.phase[open..]) {
            self.close(recording, &moved(&stroke, |rows| shifted(rows, open)));
        }
        self.open = self.numbers.len();
        self.open_is_thinned = false;
        self.thin();
        self.thinned()
    }

    /// The rows that are kept, with what was measured of all.
    fn thinned(mut self) -> RunData {
        let places = &self.places;
        let strokes = self.strokes.iter();
        let strokes = strokes.map(|stroke| {
            let kept = moved(stroke, |rows| kept_rows(places, rows));
            // Whoever asks for a whole stroke goes through all of its rows.
            let whole = stroke.whole && kept.rows.len() == stroke.rows.len();
            Stroke { whole, ..kept }
        });
        self.data.strokes = strokes.collect();
        let mut moves = self.strokes.iter().filter(|s| !s.moving.is_empty());
        let first_move = moves.next().map(|stroke| stroke.moving.start);
        let [grasp_force_peaks, torque_peaks] = self.over_all.peaks(first_move);
        self.data.thinned = Some(Box::new(Thinned {
            rows: self.count,
            strokes: self.measures,
            felt: self.felt,
            too_long: self.too_long,
            grasp_force_peaks,
            torque_peaks,
            pressed: self.over_all.pressed,
        }));
        self.data
    }
}
