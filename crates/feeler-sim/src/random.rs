//! Random numbers: one independent stream per purpose, all from the run's seed.

use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64;

/// The generator behind every random quantity of a simulation.
pub type Generator = Pcg64;

/// What a stream of random numbers is for. Streams of different purposes are independent, so that
/// another draw in one of them changes nothing in the others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Purpose {
    /// What differs from run to run: positions, friction, seat.
    Variation,
    /// Noise of the torque sensor.
    TorqueNoise,
    /// What the encoders show at their joints' zero.
    EncoderOffset,
    /// Noise of finger `n`'s camera, or of its forces when they are sensed directly.
    SensorNoise(usize),
    /// Fault `n` of the experiment.
    Fault(usize),
}

/// The stream of `purpose` in the run of `seed`.
pub fn generator(seed: u64, purpose: Purpose) -> Generator {
    let stream = match purpose {
        Purpose::Variation => 1,
        Purpose::TorqueNoise => 2,
        Purpose::EncoderOffset => 3,
        Purpose::SensorNoise(finger) => 16 + finger as u64,
        Purpose::Fault(fault) => 1024 + fault as u64,
    };
    // The odd multiplier is a bijection, so no two pairs of small seed and purpose meet.
    Generator::seed_from_u64(
        seed.wrapping_mul(0x9e37_79b9_7f4a_7c15)
            .wrapping_add(stream),
    )
}

/// A normally distributed number of mean 0 and deviation `deviation`.
#[inline]
pub fn normal(random: &mut Generator, deviation: f64) -> f64 {
    deviation * random.sample::<f64, _>(StandardNormal)
}

/// A number uniformly distributed over `-half_width..half_width`.
pub fn uniform(random: &mut Generator, half_width: f64) -> f64 {
    half_width * (2.0 * random.random::<f64>() - 1.0)
}

/// Whether something of `probability` happens.
pub fn chance(random: &mut Generator, probability: f64) -> bool {
    random.random::<f64>() < probability
}
