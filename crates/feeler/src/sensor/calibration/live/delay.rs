//! Estimates the latency of images relative to forces.

/// Time (s) and value of a measurement.
pub type Timed = (f64, f64);

/// Range of delays to search, s.
const RANGE: (f64, f64) = (-0.05, 0.5);
/// Step of the search, s.
const STEP: f64 = 0.001;
/// Minimum duration of the common time span of images and forces, s.
const MIN_TIME: f64 = 2.0;

/// A delay and the correlation at that delay.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay {
    /// Latency of images relative to forces, s.
    pub seconds: f64,
    /// Correlation of images and forces at this delay, at most 1.
    pub correlation: f64,
}

/// Finds the delay of `pictures` relative to `forces` (both in order of time) that maximizes their correlation. `None`
/// if the series are too short, one of them is constant, or the maximum is at the end of the search range.
pub fn delay(pictures: &[Timed], forces: &[Timed]) -> Option<Delay> {
    let (first, last) = (forces.first()?.0, forces.last()?.0);
    // Images for which a force is known at any delay.
    let pictures: Vec<Timed> = pictures
        .iter()
        .copied()
        .filter(|&(time, _)| time - RANGE.1 >= first && time - RANGE.0 <= last)
        .collect();
    let span = pictures.last()?.0 - pictures.first()?.0;
    if span < MIN_TIME {
        return None;
    }
    let count = ((RANGE.1 - RANGE.0) / STEP).round() as usize;
    let tried: Vec<f64> = (0..=count)
        .map(|step| correlation(&pictures, forces, RANGE.0 + step as f64 * STEP))
        .collect::<Option<_>>()?;
    let (best, &peak) = tried.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
    let (&before, &after) = (tried.get(best.checked_sub(1)?)?, tried.get(best + 1)?);
    // Maximum of the parabola through the best value and its neighbours.
    let bend = before - 2.0 * peak + after;
    let aside = if bend < 0.0 {
        0.5 * (before - after) / bend
    } else {
        0.0
    };
    Some(Delay {
        seconds: RANGE.0 + (best as f64 + aside) * STEP,
        correlation: peak,
    })
}

/// Correlation of the images with the forces `delay` seconds earlier; `None` if one of them is constant.
fn correlation(pictures: &[Timed], forces: &[Timed], delay: f64) -> Option<f64> {
    let mut next = 0;
    let pairs = pictures.iter().map(|&(time, change)| {
        let time = time - delay;
        while forces.get(next + 1).is_some_and(|&(at, _)| at < time) {
            next += 1;
        }
        Some((
            change,
            between(forces.get(next)?, forces.get(next + 1)?, time),
        ))
    });
    let pairs: Vec<(f64, f64)> = pairs.collect::<Option<_>>()?;
    let count = pairs.len() as f64;
    let sum = pairs
        .iter()
        .fold((0.0, 0.0), |sum, pair| (sum.0 + pair.0, sum.1 + pair.1));
    let mean = (sum.0 / count, sum.1 / count);
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for (x, y) in pairs {
        let (x, y) = (x - mean.0, y - mean.1);
        (xx, yy, xy) = (xx + x * x, yy + y * y, xy + x * y);
    }
    (xx > 0.0 && yy > 0.0).then(|| xy / (xx * yy).sqrt())
}

/// Interpolates linearly between two measurements.
pub fn between(&(from, start): &Timed, &(to, end): &Timed, time: f64) -> f64 {
    match to > from {
        true => start + (end - start) * ((time - from) / (to - from)).clamp(0.0, 1.0),
        false => start,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Presses that get shorter and shorter, N.
    fn force(time: f64) -> f64 {
        (1.0 - (2.0 * time + 0.3 * time * time).cos()).powi(2)
    }

    fn measured(rate: f64, seconds: f64, of: impl Fn(f64) -> f64) -> Vec<Timed> {
        let times = (0..(rate * seconds) as usize).map(|index| index as f64 / rate);
        times.map(|time| (time, of(time))).collect()
    }

    proptest! {
        /// A 30 Hz camera lags behind a 1000 Hz sensor. The delay is found to within a hundredth of the frame
        /// interval, at any scale of the images' response. The only error is the interpolation within a millisecond.
        #[test]
        fn a_known_delay_is_found(delay in -0.03..0.4_f64, scale in 0.1..100.0_f64) {
            let forces = measured(1000.0, 6.0, force);
            let pictures = measured(30.0, 6.0, |time| 7.0 + scale * force((time - delay).max(0.0)));
            let found = super::delay(&pictures, &forces).expect("a delay");
            prop_assert!((found.seconds - delay).abs() < 3.4e-4, "{found:?}, expected {delay} s");
            prop_assert!(found.correlation > 0.999);
        }
    }

    #[test]
    fn constant_short_or_empty_data_give_no_delay() {
        let forces = measured(1000.0, 6.0, force);
        let still = measured(30.0, 6.0, |_| 1.0);
        assert_eq!(delay(&still, &forces), None);
        assert_eq!(delay(&forces[..1000], &forces), None);
        assert_eq!(delay(&[], &forces), None);
        assert_eq!(delay(&forces, &[]), None);
        // For monotonic data the best delay is at the end of the search range.
        let rising = |time: f64| time;
        let (slow, fast) = (
            measured(30.0, 6.0, rising),
            measured(1000.0, 6.0, |t| t * t),
        );
        let found = delay(&slow, &fast);
        assert!(
            found.is_none() || found.unwrap().correlation < 0.9999,
            "{found:?}"
        );
    }
}
