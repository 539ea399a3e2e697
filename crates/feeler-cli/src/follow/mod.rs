//! The `feeler follow` subcommand: moves a hand at the velocities that another program requests.

mod board;
mod protocol;

use crate::experiments::run::make_folder;
use crate::experiments::throttle::Throttle;
use crate::link::hand::{self, run_hand};
use crate::options::parse_between;
use crate::{CommandError, Outcome};
use board::Board;
use feeler::control::task::follow::Requests;
use feeler_console::watch_for_interrupt;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::recorded_run::{RecordedRun, record_options};
use feeler_lab::experiment::rigs::linked::following_program;
use feeler_lab::experiment::{Session, following_facts, geometries, layouts};
use feeler_link::programs::RigSpeed;
use feeler_rig::print_outcome;
use serde_json::Value;
use std::io::{BufRead, Write, stderr, stdin};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread::{self, ScopedJoinHandle};
use std::time::{Duration, Instant};

#[derive(Debug, clap::Args)]
// Otherwise the name of the flattened structure, too.
#[group(id = "follow")]
pub struct Arguments {
    #[command(flatten)]
    hand: hand::Arguments,
    /// Simulate the rig in this process instead of waiting for other programs.
    #[arg(long)]
    simulated: bool,
    /// Time after which a request expires, and the fingers stand still (s).
    #[arg(long, value_name = "SECONDS", default_value = "0.2", value_parser = parse_lifetime)]
    lifetime: f64,
    /// Print the description of the hand and exit.
    #[arg(long)]
    describe: bool,
}

fn parse_lifetime(text: &str) -> Result<f64, String> {
    parse_between(text, 0.01, 5.0, "s")
}

/// Interval at which the end of the control loop is checked while there are no requests.
const CHECK_INTERVAL: Duration = Duration::from_millis(50);
/// Maximum time that a request waits for a control step.
const STEP_TIMEOUT: Duration = Duration::from_secs(1);
/// Time that a hand has to end its task before it is interrupted.
const END_TIMEOUT: Duration = Duration::from_secs(1);

/// Moves a hand at the velocities that another program writes to standard input, until the input ends, and answers each
/// line with the hand's readings. Messages for people go to standard error.
pub fn follow(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let experiment = arguments.hand.experiment()?;
    if let Some(option) = arguments
        .hand
        .linking_option()
        .filter(|_| arguments.simulated)
    {
        return Err(format!("{option}: has no effect with --simulated").into());
    }
    let config = &experiment.config;
    let (fingers, layouts) = (geometries(config)?, layouts(config)?);
    let elements: Vec<_> = layouts.iter().map(|layout| layout.elements.len()).collect();
    let description = protocol::description(config, &fingers, &elements, arguments.lifetime);
    // The interrupt handler is installed before the first output, because another program may respond to it with an
    // interrupt. A simulated run then still has a report.
    let interrupted = watch_for_interrupt()?;
    answer(out, &description)?;
    if arguments.describe {
        return Ok(Outcome::Done);
    }
    let joints: Vec<_> = fingers.iter().map(|finger| finger.joint_count()).collect();
    let following = Following {
        arguments,
        interrupted: &interrupted,
        requests: Requests::default(),
        board: Board::default(),
    };
    let lines = lines();
    thread::scope(|scope| {
        let control = scope.spawn(|| following.control().map_err(|error| error.to_string()));
        let served = following.serve(&lines, &joints, &control, out);
        following.end(&control);
        let ended = control.join();
        let ended = ended.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        served?;
        Ok(ended?)
    })
}

/// Lines of standard input, from a thread that waits for them. The channel closes at the end of the input.
fn lines() -> Receiver<String> {
    let (sender, lines) = sync_channel(1);
    thread::spawn(move || {
        for line in stdin().lock().lines().map_while(Result::ok) {
            if sender.send(line).is_err() {
                return;
            }
        }
    });
    lines
}

