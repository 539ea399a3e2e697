//! What recording costs: all messages of a control step of two 41-element fingers.

#[path = "../tests/support/mod.rs"]
#[allow(dead_code)]
mod support;

use feeler_record::Recorder;

fn main() {
    divan::main();
}

/// 300 control steps, from opening the file to closing it.
#[divan::bench(sample_count = 20)]
fn record_300_control_steps(bencher: divan::Bencher) {
    let path = std::env::temp_dir().join(format!("feeler-bench-{}.mcap", std::process::id()));
    bencher.bench_local(|| {
        let mut recorder = Recorder::create(&path, &support::facts(), "").expect("a file");
        support::write_strokes(&mut recorder, 1).expect("messages");
        recorder.finish(None).expect("an end")
    });
    let _ = std::fs::remove_file(path);
}
