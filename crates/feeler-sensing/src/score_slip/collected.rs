//! Reads labelled recordings and runs the detectors over them.

use super::images::{Sequence, score_images};
use super::in_order::in_order;
use super::labels::{Label, Labels, read_frames};
use super::notes::Notes;
use super::onsets::{slip_in_images, slips_in_labels};
use super::options::RecordedOptions;
use super::scores::Scored;
use super::sources::{Kind, Read, Source, find};
use super::taxels::TaxelTables;
use super::tracks::{TrackTables, is_tracks};
use super::videos::Videos;
use feeler_console::{CommandError, Steps};
use feeler_lab::grasps::{
    ContactReference, DETECTORS, Detector, DetectorTrace, GraspRecording, Labelled, SlipEvent,
};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Reader of all supported kinds of recordings.
struct Reader {
    taxels: Option<TaxelTables>,
    /// `true` if a table may contain tracks even if a taxel layout is given.
    either: bool,
    tracks: TrackTables,
    /// Reader of videos, if there are any.
    videos: Option<Videos>,
}

impl Reader {
    /// Creates a reader for the recordings to be scored, or for `others`, according to `options`.
    fn new(
        options: &RecordedOptions,
        sources: &[Source],
        others: bool,
    ) -> Result<Self, CommandError> {
        let taxels = options.taxels.as_deref();
        let taxels = taxels
            .map(|name| TaxelTables::new(name, options))
            .transpose()?;
        let video = |source: &Source| source.kind() == Kind::Video;
        // Options for the images of the recordings to be scored do not apply to other recordings.
        let plain = RecordedOptions::default();
        let pictures = if others { &plain } else { options };
        let videos = sources.iter().any(video).then(|| Videos::new(pictures));
        Ok(Self {
            taxels,
            either: others,
            tracks: TrackTables::new(pictures),
            videos: videos.transpose()?,
        })
    }

    fn read(&self, source: &Source, notes: &mut Notes) -> Result<Vec<Read>, CommandError> {
        match (source.kind(), &self.videos, &self.taxels) {
            (Kind::Video, Some(videos), _) => videos.read(source, notes),
            (_, _, Some(tables)) if self.is_of_taxels(source) => tables.read(source, notes),
            _ => self.tracks.read(source, notes),
        }
    }

    /// Returns `true` if a recording contains taxels.
    fn is_of_taxels(&self, source: &Source) -> bool {
        let is_table = source.kind() == Kind::Table && self.taxels.is_some();
        is_table && !(self.either && source.tables.iter().all(|table| is_tracks(table)))
    }

    /// Unit of the vectors in the recordings.
    fn unit(&self) -> &'static str {
        let taxels = self.taxels.as_ref();
        taxels.map_or("units of the table", TaxelTables::unit)
    }
}

/// Recordings and labels that have been found but not read yet.
pub struct Found<'a> {
    path: &'a Path,
    sources: Vec<Source>,
    labels: Option<Labels>,
    reader: Reader,
    /// Name of the label table in each recording's folder.
    frame_labels: Option<&'a str>,
    /// `true` if frames are labelled, `false` if whole recordings are.
    pub of_frames: bool,
}

impl<'a> Found<'a> {
    /// Finds the recordings to be scored at `path`, with `labels` or labels of frames.
    ///
    /// # Errors
    /// If there are no recordings, or the labels cannot be read.
    pub fn new(
        path: &'a Path,
        labels: Option<&Path>,
        options: &'a RecordedOptions,
        notes: &mut Notes,
    ) -> Result<Self, CommandError> {
        Self::find(path, labels, options, false, notes)
    }

    /// Finds other recordings at `path`: tables of tracks and videos, read with default options, or tables of the same
    /// taxel layout as the recordings to be scored.
    ///
    /// # Errors
    /// If there are no recordings, or the labels cannot be read.
    pub fn others(
        path: &'a Path,
        labels: &Path,
        options: &'a RecordedOptions,
        notes: &mut Notes,
    ) -> Result<Self, CommandError> {
        Self::find(path, Some(labels), options, true, notes)
    }

    fn find(
        path: &'a Path,
        labels: Option<&Path>,
        options: &'a RecordedOptions,
        others: bool,
        notes: &mut Notes,
    ) -> Result<Self, CommandError> {
        let group = options.group.as_deref().filter(|_| !others);
        let known = labels.map(|labels| Labels::read(labels, group, notes));
        let known = known.transpose()?;
        let no_recordings: Vec<_> = labels.into_iter().collect();
        let sources = match find(path, &options.tables, &no_recordings, notes) {
            Err(_) if others => find(path, &[], &no_recordings, notes)?,
            found => found?,
        };
        let in_folders = sources.iter().any(|source| source.folder.is_some());
        let frame_labels = options.frame_labels.as_deref();
        let frame_labels = frame_labels.filter(|_| !others || in_folders);
        Ok(Self {
            reader: Reader::new(options, &sources, others)?,
            of_frames: frame_labels.is_some() || known.as_ref().is_some_and(|k| k.of_frames),
            labels: known,
            path,
            sources,
            frame_labels,
        })
    }

