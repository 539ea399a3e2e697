//! MP4 files with AV1 video.

use mp4_atom::{
    Av01, Av1c, Co64, Codec, Dinf, Dref, Encode, Ftyp, Hdlr, Mdhd, Mdia, Minf, Moov, Mvhd, Stbl,
    Stsc, StscEntry, Stsd, Stss, Stsz, StszSamples, Stts, SttsEntry, Tkhd, Trak, Url, Visual, Vmhd,
};
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};

/// Size of the `mdat` header (bytes): type and 64-bit length.
const MEDIA_HEAD: u64 = 16;
const SEQUENCE_HEADER: u8 = 1;
const TEMPORAL_DELIMITER: u8 = 2;
/// AV1 level 31, "maximum parameters", which sets no limit on the bit rate.
const ANY_LEVEL: u8 = 31;

/// Writer of an MP4 video with a fixed frame size and rate. The index is written at the end of the file.
pub(crate) struct Mp4 {
    file: BufWriter<File>,
    /// Frames per second.
    rate: u32,
    width: u16,
    height: u16,
    /// Offset of the `mdat` header (bytes).
    start: u64,
    /// Size of each frame (bytes).
    sizes: Vec<u32>,
    /// Numbers of the key frames, counted from 1.
    keys: Vec<u32>,
    /// Total size of all frames (bytes).
    length: u64,
    sequence_header: Vec<u8>,
}

impl Mp4 {
    /// Creates a video with the given frame rate (1/s) and frame size (width, height; px).
    pub fn create(file: File, rate: u32, (width, height): (u16, u16)) -> io::Result<Self> {
        let mut head = Vec::new();
        let brands = [b"isom", b"av01", b"iso2", b"mp41"];
        let brands = Ftyp {
            major_brand: b"isom".into(),
            minor_version: 512,
            compatible_brands: brands.map(Into::into).to_vec(),
        };
        encode(&brands, &mut head)?;
        let mut file = BufWriter::new(file);
        file.write_all(&head)?;
        file.write_all(&media_head(0))?;
        Ok(Self {
            file,
            rate,
            width,
            height,
            start: head.len() as u64,
            sizes: Vec::new(),
            keys: Vec::new(),
            length: 0,
            sequence_header: Vec::new(),
        })
    }

    /// Appends a frame: an AV1 temporal unit. Key frames start with a sequence header.
    pub fn push(&mut self, unit: &[u8]) -> io::Result<()> {
        // MP4 already delimits the frames.
        let unit = match obu(unit) {
            Some((TEMPORAL_DELIMITER, length)) => &unit[length..],
            _ => unit,
        };
        let size = u32::try_from(unit.len()).map_err(io::Error::other)?;
        self.file.write_all(unit)?;
        self.sizes.push(size);
        self.length += u64::from(size);
        if let Some((SEQUENCE_HEADER, length)) = obu(unit) {
            self.keys.push(self.sizes.len() as u32);
            self.sequence_header = unit[..length].to_vec();
        }
        Ok(())
    }

    /// Display time of the next frame (s).
    pub fn time(&self) -> f64 {
        self.sizes.len() as f64 / f64::from(self.rate)
    }

    /// Size of the frames so far (bytes).
    pub fn size(&self) -> u64 {
        self.length
    }

    /// Writes the index and the final `mdat` header.
    pub fn finish(mut self) -> io::Result<()> {
        let mut index = Vec::new();
        encode(&self.index(), &mut index)?;
        self.file.write_all(&index)?;
        self.file.seek(SeekFrom::Start(self.start))?;
        self.file.write_all(&media_head(self.length))?;
        self.file.flush()
    }

    fn index(&self) -> Moov {
        let duration = self.sizes.len() as u64;
        let track = Trak {
            tkhd: Tkhd {
                track_id: 1,
                duration,
                enabled: true,
                in_movie: true,
                width: self.width.into(),
                height: self.height.into(),
                ..Tkhd::default()
            },
            mdia: Mdia {
                mdhd: Mdhd {
                    timescale: self.rate,
                    duration,
                    language: "und".into(),
                    ..Mdhd::default()
                },
                hdlr: Hdlr {
                    handler: b"vide".into(),
                    name: "pictures".into(),
                },
                minf: Minf {
                    vmhd: Some(Vmhd::default()),
                    dinf: Dinf {
                        dref: Dref {
                            // The media data is in the same file.
                            entries: vec![Url::default().into()],
                        },
                    },
                    stbl: self.samples(),
                    ..Minf::default()
                },
            },
            ..Trak::default()
        };
        Moov {
            mvhd: Mvhd {
                timescale: self.rate,
                duration,
                next_track_id: 2,
                ..Mvhd::default()
            },
            trak: vec![track],
            ..Moov::default()
        }
    }

