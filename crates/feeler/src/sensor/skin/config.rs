//! Settings of a skin's serial port.

use super::{flexitac, magnetometers, paxini};
use crate::check::Checker;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Table `[serial]` of a taxel layout: serial protocol of the skin and its parameters.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SerialConfig {
    /// Protocol of the skin.
    pub protocol: SkinProtocol,
    /// Baud rate. Has no effect on boards with native USB.
    pub baud_rate: u32,
    /// Address of the module on the bus; only for [`SkinProtocol::Paxini`].
    #[serde(default = "first_address")]
    pub address: u8,
}

fn first_address() -> u8 {
    1
}

/// Protocol of a skin. See [the module](super).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SkinProtocol {
    /// Boards with MLX90393 magnetometers: AnySkin, ReSkin, eFlesh.
    Magnetometers,
    /// Matrices of pressure-sensitive resistors: FlexiTac. They measure no shear: x and y are 0.
    Flexitac,
    /// PaXini modules of the third generation (PX-6AX GEN3).
    Paxini,
}

impl SkinProtocol {
    /// All supported protocols.
    pub const ALL: [Self; 3] = [Self::Magnetometers, Self::Flexitac, Self::Paxini];

    /// Baud rate of the protocol in the manufacturer's firmware.
    pub fn baud_rate(self) -> u32 {
        match self {
            Self::Magnetometers => 115_200,
            Self::Flexitac => 2_000_000,
            Self::Paxini => 921_600,
        }
    }

    /// Returns `true` if the skin measures tangential components.
    pub fn has_shear(self) -> bool {
        self != Self::Flexitac
    }
}

impl SerialConfig {
    /// Creates the settings of `protocol` with its firmware's baud rate and address 1.
    pub fn new(protocol: SkinProtocol) -> Self {
        Self {
            protocol,
            baud_rate: protocol.baud_rate(),
            address: first_address(),
        }
    }

    /// Number of bytes in a frame with `taxels` taxels.
    pub fn frame_bytes(&self, taxels: usize) -> usize {
        match self.protocol {
            SkinProtocol::Magnetometers => magnetometers::frame_bytes(taxels),
            SkinProtocol::Flexitac => flexitac::frame_bytes(taxels),
            SkinProtocol::Paxini => paxini::response_bytes(taxels),
        }
    }

    /// Request for the readings of `taxels` taxels; `None` if the skin sends without requests.
    pub fn request(&self, taxels: usize) -> Option<Vec<u8>> {
        match self.protocol {
            SkinProtocol::Magnetometers | SkinProtocol::Flexitac => None,
            SkinProtocol::Paxini => Some(paxini::request(self.address, taxels)),
        }
    }

    /// Number of taxels in the response to `request`; `None` if it is not a request for readings. For emulators.
    pub fn requested_taxels(&self, request: &[u8]) -> Option<usize> {
        let taxels = paxini::requested(request)?;
        (self.request(taxels).as_deref() == Some(request)).then_some(taxels)
    }

    /// Transmission time of a byte, s; 0 if bytes arrive in packets of native USB.
    pub fn byte_time(&self) -> f64 {
        const BITS: f64 = 10.0;
        match self.protocol {
            SkinProtocol::Magnetometers => 0.0,
            SkinProtocol::Flexitac | SkinProtocol::Paxini => BITS / f64::from(self.baud_rate),
        }
    }

    /// Appends the frame that a skin sends for `values` in the columns x, y and z of its taxels; for emulators. Values
    /// are clamped to the range of the protocol.
    pub fn encode(&self, values: &[DVec3], bytes: &mut Vec<u8>) {
        match self.protocol {
            SkinProtocol::Magnetometers => magnetometers::encode(values, bytes),
            SkinProtocol::Flexitac => flexitac::encode(values, bytes),
            SkinProtocol::Paxini => paxini::encode(self.address, values, bytes),
        }
    }

    /// Checks the settings for an array of `taxels` taxels.
    pub(crate) fn check(&self, taxels: usize, checker: &mut Checker) {
        let rate = self.baud_rate;
        let good = (1200..=12_000_000).contains(&rate);
        checker.require(
            "serial.baud_rate",
            rate.to_string(),
            good,
            "1200 to 12000000",
        );
        let most = match self.protocol {
            SkinProtocol::Magnetometers => magnetometers::MOST,
            SkinProtocol::Flexitac | SkinProtocol::Paxini => usize::MAX,
        };
        let expected = format!("at most {most} with protocol = \"magnetometers\"");
        checker.require(
            "taxel",
            format!("{taxels} taxels"),
            taxels <= most,
            &expected,
        );
    }
}
