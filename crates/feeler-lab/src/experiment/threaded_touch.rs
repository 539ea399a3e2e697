//! Sensors that are read on threads of their own, side by side.

use super::Sensor;
use feeler::control::touch::{FingerTouch, TouchSource};
use feeler::sensor::frame::Frame;
use feeler::sensor::reading::SensorError;
use std::hint::spin_loop;
use std::io;
use std::sync::mpsc::{Receiver, RecvError, SyncSender, TryRecvError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// How long who waits looks again and again before it falls asleep: to be woken takes longer than most of what is waited for here.
const LOOKING: Duration = Duration::from_micros(100);

/// A sensor that is read on a thread of its own from when a step [begins](TouchSource::begin). It says what it would say without.
///
/// Sensor and touch go to the thread and come back, so that nothing is shared.
pub(super) struct ThreadedTouch {
    /// `None` while the thread has it.
    idle: Option<Reading>,
    elements: usize,
    to_thread: SyncSender<Reading>,
    from_thread: Receiver<(Reading, Result<(), SensorError>)>,
}

struct Reading {
    sensor: Sensor,
    touch: FingerTouch,
}

impl ThreadedTouch {
    /// What `sensor` says.
    ///
    /// # Errors
    /// When the system gives no thread.
    pub fn new(sensor: Sensor) -> io::Result<Self> {
        let (to_thread, work) = sync_channel::<Reading>(1);
        let (done, from_thread) = sync_channel(1);
        thread::Builder::new()
            .name("sensor".into())
            .spawn(move || {
                // Until all that it works for is dropped.
                while let Ok(mut reading) = receive(&work) {
                    let result = reading.sensor.touch(&mut reading.touch);
                    if done.send((reading, result)).is_err() {
                        return;
                    }
                }
            })?;
        let elements = sensor.element_count();
        let touch = FingerTouch::none(elements);
        Ok(Self {
            idle: Some(Reading { sensor, touch }),
            elements,
            to_thread,
            from_thread,
        })
    }
}

impl TouchSource for ThreadedTouch {
    fn element_count(&self) -> usize {
        self.elements
    }

    fn begin(&mut self) {
        if let Some(reading) = self.idle.take() {
            // A thread that has ended is noticed when its answer is asked for.
            let _ = self.to_thread.send(reading);
        }
    }

    fn touch(&mut self, touch: &mut FingerTouch) -> Result<(), SensorError> {
        let actual = touch.frame.forces.len();
        if actual != self.elements {
            let expected = self.elements;
            return Err(SensorError::ElementCount { expected, actual });
        }
        self.begin();
        let ended = |_| SensorError::Failed("its thread has ended".into());
        let (reading, result) = receive(&self.from_thread).map_err(ended)?;
        if result.is_ok() {
            touch.copy_from(&reading.touch);
        }
        self.idle = Some(reading);
        result
    }

    fn frame(&self) -> Option<&Frame> {
        self.idle.as_ref()?.sensor.frame()
    }
}

/// What comes through `channel`, waited for awake at first.
fn receive<T>(channel: &Receiver<T>) -> Result<T, RecvError> {
    let began = Instant::now();
    while began.elapsed() < LOOKING {
        match channel.try_recv() {
            Ok(received) => return Ok(received),
            Err(TryRecvError::Disconnected) => return Err(RecvError),
            Err(TryRecvError::Empty) => spin_loop(),
        }
    }
    channel.recv()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feels the next number when it is asked, but the same again whenever that is even; fails at the fifth, ends its thread at the sixth.
    struct Counting(u64);

    impl TouchSource for Counting {
        fn element_count(&self) -> usize {
            2
        }

        fn touch(&mut self, touch: &mut FingerTouch) -> Result<(), SensorError> {
            self.0 += 1;
            match self.0 {
                5 => return Err(SensorError::Failed("the fifth".into())),
                6 => panic!("the sixth"),
                asked if asked % 2 == 1 => touch.frame.sequence = asked,
                _ => {}
            }
            Ok(())
        }
    }

    #[test]
    fn a_sensor_on_a_thread_says_what_it_says_without() {
        let mut threaded = ThreadedTouch::new(Box::new(Counting(0))).expect("a thread");
        let mut touch = FingerTouch::none(threaded.element_count());
        for expected in [1, 1, 3, 3] {
            // Whether it was told beforehand or not.
            if expected == 1 {
                threaded.begin();
            }
            threaded.touch(&mut touch).expect("a touch");
            assert_eq!(touch.frame.sequence, expected);
        }
        let mut said = || {
            threaded
                .touch(&mut touch)
                .expect_err("no touch")
                .to_string()
        };
        assert!(said().contains("the fifth"));
        assert!(said().contains("ended"));
        assert!(said().contains("ended"));
    }

    #[test]
    fn a_touch_of_another_finger_is_refused() {
        let mut threaded = ThreadedTouch::new(Box::new(Counting(0))).expect("a thread");
        let refused = threaded.touch(&mut FingerTouch::none(3));
        assert!(matches!(
            refused,
            Err(SensorError::ElementCount {
                expected: 2,
                actual: 3
            })
        ));
    }
}
