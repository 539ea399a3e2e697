//! Reads a file selected by the user block by block, without copying the whole file.

use js_sys::Uint8Array;
use std::io::{self, Read, Seek, SeekFrom};
use wasm_bindgen::JsValue;
use web_sys::{Blob, FileReaderSync};

/// A file selected in the browser, readable in a worker.
pub struct JsFile {
    blob: Blob,
    reader: FileReaderSync,
    position: u64,
}

impl JsFile {
    /// Opens `blob` at its start.
    ///
    /// # Errors
    /// Outside of a worker, where files cannot be read synchronously.
    pub fn new(blob: Blob) -> Result<Self, JsValue> {
        Ok(Self {
            blob,
            reader: FileReaderSync::new()?,
            position: 0,
        })
    }

    /// Size in bytes.
    pub fn len(&self) -> u64 {
        self.blob.size() as u64
    }
}

impl Read for JsFile {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let end = (self.position + buffer.len() as u64).min(self.len());
        if end <= self.position {
            return Ok(0);
        }
        let failed = |error: JsValue| io::Error::other(format!("{error:?}"));
        let (start, end) = (self.position as f64, end as f64);
        let slice = self.blob.slice_with_f64_and_f64(start, end);
        let bytes = self.reader.read_as_array_buffer(&slice.map_err(failed)?);
        let bytes = Uint8Array::new(bytes.map_err(failed)?.as_ref());
        let count = (bytes.length() as usize).min(buffer.len());
        bytes.slice(0, count as u32).copy_to(&mut buffer[..count]);
        self.position += count as u64;
        Ok(count)
    }
}

impl Seek for JsFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let position = match to {
            SeekFrom::Start(position) => Some(position),
            SeekFrom::End(offset) => self.len().checked_add_signed(offset),
            SeekFrom::Current(offset) => self.position.checked_add_signed(offset),
        };
        let before = || io::Error::new(io::ErrorKind::InvalidInput, "position before the start");
        self.position = position.ok_or_else(before)?;
        Ok(self.position)
    }
}
