//! Fingers' sensors on threads of their own: whoever steps waits for no camera.

use super::flags::FlagThresholds;
use super::touch::{AnalyzedSensor, FingerTouch, TouchSource};
use crate::pace::{Arrivals, Clock, Monotonic};
use crate::sensor::reading::{SensorError, TactileSensor};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// What one finger felt since it was asked last.
struct Felt {
    touch: FingerTouch,
    /// When the newest of it was at hand, where nobody has asked since; on the monotonic clock.
    arrived: Option<Duration>,
    /// Why there will be no more.
    failed: Option<String>,
}

/// What all fingers felt, and who waits for it.
struct Board {
    fingers: Mutex<Vec<Felt>>,
    changed: Condvar,
}

impl Board {
    fn lock(&self) -> MutexGuard<'_, Vec<Felt>> {
        self.fingers.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// What one finger's sensor says, which is read on a thread of its own. A sensor that fails stops the hand, as any; one that is late
/// says the same again, until that is stale.
///
/// The thread ends at its next reading after all that belongs to it is dropped. One whose sensor waits for ever is left waiting.
pub struct LiveTouch {
    board: Arc<Board>,
    finger: usize,
    elements: usize,
}

/// When something new of all fingers is at hand, for [`Following`](crate::pace::Following).
pub struct LiveArrivals(Arc<Board>);

/// Reads `sensors`, one per finger, on threads of their own, and raises flags by `thresholds` on what each measures. A sensor may take as
/// long as it likes, as one does whose camera waits for its next picture.
///
/// # Errors
/// When the system gives no thread.
pub fn live<S: TactileSensor + Send + 'static>(
    sensors: Vec<S>,
    thresholds: FlagThresholds,
) -> std::io::Result<(Vec<LiveTouch>, LiveArrivals)> {
    let felt = |sensor: &S| Felt {
        touch: FingerTouch::none(sensor.element_count()),
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
        let mut sensor = AnalyzedSensor::new(sensor, thresholds);
        let name = format!("finger {finger}");
        thread::Builder::new().name(name).spawn(move || {
            let mut touch = FingerTouch::none(elements);
            loop {
                let read = sensor.touch(&mut touch);
                let Some(board) = weak.upgrade() else { return };
                if !board.put(finger, &touch, read) {
                    return;
                }
            }
        })?;
        touches.push(LiveTouch {
            board: board.clone(),
            finger,
            elements,
        });
    }
    Ok((touches, LiveArrivals(board)))
}

impl Board {
    /// Takes in what `finger` felt, or why it could not; whether it may feel more.
    fn put(&self, finger: usize, touch: &FingerTouch, read: Result<(), SensorError>) -> bool {
        let now = Monotonic::new().now();
        let mut fingers = self.lock();
        let Some(felt) = fingers.get_mut(finger) else {
            return false;
        };
        match read {
            // One picture is lost, and the next may be good.
            Err(SensorError::Camera(error)) if error.may_pass() => return true,
            Err(error) => felt.failed = Some(error.to_string()),
            // A camera that is stuck says nothing new.
            Ok(()) if is_same(touch, &felt.touch) => return true,
            Ok(()) => {
                let seen = felt.arrived.is_none();
                let flags = match seen {
                    true => touch.flags,
                    false => felt.touch.flags.then(touch.flags),
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

/// Whether `touch` is of the same picture as the one `before`.
fn is_same(touch: &FingerTouch, before: &FingerTouch) -> bool {
    touch.stamp == before.stamp && touch.frame.sequence == before.frame.sequence
}

impl TouchSource for LiveTouch {
    fn element_count(&self) -> usize {
        self.elements
    }

    fn touch(&mut self, touch: &mut FingerTouch) -> Result<(), SensorError> {
        let actual = touch.frame.forces.len();
        if actual != self.elements {
            let expected = self.elements;
            return Err(SensorError::ElementCount { expected, actual });
        }
        let mut fingers = self.board.lock();
        let Some(felt) = fingers.get_mut(self.finger) else {
            return Ok(());
        };
        if let Some(reason) = &felt.failed {
            return Err(SensorError::Failed(reason.clone()));
        }
        felt.arrived = None;
        touch.copy_from(&felt.touch);
        Ok(())
    }
}

impl Arrivals for LiveArrivals {
    fn wait_for(&mut self, longest: Duration) -> Option<Duration> {
        let end = Instant::now() + longest;
        let mut fingers = self.0.lock();
        loop {
            // One that failed has nothing more to wait for: the step will tell.
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
