//! Writes an output on a background thread, so that the caller is not blocked.

use super::output::{FrameReadings, Output, partial};
use feeler::sensor::forces::ElementReading;
use feeler::sensor::image::{Frame, Picture};
use feeler_console::CommandError;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// Maximum number of queued frames: several seconds of a fast camera, 2 MB of memory.
const WAITING: usize = 512;

/// Maximum number of queued frames with images: 2 s of a 30 Hz camera, 20 MB of memory for 640x480 px.
const WAITING_WITH_PICTURES: usize = 64;

/// Maximum time to wait at the end if the disk accepts no data.
const LAST: Duration = Duration::from_secs(5);

/// Interval at which a full queue is polled.
const POLL: Duration = Duration::from_millis(1);

/// Prints a message for the user.
pub type Say = Box<dyn FnMut(&str) + Send>;

/// Policy for frames that do not fit into the queue.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Backpressure {
    /// Block until there is space, for files and streams.
    Block,
    /// Drop frames and count them, for a camera. An error of the output ends sensing.
    Drop,
    /// Like [`Drop`](Self::Drop), but an error of the output does not end sensing, because a hand needs the readings.
    DropAndIgnoreErrors,
}

/// Writes frames to another output on a background thread.
pub struct BackgroundOutput {
    works: Option<SyncSender<Work>>,
    full: Backpressure,
    spare: Receiver<Sensed>,
    spare_pictures: Receiver<Frame>,
    /// Path of the partial file that remains, if any, sent when the thread ends.
    ended: Receiver<Result<Option<PathBuf>, String>>,
    say: Say,
    dropped: u64,
    /// Number of images that were dropped; the readings of their frames may have been written.
    dropped_pictures: u64,
    is_dropping: bool,
}

/// Readings of one frame, owned by the queue.
#[derive(Default)]
struct Sensed {
    sequence: u64,
    stamp: f64,
    readings: Vec<ElementReading>,
}

enum Work {
    Write(Sensed),
    Picture(Frame),
    /// Close the output. It is complete if `true`.
    Finish(bool),
}

impl BackgroundOutput {
    /// Starts a thread that writes to `output`. Dropped frames are reported to `say`. `pictures` is `true` if frames
    /// may have images.
    ///
    /// # Errors
    /// If the thread cannot be started.
    pub fn start(
        output: Box<dyn Output>,
        full: Backpressure,
        pictures: bool,
        say: Say,
    ) -> Result<Self, CommandError> {
        // An image takes one place in the queue.
        let (works, waiting) = sync_channel(match pictures {
            true => 2 * WAITING_WITH_PICTURES,
            false => WAITING,
        });
        let (give_back, spare) = channel();
        let (give_back_picture, spare_pictures) = channel();
        let (tell, ended) = channel();
        let write = move || {
            // The receiver may have been dropped.
            let give_back = |written| match written {
                Work::Write(sensed) => give_back.send(sensed).unwrap_or_default(),
                Work::Picture(frame) => give_back_picture.send(frame).unwrap_or_default(),
                Work::Finish(_) => {}
            };
            // The receiver may not wait for the end.
            let _ = tell.send(write_all(output, &waiting, give_back));
        };
        thread::Builder::new().name("output".into()).spawn(write)?;
        Ok(Self {
            works: Some(works),
            full,
            spare,
            spare_pictures,
            ended,
            say,
            dropped: 0,
            dropped_pictures: 0,
            is_dropping: false,
        })
    }

    /// Returns the error of the thread after it ended early.
    fn why_ended(&mut self) -> String {
        self.works = None;
        match self.ended.recv() {
            Ok(Err(error)) => error,
            _ => "the output ended".into(),
        }
    }

    fn count(&mut self, is_picture: bool) {
        match is_picture {
            true => self.dropped_pictures += 1,
            false => self.dropped += 1,
        }
    }

    /// Describes the frames dropped so far.
    fn missing(&self) -> String {
        match (self.dropped, self.dropped_pictures) {
            (frames, 0) => format!("{frames} frames"),
            (frames, pictures) => format!("{frames} frames and {pictures} images"),
        }
    }

