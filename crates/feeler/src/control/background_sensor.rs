//! Reads the sensors on background threads, so that the control loop never blocks on a camera.

use super::flags::FlagThresholds;
use super::frame_buffer::FrameBuffer;
use super::touch::{FlaggedSensor, TactileReading, TactileSource};
use crate::pace::{Clock, Monotonic, StepTrigger};
use crate::sensor::forces::reading::{SensorError, TactileFrame, TactileSensor};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Latest reading of one finger and the state of its sensor.
struct SensorState {
    touch: TactileReading,
    /// Unread frames before the latest one.
    earlier: FrameBuffer,
    /// Time on the monotonic clock at which the latest unread data arrived; `None` if all data has been read.
    arrived: Option<Duration>,
    /// Error that ended the sensor's thread.
    failed: Option<String>,
}

/// Readings of all fingers, shared between the sensor threads and the control loop.
struct Board {
    fingers: Mutex<Vec<SensorState>>,
    changed: Condvar,
}

impl Board {
    fn lock(&self) -> MutexGuard<'_, Vec<SensorState>> {
        self.fingers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Source of tactile readings for one finger whose sensor runs on a background thread. An error of the sensor stops the
/// hand. If the sensor is late, its previous reading is returned, until it becomes stale.
///
/// The thread ends after its next reading once all handles are dropped. A thread whose sensor blocks forever is not
/// joined.
pub struct BackgroundSensor {
    board: Arc<Board>,
    finger: usize,
    elements: usize,
    earlier: FrameBuffer,
}

/// Signals when new data of all fingers is available; for [`DataDriven`](crate::pace::DataDriven).
pub struct NewDataSignal(Arc<Board>);

/// Starts a background thread for each of the `sensors`, one per finger. Each thread reads its sensor and computes the
/// flags with `thresholds`. A sensor may block for any time, for example until its camera's next frame.
///
/// # Errors
/// If the system cannot create a thread.
pub fn live<S: TactileSensor + Send + 'static>(
    sensors: Vec<S>,
    thresholds: FlagThresholds,
) -> std::io::Result<(Vec<BackgroundSensor>, NewDataSignal)> {
    let felt = |sensor: &S| SensorState {
        touch: TactileReading::none(sensor.element_count()),
        earlier: FrameBuffer::default(),
        arrived: None,
        failed: None,
    };
    let board = Arc::new(Board {
        fingers: Mutex::new(sensors.iter().map(felt).collect()),
        changed: Condvar::new(),
    });
    let mut touches = Vec::new();
    for (finger, sensor) in sensors.into_iter().enumerate() {
        let (elements, weak) = (sensor.element_count(), Arc::downgrade(&board));
        let mut sensor = FlaggedSensor::new(sensor, thresholds);
        let name = format!("finger {finger}");
        thread::Builder::new().name(name).spawn(move || {
            let mut touch = TactileReading::none(elements);
            loop {
                let read = sensor.touch(&mut touch);
                let Some(board) = weak.upgrade() else { return };
                if !board.put(finger, &touch, read) {
                    return;
                }
            }
        })?;
        touches.push(BackgroundSensor {
            board: board.clone(),
            finger,
            elements,
            earlier: FrameBuffer::default(),
        });
    }
    Ok((touches, NewDataSignal(board)))
}

impl Board {
    /// Stores a reading of `finger` or the error of its sensor. Returns `true` if the sensor thread should continue.
    fn put(&self, finger: usize, touch: &TactileReading, read: Result<(), SensorError>) -> bool {
        let now = Monotonic::new().now();
        let mut fingers = self.lock();
        let Some(felt) = fingers.get_mut(finger) else {
            return false;
        };
        match read {
            // One frame is lost; the next may be valid.
            Err(SensorError::Camera(error)) if error.is_recoverable() => return true,
            Err(error) => felt.failed = Some(error.to_string()),
            // A stuck camera delivers no new data.
            Ok(()) if is_same(touch, &felt.touch) => return true,
            Ok(()) => {
                let flags = match felt.arrived {
                    None => touch.flags,
                    Some(_) => {
                        let unread = &felt.touch.frame;
                        let forces = unread.forces.iter().copied();
                        felt.earlier.push(unread.sequence, unread.stamp, forces);
                        felt.touch.flags.then(touch.flags)
                    }
                };
                felt.touch.copy_from(touch);
                felt.touch.flags = flags;
                felt.arrived = Some(now);
            }
        }
        let goes_on = felt.failed.is_none();
        drop(fingers);
        self.changed.notify_all();
        goes_on
    }
}

/// Returns whether `touch` was measured from the same image as `before`.
fn is_same(touch: &TactileReading, before: &TactileReading) -> bool {
    touch.stamp == before.stamp && touch.frame.sequence == before.frame.sequence
}

impl TactileSource for BackgroundSensor {
    fn element_count(&self) -> usize {
        self.elements
    }

    fn touch(&mut self, touch: &mut TactileReading) -> Result<(), SensorError> {
        touch.frame.check_elements(self.elements)?;
        let mut fingers = self.board.lock();
        let Some(felt) = fingers.get_mut(self.finger) else {
            return Ok(());
        };
        if let Some(reason) = &felt.failed {
            return Err(SensorError::Failed(reason.clone()));
        }
        felt.arrived = None;
        touch.copy_from(&felt.touch);
        self.earlier.clear();
        std::mem::swap(&mut self.earlier, &mut felt.earlier);
        Ok(())
    }

    fn earlier_frames(&self) -> &[TactileFrame] {
        self.earlier.as_slice()
    }
}

impl StepTrigger for NewDataSignal {
    fn wait_for(&mut self, longest: Duration) -> Option<Duration> {
        let end = Instant::now() + longest;
        let mut fingers = self.0.lock();
        loop {
            // A failed sensor delivers nothing more; the step reports its error.
            if fingers.iter().any(|felt| felt.failed.is_some()) {
                return Some(Monotonic::new().now());
            }
            let arrived = fingers.iter().map(|felt| felt.arrived);
            let last = arrived.reduce(|a, b| a.zip(b).map(|(a, b)| a.max(b)));
            if let Some(Some(last)) = last {
                return Some(last);
            }
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return None;
            }
            let waited = self.0.changed.wait_timeout(fingers, left);
            fingers = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}
