//! Entry: a program that reads a data set on standard input and answers on standard output.

use super::order::Order;
use super::protocol::Question;
use crate::league::data::{DataSet, Fold};
use crate::league::definition::Target;
use std::io::{self, BufRead, BufReader, BufWriter, Read, Write};
use std::mem;
use std::process::{Child, ChildStderr, ChildStdout, Command, ExitStatus, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// Number of bytes of standard error that are shown.
const SHOWN: usize = 400;
/// Maximum time for which the exit status and standard error are awaited after standard output has ended.
const GRACE: Duration = Duration::from_secs(2);

/// Error of a program.
#[derive(Debug, thiserror::Error)]
pub enum ProgramError {
    /// The program cannot be started.
    #[error("cannot be started: {0}")]
    Start(#[from] io::Error),
    /// The program ended early.
    #[error("ended ({status}) after {answered} of {expected} answers{stderr}")]
    Ended {
        /// Exit status.
        status: String,
        /// Number of answers before the end.
        answered: usize,
        /// Expected number of answers.
        expected: usize,
        /// Last part of its standard error.
        stderr: String,
    },
    /// The program exceeded the time limit.
    #[error(
        "gave {answered} of {expected} answers within the limit of {seconds} s for the set; raise --time-limit"
    )]
    TimedOut {
        /// Number of answers before the limit.
        answered: usize,
        /// Expected number of answers.
        expected: usize,
        /// Time limit (s).
        seconds: u64,
    },
    /// An answer is invalid.
    #[error("answer {number}: {problem}")]
    Answer {
        /// Number of the answer, from 1.
        number: usize,
        /// The expected and the actual answer.
        problem: String,
    },
}

/// Predicted values by piece, row and target.
pub type Predictions = Vec<Vec<Vec<f64>>>;

/// Runs `command` in the system's shell, in a new process for each fold, and returns its answers by fold and
/// test piece.
///
/// # Errors
/// If the program cannot be started, ends early, gives an invalid answer, or takes longer than `limit` for all folds.
pub fn run(
    command: &str,
    name: &str,
    set: &DataSet,
    folds: &[Fold],
    targets: &[Target],
    limit: Duration,
) -> Result<Vec<Predictions>, ProgramError> {
    let end = Instant::now() + limit;
    let number = |(number, fold): (usize, &Fold)| {
        let order = Order::of(set, fold);
        let question = Question {
            name,
            set,
            targets,
            fold,
            order: &order,
            number: (number, folds.len()),
        };
        ask(command, &question, end, limit)
    };
    folds.iter().enumerate().map(number).collect()
}

/// Starts the program, sends it a fold, and collects its answers.
fn ask(
    command: &str,
    question: &Question,
    end: Instant,
    limit: Duration,
) -> Result<Predictions, ProgramError> {
    let mut text = Vec::new();
    question.write(&mut text)?;
    let mut running = Running::start(command)?;
    let child = &mut running.0;
    if let Some(stdin) = child.stdin.take() {
        // Ends when everything is read, or the program has ended.
        thread::spawn(move || BufWriter::new(stdin).write_all(&text));
    }
    let errors = child.stderr.take().map(last_of);
    let lines = child
        .stdout
        .take()
        .map(|stdout| lines_of(stdout, question.longest()));
    let count = question.order.test.len();
    let mut answers = vec![Vec::new(); question.fold.test.len()];
    for (number, &piece) in question.order.test.iter().enumerate() {
        let left = end.saturating_duration_since(Instant::now());
        let line = lines
            .as_ref()
            .map_or(Err(RecvTimeoutError::Disconnected), |l| {
                l.recv_timeout(left)
            });
        let text = match line {
            Ok(text) => text,
            Err(RecvTimeoutError::Timeout) => {
                return Err(ProgramError::TimedOut {
                    answered: number,
                    expected: count,
                    seconds: limit.as_secs(),
                });
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(ProgramError::Ended {
                    status: running.status(),
                    answered: number,
                    expected: count,
                    stderr: errors.map_or(String::new(), shown),
                });
            }
        };
        let answer = question.parse(number, &text);
        let number = number + 1;
        answers[piece] = answer.map_err(|problem| ProgramError::Answer { number, problem })?;
    }
    Ok(answers)
}

