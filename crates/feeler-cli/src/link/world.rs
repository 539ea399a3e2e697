//! `feeler world`

mod publish;

use super::{ExperimentArguments, LinkArguments, Refusals, expected};
use crate::interrupt::watch_for_interrupt;
use crate::{CommandError, Outcome};
use feeler::hand::hand::{HandCommand, HandState};
use feeler::pace::Pace;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::played_rig::PlayedRig;
use feeler_link::beacon::Beacon;
use feeler_link::inbox::listen;
use feeler_link::message::{Heartbeat, NO_FINGER, ProgramKind};
use feeler_link::network::Network;
use feeler_link::outlet::{Clock, draw_instance, monotonic};
use feeler_link::rig_inbox::RigInbox;
use feeler_link::shared::Shared;
use feeler_link::topic::Topic;
use std::io::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How long to wait for the hand's answer before all is said again, and before looking whether to stop.
const PATIENCE: Duration = Duration::from_millis(200);

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// The experiment whose rig to play: a file, or the name of a built-in one (see `feeler list`).
    experiment: String,
    /// Seconds of the experiment in a second; `max` waits for the hand's answer to every step instead, and
    /// then the cap closes bit for bit as in `feeler run`.
    #[arg(long, default_value = "1", value_parser = parse_speed)]
    speed: Speed,
    #[command(flatten)]
    values: ExperimentArguments,
    #[command(flatten)]
    link: LinkArguments,
}

/// How fast the world's time goes.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Speed {
    /// So many times as fast as ours.
    Times(f64),
    /// As fast as the hand answers.
    Max,
}

/// Plays the rig until Ctrl-C.
pub fn world(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = Experiment::load(&arguments.experiment, &arguments.values.settings())?;
    let rig = PlayedRig::new(&experiment)?;
    let control = &experiment.config.control;
    let limit = match arguments.speed {
        // What a command takes on its way is no fault of the hand's: it has a period for that.
        Speed::Times(_) => (control.stale_periods + 1.0) * control.period,
        Speed::Max => f64::INFINITY,
    };
    let inbox = RigInbox::new(rig.fingers(), limit, expected(&experiment)?);
    let inbox = Shared::new(inbox);
    let name = arguments.values.rig(&experiment);
    let network = arguments.link.open(&name, false)?;
    let interrupted = watch_for_interrupt()?;
    let mut world = World::new(&experiment, rig, inbox, network, arguments.speed)?;
    writeln!(
        out,
        "playing the rig of {}; Ctrl-C ends it",
        experiment.config.name
    )?;
    out.flush()?;
    match arguments.speed {
        Speed::Max => world.play_in_step(&interrupted)?,
        Speed::Times(speed) => world.play_in_time(speed, &interrupted)?,
    }
    let inbox = world.inbox.lock();
    writeln!(
        out,
        "{:.2} s played; {} periods missed, {} stale commands refused, {} stops by the watchdog, refused: {}",
        world.rig.time(),
        world.missed,
        inbox.stale_commands,
        inbox.watchdog_stops,
        inbox.rejected,
    )?;
    Ok(Outcome::Done)
}

struct World {
    rig: PlayedRig,
    inbox: Shared<RigInbox>,
    network: Arc<dyn Network>,
    beacon: Arc<Beacon>,
    clock: Clock,
    instance: u64,
    sequence: u64,
    state: HandState,
    command: HandCommand,
    /// Each finger's newest picture: its number, and the echo of when it was taken.
    exposed: Vec<(Option<u64>, (u64, f64))>,
    /// Age at which data are stale, s of the rig's time.
    limit: f64,
    period: f64,
    step: f64,
    missed: u64,
    refusals: Refusals,
    fault: String,
    /// Whether the hand is waited for.
    in_step: bool,
    /// The newest messages, to be said again, where the hand is waited for.
    said: Vec<(Topic, Vec<u8>)>,
    /// Sequence number and time (s) of the last report.
    reported: (u64, f64),
}