    /// Sample table: codec, sizes, duration and key frames. All frames form a single chunk.
    fn samples(&self) -> Stbl {
        let count = self.sizes.len() as u32;
        Stbl {
            stsd: Stsd {
                codecs: vec![Codec::Av01(self.codec())],
            },
            stts: Stts {
                entries: vec![SttsEntry {
                    sample_count: count,
                    sample_delta: 1,
                }],
            },
            stss: Some(Stss {
                entries: self.keys.clone(),
            }),
            stsc: Stsc {
                entries: vec![StscEntry {
                    first_chunk: 1,
                    samples_per_chunk: count,
                    sample_description_index: 1,
                }],
            },
            stsz: Stsz {
                samples: StszSamples::Different {
                    sizes: self.sizes.clone(),
                },
            },
            co64: Some(Co64 {
                entries: vec![self.start + MEDIA_HEAD],
            }),
            ..Stbl::default()
        }
    }

    fn codec(&self) -> Av01 {
        Av01 {
            visual: Visual {
                data_reference_index: 1,
                width: self.width,
                height: self.height,
                ..Visual::default()
            },
            av1c: Av1c {
                seq_level_idx_0: ANY_LEVEL,
                chroma_subsampling_x: true,
                chroma_subsampling_y: true,
                config_obus: self.sequence_header.clone(),
                ..Av1c::default()
            },
            ..Av01::default()
        }
    }
}

fn encode(atom: &impl Encode, bytes: &mut Vec<u8>) -> io::Result<()> {
    atom.encode(bytes).map_err(io::Error::other)
}

/// The `mdat` header for media data of `length` bytes.
fn media_head(length: u64) -> [u8; MEDIA_HEAD as usize] {
    /// Value of a box's 32-bit length field if a 64-bit length follows the type.
    const LONG: u32 = 1;
    let mut head = [0; MEDIA_HEAD as usize];
    head[..4].copy_from_slice(&LONG.to_be_bytes());
    head[4..8].copy_from_slice(b"mdat");
    head[8..].copy_from_slice(&(MEDIA_HEAD + length).to_be_bytes());
    head
}

/// Type and total size (bytes, including the header) of the open bitstream unit (OBU) at the start of `bytes`. `None`
/// if the unit has no size field or extends beyond `bytes`.
fn obu(bytes: &[u8]) -> Option<(u8, usize)> {
    let &head = bytes.first()?;
    let (has_extension, has_size) = (head & 0b100 != 0, head & 0b10 != 0);
    let mut place = if has_extension { 2 } else { 1 };
    let mut size = 0;
    // LEB128-encoded size.
    for shift in (0..32).step_by(7) {
        let &byte = bytes.get(place).filter(|_| has_size)?;
        place += 1;
        size |= usize::from(byte & 0x7f) << shift;
        if byte & 0x80 == 0 {
            let end = place.checked_add(size)?;
            return (end <= bytes.len()).then_some((head >> 3 & 0b1111, end));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn obu_type_and_size_are_parsed() {
        let delimiter = [0x12, 0x00, 0x0a, 0x01, 0xff];
        assert_eq!(obu(&delimiter), Some((TEMPORAL_DELIMITER, 2)));
        assert_eq!(obu(&delimiter[2..]), Some((SEQUENCE_HEADER, 3)));
        let mut long = vec![0x0a, 0x80, 0x01];
        long.extend([0; 128]);
        assert_eq!(obu(&long), Some((SEQUENCE_HEADER, 131)));
        // No size field, a size beyond the end, or a truncated size field.
        for bytes in [
            &[][..],
            &[0x08, 0x00],
            &[0x0a],
            &[0x0a, 0x02, 0x00],
            &[0x0a, 0xff],
        ] {
            assert_eq!(obu(bytes), None, "{bytes:?}");
        }
        assert_eq!(obu(&[0x0a, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff]), None);
    }
}
