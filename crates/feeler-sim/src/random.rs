//! Random numbers: an independent stream per purpose, derived from the run's seed.

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

/// Generator of all random quantities of a simulation.
pub type Generator = Pcg64;

/// Purpose of a random stream. Streams are independent, so additional draws from one do not change the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// Variation between runs: positions, friction, seat.
    Variation,
    /// Noise of the torque sensor.
    TorqueNoise,
    /// Zero offsets of the encoders.
    EncoderOffset,
    /// Noise of finger `n`'s camera, or of its directly sensed forces.
    SensorNoise(usize),
    /// Fault `n` of the experiment.
    Fault(usize),
}

/// Creates the stream of `purpose` in the run of `seed`.
pub fn generator(seed: u64, purpose: Purpose) -> Generator {
    let stream = match purpose {
        Purpose::Variation => 1,
        Purpose::TorqueNoise => 2,
        Purpose::EncoderOffset => 3,
        Purpose::SensorNoise(finger) => 16 + finger as u64,
        Purpose::Fault(fault) => 1024 + fault as u64,
    };
    // Multiplication by an odd number is a bijection, and separates the streams of small seeds and purposes.
    Generator::seed_from_u64(
        seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .wrapping_add(stream),
    )
}

/// Draws from a normal distribution with mean 0 and standard deviation `deviation`.
#[inline]
pub fn normal(random: &mut Generator, deviation: f64) -> f64 {
    deviation * random.sample::<f64, _>(StandardNormal)
}

/// Draws from the uniform distribution over `-half_width..half_width`.
pub fn uniform(random: &mut Generator, half_width: f64) -> f64 {
    half_width * (2.0 * random.random::<f64>() - 1.0)
}

/// Returns `true` with the given `probability`.
pub fn chance(random: &mut Generator, probability: f64) -> bool {
    random.random::<f64>() < probability
}