    /// Returns the paths of all input files.
    pub fn inputs(&self) -> impl Iterator<Item = &Path> {
        let tables = self.sources.iter().flat_map(|source| &source.tables);
        tables.map(PathBuf::as_path)
    }

    /// Unit of the vectors in the recordings.
    pub fn unit(&self) -> &'static str {
        self.reader.unit()
    }

    /// Runs the detectors over all recordings.
    ///
    /// # Errors
    /// If no recording has a label.
    pub fn collect(self, notes: &mut Notes) -> Result<Collected, CommandError> {
        self.collect_with(notes, |_, _, _, _| {})
    }

    /// Like [`collect`](Self::collect). Calls `keep` with the name, group, content and label of each labelled recording.
    ///
    /// # Errors
    /// If no recording has a label.
    pub fn collect_with(
        mut self,
        notes: &mut Notes,
        mut keep: impl FnMut(&str, &str, &GraspRecording, &Label),
    ) -> Result<Collected, CommandError> {
        let mut collected = Collected {
            scored: Vec::new(),
            groups: BTreeMap::new(),
            noise: Vec::new(),
            sequences: Vec::new(),
            in_spacings: true,
            of_taxels: true,
        };
        let bar = Steps::new(self.sources.len());
        let read = |source: &Source| {
            let mut own = Notes::default();
            // Errors are converted to text because they are not `Send`.
            let read = self.reader.read(source, &mut own);
            (read.map_err(|error| error.to_string()), own)
        };
        in_order(&self.sources, read, |source, (read, own)| {
            notes.extend(own);
            match read {
                Ok(recordings) => {
                    collected.of_taxels &= self.reader.is_of_taxels(source);
                    for read in &recordings {
                        let labels = self.labels.as_mut();
                        collected.add(read, source, self.frame_labels, labels, notes, &mut keep)?;
                    }
                }
                Err(error) => notes.add("unreadable", || format!("{error}; recording skipped")),
            }
            bar.advance();
            Ok::<_, CommandError>(())
        })?;
        drop(bar);
        for name in self.labels.iter().flat_map(Labels::unused) {
            notes.add("unused", || {
                format!("{name} is labelled, but there is no such recording")
            });
        }
        if collected.scored.is_empty() {
            return Err(format!("{}: no recording has a label; the names in LABELS must match the files, folders or sequences", self.path.display()).into());
        }
        Ok(collected)
    }
}

/// Detector scores of labelled recordings.
pub struct Collected {
    pub scored: Vec<Scored>,
    /// Index of each group by name.
    pub groups: BTreeMap<String, usize>,
    /// Noise of each recording, in the unit of its vectors.
    noise: Vec<f64>,
    /// Scores and images of the recordings over time.
    sequences: Vec<Sequence>,
    /// `true` if all loads are in spacings of the markers' pattern, `false` if any is in a sensor's unit.
    pub in_spacings: bool,
    /// `true` if all recordings are of taxels.
    pub of_taxels: bool,
}

