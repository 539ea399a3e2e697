//! Videos of AV1 in MP4 files.

use mp4_atom::{
    Av01, Av1c, Co64, Codec, Dinf, Dref, Encode, Ftyp, Hdlr, Mdhd, Mdia, Minf, Moov, Mvhd, Stbl,
    Stsc, StscEntry, Stsd, Stss, Stsz, StszSamples, Stts, SttsEntry, Tkhd, Trak, Url, Visual, Vmhd,
};
use std::fs::File;
use std::io::{self, BufWriter, Seek, SeekFrom, Write};

/// What stands before the pictures: type, and a length of 64 bits.
const MEDIA_HEAD: u64 = 16;
const SEQUENCE_HEADER: u8 = 1;
const TEMPORAL_DELIMITER: u8 = 2;
/// Level of an AV1 stream that makes no promise of its rate.
const ANY_LEVEL: u8 = 31;

/// A video while it is written: pictures of equal size at a constant rate. Where each of them is stands at the file's end.
pub(crate) struct Mp4 {
    file: BufWriter<File>,
    /// Pictures per second.
    rate: u32,
    width: u16,
    height: u16,
    /// Where the media's head is.
    start: u64,
    /// Bytes of each picture.
    sizes: Vec<u32>,
    /// Pictures from which decoding can begin, from 1.
    keys: Vec<u32>,
    /// Bytes of all of them.
    length: u64,
    sequence_header: Vec<u8>,
}

impl Mp4 {
    /// Begins a video of so many pictures per second, each of width and height (px).
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

    /// Adds a picture: a temporal unit of AV1, which begins with a sequence header if decoding can begin there.
    pub fn push(&mut self, unit: &[u8]) -> io::Result<()> {
        // What an MP4 file says by itself is left out.
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

    /// Pictures so far.
    pub fn pictures(&self) -> usize {
        self.sizes.len()
    }

    /// Bytes so far.
    pub fn size(&self) -> u64 {
        self.length
    }

    /// Ends the video.
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
                            // In this file.
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

    /// Where each picture is, all in one piece, and how long it is shown.
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

/// The head of media of so many bytes.
fn media_head(length: u64) -> [u8; MEDIA_HEAD as usize] {
    /// In place of a length of 32 bits: one of 64 follows.
    const LONG: u32 = 1;
    let mut head = [0; MEDIA_HEAD as usize];
    head[..4].copy_from_slice(&LONG.to_be_bytes());
    head[4..8].copy_from_slice(b"mdat");
    head[8..].copy_from_slice(&(MEDIA_HEAD + length).to_be_bytes());
    head
}

/// Type of the open bitstream unit (OBU) at the beginning of `bytes`, and its length with its head, bytes; none if it has no
/// length, or one beyond the end.
fn obu(bytes: &[u8]) -> Option<(u8, usize)> {
    let &head = bytes.first()?;
    let (has_extension, has_size) = (head & 0b100 != 0, head & 0b10 != 0);
    let mut place = if has_extension { 2 } else { 1 };
    let mut size = 0;
    // Little-endian base 128.
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
    fn units_of_a_bitstream_are_told_apart() {
        let delimiter = [0x12, 0x00, 0x0a, 0x01, 0xff];
        assert_eq!(obu(&delimiter), Some((TEMPORAL_DELIMITER, 2)));
        assert_eq!(obu(&delimiter[2..]), Some((SEQUENCE_HEADER, 3)));
        let mut long = vec![0x0a, 0x80, 0x01];
        long.extend([0; 128]);
        assert_eq!(obu(&long), Some((SEQUENCE_HEADER, 131)));
        // Without a length, or one that is beyond the end or has none.
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
