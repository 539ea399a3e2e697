//! Converts recordings of any length to columns in bounded memory, from a file or while recording.
//!
//! The recording is processed in parts; aligned messages are released. A run of ordinary length keeps all of its rows,
//! exactly as [`RunData::new`] returns them. In a longer run, each stroke is measured from all of its rows when it
//! ends, and quantities of the whole run that claims need are accumulated row by row. Then rows are decimated: all rows
//! of the strokes that the paper's claims refer to are kept. Of the rest, each time cell keeps its first and last row
//! and the rows with extreme force, rate and torque (`rows_that_stay`).

mod letting_go;
mod over_all;

use super::data::{RunData, findings};
use super::finger_columns::keep;
use super::stroke::{Stroke, split_strokes};
use super::thinned::DecimatedRun;
use crate::measures::cap::CapEstimates;
use crate::measures::contact::Contact;
use crate::measures::strokes::{FeltStroke, StrokeMeasures};
use feeler_record::{RecordError, Recording, SAME_TIME};
use letting_go::{
    has_many_messages, kept_rows, moved, row_size, rows_of_cells, shifted, thin_messages,
};
use over_all::OverAll;
use std::io::{Read, Seek};
use std::ops::Range;
use std::path::Path;

/// Memory limit of the rows (bytes): about three and a half minutes of two fingers with 41 elements each at 100 Hz.
pub(super) const MEMORY: usize = 48 << 20;
/// Minimum and maximum number of rows kept before decimation.
const ROWS: (usize, usize) = (1_000, 30_000);
/// Maximum delay of a message in the file relative to other messages of the same time (s).
const LATE: f64 = 5.0;
/// Number of strokes that the paper's claims and figures refer to.
const CLAIMED: u32 = 4;

/// Reads the recording at `path` and converts it to columns. `progress` receives the fraction of the file that has been
/// read (0 to 1). The returned recording contains only its facts, its end, its latest messages and its findings.
///
/// # Errors
/// Same as [`Recording::read`].
pub fn read(
    path: impl AsRef<Path>,
    progress: &mut dyn FnMut(f64),
) -> Result<(Recording, RunData), RecordError> {
    read_within(path, MEMORY, progress)
}

/// Like [`read`], but with a memory limit for the rows (bytes). At least 1,000 rows are kept.
///
/// # Errors
/// Same as [`read`].
pub fn read_within(
    path: impl AsRef<Path>,
    memory: usize,
    progress: &mut dyn FnMut(f64),
) -> Result<(Recording, RunData), RecordError> {
    convert(memory, progress, |part| {
        Recording::read_in_parts(path, part)
    })
}

/// Like [`read`], from an open `file` of `length` bytes, which errors call `path`.
///
/// # Errors
/// Same as [`Recording::read_from`].
pub fn read_from(
    file: &mut (impl Read + Seek),
    length: u64,
    path: &Path,
    progress: &mut dyn FnMut(f64),
) -> Result<(Recording, RunData), RecordError> {
    convert(MEMORY, progress, |part| {
        Recording::read_from(file, length, path, part)
    })
}

/// Converts the parts of a recording while `read_parts` reads them.
fn convert(
    memory: usize,
    progress: &mut dyn FnMut(f64),
    read_parts: impl FnOnce(&mut dyn FnMut(&mut Recording, f64)) -> Result<Recording, RecordError>,
) -> Result<(Recording, RunData), RecordError> {
    let mut run = None;
    let mut recording = read_parts(&mut |recording, share| {
        let run = run.get_or_insert_with(|| LongRun::new(recording, memory));
        run.take(recording, recording.readable_until - LATE);
        progress(share);
    })?;
    let run = run.unwrap_or_else(|| LongRun::new(&recording, memory));
    let data = run.finish(&mut recording);
    Ok((recording, data))
}

/// Converts a run to columns and measures in bounded memory, while the run is read or recorded.
pub(super) struct LongRun {
    /// Retained rows.
    data: RunData,
    /// For each retained row: its index among all rows.
    places: Vec<usize>,
    /// For each retained row: the number of its stroke.
    numbers: Vec<u32>,
    /// Number of rows so far.
    count: usize,
    /// Memory limit of the rows (bytes).
    memory: usize,
    /// Number of rows that the memory limit allows at the current row size.
    most: usize,
    /// Length of a time cell (s); `None` while all rows are kept.
    cell: Option<f64>,
    /// Number of control steps at the start of the recording that have been converted to rows.
    aligned: usize,
    /// Completed strokes; their row ranges count all rows, not only retained ones.
    strokes: Vec<Stroke>,
    /// Index of the first retained row after the completed strokes.
    open: usize,
    /// `true` if rows at or after `open` have been removed.
    open_is_thinned: bool,
    measures: Vec<StrokeMeasures>,
    felt: Vec<FeltStroke>,
    too_long: Vec<u32>,
    over_all: OverAll,
    /// Number of retained rows already included in `over_all`: those before the latest removal.
    measured: usize,
    contact: Contact,
}