fn shell(command: &str) -> Command {
    #[cfg(unix)]
    let mut shell = {
        use std::os::unix::process::CommandExt;
        let mut shell = Command::new("sh");
        // A separate group, so that its child processes are ended, too.
        shell.arg("-c").process_group(0);
        shell
    };
    #[cfg(not(unix))]
    let mut shell = {
        let mut shell = Command::new("cmd");
        shell.arg("/C");
        shell
    };
    shell
        .arg(command)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    shell
}

/// Process groups of the running programs.
static GROUPS: Mutex<Vec<u32>> = Mutex::new(Vec::new());

/// A running program, which is killed when dropped.
struct Running(Child);

impl Running {
    /// Starts `command` in the system's shell.
    fn start(command: &str) -> io::Result<Self> {
        // Locked before the start, so that no program is missed.
        let mut groups = lock_groups();
        let child = shell(command).spawn()?;
        groups.push(child.id());
        Ok(Self(child))
    }

    /// Returns the exit status as text, after a short wait.
    fn status(&mut self) -> String {
        let end = Instant::now() + GRACE;
        loop {
            match self.0.try_wait() {
                Ok(Some(status)) => return ExitStatus::to_string(&status),
                Ok(None) if Instant::now() < end => thread::sleep(Duration::from_millis(5)),
                _ => return "its standard output is closed".into(),
            }
        }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        lock_groups().retain(|id| *id != self.0.id());
        kill_group(self.0.id());
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

fn lock_groups() -> MutexGuard<'static, Vec<u32>> {
    GROUPS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Kills all running programs with their child processes; on Unix only. Starting or dropping a program blocks
/// afterwards; call this only before the process ends.
pub fn end_programs() {
    let groups = lock_groups();
    groups.iter().copied().for_each(kill_group);
    mem::forget(groups);
}

/// Kills the process group of a program, if it has not ended. Does nothing on other systems than Unix.
fn kill_group(id: u32) {
    #[cfg(unix)]
    if let Some(group) = i32::try_from(id)
        .ok()
        .and_then(rustix::process::Pid::from_raw)
    {
        let _ = rustix::process::kill_process_group(group, rustix::process::Signal::KILL);
    }
    #[cfg(not(unix))]
    let _ = id;
}

/// Reads lines of at most `longest` bytes on a background thread. A longer line is cut, and is the last one.
fn lines_of(stdout: ChildStdout, longest: usize) -> Receiver<Vec<u8>> {
    let (sender, receiver) = channel();
    thread::spawn(move || {
        let mut stdout = BufReader::new(stdout);
        loop {
            let mut line = Vec::new();
            let read = stdout
                .by_ref()
                .take(longest as u64)
                .read_until(b'\n', &mut line);
            let is_whole = line.ends_with(b"\n");
            if !matches!(read, Ok(1..)) || sender.send(line).is_err() || !is_whole {
                break;
            }
        }
    });
    receiver
}

/// Reads standard error on a background thread, and sends its last part when it is closed.
fn last_of(stderr: ChildStderr) -> Receiver<Vec<u8>> {
    let (sender, receiver) = channel();
    thread::spawn(move || {
        let (mut stderr, mut last, mut block) = (stderr, Vec::new(), [0; 4096]);
        while let Ok(count @ 1..) = stderr.read(&mut block) {
            last.extend_from_slice(&block[..count]);
            let excess = last.len().saturating_sub(SHOWN);
            last.drain(..excess);
        }
        // The receiver may be gone.
        let _ = sender.send(last);
    });
    receiver
}

/// Returns a colon and the last part of standard error, or an empty string if nothing was written to it.
fn shown(errors: Receiver<Vec<u8>>) -> String {
    let last = errors.recv_timeout(GRACE).unwrap_or_default();
    let last = String::from_utf8_lossy(&last);
    match last.trim() {
        "" => String::new(),
        last => format!(": {last}"),
    }
}
