//! The report of a recording four times as long needs no more memory.

use feeler_record::Recorder;
use feeler_report::run::make::page_of_rows;
use feeler_report::run::read_within;
use std::alloc::{GlobalAlloc, Layout, System};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

#[path = "support/mod.rs"]
#[allow(dead_code, reason = "not every test program needs all of it")]
mod support;

/// Bytes that are allocated, and the most that ever were.
static ALLOCATED: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

struct Counting;

// SAFETY: every request is handed on to the system's allocator.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let before = ALLOCATED.fetch_add(layout.size(), Ordering::Relaxed);
        PEAK.fetch_max(before + layout.size(), Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        ALLOCATED.fetch_sub(layout.size(), Ordering::Relaxed);
        // SAFETY: the caller keeps the contract of `dealloc`; all memory came from the system.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Room for 1.5 to 2 thousand rows of two fingers.
const MEMORY: usize = 5 << 20;

/// Bytes that reading a recording of so many strokes and making its page take at most, and bytes of the page.
fn peak(strokes: u32) -> (usize, usize) {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("report-memory");
    fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join(format!("{strokes}.mcap"));
    let recorder = Recorder::create(&path, &support::facts(), support::EXPERIMENT);
    let mut recorder = recorder.expect("a recorder");
    support::write_strokes(&mut recorder, strokes).expect("strokes");
    recorder.finish(None).expect("a recording");
    let before = ALLOCATED.load(Ordering::Relaxed);
    PEAK.store(before, Ordering::Relaxed);
    let (recording, data) = read_within(&path, MEMORY, &mut |_| {}).expect("a run");
    let page = page_of_rows(&recording, &data);
    let peak = PEAK.load(Ordering::Relaxed) - before;
    fs::remove_file(&path).expect("the file");
    assert!(page.contains("This is a long run"));
    (peak, page.len())
}

#[test]
fn a_report_of_a_longer_run_needs_no_more_memory() {
    // Both leave rows out; a stroke has 300.
    let [(short, page), (long, long_page)] = [20, 80].map(peak);
    // What grows are strokes: 60 more, of some hundred bytes each of measures, and their columns in a table. How full the
    // rows' room is when the recording ends is chance, and up to a quarter of it.
    let room = MEMORY / 4 + 60 * 4_000;
    assert!(long < short + room, "{short} bytes, then {long}");
    assert!(long < 8 * MEMORY, "{long} bytes");
    assert!(
        long_page < page + page / 2 + 60 * 4_000,
        "{page}, then {long_page}"
    );
}
