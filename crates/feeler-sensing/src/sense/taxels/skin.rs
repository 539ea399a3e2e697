//! Reads a skin on a serial port on a background thread. Pressing Enter measures the zero again.

use super::pump::{Event, RowPump};
use feeler::sensor::forces::{TactileFrame, TactileSensor};
use feeler_console::CommandError;
use feeler_sources::skin::{SkinNews, SkinSensor};
use std::io::{BufRead, stdin};
use std::iter;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, SyncSender};
use std::thread;
use std::time::Instant;

/// Message after each measurement of the zero.
const HAS_ZERO: &str =
    "the zero is measured; press Enter to measure it again while the skin is untouched";

/// Starts reading `sensor`.
pub fn start(sensor: SkinSensor) -> Result<RowPump, CommandError> {
    let wants_zero = Arc::new(AtomicBool::new(false));
    if may_read_input() {
        let wants_zero = Arc::clone(&wants_zero);
        let listen = move || {
            for _line in stdin().lock().lines().map_while(Result::ok) {
                wants_zero.store(true, Ordering::Relaxed);
            }
        };
        thread::Builder::new()
            .name("zero key".into())
            .spawn(listen)?;
    }
    RowPump::spawn(move |sender, unused| {
        let ended = read_all(sensor, &wants_zero, sender, unused);
        ended.err().map(|error| Event::Failed(error.to_string()))
    })
}

/// Returns `true` unless reading standard input would suspend the program, because it runs in the background of a terminal.
fn may_read_input() -> bool {
    #[cfg(unix)]
    if rustix::termios::isatty(stdin()) {
        let foreground = rustix::termios::tcgetpgrp(stdin());
        return foreground.is_ok_and(|group| group == rustix::process::getpgrp());
    }
    true
}

/// Reads until the receiver is dropped.
fn read_all(
    mut sensor: SkinSensor,
    wants_zero: &AtomicBool,
    sender: &SyncSender<Event>,
    unused: &Receiver<TactileFrame>,
) -> Result<(), CommandError> {
    let elements = sensor.element_count();
    let mut zeros = 0_u64;
    let mut has_zero = false;
    loop {
        if wants_zero.swap(false, Ordering::Relaxed) {
            sensor.zero();
            zeros += 1;
            let begins = Event::Sequence(format!("zero {zeros}"));
            if sender.send(begins).is_err() {
                return Ok(());
            }
        }
        let new = || TactileFrame::unloaded(elements);
        let mut frame = unused.try_recv().unwrap_or_else(|_| new());
        sensor.read(&mut frame)?;
        let at = Instant::now();
        let news = sensor.take_news().map(in_words);
        let had_zero = std::mem::replace(&mut has_zero, sensor.has_zero());
        let zero = (has_zero && !had_zero).then(|| Event::Note(HAS_ZERO.into()));
        let frame = iter::once(Event::Frame { frame, at });
        for event in frame.chain(news).chain(zero) {
            if sender.send(event).is_err() {
                return Ok(());
            }
        }
    }
}

fn in_words(news: SkinNews) -> Event {
    match news {
        SkinNews::Disconnected(reason) => Event::TableProblem(format!(
            "the skin is disconnected ({reason}); forces are unknown until it is connected again"
        )),
        SkinNews::Reconnected => Event::Note("the skin is connected again; its zero is kept".into()),
        SkinNews::Silent => Event::TableProblem(
            "the skin sends no frames; check its power, its baud rate and the layout's number of taxels"
                .into(),
        ),
    }
}
