//! Background thread that writes a recording's file, and the queue in front of it.

use super::batch::{Batch, CHUNK_BYTES};
use super::closing::CloseDeadline;
use super::options::Backpressure;
use crate::error::RecordError;
use crate::messages::channels::RecordingGap;
use crate::messages::run_end::RunEnd;
use crate::reading::digest::Digest;
use std::mem::take;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{
    Receiver, RecvTimeoutError, SyncSender, TrySendError, channel, sync_channel,
};
use std::thread;
use std::time::{Duration, Instant};

/// Capacity of a batch in bytes: a chunk and the message that exceeds it.
const BATCH_ROOM: usize = CHUNK_BYTES + 16 * 1024;

/// Capacity of a batch in messages: more than a chunk of any rig contains.
const BATCH_MESSAGES: usize = CHUNK_BYTES / 128;

/// Maximum number of batches that wait for the file: several seconds of two fingers, to bridge slow phases of a disk.
pub const WAITING_BATCHES: usize = 8;

/// Interval at which a full queue is polled.
const POLL: Duration = Duration::from_millis(1);

/// A destination for the batches of a recording.
pub trait Store: Send + 'static {
    /// Writes a batch.
    fn write(&mut self, batch: &Batch) -> Result<(), RecordError>;
    /// Writes the end record and closes the destination.
    fn close(self, end: &End) -> Result<Digest, RecordError>;
}

/// Content of a recording's end record, except its digest.
#[derive(Debug, Clone, Default)]
pub struct End {
    /// Wall time of the run (s), if measured.
    pub wall_time: Option<f64>,
    /// End of the run, if known.
    pub run_end: Option<RunEnd>,
    /// Number of dropped messages.
    pub dropped: u64,
}

/// Work for the background thread.
enum Work {
    Write(Batch),
    Close(End),
}

/// Reason why the queue did not accept work.
enum Refused {
    /// The queue is full.
    Full(Work),
    /// The thread has ended.
    Ended(Work),
}

/// The current batch and the thread that writes batches to the store.
pub struct Writer {
    path: PathBuf,
    patience: Backpressure,
    /// Batch being filled.
    pub batch: Batch,
    /// Queue of the thread. `None` once the thread has ended or the recording is closed.
    queue: Option<SyncSender<Work>>,
    /// Written batches returned by the thread for reuse.
    written: Receiver<Batch>,
    /// Empty batches.
    spares: Vec<Batch>,
    /// Result of the thread.
    done: Receiver<Result<Option<Digest>, RecordError>>,
    /// Dropped messages that are not yet recorded as a gap.
    pub gap: Option<RecordingGap>,
    /// Total number of dropped messages.
    pub dropped: u64,
    /// `true` if a write has already waited until its time limit since the queue last had space.
    waited: bool,
    /// Error that ended the writing, for a writer that drops messages instead of blocking.
    pub failure: Option<RecordError>,
}

impl Writer {
    /// Starts a thread that writes to `store`, the file at `path`.
    pub fn start(
        path: &Path,
        mut store: impl Store,
        patience: Backpressure,
    ) -> Result<Self, RecordError> {
        let (queue, works) = sync_channel::<Work>(WAITING_BATCHES);
        let (give_back, written) = channel();
        let (tell, done) = channel();
        let write_all = move || {
            for work in works {
                match work {
                    Work::Write(mut batch) => {
                        store.write(&batch)?;
                        batch.clear();
                        // The recorder may have been dropped.
                        let _ = give_back.send(batch);
                    }
                    Work::Close(end) => return store.close(&end).map(Some),
                }
            }
            Ok(None)
        };
        let thread = thread::Builder::new().name("recorder".into());
        // The recorder may not wait for the result.
        let spawned = thread.spawn(move || tell.send(write_all()).unwrap_or_default());
        spawned.map_err(RecordError::file(path))?;
        Ok(Self {
            path: path.to_path_buf(),
            patience,
            batch: new_batch(),
            queue: Some(queue),
            written,
            spares: match patience {
                Backpressure::Unlimited => Vec::new(),
                // A moving hand must not allocate: one batch is being written while the others wait.
                Backpressure::Limited(_) => {
                    (0..=WAITING_BATCHES).map(|_| resident_batch()).collect()
                }
            },
            done,
            gap: None,
            dropped: 0,
            waited: false,
            failure: None,
        })
    }

    /// Sends the batch to the thread, or drops it. Returns `false` if it was dropped.
    ///
    /// # Errors
    /// If the file fails, for a writer of unlimited patience.
    pub fn send(&mut self) -> Result<bool, RecordError> {
        match self.patience {
            Backpressure::Unlimited => self.offer(None),
            Backpressure::Limited(limit) => {
                let limit = if self.waited { Duration::ZERO } else { limit };
                let sent = self.offer(Some(limit)).unwrap_or_else(|error| {
                    self.failure.get_or_insert(error);
                    false
                });
                self.waited = !sent;
                if !sent {
                    self.drop_batch();
                }
                Ok(sent)
            }
        }
    }

