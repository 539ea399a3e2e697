//! Captures images on a background thread, so that the caller can wait with a timeout.

use feeler::sensor::image::{Camera, CameraError, CaptureReport, Frame};
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// Capacity of the queue of captured frames. If it is full, a live camera drops frames and a stream waits.
const WAITING: usize = 4;

/// Time given to a camera to stop when its pump is dropped; a running camera delivers its next image in this time.
const STOP: Duration = Duration::from_millis(500);

/// Result of one capture.
#[derive(Debug)]
pub struct Captured {
    /// The frame, or the camera's error.
    pub frame: Result<Frame, CameraError>,
    /// Time of arrival.
    pub at: Instant,
    /// Report on the capture.
    pub report: CaptureReport,
}

impl Captured {
    /// Creates a result for a camera failure that occurs now.
    fn failure(words: String) -> Self {
        Self {
            frame: Err(CameraError::Failed(words)),
            at: Instant::now(),
            report: CaptureReport::default(),
        }
    }
}

/// Captures from a camera on a background thread.
///
/// The thread ends with the camera, or at its next image after the pump is dropped. Dropping waits up to half a second
/// for that. If the camera never delivers another image, the thread keeps waiting.
#[derive(Debug)]
pub struct FramePump {
    captured: Receiver<Captured>,
    used: Sender<Frame>,
    /// Disconnected when the thread has ended.
    ended: Receiver<()>,
}

impl FramePump {
    /// Starts capturing images of `size` (columns, rows) px.
    ///
    /// # Errors
    /// If the thread cannot be created.
    pub fn start(
        camera: impl Camera + Send + 'static,
        size: (usize, usize),
    ) -> std::io::Result<Self> {
        let (sender, captured) = sync_channel(WAITING);
        let (used, unused) = channel();
        let (running, ended) = channel::<()>();
        let run = move || {
            // Dropped after the camera.
            let _running = running;
            let mut camera = camera;
            let pump = || pump(&mut camera, size, &sender, &unused);
            if let Err(panic) = catch_unwind(AssertUnwindSafe(pump)) {
                // A send error means that the pump was dropped.
                let _ = sender.send(Captured::failure(words_of(panic.as_ref())));
            }
        };
        thread::Builder::new().name("camera".into()).spawn(run)?;
        Ok(Self {
            captured,
            used,
            ended,
        })
    }

    /// Next result, or `None` if nothing arrives within `timeout`.
    pub fn next(&self, timeout: Duration) -> Option<Captured> {
        match self.captured.recv_timeout(timeout) {
            Ok(captured) => Some(captured),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                Some(Captured::failure("the camera's thread has ended".into()))
            }
        }
    }

    /// Returns a frame to be reused.
    pub fn give_back(&self, frame: Frame) {
        // A send error means that the camera has ended.
        let _ = self.used.send(frame);
    }
}

impl Drop for FramePump {
    fn drop(&mut self) {
        // Disconnects, so that the thread ends at its next image.
        self.captured = sync_channel(0).1;
        let _ = self.ended.recv_timeout(STOP);
    }
}

/// Error message for a camera thread that panicked with `panic`.
fn words_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    format!(
        "the camera's thread has panicked: {}",
        text.unwrap_or("no message")
    )
}

fn pump(
    camera: &mut impl Camera,
    (width, height): (usize, usize),
    sender: &SyncSender<Captured>,
    unused: &Receiver<Frame>,
) {
    loop {
        let mut frame = (unused.try_recv()).unwrap_or_else(|_| Frame::black(width, height));
        let frame = camera.capture(&mut frame).map(|()| frame);
        let goes_on = frame.as_ref().err().is_none_or(CameraError::is_recoverable);
        let captured = Captured {
            frame,
            at: Instant::now(),
            report: camera.take_report(),
        };
        if sender.send(captured).is_err() || !goes_on {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Captures two images, then fails with the given error or panic.
    struct Failing(u64, fn() -> CameraError);

    impl Camera for Failing {
        fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
            frame.sequence = self.0;
            self.0 += 1;
            if self.0 > 2 { Err((self.1)()) } else { Ok(()) }
        }
    }

    #[test]
    fn errors_and_panics_of_a_camera_are_reported() {
        let failed = || CameraError::Failed("the cable is out".into());
        let panicked = || panic!("no such lens");
        for (fail, words) in [
            (failed as fn() -> CameraError, "the cable is out"),
            (panicked, "panicked: no such lens"),
        ] {
            let pump = FramePump::start(Failing(0, fail), (2, 1)).unwrap();
            let next = || {
                pump.next(Duration::from_secs(60))
                    .expect("a picture or an error")
            };
            assert_eq!(next().frame.unwrap().sequence, 0);
            assert_eq!(next().frame.unwrap().sequence, 1);
            let error = next().frame.unwrap_err();
            assert!(
                !error.is_recoverable() && error.to_string().contains(words),
                "{error}"
            );
        }
    }
}
