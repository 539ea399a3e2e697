//! Live page of a simulated run.

use super::ServerOptions;
use super::feed::{Feed, Moment, Orders};
use super::server::Server;
use super::source::serve;
use feeler::control::StopReason;
use feeler_console::CommandError;
use feeler_lab::config::Experiment;
use feeler_lab::experiment::live::{LiveRows, write_state};
use feeler_lab::experiment::{Instruments, SimulatedLoop};
use feeler_record::{Felt, RunEnd, RunState};
use std::fmt::Write as _;
use std::io::Write;
use std::sync::Arc;

/// Sender name of a stop by the live page.
const BY: &str = "the live page";

/// Live page of a simulated run.
pub struct LiveRun {
    feed: Arc<Feed>,
    server: Server,
    run: Run,
    /// Readings of the instruments in the latest step.
    instruments: Option<Instruments>,
}

/// Constants needed to build a run's rows.
struct Run {
    rows: LiveRows,
    strokes: u32,
}

impl LiveRun {
    /// Serves the page of a run of `experiment` that is about to start, and prints its address.
    pub fn open(
        experiment: &Experiment,
        options: ServerOptions,
        out: &mut dyn Write,
    ) -> Result<Self, CommandError> {
        let config = &experiment.config;
        let rows = LiveRows::new(config)?;
        let title = format!("{}, seed {}", config.name, config.seed);
        let (feed, server) = serve(&title, &rows, BY, true, options, out)?;
        Ok(Self {
            feed,
            server,
            run: Run {
                rows,
                strokes: config.task.strokes(),
            },
            instruments: None,
        })
    }

    /// Offers the latest step of `control_loop` to the page and executes the page's orders. Returns the rumble and tone
    /// that the page plays, if they have changed. Neither blocks nor allocates.
    pub fn step(
        &mut self,
        control_loop: &mut SimulatedLoop,
        instruments: &Instruments,
    ) -> Option<Felt> {
        self.instruments = Some(*instruments);
        let Orders { stop, resume } = self.feed.orders();
        if resume {
            control_loop.controller_mut().resume();
        }
        // A stop takes precedence over a resume.
        if let Some(by) = stop {
            control_loop
                .controller_mut()
                .stop(StopReason::Requested { by });
        }
        let run = &mut self.run;
        self.feed
            .offer(|moment| run.fill(moment, control_loop, instruments));
        let stamp = control_loop.state().stamp;
        self.feed.felt().map(|felt| Felt { stamp, ..felt })
    }

    /// Sends the final state of `control_loop` and the end of the run to the pages.
    pub fn over(&mut self, control_loop: &SimulatedLoop, end: &RunEnd) {
        self.feed.offer_last(|moment| {
            if let Some(instruments) = &self.instruments {
                self.run.fill(moment, control_loop, instruments);
            }
            moment.words.clear();
            // Text that does not fit is cut off.
            let _ = write_end(moment, end);
        });
    }

    /// Waits up to two seconds until pages have received the end of the run, or the error with which it `failed`.
    pub fn leave(self, failed: Option<&CommandError>) {
        if let Some(error) = failed {
            self.feed.offer_last(|moment| {
                if !moment.over {
                    moment.words.clear();
                    let _ = write!(moment.words, "The run failed: {error}.");
                }
            });
        }
        self.server.wait_for_last();
    }
}

impl Run {
    fn fill(&mut self, moment: &mut Moment, control_loop: &SimulatedLoop, at: &Instruments) {
        let controller = control_loop.controller();
        moment.stopped = controller.stop_reason().is_some();
        moment.words.clear();
        // Text that does not fit is cut off.
        let _ = write_state(&mut moment.words, controller, self.strokes);
        moment.time = control_loop.state().stamp;
        self.rows.write(&mut moment.numbers, control_loop, at);
    }
}

/// Writes the end of a run as text.
fn write_end(moment: &mut Moment, end: &RunEnd) -> std::fmt::Result {
    match (end.state, &end.reason) {
        (RunState::Done, _) => write!(moment.words, "The task is done."),
        (state, None) => write!(moment.words, "The run was {state}."),
        (state, Some(reason)) => write!(moment.words, "The run was {state}: {reason}."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use assert_no_alloc::assert_no_alloc;
    use feeler::pace::FreeRunning;
    use feeler_lab::config::BUILT_IN;
    use feeler_lab::experiment::Session;
    use std::convert::Infallible;
    use std::ops::ControlFlow;
    use std::sync::atomic::AtomicBool;

    const OPTIONS: ServerOptions = ServerOptions {
        port: 0,
        open: false,
    };

    /// Runs all built-in experiments while a page reads every step and stops the hand at times.
    #[test]
    fn handing_a_step_to_the_page_does_not_allocate() {
        for built_in in BUILT_IN {
            let settings = ["sensing=\"direct\"".to_string()];
            let experiment = Experiment::load(built_in.name, &settings).expect("an experiment");
            let mut session = Session::new(&experiment).expect("a session");
            let page = LiveRun::open(&experiment, OPTIONS, &mut Vec::new());
            let mut page = page.expect("a page");
            let feed = Arc::clone(&page.feed);
            let (mut step, mut whole, mut stopped, mut played) = (0, 0, 0, 0);
            let ran = session.run(
                &mut FreeRunning::default(),
                &AtomicBool::new(false),
                |control_loop, at, _| {
                    step += 1;
                    match step % 300 {
                        100 => feed.stop(BY),
                        // Resuming frees the stop reason's memory, but the hand stands still then.
                        110 => control_loop.controller_mut().resume(),
                        _ => {}
                    }
                    feed.want();
                    feed.play(Felt::SILENT);
                    let felt = assert_no_alloc(|| page.step(control_loop, at));
                    played += usize::from(felt.is_some());
                    feed.take(|moment| {
                        whole += usize::from(moment.numbers.len() == feed.width());
                        stopped += usize::from(moment.stopped);
                    });
                    ControlFlow::<Infallible>::Continue(())
                },
            );
            ran.expect("a run");
            // The server takes some of the states, and looks at the rumble at times.
            assert!(whole > step / 2, "{}: {whole} of {step}", built_in.name);
            assert!(played > step / 2, "{}: {played} of {step}", built_in.name);
            assert!(stopped > 0, "{}", built_in.name);
        }
    }
}