impl LongRun {
    pub(super) fn new(recording: &Recording, memory: usize) -> Self {
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

    /// Converts all messages up to `until` (s), which must be complete, and releases them.
    pub(super) fn take(&mut self, recording: &mut Recording, until: f64) {
        let tasks = recording.task.iter();
        let known = tasks
            .take_while(|task| task.stamp <= until + SAME_TIME)
            .count();
        if known > self.aligned {
            self.align(recording, known);
        }
        self.contact.take(recording, until);
        recording.discard_until(until);
        // The last converted step is still in the recording.
        self.aligned = known.min(1);
        if has_many_messages(recording) {
            self.close_strokes(recording);
            let open = self.data.time.get(self.open);
            thin_messages(recording, open.copied().unwrap_or(until));
        }
    }

    /// Appends rows for the control steps before `end` that have not been converted yet.
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

    /// Measures the completed strokes: those followed by further rows.
    fn close_strokes(&mut self, recording: &Recording) {
        let open = self.open;
        let count = self.numbers.len();
        for stroke in split_strokes(&self.numbers[open..], &self.data.phase[open..]) {
            let stroke = moved(&stroke, |rows| shifted(rows, open));
            if stroke.rows.end == count {
                // The last stroke may continue.
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
            let felt = CapEstimates::new(recording);
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

    /// Removes rows. Strokes that claims refer to may keep a quarter of the limit, the open stroke an eighth, all other
    /// rows half.
    fn thin(&mut self) {
        self.take_over_all();
        let pinned = self.pinned();
        let (strokes, most) = (self.strokes.len(), self.most / 2);
        let (stay, cell) = rows_of_cells(&self.data, &pinned, strokes, most, self.cell);
        self.cell = Some(cell);
        self.open = stay.partition_point(|&row| row < self.open);
        self.data.keep(&stay);
        keep(&mut self.places, &stay);
        keep(&mut self.numbers, &stay);
        self.measured = self.numbers.len();
    }

    /// Accumulates the quantities of the whole run over rows that are not included yet.
    fn take_over_all(&mut self) {
        let rows = self.measured..self.data.time.len();
        let place = self.count - rows.len();
        self.over_all.take(&self.data, rows, place);
    }

    /// Rows that must be kept: those of the strokes that claims refer to, with the row before each, and those of the
    /// open stroke.
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

    pub(super) fn finish(mut self, recording: &mut Recording) -> RunData {
        self.align(recording, recording.task.len());
        self.contact.take(recording, f64::INFINITY);
        self.data.findings = findings(recording);
        self.data.longest_loss = self.contact.longest_loss();
        if self.cell.is_none() {
            self.data.strokes = split_strokes(&self.numbers, &self.data.phase);
            return self.data;
        }
        // At the end of the run, the last stroke counts as completed.
        let open = self.open;
        for stroke in split_strokes(&self.numbers[open..], &self.data.phase[open..]) {
            self.close(recording, &moved(&stroke, |rows| shifted(rows, open)));
        }
        self.open = self.numbers.len();
        self.open_is_thinned = false;
        self.thin();
        self.thinned()
    }

    /// Retained rows, with the measures of all rows.
    fn thinned(mut self) -> RunData {
        let places = &self.places;
        let strokes = self.strokes.iter();
        let strokes = strokes.map(|stroke| {
            let kept = moved(stroke, |rows| kept_rows(places, rows));
            // A stroke is whole only if all of its rows are retained.
            let whole = stroke.whole && kept.rows.len() == stroke.rows.len();
            Stroke { whole, ..kept }
        });
        self.data.strokes = strokes.collect();
        let mut moves = self.strokes.iter().filter(|s| !s.moving.is_empty());
        let first_move = moves.next().map(|stroke| stroke.moving.start);
        let [grasp_force_peaks, torque_peaks] = self.over_all.peaks(first_move);
        self.data.thinned = Some(Box::new(DecimatedRun {
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
