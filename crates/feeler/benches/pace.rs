//! Punctuality of a loop at 1 kHz, without and with the requests of `real_time`.
//!
//! The jitter is that of the machine, so run this on an idle one.

use feeler::pace::real_time::{self, Refusal};
use feeler::pace::{FixedRate, PaceError, Punctuality, PunctualitySummary};
use std::thread;

/// Control period (s).
const PERIOD: f64 = 1e-3;
const STEPS: u64 = 10_000;

/// Real-time requests made before the steps.
type Requests = &'static [fn() -> Result<(), Refusal>];

fn main() {
    if let Ok(load) = std::fs::read_to_string("/proc/loadavg") {
        println!("load average before: {}", load.trim());
    }
    println!("10 s at 1 kHz, lateness in us: median, 99 %, largest; periods missed");
    measure("as the system is", &[]);
    measure("fine timer", &[real_time::fine_timer]);
    // Last, because memory is locked for the process and not for a thread.
    let real_time: Requests = &[
        || real_time::raise_priority(real_time::MODERATE),
        real_time::lock_memory,
    ];
    measure("real-time priority, memory locked", real_time);
}

/// Prints one row of the table. Runs on a separate thread, so that thread settings do not affect other rows.
fn measure(name: &str, requests: Requests) {
    let measured = thread::spawn(move || {
        let mut granted = true;
        for refusal in requests.iter().filter_map(|request| request().err()) {
            println!("refused: {refusal}");
            granted = false;
        }
        run().map(|summary| (summary, granted))
    });
    match measured.join() {
        Ok(Ok((summary, true))) => print_row(name, &summary),
        Ok(Ok((summary, false))) => print_row("not all granted", &summary),
        Ok(Err(error)) => println!("{name}: {error}"),
        Err(_) => println!("{name}: the thread panicked"),
    }
}

fn run() -> Result<PunctualitySummary, PaceError> {
    let mut punctuality = Punctuality::new()?;
    let mut pace = FixedRate::new(PERIOD)?;
    loop {
        let tick = pace.wait();
        punctuality.record(&tick);
        if tick.number >= STEPS {
            return Ok(punctuality.summary());
        }
    }
}

fn print_row(name: &str, summary: &PunctualitySummary) {
    let us = |seconds: Option<f64>| seconds.map_or(f64::NAN, |s| s * 1e6);
    println!(
        "{name:<34} {:>8.1} {:>8.1} {:>8.1} {:>6}",
        us(summary.median),
        us(summary.percentile_99),
        us(summary.largest),
        summary.missed
    );
}