impl Collected {
    /// Runs the detectors over a recording if it has a label.
    fn add(
        &mut self,
        read: &Read,
        source: &Source,
        frame_labels: Option<&str>,
        labels: Option<&mut Labels>,
        notes: &mut Notes,
        keep: &mut impl FnMut(&str, &str, &GraspRecording, &Label),
    ) -> Result<(), CommandError> {
        let names: Vec<_> = read.names.iter().map(String::as_str).collect();
        let Some(&name) = names.first() else {
            return Ok(());
        };
        let known = labels.map(|labels| labels.of(&names));
        let is_listed = known.as_ref().is_none_or(Option::is_some);
        let (group, mut label) = known.flatten().unwrap_or_else(|| (name.to_owned(), None));
        if let Some(file) = frame_labels {
            label = match source.folder.as_ref().map(|folder| folder.join(file)) {
                Some(path) if path.is_file() => Some(read_frames(&path, notes)?),
                Some(path) => {
                    notes.add("no frame labels", || {
                        format!("{} not found; {name} skipped", path.display())
                    });
                    return Ok(());
                }
                None => {
                    let message =
                        "--frame-labels: requires recordings in separate folders; add --table";
                    return Err(message.into());
                }
            };
        }
        let Some(label) = label.filter(|_| is_listed) else {
            notes.add("unlabelled", || format!("{name} has no label; skipped"));
            return Ok(());
        };
        keep(name, &group, &read.recording, &label);
        let trace = DetectorTrace::of(&read.recording)?;
        if let Some(why) = &trace.no_pattern {
            let known = trace.sums().iter().any(Option::is_some);
            let what = match read.recording.untouched {
                ContactReference::LocatedPattern(_) if known => {
                    "a frame shows no pattern; its contact is unknown"
                }
                _ => "its contact is unknown",
            };
            notes.add("pattern", || format!("{name}: {why}; {what}"));
        }
        self.noise.extend(trace.noise);
        self.in_spacings &= matches!(
            read.recording.untouched,
            ContactReference::Pattern(_) | ContactReference::LocatedPattern(_)
        );
        let next = self.groups.len();
        let group = *self.groups.entry(group).or_insert(next);
        let own_noise = trace.noise;
        let first = self.scored.len();
        let mut scored = |frame: Option<usize>, slip, scores| {
            let recording = name.to_owned();
            self.scored.push(Scored {
                recording,
                frame,
                group,
                slip,
                scores,
                own_noise,
                verdicts: Default::default(),
                verdicts_by_others: Default::default(),
                event: None,
                alarms: Default::default(),
            });
        };
        match &label {
            Label::Whole(slip) => scored(None, *slip, trace.sums()),
            Label::Frames(frames) => {
                let count = trace.frames.len();
                if frames.len() != count {
                    let labelled = frames.len();
                    notes.add("frames", || format!("{name}: {count} frames, {labelled} labels; only frames with a label are scored"));
                }
                for (frame, slip) in frames {
                    if let Some(scores) = trace.frames.get(*frame) {
                        scored(Some(*frame), *slip, *scores);
                    }
                }
            }
        }
        let stamps: Vec<_> = (read.recording.frames.iter())
            .map(|frame| frame.stamp)
            .collect();
        let mut sequence = Sequence {
            group,
            images: read.images.clone(),
            scored: first..self.scored.len(),
            scores: trace.frames,
            slips: Vec::new(),
            stamps,
        };
        sequence.slips = match &label {
            Label::Whole(false) => Vec::new(),
            Label::Whole(true) => slip_in_images(sequence.valid()).into_iter().collect(),
            Label::Frames(frames) => slips_in_labels(frames, &sequence.stamps),
        };
        self.sequences.push(sequence);
        Ok(())
    }

    /// Computes image loss: compares the images of the recordings with each other and with those of `others`.
    pub fn score_images(&mut self, others: Option<&Self>) {
        let others = others.map_or(&[][..], |others| &others.sequences);
        score_images(&mut self.sequences, others, &mut self.scored);
    }

    /// Divides the drag scores by the median noise of all recordings, which are assumed to come from the same sensor.
    pub fn normalize(&mut self) {
        self.noise.sort_by(f64::total_cmp);
        let noise = self.noise.get(self.noise.len() / 2).copied();
        self.divide_drag(|_| noise);
    }

    /// Like [`normalize`](Self::normalize), but divides by the noise of each recording, which may come from different
    /// sensors.
    pub fn normalize_each(&mut self) {
        self.divide_drag(|scored| scored.own_noise);
    }

    fn divide_drag(&mut self, noise: impl Fn(&Scored) -> Option<f64>) {
        let Some(drag) = DETECTORS.iter().position(|d| *d == Detector::Drag) else {
            return;
        };
        for sequence in &mut self.sequences {
            let scored = &mut self.scored[sequence.scored.clone()];
            let Some(noise) = scored.first().and_then(&noise) else {
                continue;
            };
            let own = scored.iter_mut().map(|scored| &mut scored.scores);
            for score in own
                .chain(&mut sequence.scores)
                .filter_map(|scores| scores[drag].as_mut())
            {
                *score /= noise;
            }
        }
    }

    /// Returns all slips with a known onset, each with the start of the detector's alarm (s) at its cross-validated
    /// threshold. Also stores slip and alarm with the score of the recording if whole recordings are scored.
    pub fn alarms(&mut self, detector: usize) -> Vec<(SlipEvent, Option<f64>)> {
        let mut alarms = Vec::new();
        for sequence in &self.sequences {
            let scored = &mut self.scored[sequence.scored.clone()];
            let Some(verdict) = scored.iter().find_map(|scored| scored.verdicts[detector]) else {
                continue;
            };
            for slip in &sequence.slips {
                let scores = sequence.scores.iter().map(|scores| scores[detector]);
                let frames = sequence.stamps.iter().copied().zip(scores);
                let alarm = slip.alarm(frames, verdict.threshold);
                for whole in scored.iter_mut().filter(|scored| scored.frame.is_none()) {
                    whole.event = Some(*slip);
                    whole.alarms[detector] = alarm;
                }
                alarms.push((*slip, alarm));
            }
        }
        alarms
    }

    /// Labels and scores of the detector with this index.
    pub fn labelled(&self, detector: usize) -> Vec<Labelled> {
        let labelled = self.scored.iter().map(|s| Labelled {
            group: s.group,
            slip: s.slip,
            score: s.scores[detector],
        });
        labelled.collect()
    }
}
