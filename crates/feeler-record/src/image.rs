//! A camera's picture as ROS 2's `sensor_msgs/Image`, which every viewer of recordings shows.

use super::channels::{Stamped, nanoseconds};
use super::error::RecordError;
use crate::wire::{Message, WireError};
use feeler::sensor::frame::{Frame, Picture};
use serde::{Deserialize, Serialize};

/// Grey pixels of 8 bits, in ROS 2's words.
const MONO8: &str = "mono8";
/// Nanoseconds of a second.
const SECOND: u64 = 1_000_000_000;

/// A time, as ROS 2's `builtin_interfaces/Time`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Time {
    /// Whole seconds.
    pub sec: i32,
    /// Nanoseconds after them.
    pub nanosec: u32,
}

/// What stands before ROS 2's own messages, `std_msgs/Header`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImageHeader {
    /// Time of exposure, to the nanosecond. The [`Tactile`](super::Tactile) frame that was made of the picture
    /// has all of it.
    pub stamp: Time,
    /// The camera that took it.
    pub frame_id: String,
}

/// A grey picture, row by row from the top left.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Image {
    /// When and by which camera it was taken.
    pub header: ImageHeader,
    /// Rows, px.
    pub height: u32,
    /// Columns, px.
    pub width: u32,
    /// How pixels are written: `mono8`.
    pub encoding: String,
    /// Whether the most significant byte of a pixel comes first; of no meaning for single bytes.
    pub is_bigendian: u8,
    /// Length of a row, bytes.
    pub step: u32,
    /// The pixels. In one piece: element by element, a picture would take a hundred times as long.
    #[serde(with = "serde_bytes")]
    pub data: Vec<u8>,
}

impl Message for Image {
    const SCHEMA_NAME: &'static str = "sensor_msgs/msg/Image";
    const SCHEMA: &'static str = "\
std_msgs/Header header
uint32 height
uint32 width
string encoding
uint8 is_bigendian
uint32 step
uint8[] data
================================================================================
MSG: std_msgs/Header
builtin_interfaces/Time stamp
string frame_id
================================================================================
MSG: builtin_interfaces/Time
int32 sec
uint32 nanosec
";
}

impl Stamped for Image {
    fn stamp(&self) -> f64 {
        let Time { sec, nanosec } = self.header.stamp;
        f64::from(sec) + f64::from(nanosec) * 1e-9
    }
}

impl Image {
    /// A picture without pixels by the camera in the fingertip of `finger`, to be filled.
    pub fn of_finger(finger: usize) -> Self {
        Self {
            header: ImageHeader {
                stamp: Time::default(),
                frame_id: format!("finger_{finger}_camera"),
            },
            height: 0,
            width: 0,
            encoding: MONO8.into(),
            is_bigendian: 0,
            step: 0,
            data: Vec::new(),
        }
    }

    /// Takes over `frame`. Allocates only when it is larger than any before.
    ///
    /// # Errors
    /// When its stamp is no time, or it is larger than any picture can be.
    pub fn fill(&mut self, frame: &Frame) -> Result<(), RecordError> {
        let time = nanoseconds(frame.stamp).and_then(|ns| {
            Some(Time {
                sec: i32::try_from(ns / SECOND).ok()?,
                nanosec: (ns % SECOND) as u32,
            })
        });
        self.header.stamp = time.ok_or_else(|| RecordError::Stamp {
            topic: self.header.frame_id.clone(),
            stamp: frame.stamp,
        })?;
        let side = |pixels: usize| {
            u32::try_from(pixels).map_err(|e| WireError::Encode {
                schema: Self::SCHEMA_NAME,
                reason: format!("{pixels} px: {e}"),
            })
        };
        self.height = side(frame.picture.height)?;
        self.width = side(frame.picture.width)?;
        self.step = self.width;
        self.data.clear();
        self.data.extend_from_slice(&frame.picture.pixels);
        Ok(())
    }

    /// The picture in it.
    ///
    /// # Errors
    /// When it is no grey picture of 8 bits with as many pixels as it says: what was expected, what found.
    pub fn into_picture(self) -> Result<Picture, String> {
        self.check()?;
        Ok(Picture {
            width: self.width as usize,
            height: self.height as usize,
            pixels: self.data,
        })
    }

    /// Refuses what [`into_picture`](Self::into_picture) refuses.
    pub(super) fn check(&self) -> Result<(), String> {
        if self.encoding != MONO8 {
            return Err(format!("{MONO8} expected, {:?} found", self.encoding));
        }
        let (step, rows) = (self.step as usize, self.height as usize);
        if step != self.width as usize || Some(self.data.len()) != step.checked_mul(rows) {
            return Err(format!(
                "{}x{} px without gaps expected, {} bytes in rows of {step} found",
                self.width,
                self.height,
                self.data.len()
            ));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::cdr;

    fn frame() -> Frame {
        let mut frame = Frame::black(3, 2);
        frame.stamp = 12.345_678_901_2;
        frame.picture.pixels = vec![0, 1, 127, 128, 254, 255];
        frame
    }

    #[test]
    fn a_picture_reads_back_as_it_was_written() {
        let mut image = Image::of_finger(1);
        image.fill(&frame()).unwrap();
        let mut bytes = Vec::new();
        cdr::encode(&image, &mut bytes).unwrap();
        assert_eq!(bytes[bytes.len() - 10..][..4], [6, 0, 0, 0], "{bytes:?}");
        let again: Image = cdr::decode(&bytes).unwrap();
        assert_eq!(again, image);
        assert_eq!(
            again.header.stamp,
            Time {
                sec: 12,
                nanosec: 345_678_901
            }
        );
        assert_eq!(nanoseconds(again.stamp()), nanoseconds(frame().stamp));
        assert_eq!(again.into_picture().unwrap(), frame().picture);
        // Cut anywhere, it is refused.
        for length in 0..bytes.len() {
            assert!(
                cdr::decode::<Image>(&bytes[..length]).is_err(),
                "{length} bytes"
            );
        }
    }

    #[test]
    fn what_is_no_grey_picture_is_refused() {
        let mut image = Image::of_finger(0);
        image.fill(&frame()).unwrap();
        let spoil: [fn(&mut Image); 4] = [
            |image| image.encoding = "rgb8".into(),
            |image| image.step = 9,
            |image| image.height = u32::MAX,
            |image| image.data.truncate(5),
        ];
        for spoil in spoil {
            let mut spoilt = image.clone();
            spoil(&mut spoilt);
            let reason = spoilt.into_picture().unwrap_err();
            assert!(reason.contains("expected"), "{reason}");
        }
        for stamp in [f64::NAN, -1.0, 1e10] {
            let mut frame = frame();
            frame.stamp = stamp;
            assert!(matches!(image.fill(&frame), Err(RecordError::Stamp { .. })));
        }
    }
}
