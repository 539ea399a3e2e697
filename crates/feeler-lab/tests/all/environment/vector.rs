//! Vectorized environments: each behaves like a single environment.

use super::support::{config, environment};
use feeler_lab::environment::{Autoreset, Batch, Environment, VectorEnvironment};

const COUNT: usize = 5;
/// Truncates episodes after 20 steps.
const SETTINGS: [&str; 1] = ["time_limit=0.2"];

/// Buffers for the results of all environments.
struct Buffers {
    observations: Vec<f32>,
    rewards: Vec<f64>,
    terminated: Vec<bool>,
    truncated: Vec<bool>,
    infos: Vec<f64>,
}

impl Buffers {
    fn of(vector: &VectorEnvironment) -> Self {
        let count = vector.count();
        Self {
            observations: vec![f32::NAN; count * vector.observation_len()],
            rewards: vec![f64::NAN; count],
            terminated: vec![true; count],
            truncated: vec![true; count],
            infos: vec![f64::NAN; count * vector.info_len()],
        }
    }

    fn batch(&mut self) -> Batch<'_> {
        Batch {
            observations: &mut self.observations,
            rewards: &mut self.rewards,
            terminated: &mut self.terminated,
            truncated: &mut self.truncated,
            infos: &mut self.infos,
        }
    }

    /// Asserts that row `index` equals the state of `environment`, with this reward and truncation flag.
    fn assert_row(
        &self,
        index: usize,
        environment: &Environment,
        (reward, truncated): (f64, bool),
    ) {
        let row = |length| index * length..(index + 1) * length;
        let (observation, info) = (environment.observation(), environment.info());
        assert_eq!(&self.observations[row(observation.len())], observation);
        assert_eq!(&self.infos[row(info.len())], info);
        assert_eq!(
            (self.rewards[index], self.truncated[index]),
            (reward, truncated)
        );
        assert!(!self.terminated[index]);
    }
}

fn vector(threads: usize, autoreset: Autoreset) -> VectorEnvironment {
    let vector =
        VectorEnvironment::new(&config("cap-closing", &SETTINGS), COUNT, threads, autoreset);
    vector.expect("environments")
}

fn seeds() -> [Option<u64>; COUNT] {
    std::array::from_fn(|index| Some(10 + index as u64))
}

/// Arbitrary action of environment `index` in step `step` (m/s).
fn action(index: usize, step: usize) -> [f64; 6] {
    std::array::from_fn(|number| 0.01 * ((index + 3 * step + 7 * number) as f64).sin())
}

#[test]
fn vectorized_environments_equal_single_ones_with_any_threads_and_autoreset() {
    for autoreset in [Autoreset::NextStep, Autoreset::SameStep] {
        for threads in [1, 2, 3, 9] {
            let mut vector = vector(threads, autoreset);
            let mut buffers = Buffers::of(&vector);
            vector
                .reset(&seeds(), None, &mut buffers.batch())
                .expect("episodes");
            let mut singles: Vec<_> = (0..COUNT)
                .map(|_| environment("cap-closing", &SETTINGS))
                .collect();
            let mut ended = false;
            for (single, seed) in singles.iter_mut().zip(seeds()) {
                single.reset(seed).expect("an episode");
            }
            for step in 0..70 {
                let actions: Vec<f64> = (0..COUNT).flat_map(|index| action(index, step)).collect();
                vector.step(&actions, &mut buffers.batch()).expect("a step");
                let mut ends = false;
                for (index, single) in singles.iter_mut().enumerate() {
                    let (mut reward, mut truncated) = (0.0, false);
                    if ended && autoreset == Autoreset::NextStep {
                        single.reset(None).expect("an episode");
                    } else {
                        let made = single.step(&action(index, step)).expect("a step");
                        (reward, truncated) = (made.reward, made.truncated);
                        ends = truncated;
                    }
                    let mut last = (
                        vec![0.0; single.observation().len()],
                        vec![0.0; single.info().len()],
                    );
                    let is_new = vector.last(index, &mut last.0, &mut last.1).expect("room");
                    assert_eq!(is_new, ends && autoreset == Autoreset::SameStep);
                    if is_new {
                        assert_eq!(
                            (&last.0[..], &last.1[..]),
                            (single.observation(), single.info())
                        );
                        single.reset(None).expect("an episode");
                    }
                    buffers.assert_row(index, single, (reward, truncated));
                }
                ended = ends;
            }
        }
    }
}

#[test]
fn without_autoreset_only_masked_environments_are_reset() {
    let mut vector = vector(2, Autoreset::Disabled);
    let mut buffers = Buffers::of(&vector);
    vector
        .reset(&seeds(), None, &mut buffers.batch())
        .expect("episodes");
    let still = [0.0; 6 * COUNT];
    while !buffers.truncated[0] {
        vector.step(&still, &mut buffers.batch()).expect("a step");
    }
    assert_eq!(buffers.truncated, [true; COUNT]);
    let error = vector
        .step(&still, &mut buffers.batch())
        .expect_err("all episodes have ended");
    assert!(
        error
            .to_string()
            .starts_with("environment 0: no episode is active"),
        "{error}"
    );
    let mask = [false, true, false, true, false];
    let before = buffers.observations.clone();
    vector
        .reset(&seeds(), Some(&mask), &mut buffers.batch())
        .expect("episodes");
    let length = vector.observation_len();
    for (index, masked) in mask.into_iter().enumerate() {
        let row = index * length..(index + 1) * length;
        assert_eq!(buffers.observations[row.clone()] != before[row], masked);
        assert_eq!(buffers.truncated[index], !masked);
        let mut single = environment("cap-closing", &SETTINGS);
        single.reset(seeds()[index]).expect("an episode");
        let time = vector
            .look(index, |own| own.info()[0])
            .expect("an environment");
        assert_eq!(time == single.info()[0], masked);
    }
}

#[test]
fn invalid_arguments_are_rejected_with_messages_that_name_the_environment() {
    let mut vector = vector(2, Autoreset::NextStep);
    let mut buffers = Buffers::of(&vector);
    vector
        .reset(&seeds(), None, &mut buffers.batch())
        .expect("episodes");
    let mut actions = [0.0; 6 * COUNT];
    actions[3 * 6 + 1] = f64::NAN;
    let told = |error: Result<(), feeler_lab::environment::VectorError>, words: &str| {
        let error = error.expect_err("an error").to_string();
        assert!(error.contains(words), "{error}");
    };
    told(
        vector.step(&actions, &mut buffers.batch()),
        "environment 3: action[1]: expected a finite number",
    );
    told(
        vector.step(&actions[1..], &mut buffers.batch()),
        "numbers of all actions: expected 30, got 29",
    );
    told(
        vector.reset(&seeds()[1..], None, &mut buffers.batch()),
        "seeds: expected 5, got 4",
    );
    told(
        vector.reset(&seeds(), Some(&[true]), &mut buffers.batch()),
        "mask: expected 5, got 1",
    );
    buffers.rewards.pop();
    told(
        vector.step(&[0.0; 30], &mut buffers.batch()),
        "rewards: expected 5, got 4",
    );
    assert!(vector.look(COUNT, |_| ()).is_err());
    assert!(vector.last(0, &mut [], &mut []).is_err());
    for (count, threads) in [(0, 1), (1, 0), (1 << 20, 1)] {
        let config = config("cap-closing", &SETTINGS);
        assert!(VectorEnvironment::new(&config, count, threads, Autoreset::NextStep).is_err());
    }
}
