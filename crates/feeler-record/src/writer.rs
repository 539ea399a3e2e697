//! The thread that a recording's file is written on, and what becomes of messages while it cannot be.

use super::batch::Batch;
use super::channels::RecordingGap;
use super::closing::Closing;
use super::digest::Digest;
use super::error::RecordError;
use super::options::Patience;
use super::run_end::RunEnd;
use std::mem::take;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{
    Receiver, RecvTimeoutError, SyncSender, TrySendError, channel, sync_channel,
};
use std::thread;
use std::time::{Duration, Instant};

/// Bytes of messages that make a chunk. More would be lost with a program that is killed; of each, the writer keeps
/// 0.6 KB for the index at the end.
pub const CHUNK_BYTES: usize = 512 * 1024;

/// Room of a batch: a chunk and the message that filled it.
const BATCH_ROOM: usize = CHUNK_BYTES + 16 * 1024;

/// Messages that a batch has room for: more than a chunk of any rig's.
const BATCH_MESSAGES: usize = CHUNK_BYTES / 128;

/// Batches that may wait for the file: some seconds of two fingers, so that a disk that is slow now and then costs
/// nothing.
pub const WAITING_BATCHES: usize = 8;

/// Time between two looks at whether there is room.
const POLL: Duration = Duration::from_millis(1);

/// What takes the batches of a recording.
pub trait Store: Send + 'static {
    /// Takes a batch, for good.
    fn write(&mut self, batch: &Batch) -> Result<(), RecordError>;
    /// Takes what belongs at the end.
    fn close(self, end: &End) -> Result<Digest, RecordError>;
}

/// What stands at a recording's end beside its digest.
#[derive(Debug, Clone, Default)]
pub struct End {
    /// Wall time of the run, s, if it was measured.
    pub wall_time: Option<f64>,
    /// How the run ended, if somebody said so.
    pub run_end: Option<RunEnd>,
    /// Messages that are missing.
    pub dropped: u64,
}

/// Work for the thread.
enum Work {
    Write(Batch),
    Close(End),
}

/// Why the queue did not take something.
enum Refused {
    /// There is no room.
    Full(Work),
    /// The thread has ended.
    Ended(Work),
}

/// Batches, and the thread that puts them into the store.
pub struct Writer {
    path: PathBuf,
    patience: Patience,
    /// The batch that is being filled.
    pub batch: Batch,
    /// To the thread; none once that has ended, or the recording is closed.
    queue: Option<SyncSender<Work>>,
    /// Batches that have been written and can be filled again, from the thread.
    written: Receiver<Batch>,
    /// Batches that can be filled.
    spares: Vec<Batch>,
    /// What came of it, when the thread ends.
    done: Receiver<Result<Option<Digest>, RecordError>>,
    /// What is missing and has not been told yet.
    gap: Option<RecordingGap>,
    /// Messages that are missing in all.
    dropped: u64,
    /// Whether a write has waited in vain since there was room.
    waited: bool,
    /// Why the file takes nothing any more.
    failure: Option<RecordError>,
}

impl Writer {
    /// Starts the thread, which writes to `store`, the file at `path`.
    pub fn start(
        path: &Path,
        mut store: impl Store,
        patience: Patience,
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
                        // The recorder may be gone already; then nobody needs the memory.
                        let _ = give_back.send(batch);
                    }
                    Work::Close(end) => return store.close(&end).map(Some),
                }
            }
            Ok(None)
        };
        let thread = thread::Builder::new().name("recorder".into());
        // A recorder that has given up waits for no answer.
        let spawned = thread.spawn(move || tell.send(write_all()).unwrap_or_default());
        spawned.map_err(|source| RecordError::File {
            path: path.to_path_buf(),
            source,
        })?;
        Ok(Self {
            path: path.to_path_buf(),
            patience,
            batch: new_batch(),
            queue: Some(queue),
            written,
            spares: match patience {
                Patience::Unlimited => Vec::new(),
                // A hand that moves takes no memory meanwhile: so many wait, and one is being written.
                Patience::Limited(_) => (0..=WAITING_BATCHES).map(|_| resident_batch()).collect(),
            },
            done,
            gap: None,
            dropped: 0,
            waited: false,
            failure: None,
        })
    }

    /// Messages that were dropped.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    /// What is missing and has not been told yet, as there still is no room.
    pub fn gap(&self) -> Option<&RecordingGap> {
        self.gap.as_ref()
    }

    /// Why the file takes nothing any more, of a writer of limited patience.
    pub fn failure(&self) -> Option<&RecordError> {
        self.failure.as_ref()
    }

    /// Hands the batch to the thread, or drops it; whether it was handed on.
    ///
    /// # Errors
    /// When the file fails, of a writer of unlimited patience.
    pub fn send(&mut self) -> Result<bool, RecordError> {
        match self.patience {
            Patience::Unlimited => self.offer(None),
            Patience::Limited(limit) => {
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

    /// Offers the batch to the thread for at most `limit`; whether it was taken. If not, it stays.
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

    /// Closes the recording with what belongs at its end, if that is known, for as long as `closing` allows.
    ///
    /// # Errors
    /// When the file fails or has failed, or takes nothing.
    pub fn finish(
        &mut self,
        end: Option<End>,
        closing: &mut Closing<'_>,
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

    /// Waits a little, or gives the file up.
    fn wait(&mut self, closing: &mut Closing<'_>) -> Result<(), RecordError> {
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

    /// Why the thread ended.
    fn ended(&mut self) -> RecordError {
        self.queue = None;
        match self.done.recv() {
            Ok(Err(error)) => error,
            _ => self.closed(),
        }
    }

    /// That nothing can be written any more.
    pub fn closed(&self) -> RecordError {
        RecordError::Closed {
            path: self.path.clone(),
        }
    }
}

fn new_batch() -> Batch {
    Batch::with_capacity(BATCH_ROOM, BATCH_MESSAGES)
}

/// A batch whose memory the system has given already.
fn resident_batch() -> Batch {
    let mut batch = new_batch();
    batch.bytes.resize(BATCH_ROOM, 0);
    batch.clear();
    batch
}

/// Puts `work` into the queue; waits for room where it is to.
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
            // Without `finish` nobody asks what became of the rest; reading says it was not closed.
            let mut closing = Closing::of(self.patience);
            let _ = self.finish(None, &mut closing);
        }
    }
}

#[cfg(test)]
mod tests;