    /// Queues `work`, or drops it if the queue is full and must not block.
    fn hand_on(&mut self, work: Work) -> Result<(), CommandError> {
        let Some(works) = &self.works else {
            return Ok(());
        };
        let sent = match self.full {
            Backpressure::Block => works
                .send(work)
                .map_err(|back| TrySendError::Disconnected(back.0)),
            Backpressure::Drop | Backpressure::DropAndIgnoreErrors => works.try_send(work),
        };
        let is_picture = matches!(
            sent,
            Err(TrySendError::Full(Work::Picture(_)) | TrySendError::Disconnected(Work::Picture(_)))
        );
        let was_dropping = std::mem::replace(&mut self.is_dropping, sent.is_err());
        match sent {
            Ok(()) if was_dropping => {
                let missing = self.missing();
                (self.say)(&format!("output: resumed; {missing} missing so far"));
            }
            Ok(()) => {}
            Err(TrySendError::Full(_)) => {
                self.count(is_picture);
                if !was_dropping {
                    (self.say)("output: the disk accepts no data; frames are missing in the file");
                }
            }
            Err(TrySendError::Disconnected(_)) => {
                let error = self.why_ended();
                if self.full != Backpressure::DropAndIgnoreErrors {
                    return Err(error.into());
                }
                (self.say)(&format!("{error}; publishing continues without a file"));
                self.count(is_picture);
            }
        }
        Ok(())
    }
}

/// Writes all queued work, then closes `output`.
fn write_all(
    mut output: Box<dyn Output>,
    works: &Receiver<Work>,
    give_back: impl Fn(Work),
) -> Result<Option<PathBuf>, String> {
    let mut whole = false;
    let mut write = || -> Result<bool, CommandError> {
        loop {
            let work = match works.try_recv() {
                Ok(work) => work,
                Err(TryRecvError::Disconnected) => return Ok(false),
                Err(TryRecvError::Empty) => {
                    // Flush as soon as no frame is waiting.
                    output.flush()?;
                    match works.recv() {
                        Ok(work) => work,
                        Err(_) => return Ok(false),
                    }
                }
            };
            match &work {
                Work::Finish(whole) => return Ok(*whole),
                Work::Picture(frame) => output.write_picture(frame)?,
                Work::Write(sensed) => output.write(&FrameReadings {
                    sequence: sensed.sequence,
                    stamp: sensed.stamp,
                    readings: &sensed.readings,
                    markers: &[],
                })?,
            }
            give_back(work);
        }
    };
    let written = write().map(|is_whole| whole = is_whole);
    let left = output.finish(whole);
    match (written, left) {
        (Err(error), Ok(Some(part))) => Err(partial(&error, &part).to_string()),
        (Err(error), _) => Err(error.to_string()),
        (Ok(()), left) => left.map_err(|error| error.to_string()),
    }
}

impl Output for BackgroundOutput {
    fn write(&mut self, readings: &FrameReadings) -> Result<(), CommandError> {
        let mut sensed = self.spare.try_recv().unwrap_or_default();
        (sensed.sequence, sensed.stamp) = (readings.sequence, readings.stamp);
        sensed.readings.clear();
        sensed.readings.extend_from_slice(readings.readings);
        self.hand_on(Work::Write(sensed))
    }

    fn write_picture(&mut self, frame: &Frame) -> Result<(), CommandError> {
        let spare = self.spare_pictures.try_recv();
        let mut copy = spare.unwrap_or_else(|_| Frame::black(0, 0));
        (copy.sequence, copy.stamp) = (frame.sequence, frame.stamp);
        let Picture {
            width,
            height,
            pixels,
        } = &mut copy.picture;
        (*width, *height) = (frame.picture.width, frame.picture.height);
        pixels.clear();
        pixels.extend_from_slice(&frame.picture.pixels);
        self.hand_on(Work::Picture(copy))
    }

    fn flush(&mut self) -> Result<(), CommandError> {
        Ok(())
    }

    fn finish(mut self: Box<Self>, whole: bool) -> Result<Option<PathBuf>, CommandError> {
        let slow = "output: the disk accepts no data; the file remains partial";
        let Some(works) = self.works.take() else {
            return Err("output: not written completely".into());
        };
        if self.full == Backpressure::Block {
            // If the thread has ended, its result is received below.
            let _ = works.send(Work::Finish(whole));
            let ended = self.ended.recv();
            return Ok(ended.map_err(|_| "output: not written completely")??);
        }
        let start = Instant::now();
        let whole = whole && self.dropped + self.dropped_pictures == 0;
        loop {
            match works.try_send(Work::Finish(whole)) {
                Err(TrySendError::Full(_)) if start.elapsed() < LAST => thread::sleep(POLL),
                Err(TrySendError::Full(_)) => return Err(slow.into()),
                _ => break,
            }
        }
        match self.ended.recv_timeout(LAST) {
            Ok(ended) => Ok(ended?),
            Err(_) => Err(slow.into()),
        }
    }
}

#[cfg(test)]
mod tests;
