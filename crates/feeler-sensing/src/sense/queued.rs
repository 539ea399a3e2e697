//! An output that holds nobody up: a thread of its own writes it.

use super::output::{FrameReadings, Output, partial};
use feeler::sensor::frame::{Frame, Picture};
use feeler::sensor::sensing::ElementReading;
use feeler_console::CommandError;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// Frames that may wait for the disk: some seconds of a fast camera, 2 MB.
const WAITING: usize = 512;

/// The same where frames have their pictures: 2 s of a camera of 30 Hz, 20 MB of 640x480 px.
const WAITING_WITH_PICTURES: usize = 64;

/// How long the end waits for a disk that takes nothing.
const LAST: Duration = Duration::from_secs(5);

/// Time between two looks at whether there is room.
const POLL: Duration = Duration::from_millis(1);

/// Says something to the user.
pub type Say = Box<dyn FnMut(&str) + Send>;

/// What becomes of frames that find no room.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Full {
    /// They wait for it: files and streams can.
    Wait,
    /// They are dropped and counted: a camera goes on. Where the output fails, so does sensing.
    Drop,
    /// The same, and a hand needs what is sensed, whatever becomes of the output.
    DropForAHand,
}

/// Writes frames to another output as fast as that takes them.
pub struct Queued {
    works: Option<SyncSender<Work>>,
    full: Full,
    spare: Receiver<Sensed>,
    spare_pictures: Receiver<Frame>,
    /// What came of it, when the thread ends: the partial file that is left, if one is.
    ended: Receiver<Result<Option<PathBuf>, String>>,
    say: Say,
    dropped: u64,
    /// Pictures that were dropped, which their frames need not be.
    dropped_pictures: u64,
    is_dropping: bool,
}

/// The readings of one frame, for a thread.
#[derive(Default)]
struct Sensed {
    sequence: u64,
    stamp: f64,
    readings: Vec<ElementReading>,
}

enum Work {
    Write(Sensed),
    Picture(Frame),
    /// Close what is whole, or not.
    Finish(bool),
}

impl Queued {
    /// Writes to `output`, and tells `say` what is dropped; frames may have `pictures`.
    ///
    /// # Errors
    /// When the system has no thread left.
    pub fn start(
        output: Box<dyn Output>,
        full: Full,
        pictures: bool,
        say: Say,
    ) -> Result<Self, CommandError> {
        // A picture is a work of its own.
        let (works, waiting) = sync_channel(match pictures {
            true => 2 * WAITING_WITH_PICTURES,
            false => WAITING,
        });
        let (give_back, spare) = channel();
        let (give_back_picture, spare_pictures) = channel();
        let (tell, ended) = channel();
        let write = move || {
            // Whoever takes no more frames needs no memory for them.
            let give_back = |written| match written {
                Work::Write(sensed) => give_back.send(sensed).unwrap_or_default(),
                Work::Picture(frame) => give_back_picture.send(frame).unwrap_or_default(),
                Work::Finish(_) => {}
            };
            // Who does not wait for the end does not ask.
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

    /// Why the thread has ended before it was told to.
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

    /// What was dropped so far, in words.
    fn missing(&self) -> String {
        match (self.dropped, self.dropped_pictures) {
            (frames, 0) => format!("{frames} frames"),
            (frames, pictures) => format!("{frames} frames and {pictures} pictures"),
        }
    }

    /// Hands on what is to be written, or drops it where there is no room and it must not wait.
    fn hand_on(&mut self, work: Work) -> Result<(), CommandError> {
        let Some(works) = &self.works else {
            return Ok(());
        };
        let sent = match self.full {
            Full::Wait => works
                .send(work)
                .map_err(|back| TrySendError::Disconnected(back.0)),
            Full::Drop | Full::DropForAHand => works.try_send(work),
        };
        let is_picture = matches!(
            sent,
            Err(TrySendError::Full(Work::Picture(_)) | TrySendError::Disconnected(Work::Picture(_)))
        );
        let was_dropping = std::mem::replace(&mut self.is_dropping, sent.is_err());
        match sent {
            Ok(()) if was_dropping => {
                let missing = self.missing();
                (self.say)(&format!("output: goes on; {missing} are missing so far"));
            }
            Ok(()) => {}
            Err(TrySendError::Full(_)) => {
                self.count(is_picture);
                if !was_dropping {
                    (self.say)("output: the disk takes nothing; frames are left out of the file");
                }
            }
            Err(TrySendError::Disconnected(_)) => {
                let error = self.why_ended();
                if self.full != Full::DropForAHand {
                    return Err(error.into());
                }
                (self.say)(&format!("{error}; publishing goes on without a file"));
                self.count(is_picture);
            }
        }
        Ok(())
    }
}

/// Writes all that comes, then closes `output`.
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
                    // What is written is handed on as soon as no frame waits.
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

impl Output for Queued {
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
        let slow = "output: the disk takes nothing; the file is left as it is, partial";
        let Some(works) = self.works.take() else {
            return Err("output: it was not written to its end".into());
        };
        if self.full == Full::Wait {
            // A thread that has ended says why.
            let _ = works.send(Work::Finish(whole));
            let ended = self.ended.recv();
            return Ok(ended.map_err(|_| "output: it was not written to its end")??);
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
