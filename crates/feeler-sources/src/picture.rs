//! One picture file to one grey picture.

use super::jpeg;
use feeler::sensor::frame::Picture;
use image::{DynamicImage, ImageDecoder, ImageError, ImageReader, Limits};
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

/// Extensions of the files that are taken for pictures, in any case.
pub const EXTENSIONS: [&str; 10] = [
    "png", "jpg", "jpeg", "pgm", "ppm", "pnm", "tif", "tiff", "bmp", "webp",
];

/// Largest picture file, bytes.
const MAX_FILE: u64 = 256 << 20;
/// Most columns or rows of a picture, px.
const MAX_SIDE: u32 = 16_384;
/// Most memory that decoding may take, bytes.
const MAX_MEMORY: u64 = 1 << 30;

/// Why there is no picture in a file.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The file cannot be read.
    #[error("{0}")]
    Read(#[from] std::io::Error),
    /// The file is no picture, or a damaged one.
    #[error("a picture (PNG, JPEG, PGM, TIFF, BMP, WebP) expected: {0}")]
    Decode(#[from] ImageError),
    /// The file ends within the picture.
    #[error("the file is truncated: {bytes} bytes without the end mark of a JPEG picture")]
    Truncated {
        /// Length of what is there.
        bytes: usize,
    },
    /// The file is far larger than any picture.
    #[error("a picture file of at most {} MiB expected, it is larger", MAX_FILE >> 20)]
    TooLarge,
}

/// Reads the picture file at `path`; see [`decode_picture`].
///
/// # Errors
/// When it cannot be read, or is no whole picture.
pub fn read_picture(path: &Path) -> Result<Picture, PictureError> {
    let mut bytes = Vec::new();
    let mut file = File::open(path)?.take(MAX_FILE + 1);
    file.read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_FILE {
        return Err(PictureError::TooLarge);
    }
    decode_picture(&bytes)
}

/// The grey 8-bit picture in the bytes of a PNG, JPEG, PNM, TIFF, BMP or WebP file, told by its content; of an animation its
/// first frame.
///
/// A picture is turned and mirrored as its EXIF orientation says, so that its pixels are where a viewer shows them. 16-bit values are scaled by 1/257 and rounded; colours become `0.2126 R + 0.7152 G + 0.0722 B` of
/// their values as stored; transparency is ignored.
///
/// # Errors
/// When it is no such file, or not a whole one.
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

/// Whether the name of `path` is that of a picture file.
pub fn is_picture_name(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str());
    extension.is_some_and(|e| EXTENSIONS.iter().any(|known| known.eq_ignore_ascii_case(e)))
}

/// The extensions of picture files, for messages.
pub fn extensions() -> String {
    EXTENSIONS
        .map(|extension| format!(".{extension}"))
        .join(", ")
}

/// The picture files in `folder`, in the natural order of their names.
///
/// # Errors
/// When the folder cannot be read.
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