impl World {
    fn new(
        experiment: &Experiment,
        rig: PlayedRig,
        inbox: Shared<RigInbox>,
        network: Arc<dyn Network>,
        speed: Speed,
    ) -> Result<Self, CommandError> {
        let (control, fingers) = (&experiment.config.control, rig.fingers());
        let instance = draw_instance();
        let heartbeat = Heartbeat {
            instance,
            program: ProgramKind::World,
            finger: NO_FINGER,
            experiment: experiment.sha256(),
            age: f64::NAN,
            speed: match speed {
                Speed::Times(speed) => speed,
                Speed::Max => 0.0,
            },
            ..Heartbeat::default()
        };
        let clock = monotonic();
        let beacon = Arc::new(Beacon::start(network.clone(), heartbeat)?);
        let topics = [Topic::Heartbeat, Topic::Mode, Topic::Command];
        listen(&*network, &topics, &inbox, &clock, &beacon)?;
        Ok(Self {
            rig,
            inbox,
            beacon,
            network,
            clock,
            instance,
            sequence: 0,
            state: HandState::zero(fingers),
            command: HandCommand::stop(fingers),
            exposed: vec![(None, (0, 0.0)); fingers],
            limit: control.stale_periods * control.period,
            period: control.period,
            step: experiment.config.simulation()?.step,
            missed: 0,
            refusals: Refusals::default(),
            fault: String::new(),
            in_step: speed == Speed::Max,
            said: Vec::new(),
            reported: (0, 0.0),
        })
    }

    /// Plays `speed` times as fast as our time, whatever comes of the hand. The rig's time begins with the
    /// hand's first command.
    fn play_in_time(&mut self, speed: f64, stop: &AtomicBool) -> Result<(), CommandError> {
        let watchdog = (self.limit + self.period) / speed;
        let steps = self.rig.steps_per_period();
        let mut pace = Pace::new(self.step / speed)?;
        while !stop.load(Ordering::Relaxed) {
            self.publish()?;
            self.rig.begin_period();
            for _ in 0..steps {
                let Some(tick) = pace.wait_unless(stop) else {
                    return Ok(());
                };
                // The world does not leave steps out: it is late then, and says how much.
                self.missed += tick.missed;
                let now = (self.clock)();
                let mut inbox = self.inbox.lock();
                if !inbox.is_commanded() {
                    continue;
                }
                match inbox.drive(now, watchdog) {
                    Some(velocities) => self.command.relay(velocities),
                    None => self.command.set_to_stop(),
                }
                drop(inbox);
                self.rig.advance(&self.command)?;
                self.tell_time();
            }
        }
        Ok(())
    }

    /// Waits for the hand's answer to every period, and loses none.
    fn play_in_step(&mut self, stop: &AtomicBool) -> Result<(), CommandError> {
        self.publish()?;
        while !stop.load(Ordering::Relaxed) {
            let sequence = self.sequence;
            let answered = |inbox: &mut RigInbox| inbox.has_answered(sequence);
            if !self.inbox.wait_for(PATIENCE, answered) {
                self.say_again()?;
                continue;
            }
            if let Some(velocities) = self.inbox.lock().drive((self.clock)(), f64::INFINITY) {
                self.command.relay(velocities);
            }
            self.rig.begin_period();
            for _ in 0..self.rig.steps_per_period() {
                self.rig.advance(&self.command)?;
            }
            self.tell_time();
            self.publish()?;
        }
        Ok(())
    }

    fn tell_time(&self) {
        self.inbox.lock().time = self.rig.time();
    }
}

fn parse_speed(text: &str) -> Result<Speed, String> {
    if text == "max" {
        return Ok(Speed::Max);
    }
    let speed = text.parse().ok().filter(|s| (0.01..=100.0).contains(s));
    speed
        .map(Speed::Times)
        .ok_or_else(|| "expected 0.01 to 100, or max".into())
}
