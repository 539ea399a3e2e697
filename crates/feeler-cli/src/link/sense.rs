//! `feeler sense --publish`: what one finger feels, for the hand program.

use super::{Refusals, expected};
use crate::CommandError;
use crate::sense::output::{FrameReadings, Output};
use crate::sense::sensor::{self, SensorOf};
use crate::sense::source::Source;
use crate::sense::tally::Tally;
use crate::sense::{Arguments, close, is_raised};
use feeler::control::flags::FlagAnalyzer;
use feeler::control::touch::FingerTouch;
use feeler::sensor::camera::CameraError;
use feeler::sensor::frame::{Frame, Picture};
use feeler::sensor::reading::NO_FORCE;
use feeler::sensor::sensing::{ElementReading, Sensing};
use feeler_lab::config::{Experiment, Sensing as SensingBy};
use feeler_link::beacon::Beacon;
use feeler_link::inbox::{Inbox, listen};
use feeler_link::message::{Header, Heartbeat, ProgramKind, TactileUpdate};
use feeler_link::network::Network;
use feeler_link::outlet::{Clock, draw_instance, header, monotonic, send};
use feeler_link::sense_inbox::{Exposed, SenseInbox};
use feeler_link::shared::Shared;
use feeler_link::topic::Topic;
use feeler_sources::pump::{Captured, FramePump};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// How long to wait for a picture before looking whether to stop.
const WAIT: Duration = Duration::from_millis(50);

/// Pictures between two reports of how it goes.
const REPORT_FRAMES: u64 = 25;

/// The sensor program of one finger.
struct Program<'a> {
    finger: usize,
    sensing: Sensing,
    readings: Vec<ElementReading>,
    touch: FingerTouch,
    analyzer: FlagAnalyzer,
    slip_threshold: f64,
    inbox: Shared<SenseInbox>,
    network: Arc<dyn Network>,
    beacon: Arc<Beacon>,
    clock: Clock,
    instance: u64,
    output: Option<Box<dyn Output>>,
    tally: &'a mut Tally,
    refusals: Refusals,
    /// Number and time (s) of the last report.
    reported: (u64, f64),
}

/// Senses what `source` delivers and publishes it, until it ends or `stop` is raised.
pub fn publish(
    arguments: &Arguments,
    source: &Source,
    tally: &mut Tally,
    stop: &AtomicBool,
) -> Result<(), CommandError> {
    let settings = arguments.values.settings();
    let experiment = Experiment::load(&arguments.experiment, &settings)?;
    let finger = arguments.finger.unwrap_or(0);
    experiment.fingertip(Some(finger))?;
    let mut program = Program::new(arguments, &experiment, finger, tally)?;
    let ended = match source {
        Source::Rig => program.sense_rig(&experiment, stop),
        source => program.sense_camera(arguments, source, stop),
    };
    let Program { output, tally, .. } = program;
    match output {
        Some(output) => close(output, tally, ended, source.is_stream() || !is_raised(stop)),
        None => {
            tally.close();
            ended
        }
    }
}

impl<'a> Program<'a> {
    fn new(
        arguments: &Arguments,
        experiment: &Experiment,
        finger: usize,
        tally: &'a mut Tally,
    ) -> Result<Self, CommandError> {
        let SensorOf { sensing, sha256 } = sensor::for_the_hand(arguments, experiment, finger)?;
        let (elements, size) = (sensing.element_count(), sensing.picture_size());
        let inbox = SenseInbox::new((finger, elements), size, expected(experiment)?);
        let (inbox, clock) = (Shared::new(inbox), monotonic());
        let output = match arguments.output {
            Some(_) => Some(arguments.open_output(true)?),
            None => None,
        };
        let rig = arguments.values.rig(experiment);
        let network = arguments.link.open(&rig, false)?;
        let instance = draw_instance();
        let heartbeat = Heartbeat {
            instance,
            program: ProgramKind::Sense,
            finger: finger as u32,
            experiment: experiment.sha256(),
            fingertip: sha256,
            age: f64::NAN,
            ..Heartbeat::default()
        };
        let beacon = Arc::new(Beacon::start(network.clone(), heartbeat)?);
        let topics = [
            Topic::Heartbeat,
            Topic::Mode,
            Topic::Picture(finger),
            Topic::DirectForces(finger),
        ];
        listen(&*network, &topics, &inbox, &clock, &beacon)?;
        let thresholds = experiment.config.control.thresholds();
        Ok(Self {
            finger,
            readings: vec![ElementReading::default(); elements],
            touch: FingerTouch::none(elements),
            analyzer: FlagAnalyzer::new(thresholds, elements),
            slip_threshold: thresholds.slip_threshold,
            sensing,
            inbox,
            network,
            beacon,
            clock,
            instance,
            output,
            tally,
            refusals: Refusals::default(),
            reported: (0, 0.0),
        })
    }