    /// Offers the batch to the thread for up to `limit`. Returns `false` if it was not accepted; the batch is then
    /// kept.
    fn offer(&mut self, limit: Option<Duration>) -> Result<bool, RecordError> {
        let Some(queue) = &self.queue else {
            return Err(self.closed());
        };
        let mut work = Work::Write(Batch {
            gap: self.gap,
            ..take(&mut self.batch)
        });
        let start = Instant::now();
        loop {
            let refused = match push(queue, work, limit.is_none()) {
                Ok(()) => {
                    self.gap = None;
                    self.batch = self.empty_batch();
                    return Ok(true);
                }
                Err(refused) => refused,
            };
            match refused {
                Refused::Full(back) if limit.is_some_and(|limit| start.elapsed() >= limit) => {
                    self.take_back(back);
                    return Ok(false);
                }
                Refused::Full(back) => work = back,
                Refused::Ended(back) => {
                    self.take_back(back);
                    return Err(self.ended());
                }
            }
            thread::sleep(POLL);
        }
    }

    /// Closes the recording, with the end record `end` if given, within the time that `closing` allows.
    ///
    /// # Errors
    /// If the file fails, has failed, or accepts no data.
    pub fn finish(
        &mut self,
        end: Option<End>,
        closing: &mut CloseDeadline<'_>,
    ) -> Result<Option<Digest>, RecordError> {
        if let Some(failure) = self.failure.take() {
            self.queue = None;
            return Err(failure);
        }
        while !self.offer(Some(Duration::ZERO))? {
            self.wait(closing)?;
        }
        let dropped = self.dropped;
        let mut close = end.map(|end| Work::Close(End { dropped, ..end }));
        while let (Some(queue), Some(work)) = (&self.queue, close.take()) {
            match push(queue, work, false) {
                Ok(()) => {}
                Err(Refused::Full(back)) => {
                    close = Some(back);
                    self.wait(closing)?;
                }
                Err(Refused::Ended(_)) => return Err(self.ended()),
            }
        }
        self.queue = None;
        loop {
            match self.done.recv_timeout(POLL) {
                Ok(done) => return done,
                Err(RecvTimeoutError::Timeout) => self.wait(closing)?,
                Err(RecvTimeoutError::Disconnected) => return Err(self.closed()),
            }
        }
    }

    /// Waits briefly, or gives up if the time limit is exceeded.
    fn wait(&mut self, closing: &mut CloseDeadline<'_>) -> Result<(), RecordError> {
        if closing.goes_on() {
            thread::sleep(POLL);
            return Ok(());
        }
        self.queue = None;
        Err(RecordError::NotClosed {
            path: self.path.clone(),
            limit: closing.limit(),
        })
    }

    fn empty_batch(&mut self) -> Batch {
        self.spares.extend(self.written.try_iter());
        self.spares.pop().unwrap_or_else(new_batch)
    }

    fn take_back(&mut self, work: Work) {
        if let Work::Write(batch) = work {
            self.batch = batch;
        }
    }

    fn drop_batch(&mut self) {
        self.dropped += self.batch.messages.len() as u64;
        self.gap = self.batch.lost(self.gap);
        self.batch.clear();
    }

    /// Returns the error with which the thread ended early.
    fn ended(&mut self) -> RecordError {
        self.queue = None;
        match self.done.recv() {
            Ok(Err(error)) => error,
            _ => self.closed(),
        }
    }

    /// Error for writes after the recording was closed.
    pub fn closed(&self) -> RecordError {
        RecordError::Closed {
            path: self.path.clone(),
        }
    }
}

fn new_batch() -> Batch {
    Batch::with_capacity(BATCH_ROOM, BATCH_MESSAGES)
}

/// Creates a batch whose memory is resident.
fn resident_batch() -> Batch {
    let mut batch = new_batch();
    batch.bytes.resize(BATCH_ROOM, 0);
    batch.clear();
    batch
}

/// Puts `work` into the queue. If `waits` is `true`, blocks until there is space.
fn push(queue: &SyncSender<Work>, work: Work, waits: bool) -> Result<(), Refused> {
    if waits {
        return queue.send(work).map_err(|back| Refused::Ended(back.0));
    }
    queue.try_send(work).map_err(|back| match back {
        TrySendError::Full(work) => Refused::Full(work),
        TrySendError::Disconnected(work) => Refused::Ended(work),
    })
}

impl Drop for Writer {
    fn drop(&mut self) {
        if self.queue.is_some() {
            // The result is ignored: readers report that the recording was not closed.
            let mut closing = CloseDeadline::of(self.patience);
            let _ = self.finish(None, &mut closing);
        }
    }
}

#[cfg(test)]
mod tests;
