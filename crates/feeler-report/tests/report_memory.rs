//! The report of a recording four times as long does not require more memory.

use feeler_record::Recorder;
use feeler_report::run::make::page_of_rows;
use feeler_report::run::read_within;
use std::alloc::{GlobalAlloc, Layout, System};
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

#[path = "../../feeler-record/tests/support/mod.rs"]
mod support;

/// Currently allocated bytes, and their maximum.
static ALLOCATED: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

struct Counting;

// SAFETY: all requests are forwarded to the system's allocator.
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

/// Memory (bytes) for 1.5 to 2 thousand rows of two fingers.
const MEMORY: usize = 5 << 20;

/// Peak memory (bytes) of reading a recording of `strokes` strokes and creating its page, and the page's size (bytes).
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
fn a_report_of_a_longer_run_requires_no_more_memory() {
    // Both runs omit rows; a stroke has 300.
    let [(short, page), (long, long_page)] = [20, 80].map(peak);
    // Memory grows by the measures of 60 more strokes, some hundred bytes each, and their table columns. The fill level
    // of the row buffers at the end varies by up to a quarter.
    let room = MEMORY / 4 + 60 * 4_000;
    assert!(long < short + room, "{short} bytes, then {long}");
    assert!(long < 8 * MEMORY, "{long} bytes");
    assert!(
        long_page < page + page / 2 + 60 * 4_000,
        "{page}, then {long_page}"
    );
}
