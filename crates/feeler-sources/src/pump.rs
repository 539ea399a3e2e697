//! Takes a camera's pictures on a thread of its own, so that who waits for one can give up waiting.

use feeler::sensor::camera::{Camera, CameraError};
use feeler::sensor::frame::Frame;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// Frames that may wait for being sensed. A live camera drops its own frames when there are more; a
/// stream waits.
const WAITING: usize = 4;

/// What came of taking one picture.
#[derive(Debug)]
pub struct Captured {
    /// The frame, or why there is none.
    pub frame: Result<Frame, CameraError>,
    /// When it came in.
    pub at: Instant,
}

/// A camera on a thread of its own.
///
/// The thread ends with the camera, or at its next picture after the pump is dropped. One that waits
/// for a picture that never comes is left waiting.
#[derive(Debug)]
pub struct FramePump {
    captured: Receiver<Captured>,
    used: Sender<Frame>,
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
        let run = move || pump(camera, size, &sender, &unused);
        thread::Builder::new().name("camera".into()).spawn(run)?;
        Ok(Self { captured, used })
    }

    /// The next picture: none if there is none within `timeout`.
    pub fn next(&self, timeout: Duration) -> Option<Captured> {
        match self.captured.recv_timeout(timeout) {
            Ok(captured) => Some(captured),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => Some(Captured {
                frame: Err(CameraError::Failed("the camera's thread has ended".into())),
                at: Instant::now(),
            }),
        }
    }

    /// Gives a frame back to be filled again.
    pub fn give_back(&self, frame: Frame) {
        // Where the camera has ended, nobody needs it.
        let _ = self.used.send(frame);
    }
}

fn pump(
    mut camera: impl Camera,
    (width, height): (usize, usize),
    sender: &SyncSender<Captured>,
    unused: &Receiver<Frame>,
) {
    loop {
        let mut frame = (unused.try_recv()).unwrap_or_else(|_| Frame::black(width, height));
        let frame = camera.capture(&mut frame).map(|()| frame);
        let goes_on = frame.as_ref().err().is_none_or(CameraError::may_pass);
        let at = Instant::now();
        if sender.send(Captured { frame, at }).is_err() || !goes_on {
            return;
        }
    }
}