fn answer(out: &mut dyn Write, answer: &Value) -> std::io::Result<()> {
    writeln!(out, "{answer}")?;
    out.flush()
}

/// State shared by the control loop's thread and the thread that answers requests.
struct Following<'a> {
    arguments: &'a Arguments,
    interrupted: &'a AtomicBool,
    requests: Requests,
    board: Board,
}

/// Thread of the control loop.
type Control<'s> = ScopedJoinHandle<'s, Result<Outcome, String>>;

impl Following<'_> {
    /// Runs the hand until its task ends or it is interrupted.
    fn control(&self) -> Result<Outcome, CommandError> {
        let Arguments { hand, lifetime, .. } = self.arguments;
        if self.arguments.simulated {
            return self.simulate();
        }
        run_hand(
            hand,
            self.interrupted,
            &mut stderr(),
            |experiment, speed, network| {
                let facts = following_facts(&experiment.config)?;
                let program =
                    following_program(experiment, &self.requests, *lifetime, speed, network)?;
                Ok((program, facts))
            },
            |control_loop| self.board.update(control_loop, &self.requests),
        )
    }

    fn simulate(&self) -> Result<Outcome, CommandError> {
        let Arguments { hand, lifetime, .. } = self.arguments;
        let experiment: Experiment = hand.experiment()?;
        let options = record_options(&experiment, false)?;
        let session = Session::following(&experiment, &self.requests, *lifetime)?;
        let folder = make_folder(hand.out.as_deref(), &experiment, None)?;
        let run = RecordedRun::of_session(session, &experiment, &options, &folder)?;
        let speed = match hand.speed {
            RigSpeed::Times(times) => times,
            RigSpeed::Lockstep => f64::INFINITY,
        };
        let mut pace = Throttle::new(experiment.config.control.period, speed);
        let run = run.keeping_time();
        let ran = run.run(&mut pace, self.interrupted, |control_loop, _, _| {
            self.board.update(control_loop, &self.requests);
            None
        })?;
        print_outcome(&ran.report, &mut stderr())?;
        Ok(Outcome::from(&ran.end))
    }

    /// Answers requests until the input or the control loop ends.
    fn serve(
        &self,
        lines: &Receiver<String>,
        joints: &[usize],
        control: &Control<'_>,
        out: &mut dyn Write,
    ) -> std::io::Result<()> {
        while !control.is_finished() {
            match lines.recv_timeout(CHECK_INTERVAL) {
                Ok(line) => answer(out, &self.execute(&line, joints))?,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
        }
        Ok(())
    }

    fn execute(&self, line: &str, joints: &[usize]) -> Value {
        let request = match protocol::decode(line, joints) {
            Ok(request) => request,
            Err(reason) => return protocol::error(&reason),
        };
        let Some(latest) = self.board.latest() else {
            return protocol::waiting();
        };
        let velocities = match request {
            // A stopped hand follows no request, also not after it resumes.
            Some(velocities) if latest.stopped.is_none() => velocities,
            _ => return protocol::readings(&latest),
        };
        let number = self.requests.request(velocities);
        match self.board.wait_for(number, STEP_TIMEOUT) {
            Some(after) if after.followed >= number || after.stopped.is_some() => {
                protocol::readings(&after)
            }
            _ => {
                let limit = STEP_TIMEOUT.as_secs();
                protocol::error(&format!("the hand made no control step within {limit} s"))
            }
        }
    }

    /// Ends the control loop: through its task, so that the run counts as complete, otherwise with an interrupt.
    fn end(&self, control: &Control<'_>) {
        let latest = self.board.latest();
        let can_end = latest.is_some_and(|latest| latest.stopped.is_none());
        self.requests.end();
        let patience = if can_end { END_TIMEOUT } else { Duration::ZERO };
        let start = Instant::now();
        while !control.is_finished() && start.elapsed() < patience {
            thread::sleep(Duration::from_millis(5));
        }
        self.interrupted.store(true, Ordering::Relaxed);
    }
}
