//! Takes a camera's pictures on a thread of its own, so that who waits for one can give up waiting.

use feeler::sensor::camera::{Camera, CameraError, CaptureReport};
use feeler::sensor::frame::Frame;
use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// Frames that may wait for being sensed. A live camera drops its own frames when there are more; a
/// stream waits.
const WAITING: usize = 4;

/// A camera is given so long to stop when its pump is dropped: one that runs has its next picture by then, and is free for others.
const STOP: Duration = Duration::from_millis(500);

/// What came of taking one picture.
#[derive(Debug)]
pub struct Captured {
    /// The frame, or why there is none.
    pub frame: Result<Frame, CameraError>,
    /// When it came in.
    pub at: Instant,
    /// How it was made.
    pub report: CaptureReport,
}

impl Captured {
    /// A failure of the camera, now.
    fn failure(words: String) -> Self {
        Self {
            frame: Err(CameraError::Failed(words)),
            at: Instant::now(),
            report: CaptureReport::default(),
        }
    }
}

/// A camera on a thread of its own.
///
/// The thread ends with the camera, or at its next picture after the pump is dropped, which waits half a second for it. One that
/// waits for a picture that never comes is left waiting.
#[derive(Debug)]
pub struct FramePump {
    captured: Receiver<Captured>,
    used: Sender<Frame>,
    /// Closed when the thread has ended.
    ended: Receiver<()>,
}

impl FramePump {
    /// Starts taking pictures of `size` (columns, rows) px.
    ///
    /// # Errors
    /// When the system gives no thread.
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
                // Whoever takes no more frames need not know.
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

    /// The next picture: none if there is none within `timeout`.
    pub fn next(&self, timeout: Duration) -> Option<Captured> {
        match self.captured.recv_timeout(timeout) {
            Ok(captured) => Some(captured),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                Some(Captured::failure("the camera's thread has ended".into()))
            }
        }
    }

    /// Gives a frame back to be filled again.
    pub fn give_back(&self, frame: Frame) {
        // Where the camera has ended, nobody needs it.
        let _ = self.used.send(frame);
    }
}

impl Drop for FramePump {
    fn drop(&mut self) {
        // Nobody takes another picture.
        self.captured = sync_channel(0).1;
        let _ = self.ended.recv_timeout(STOP);
    }
}

/// Why a camera's thread has ended, by what it panicked with.
fn words_of(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
    format!(
        "the camera's thread has panicked: {}",
        text.unwrap_or("it does not say why")
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
        let goes_on = frame.as_ref().err().is_none_or(CameraError::may_pass);
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

    /// Takes two pictures, then fails as it is told to.
    struct Failing(u64, fn() -> CameraError);

    impl Camera for Failing {
        fn capture(&mut self, frame: &mut Frame) -> Result<(), CameraError> {
            frame.sequence = self.0;
            self.0 += 1;
            if self.0 > 2 { Err((self.1)()) } else { Ok(()) }
        }
    }

    #[test]
    fn a_camera_that_fails_halfway_says_why() {
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
                !error.may_pass() && error.to_string().contains(words),
                "{error}"
            );
        }
    }
}
