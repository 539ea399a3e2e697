//! How much later than a force the picture of it comes in.

/// What was measured at one time: s, and how much.
pub type Timed = (f64, f64);

/// Delays that are looked for, s.
const RANGE: (f64, f64) = (-0.05, 0.5);
/// Between delays that are tried, s.
const STEP: f64 = 0.001;
/// Time that both must be known for, s.
const LEAST_TIME: f64 = 2.0;

/// A delay, and how well both go together with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Delay {
    /// Time that pictures come in after forces, s.
    pub seconds: f64,
    /// Correlation of both with this delay, at most 1.
    pub correlation: f64,
}

/// The delay with which `pictures` follow `forces`, both in the order of time: where their correlation is largest. None where
/// they are too short, one of them does not change, or no delay within reach is best.
pub fn delay(pictures: &[Timed], forces: &[Timed]) -> Option<Delay> {
    let (first, last) = (forces.first()?.0, forces.last()?.0);
    // Those whose force is known with any delay.
    let pictures: Vec<Timed> = pictures
        .iter()
        .copied()
        .filter(|&(time, _)| time - RANGE.1 >= first && time - RANGE.0 <= last)
        .collect();
    let span = pictures.last()?.0 - pictures.first()?.0;
    if span < LEAST_TIME {
        return None;
    }
    let count = ((RANGE.1 - RANGE.0) / STEP).round() as usize;
    let tried: Vec<f64> = (0..=count)
        .map(|step| correlation(&pictures, forces, RANGE.0 + step as f64 * STEP))
        .collect::<Option<_>>()?;
    let (best, &peak) = tried.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1))?;
    let (&before, &after) = (tried.get(best.checked_sub(1)?)?, tried.get(best + 1)?);
    // The top of the parabola through the best and its neighbours.
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

/// Correlation of the pictures with the forces that were so much earlier; none where one does not change.
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

/// What was between two times.
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

    /// Presses of growing length, N.
    fn force(time: f64) -> f64 {
        (1.0 - (2.0 * time + 0.3 * time * time).cos()).powi(2)
    }

    fn measured(rate: f64, seconds: f64, of: impl Fn(f64) -> f64) -> Vec<Timed> {
        let times = (0..(rate * seconds) as usize).map(|index| index as f64 / rate);
        times.map(|time| (time, of(time))).collect()
    }

    proptest! {
        /// A camera of 30 frames a second follows a sensor of 1000: the delay is found to a third of a thirtieth of its frame's interval,
        /// as nothing is lost by interpolation here but what the curve does in a millisecond; and whatever the picture's scale is.
        #[test]
        fn a_known_delay_is_found(delay in -0.03..0.4_f64, scale in 0.1..100.0_f64) {
            let forces = measured(1000.0, 6.0, force);
            let pictures = measured(30.0, 6.0, |time| 7.0 + scale * force((time - delay).max(0.0)));
            let found = super::delay(&pictures, &forces).expect("a delay");
            prop_assert!((found.seconds - delay).abs() < 3.4e-4, "{found:?}, {delay} s expected");
            prop_assert!(found.correlation > 0.999);
        }
    }

    #[test]
    fn nothing_is_found_where_nothing_is() {
        let forces = measured(1000.0, 6.0, force);
        let still = measured(30.0, 6.0, |_| 1.0);
        assert_eq!(delay(&still, &forces), None);
        assert_eq!(delay(&forces[..1000], &forces), None);
        assert_eq!(delay(&[], &forces), None);
        assert_eq!(delay(&forces, &[]), None);
        // What only rises is best at the end of what is tried.
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