    /// Senses the pictures of a rig in another program.
    fn sense_rig(
        &mut self,
        experiment: &Experiment,
        stop: &AtomicBool,
    ) -> Result<(), CommandError> {
        let pictures = experiment.config.sensing == SensingBy::Image;
        while !is_raised(stop) {
            let mut next = None;
            self.inbox.wait_for(WAIT, |inbox| {
                next = inbox.take_next();
                next.is_some()
            });
            self.complain()?;
            let Some(exposed) = next else { continue };
            let at = Instant::now();
            let (header, number) = exposed.header();
            match exposed {
                Exposed::Picture(picture) if pictures => {
                    let picture = Picture {
                        width: picture.width as usize,
                        height: picture.height as usize,
                        pixels: picture.pixels,
                    };
                    self.sensing.sense(&picture, &mut self.readings)?;
                }
                Exposed::Forces(forces) if !pictures => {
                    for (reading, &force) in self.readings.iter_mut().zip(&forces.forces) {
                        reading.force = Some(force.into());
                    }
                }
                _ => continue,
            }
            self.tell(header, number, at)?;
        }
        Ok(())
    }

    /// Senses the pictures of a camera, or of files in its stead.
    fn sense_camera(
        &mut self,
        arguments: &Arguments,
        source: &Source,
        stop: &AtomicBool,
    ) -> Result<(), CommandError> {
        let size = self.sensing.picture_size();
        let pump = FramePump::start(source.camera(arguments, size)?, size)?;
        while !is_raised(stop) {
            self.complain()?;
            let Some(Captured { frame, at }) = pump.next(WAIT) else {
                continue;
            };
            match frame {
                Ok(frame) => {
                    self.sensing.sense(&frame.picture, &mut self.readings)?;
                    let header = self.header_of(&frame, at);
                    self.tell(header, frame.sequence, at)?;
                    pump.give_back(frame);
                }
                Err(error @ CameraError::Unreadable { .. }) => self.tally.skip(&error.to_string()),
                Err(CameraError::Ended { .. }) => return Ok(()),
                Err(error) => return Err(error.into()),
            }
        }
        Ok(())
    }

    /// The header of what a `frame` that came in at `at` says.
    fn header_of(&self, frame: &Frame, at: Instant) -> Header {
        let came = (self.clock)() - at.elapsed().as_secs_f64();
        let echo = self.inbox.lock().echo_at(came);
        Header {
            echo_step: echo.step,
            echo_age: came - echo.arrived,
            // From 1, as everywhere.
            ..header(self.instance, frame.sequence + 1, frame.stamp)
        }
    }

    /// Raises flags on the newest readings, publishes and writes them. They are those of picture `number`,
    /// which came in at `at`.
    fn tell(&mut self, taken: Header, number: u64, at: Instant) -> Result<(), CommandError> {
        let frame = &mut self.touch.frame;
        for (force, reading) in frame.forces.iter_mut().zip(&self.readings) {
            *force = reading.force.unwrap_or(NO_FORCE);
        }
        (frame.sequence, frame.stamp) = (number, taken.stamp);
        self.touch.analyze(&mut self.analyzer);
        let header = Header {
            instance: self.instance,
            ..taken
        };
        let update = TactileUpdate::of_touch(header, self.finger, &self.touch, self.slip_threshold);
        send(&*self.network, Topic::Tactile(self.finger), &update)?;
        if let Some(output) = &mut self.output {
            output.write(&FrameReadings {
                sequence: number,
                stamp: taken.stamp,
                readings: &self.readings,
            })?;
        }
        self.tally.frame(taken.sequence, at, &self.readings);
        if self.tally.frames().is_multiple_of(REPORT_FRAMES) {
            self.report(at);
        }
        Ok(())
    }

    /// Ends where a hand does not agree with this program: what is sensed would be refused.
    fn complain(&mut self) -> Result<(), CommandError> {
        let (refused, has_hand) = {
            let (inbox, now) = (self.inbox.lock(), (self.clock)());
            let refused = self.refusals.new_peers(inbox.peers());
            let has_hand = inbox.peers().taken(ProgramKind::Hand, now).next().is_some();
            (refused, has_hand)
        };
        for (program, mismatch) in refused {
            if program == ProgramKind::Hand && !has_hand && mismatch.is_final() {
                return Err(mismatch.into());
            }
            self.tally.warn(&format!("refused: {mismatch}"));
        }
        Ok(())
    }

    fn report(&mut self, newest: Instant) {
        let (frames, now) = (self.tally.frames(), (self.clock)());
        let rate = (frames - self.reported.0) as f64 / (now - self.reported.1).max(1e-9);
        self.reported = (frames, now);
        let inbox = self.inbox.lock();
        self.beacon.update(|heartbeat| {
            heartbeat.rate = rate;
            heartbeat.age = newest.elapsed().as_secs_f64();
            heartbeat.lost = inbox.lost;
            heartbeat.refused = inbox.rejected.total();
        });
    }
}
