//! Tactile sensors that are read concurrently on background threads.

use crate::experiment::Sensor;
use feeler::control::{TactileReading, TactileSource};
use feeler::sensor::forces::SensorError;
use feeler::sensor::image::Frame;
use std::hint::spin_loop;
use std::sync::mpsc::{Receiver, RecvError, SyncSender, TryRecvError, sync_channel};
use std::time::{Duration, Instant};
use std::{io, thread};

/// Duration of spinning before a waiting thread sleeps. Most waits here are shorter than waking a thread.
const LOOKING: Duration = Duration::from_micros(100);

/// A tactile sensor that is read on a background thread as soon as a step [begins](TactileSource::begin). The readings
/// are identical to synchronous ones.
///
/// Sensor and reading are moved to the thread and back, so no state is shared.
pub(super) struct PrefetchingSensor {
    /// The sensor and its reading, or `None` while the thread uses them.
    idle: Option<Reading>,
    elements: usize,
    to_thread: SyncSender<Reading>,
    from_thread: Receiver<(Reading, Result<(), SensorError>)>,
}

struct Reading {
    sensor: Sensor,
    touch: TactileReading,
}

impl PrefetchingSensor {
    /// Starts a thread that reads `sensor`.
    ///
    /// # Errors
    /// If the system cannot create a thread.
    pub fn new(sensor: Sensor) -> io::Result<Self> {
        let (to_thread, work) = sync_channel::<Reading>(1);
        let (done, from_thread) = sync_channel(1);
        thread::Builder::new()
            .name("sensor".into())
            .spawn(move || {
                // Ends when the owner is dropped.
                while let Ok(mut reading) = receive(&work) {
                    let result = reading.sensor.touch(&mut reading.touch);
                    if done.send((reading, result)).is_err() {
                        return;
                    }
                }
            })?;
        let elements = sensor.element_count();
        let touch = TactileReading::none(elements);
        Ok(Self {
            idle: Some(Reading { sensor, touch }),
            elements,
            to_thread,
            from_thread,
        })
    }
}

impl TactileSource for PrefetchingSensor {
    fn element_count(&self) -> usize {
        self.elements
    }

    fn begin(&mut self) {
        if let Some(reading) = self.idle.take() {
            // A failed send is detected on the next receive.
            let _ = self.to_thread.send(reading);
        }
    }

    fn touch(&mut self, touch: &mut TactileReading) -> Result<(), SensorError> {
        touch.frame.check_elements(self.elements)?;
        self.begin();
        let ended = |_| SensorError::Failed("the sensor thread has ended".into());
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

/// Receives from `channel`, spinning at first.
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

    /// Returns the next number on each read, but repeats even numbers; fails at the fifth read, and ends its thread
    /// at the sixth.
    struct Counting(u64);

    impl TactileSource for Counting {
        fn element_count(&self) -> usize {
            2
        }

        fn touch(&mut self, touch: &mut TactileReading) -> Result<(), SensorError> {
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
    fn background_readings_equal_synchronous_ones() {
        let mut threaded = PrefetchingSensor::new(Box::new(Counting(0))).expect("a thread");
        let mut touch = TactileReading::none(threaded.element_count());
        for expected in [1, 1, 3, 3] {
            // With and without a preceding `begin`.
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
    fn a_buffer_of_another_size_is_rejected() {
        let mut threaded = PrefetchingSensor::new(Box::new(Counting(0))).expect("a thread");
        let refused = threaded.touch(&mut TactileReading::none(3));
        assert!(matches!(
            refused,
            Err(SensorError::ElementCount {
                expected: 2,
                actual: 3
            })
        ));
    }
}
