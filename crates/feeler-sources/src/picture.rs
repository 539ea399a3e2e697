//! Decodes image files to greyscale images.

use crate::jpeg;
use feeler::sensor::image::Picture;
use image::{DynamicImage, ImageDecoder, ImageError, ImageReader, Limits};
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

/// Extensions of image files, in lower case; any case is accepted.
pub const EXTENSIONS: [&str; 10] = [
    "png", "jpg", "jpeg", "pgm", "ppm", "pnm", "tif", "tiff", "bmp", "webp",
];

/// Maximum size of an image file, bytes.
const MAX_FILE: u64 = 256 << 20;
/// Maximum number of columns or rows of an image, px.
const MAX_SIDE: u32 = 16_384;
/// Maximum memory for decoding, bytes.
const MAX_MEMORY: u64 = 1 << 30;

/// Error of reading an image file.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file cannot be read.
    #[error("{0}")]
    Read(#[from] std::io::Error),
    /// The file is not a valid image.
    #[error("expected an image (PNG, JPEG, PGM, TIFF, BMP, WebP): {0}")]
    Decode(#[from] ImageError),
    /// The image is truncated.
    #[error("the file is truncated: {bytes} bytes without the end marker of a JPEG image")]
    Truncated {
        /// Length of the file, bytes.
        bytes: usize,
    },
    /// The file is too large.
    #[error("the file is too large; expected an image file of at most {} MiB", MAX_FILE >> 20)]
    TooLarge,
}

/// Reads and decodes the image file at `path`; see [`decode_picture`].
///
/// # Errors
/// If the file cannot be read or is not a complete image.
pub fn read_picture(path: &Path) -> Result<Picture, PictureError> {
    let mut bytes = Vec::new();
    let mut file = File::open(path)?.take(MAX_FILE + 1);
    file.read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_FILE {
        return Err(PictureError::TooLarge);
    }
    decode_picture(&bytes)
}

/// Decodes a PNG, JPEG, PNM, TIFF, BMP or WebP file to an 8-bit greyscale image. The format is detected from the
/// content; of an animation, the first frame is decoded.
///
/// The EXIF orientation is applied, so that the pixels are where a viewer shows them. 16-bit values are scaled by
/// 1/257 and rounded. Colours become `0.2126 R + 0.7152 G + 0.0722 B` of their stored values. Transparency is
/// ignored.
///
/// # Errors
/// If `bytes` are not a complete image in one of these formats.
pub fn decode_picture(bytes: &[u8]) -> Result<Picture, PictureError> {
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format()?;
    let mut limits = Limits::default();
    limits.max_image_width = Some(MAX_SIDE);
    limits.max_image_height = Some(MAX_SIDE);
    limits.max_alloc = Some(MAX_MEMORY);
    reader.limits(limits.clone());
    let mut decoder = reader.into_decoder()?;
    limits.reserve(decoder.total_bytes())?;
    let orientation = decoder.orientation()?;
    let mut decoded = DynamicImage::from_decoder(decoder)?;
    decoded.apply_orientation(orientation);
    if jpeg::is_jpeg(bytes) && !jpeg::is_whole(bytes) {
        return Err(PictureError::Truncated { bytes: bytes.len() });
    }
    let gray = decoded.into_luma8();
    Ok(Picture {
        width: gray.width() as usize,
        height: gray.height() as usize,
        pixels: gray.into_raw(),
    })
}

/// Returns whether `path` has the extension of an image file.
pub fn is_picture_name(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str());
    extension.is_some_and(|e| EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(e)))
}

/// Extensions of image files, as a list for messages.
pub fn extensions() -> String {
    EXTENSIONS
        .map(|extension| format!(".{extension}"))
        .join(", ")
}

/// Lists the image files in `folder`, in natural order of their names.
///
/// # Errors
/// If the folder cannot be read.
pub fn picture_files(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let path = entry?.path();
        if is_picture_name(&path) && !path.is_dir() {
            files.push(path);
        }
    }
    files.sort_by(|a, b| {
        let (a, b) = (a.to_string_lossy(), b.to_string_lossy());
        super::natural_order::compare(&a, &b)
    });
    Ok(files)
}
