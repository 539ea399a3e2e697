//! The pictures that a camera sends.

use super::{Device, Functions, Object};
use std::ffi::{c_int, c_void};
use std::ptr::{NonNull, null};
use std::time::Duration;

/// `ARV_BUFFER_STATUS_SUCCESS`.
const SUCCESS: c_int = 0;

impl Device {
    /// A stream of its pictures with so many buffers. Must be dropped before the camera.
    pub(in super::super) fn stream(&self, buffers: usize) -> Result<Stream, String> {
        // SAFETY: the camera is open.
        let payload = self.call(|functions, camera, failure| unsafe {
            (functions.arv_camera_get_payload)(camera, failure)
        })?;
        // SAFETY: the camera is open; there is no callback, and no data for one.
        let stream = self.call(|functions, camera, failure| unsafe {
            (functions.arv_camera_create_stream)(camera, null(), null(), failure)
        })?;
        let stream = Stream {
            functions: self.functions(),
            stream: NonNull::new(stream).ok_or("no stream")?,
        };
        for _ in 0..buffers {
            // SAFETY: the stream is open, and takes the new buffer for its own.
            unsafe {
                let buffer = (stream.functions.arv_buffer_new_allocate)(payload as usize);
                (stream.functions.arv_stream_push_buffer)(stream.stream.as_ptr(), buffer);
            }
        }
        Ok(stream)
    }
}

/// What a camera sends.
pub(in super::super) struct Stream {
    functions: &'static Functions,
    stream: NonNull<c_void>,
}

// SAFETY: as with `Device`; the stream's own thread meets others in a queue of GLib's.
unsafe impl Send for Stream {}

impl Drop for Stream {
    fn drop(&mut self) {
        // SAFETY: the reference that the camera gave, given back once. It ends the stream's thread and frees its buffers.
        unsafe { (self.functions.g_object_unref)(self.stream.as_ptr()) }
    }
}

impl Stream {
    /// The next picture in the order in which they came; none if none comes in time.
    pub(in super::super) fn next(&mut self, timeout: Duration) -> Option<Buffer<'_>> {
        let microseconds = timeout.as_micros() as u64;
        // SAFETY: the stream is open. A buffer that it gives is the caller's.
        let buffer = unsafe {
            (self.functions.arv_stream_timeout_pop_buffer)(self.stream.as_ptr(), microseconds)
        };
        let buffer = NonNull::new(buffer)?;
        Some(Buffer {
            stream: self,
            buffer,
        })
    }
}

/// A picture; the stream gets its memory back when it is dropped.
pub(in super::super) struct Buffer<'a> {
    stream: &'a Stream,
    buffer: NonNull<c_void>,
}

impl Drop for Buffer<'_> {
    fn drop(&mut self) {
        let stream = self.stream;
        // SAFETY: stream and buffer are there; the buffer is given away once.
        unsafe {
            (stream.functions.arv_stream_push_buffer)(stream.stream.as_ptr(), self.buffer.as_ptr());
        }
    }
}

impl Buffer<'_> {
    fn get<T>(&self, get: unsafe extern "C" fn(Object) -> T) -> T {
        // SAFETY: the buffer is the caller's.
        unsafe { get(self.buffer.as_ptr()) }
    }

    /// What is wrong with it, if anything.
    pub(in super::super) fn fault(&self) -> Option<&'static str> {
        match self.get(self.stream.functions.arv_buffer_get_status) {
            SUCCESS => None,
            2 => Some("not all of it came in time"),
            3 => Some("packets of it are missing"),
            4 => Some("a packet of it has a wrong number"),
            5 => Some("it has another size than the camera said"),
            8 => Some("it was aborted"),
            9 => Some("its kind of payload is not known"),
            _ => Some("it was not filled"),
        }
    }

    /// When the camera took it, ns of the camera's own clock.
    pub(in super::super) fn timestamp(&self) -> u64 {
        self.get(self.stream.functions.arv_buffer_get_timestamp)
    }

    /// Its number by the camera's counter.
    pub(in super::super) fn frame_id(&self) -> u64 {
        self.get(self.stream.functions.arv_buffer_get_frame_id)
    }

    /// Number of its pixel format.
    pub(in super::super) fn pixel_format(&self) -> u32 {
        self.get(self.stream.functions.arv_buffer_get_image_pixel_format)
    }

    /// Its columns and rows.
    pub(in super::super) fn size(&self) -> [i32; 2] {
        let functions = self.stream.functions;
        [
            functions.arv_buffer_get_image_width,
            functions.arv_buffer_get_image_height,
        ]
        .map(|of| self.get(of))
    }

    /// Its bytes.
    pub(in super::super) fn bytes(&self) -> &[u8] {
        let mut size = 0;
        // SAFETY: the buffer is the caller's, so that nobody writes into it; its memory is there for as long as it is.
        unsafe {
            let get = self.stream.functions.arv_buffer_get_data;
            let data = get(self.buffer.as_ptr(), &raw mut size);
            if data.is_null() {
                return &[];
            }
            std::slice::from_raw_parts(data, size)
        }
    }
}
