//! The recording that a page is of, as its link gets it.

use axum::body::{Body, Bytes};
use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE, HeaderValue};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Bytes that are read at a time.
const BLOCK: u64 = 64 * 1024;

/// Whether a part of a long answer was taken since somebody looked.
#[derive(Debug, Clone, Default)]
pub struct Progress(Arc<AtomicBool>);

impl Progress {
    fn made(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether there was any since the last call.
    pub fn was_made(&self) -> bool {
        self.0.swap(false, Ordering::Relaxed)
    }
}

/// The file at `path`, as long as it is now, block by block as it is taken.
///
/// # Errors
/// When the file cannot be opened.
pub fn download(path: &Path, progress: Progress) -> io::Result<Response> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut rest = file.take(length);
    // The page's thread does nothing else of importance: it may wait for the disk.
    let blocks = std::iter::from_fn(move || {
        progress.made();
        next_block(&mut rest).transpose()
    });
    // MCAP has no media type of its own.
    let kind = HeaderValue::from_static("application/octet-stream");
    let headers = [
        (CONTENT_TYPE, kind),
        (CONTENT_LENGTH, HeaderValue::from(length)),
    ];
    let body = Body::from_stream(stream::iter(blocks));
    Ok((headers, body).into_response())
}

/// What is read next; nothing at the end.
fn next_block(file: &mut impl Read) -> io::Result<Option<Bytes>> {
    let mut block = Vec::new();
    file.take(BLOCK).read_to_end(&mut block)?;
    Ok((!block.is_empty()).then(|| block.into()))
}
