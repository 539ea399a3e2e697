//! The torque sensor under the bottle: a bridge of four strain gauges, an amplifier and an A/D converter (paper,
//! section V.A).

use crate::random::{Generator, normal};
use feeler::check::Checker;
use serde::{Deserialize, Serialize};

/// Parameters of the sensor and its electronics.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TorqueSensorConfig {
    /// Torsional stiffness of the shaft (N·m/rad).
    pub stiffness: f64,
    /// Torque at which the gauges' strain is `rated_strain` (N·m).
    pub rated_torque: f64,
    /// Strain of each gauge at the rated torque.
    pub rated_strain: f64,
    /// Relative change of a gauge's resistance per strain.
    pub gauge_factor: f64,
    /// Supply voltage of the bridge (V).
    pub bridge_voltage: f64,
    /// Gain of the amplifier.
    pub amplifier_gain: f64,
    /// Cutoff frequency (-3 dB) of the amplifier's low-pass filter (Hz).
    pub cutoff_frequency: f64,
    /// Standard deviation of the noise at the converter's input (V).
    pub noise: f64,
    /// Maximum absolute input voltage of the converter (V).
    pub converter_range: f64,
    /// Resolution of the converter (bits).
    pub converter_bits: u32,
}

impl Default for TorqueSensorConfig {
    /// The paper's TCF-0.2N (section V.A); unpublished values are assumed.
    fn default() -> Self {
        Self {
            stiffness: 50.0,
            rated_torque: 0.2,
            rated_strain: 0.0005,
            gauge_factor: 2.1,
            bridge_voltage: 5.0,
            amplifier_gain: 1000.0,
            cutoff_frequency: 200.0,
            noise: 0.002,
            converter_range: 10.0,
            converter_bits: 14,
        }
    }
}

/// A reading of the torque sensor.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TorqueReading {
    /// Measured torque about W's z on the bottle by the cap (N·m).
    pub torque: f64,
    /// Voltage at the converter's input (V).
    pub voltage: f64,
    /// Output of the converter (counts).
    pub counts: i32,
}

impl TorqueSensorConfig {
    /// Checks that every value of the table `key` is in its range.
    pub fn check(&self, key: &str, checker: &mut Checker) {
        let positive = [
            ("stiffness", self.stiffness),
            ("rated_torque", self.rated_torque),
            ("gauge_factor", self.gauge_factor),
            ("bridge_voltage", self.bridge_voltage),
            ("amplifier_gain", self.amplifier_gain),
            ("cutoff_frequency", self.cutoff_frequency),
            ("converter_range", self.converter_range),
        ];
        checker.all_positive(key, &positive);
        checker.not_negative(&format!("{key}.noise"), self.noise);
        checker.between(&format!("{key}.rated_strain"), self.rated_strain, 1e-9, 0.1);
        checker.require(
            &format!("{key}.converter_bits"),
            self.converter_bits.to_string(),
            (1..=24).contains(&self.converter_bits),
            "1 to 24",
        );
    }

    /// Gain of the low-pass filter for a step of `step` seconds: the fraction of the difference between input and
    /// output by which the output changes.
    pub fn low_pass_gain(&self, step: f64) -> f64 {
        1.0 - libm::exp(-std::f64::consts::TAU * self.cutoff_frequency * step)
    }

    /// Output voltage of the bridge at `torque` (N·m): gauges 1 and 3 are stretched, 2 and 4 compressed.
    fn bridge_output(&self, torque: f64) -> f64 {
        let change = self.gauge_factor * self.rated_strain * torque / self.rated_torque;
        let (stretched, pressed) = (1.0 + change, 1.0 - change);
        self.bridge_voltage * (stretched / (stretched + pressed) - pressed / (pressed + stretched))
    }

    /// Reads the sensor; `filtered_torque` is the output of the low-pass filter (N·m).
    pub fn read(&self, filtered_torque: f64, random: &mut Generator) -> TorqueReading {
        let voltage =
            self.amplifier_gain * self.bridge_output(filtered_torque) + normal(random, self.noise);
        let volts_per_count = 2.0 * self.converter_range / f64::from(1_u32 << self.converter_bits);
        let most = (1_i64 << (self.converter_bits - 1)) as f64;
        let counts = (voltage / volts_per_count).round().clamp(-most, most - 1.0);
        let volts_per_torque =
            self.amplifier_gain * self.bridge_output(self.rated_torque) / self.rated_torque;
        TorqueReading {
            torque: counts * volts_per_count / volts_per_torque,
            voltage,
            counts: counts as i32,
        }
    }
}
