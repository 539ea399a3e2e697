//! Stream of images from a camera.

use super::device::Device;
use super::{Functions, Object};
use std::ffi::{c_int, c_void};
use std::ptr::{NonNull, null};
use std::time::Duration;

/// `ARV_BUFFER_STATUS_SUCCESS`.
const SUCCESS: c_int = 0;

impl Device {
    /// Creates a stream with the given number of buffers. The stream must be dropped before the camera.
    pub(in super::super) fn stream(&self, buffers: usize) -> Result<Stream, String> {
        // SAFETY: the camera is open.
        let payload = self.call(|functions, camera, failure| unsafe {
            (functions.arv_camera_get_payload)(camera, failure)
        })?;
        // SAFETY: the camera is open; callback and user data are null.
        let stream = self.call(|functions, camera, failure| unsafe {
            (functions.arv_camera_create_stream)(camera, null(), null(), failure)
        })?;
        let stream = Stream {
            functions: self.functions(),
            stream: NonNull::new(stream).ok_or("no stream")?,
        };
        for _ in 0..buffers {
            // SAFETY: the stream is open and takes ownership of the new buffer.
            unsafe {
                let buffer = (stream.functions.arv_buffer_new_allocate)(payload as usize);
                (stream.functions.arv_stream_push_buffer)(stream.stream.as_ptr(), buffer);
            }
        }
        Ok(stream)
    }
}

/// An image stream of a camera.
pub(in super::super) struct Stream {
    functions: &'static Functions,
    stream: NonNull<c_void>,
}

// SAFETY: as for `Device`; the stream's internal thread communicates through a GLib queue.
unsafe impl Send for Stream {}

impl Drop for Stream {
    fn drop(&mut self) {
        // SAFETY: releases the reference obtained from the camera, once. This ends the stream's thread and frees its
        // buffers.
        unsafe { (self.functions.g_object_unref)(self.stream.as_ptr()) }
    }
}

impl Stream {
    /// Next image in order of arrival, or `None` if none arrives within `timeout`.
    pub(in super::super) fn next(&mut self, timeout: Duration) -> Option<Buffer<'_>> {
        let microseconds = timeout.as_micros() as u64;
        // SAFETY: the stream is open. The caller owns the returned buffer.
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

/// An image. Dropping it returns its buffer to the stream.
pub(in super::super) struct Buffer<'a> {
    stream: &'a Stream,
    buffer: NonNull<c_void>,
}

impl Drop for Buffer<'_> {
    fn drop(&mut self) {
        let stream = self.stream;
        // SAFETY: stream and buffer are valid; ownership of the buffer is passed once.
        unsafe {
            (stream.functions.arv_stream_push_buffer)(stream.stream.as_ptr(), self.buffer.as_ptr());
        }
    }
}

impl Buffer<'_> {
    fn get<T>(&self, get: unsafe extern "C" fn(Object) -> T) -> T {
        // SAFETY: this object owns the buffer.
        unsafe { get(self.buffer.as_ptr()) }
    }

    /// Reason why the image is incomplete, or `None` if it is complete.
    pub(in super::super) fn fault(&self) -> Option<&'static str> {
        match self.get(self.stream.functions.arv_buffer_get_status) {
            SUCCESS => None,
            2 => Some("it did not arrive completely in time"),
            3 => Some("packets of it are missing"),
            4 => Some("a packet of it has a wrong number"),
            5 => Some("its size differs from the one announced by the camera"),
            8 => Some("it was aborted"),
            9 => Some("its payload type is unknown"),
            _ => Some("it was not filled"),
        }
    }

    /// Time of exposure by the camera's clock, ns.
    pub(in super::super) fn timestamp(&self) -> u64 {
        self.get(self.stream.functions.arv_buffer_get_timestamp)
    }

    /// Frame number by the camera's counter.
    pub(in super::super) fn frame_id(&self) -> u64 {
        self.get(self.stream.functions.arv_buffer_get_frame_id)
    }

    /// Pixel format code.
    pub(in super::super) fn pixel_format(&self) -> u32 {
        self.get(self.stream.functions.arv_buffer_get_image_pixel_format)
    }

    /// Width and height, px.
    pub(in super::super) fn size(&self) -> [i32; 2] {
        let functions = self.stream.functions;
        [
            functions.arv_buffer_get_image_width,
            functions.arv_buffer_get_image_height,
        ]
        .map(|of| self.get(of))
    }

    /// Image data.
    pub(in super::super) fn bytes(&self) -> &[u8] {
        let mut size = 0;
        // SAFETY: this object owns the buffer, so nothing else writes into it; its memory stays valid as long as the
        // buffer.
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
