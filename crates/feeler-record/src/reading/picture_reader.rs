//! Reads images from a recording's file.

use super::chunk::unpack;
use super::record::RECORD_HEAD;
use super::recording::PictureAt;
use super::scan::read_record;
use crate::messages::image::picture;
use crate::ros::CompressedImage;
use crate::wire::cdr;
use ::mcap::records::op;
use feeler::sensor::image::Picture;
use std::io::{Read, Seek, SeekFrom};

/// A reader of images. Caches the compressed chunk of the latest image, because a chunk contains many images.
#[derive(Debug)]
pub struct PictureReader<F> {
    file: F,
    /// Offset of the chunk's body in the file, and its records.
    chunk: Option<(u64, Vec<u8>)>,
}

impl<F: Read + Seek> PictureReader<F> {
    /// Creates a reader for images in `file`.
    pub fn new(file: F) -> Self {
        Self { file, chunk: None }
    }

    /// Reads the image at `at`.
    ///
    /// # Errors
    /// If the image cannot be read or decoded. Returns a description.
    pub fn read(&mut self, at: PictureAt) -> Result<Picture, String> {
        let image: CompressedImage = match at.chunk {
            Some(start) => {
                let records = self.chunk(start)?;
                let message = usize::try_from(at.offset).ok();
                let message = message.and_then(|offset| records.get(offset..)?.get(..at.length));
                cdr::decode(message.ok_or("its chunk ends before it")?)
            }
            None => {
                self.seek(at.offset)?;
                let mut bytes = vec![0; at.length];
                self.file
                    .read_exact(&mut bytes)
                    .map_err(|e| e.to_string())?;
                cdr::decode(&bytes)
            }
        }
        .map_err(|e| e.to_string())?;
        picture(&image)
    }

    /// Returns the records of the chunk whose body begins at `start`.
    fn chunk(&mut self, start: u64) -> Result<&[u8], String> {
        if self
            .chunk
            .as_ref()
            .is_none_or(|(newest, _)| *newest != start)
        {
            self.chunk = None;
            self.seek(start.saturating_sub(RECORD_HEAD as u64))?;
            let mut body = Vec::new();
            let (opcode, _) = read_record(&mut self.file, &mut body)?;
            if opcode != op::CHUNK {
                return Err("expected its chunk, got another record".into());
            }
            self.chunk = Some((start, unpack(&body)?.records.into_owned()));
        }
        Ok(self.chunk.as_ref().map_or(&[], |(_, records)| records))
    }

    fn seek(&mut self, offset: u64) -> Result<(), String> {
        let sought = self.file.seek(SeekFrom::Start(offset));
        sought.map(|_| ()).map_err(|e| e.to_string())
    }
}
