//! Downloads of the recording that a page shows.

use axum::body::{Body, Bytes};
use axum::http::header::{CONTENT_LENGTH, CONTENT_TYPE, HeaderValue};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Block size in bytes.
const BLOCK: u64 = 64 * 1024;

/// Flag that a part of a long response has been sent.
#[derive(Debug, Clone, Default)]
pub struct Progress(Arc<AtomicBool>);

impl Progress {
    fn made(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Returns `true` if a part was sent since the last call.
    pub fn was_made(&self) -> bool {
        self.0.swap(false, Ordering::Relaxed)
    }
}

/// Responds with the file at `path`, up to its current length, block by block.
///
/// # Errors
/// If the file cannot be opened.
pub fn download(path: &Path, progress: Progress) -> io::Result<Response> {
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    let mut rest = file.take(length);
    // Reading may block: the page's thread has no other important work.
    let blocks = std::iter::from_fn(move || {
        progress.made();
        next_block(&mut rest).transpose()
    });
    // MCAP has no registered media type.
    let kind = HeaderValue::from_static("application/octet-stream");
    let headers = [
        (CONTENT_TYPE, kind),
        (CONTENT_LENGTH, HeaderValue::from(length)),
    ];
    let body = Body::from_stream(stream::iter(blocks));
    Ok((headers, body).into_response())
}

/// Reads the next block, or returns `None` at the end.
fn next_block(file: &mut impl Read) -> io::Result<Option<Bytes>> {
    let mut block = Vec::new();
    file.take(BLOCK).read_to_end(&mut block)?;
    Ok((!block.is_empty()).then(|| block.into()))
}
