//! Programs that run beside the test, and never longer than it.

use crate::program::Ended;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Arc, Condvar, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// After so long a test is taken to hang.
const GIVE_UP: Duration = Duration::from_secs(120);

/// Lines that a program has written so far, and whether it has closed the stream.
#[derive(Default)]
struct Said(Mutex<(Vec<String>, bool)>, Condvar);

/// A running program. It is killed when this is dropped.
pub struct Process {
    child: Child,
    out: Arc<Said>,
    errors: Arc<Said>,
    readers: Vec<JoinHandle<()>>,
}

impl Process {
    pub fn start(mut command: Command) -> Self {
        let piped = command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = piped.spawn().expect("the program starts");
        let (out, errors) = (Arc::default(), Arc::default());
        let readers = vec![
            read(child.stdout.take().expect("a pipe"), &out),
            read(child.stderr.take().expect("a pipe"), &errors),
        ];
        Self {
            child,
            out,
            errors,
            readers,
        }
    }

    /// Sends the signal called `name`, as in `STOP`.
    pub fn signal(&self, name: &str) {
        let id = self.child.id().to_string();
        let kill = Command::new("kill")
            .args([&format!("-{name}"), &id])
            .status();
        assert!(kill.expect("kill").success(), "kill -{name}");
    }

    /// Waits until `text` stands in its standard output.
    pub fn wait_to_say(&self, text: &str) {
        self.wait_until(&self.out, text, 0);
    }

    /// Waits until `text` stands in a line of its standard error after the first `skip` lines; how many lines
    /// there are up to and with that one.
    pub fn wait_to_warn(&self, text: &str, skip: usize) -> usize {
        self.wait_until(&self.errors, text, skip)
    }

    /// How many lines of its standard error there are.
    pub fn warnings(&self) -> usize {
        self.errors.0.lock().unwrap().0.len()
    }

    /// Whether it has not ended.
    pub fn is_running(&mut self) -> bool {
        self.child.try_wait().expect("the child").is_none()
    }

    fn wait_until(&self, said: &Said, text: &str, skip: usize) -> usize {
        let end = Instant::now() + GIVE_UP;
        let mut lines = said.0.lock().unwrap();
        loop {
            let found = lines.0.iter().skip(skip).position(|l| l.contains(text));
            if let Some(found) = found {
                return skip + found + 1;
            }
            let left = end.saturating_duration_since(Instant::now());
            let over = lines.1 || left.is_zero();
            assert!(!over, "no {text:?} after line {skip} of {:?}", lines.0);
            lines = said.1.wait_timeout(lines, left).unwrap().0;
        }
    }

    /// Waits for its end, however it comes.
    pub fn end(mut self) -> Ended {
        let end = Instant::now() + GIVE_UP;
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("the child") {
                break status;
            }
            assert!(
                Instant::now() < end,
                "it hangs: {:?}",
                self.said(ExitStatus::default())
            );
            thread::sleep(Duration::from_millis(20));
        };
        for reader in self.readers.drain(..) {
            reader.join().expect("text");
        }
        let ended = self.said(status);
        assert!(!ended.stderr.contains("panicked"), "{ended:?}");
        ended
    }

    /// Ends it as Ctrl-C does.
    pub fn interrupt(self) -> Ended {
        self.signal("INT");
        self.end()
    }

    fn said(&self, status: ExitStatus) -> Ended {
        let text = |said: &Said| said.0.lock().unwrap().0.join("\n");
        Ended {
            status: status.code(),
            stdout: text(&self.out),
            stderr: text(&self.errors),
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn read(stream: impl Read + Send + 'static, said: &Arc<Said>) -> JoinHandle<()> {
    let said = Arc::clone(said);
    thread::spawn(move || {
        for line in BufReader::new(stream).lines() {
            said.0.lock().unwrap().0.push(line.expect("text"));
            said.1.notify_all();
        }
        said.0.lock().unwrap().1 = true;
        said.1.notify_all();
    })
}
