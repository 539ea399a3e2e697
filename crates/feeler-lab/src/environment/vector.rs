//! Vector environments: many environments that step together, on several threads.

use super::pool::Pool;
use super::slot::{Autoreset, Order, Slot};
use super::vector_error::{VectorError, at, check_count, check_range};
use super::{Environment, EnvironmentConfig};

/// Number of work items per thread, for load balancing.
const PARTS_PER_THREAD: usize = 8;

/// Output buffers for the results of n environments, row by row. Each field states the required length.
#[derive(Debug)]
pub struct Batch<'a> {
    /// Observations; n times [`VectorEnvironment::observation_len`].
    pub observations: &'a mut [f32],
    /// Rewards; n.
    pub rewards: &'a mut [f64],
    /// `true` if each episode is over; n.
    pub terminated: &'a mut [bool],
    /// `true` if each episode was cut off; n.
    pub truncated: &'a mut [bool],
    /// Ground-truth values; n times [`VectorEnvironment::info_len`].
    pub infos: &'a mut [f64],
}

/// A set of environments with the same configuration. The results of each equal those of a single [`Environment`] with
/// the same seeds, for any number of environments and threads.
pub struct VectorEnvironment {
    pool: Pool<Part>,
    count: usize,
    size: usize,
    action_len: usize,
    observation_len: usize,
    info_len: usize,
}

/// Environments that one thread steps sequentially.
struct Part(Vec<Slot>);

impl Part {
    fn work(&mut self) {
        for slot in &mut self.0 {
            slot.work();
        }
    }
}

impl VectorEnvironment {
    /// Creates `count` environments on `threads` threads, including the caller's. Call [`reset`](Self::reset) to begin
    /// the first episodes.
    ///
    /// # Errors
    /// If the configuration is invalid, or a count is out of range.
    pub fn new(
        config: &EnvironmentConfig,
        count: usize,
        threads: usize,
        autoreset: Autoreset,
    ) -> Result<Self, VectorError> {
        check_range("environments", count)?;
        check_range("threads", threads)?;
        let first = Environment::new(config).map_err(at(0))?;
        let (action_len, observation_len) = (first.action_len(), first.observation().len());
        let info_len = first.info().len();
        let others = (1..count).map(|index| first.another().map_err(at(index)));
        let others = others.collect::<Result<Vec<_>, _>>()?;
        let environments = std::iter::once(first).chain(others);
        let mut slots = environments.map(|environment| Slot::new(environment, autoreset));
        let size = count.div_ceil(PARTS_PER_THREAD * threads);
        let parts = (0..count.div_ceil(size)).map(|_| Part(slots.by_ref().take(size).collect()));
        let pool = Pool::new(parts.collect(), threads, Part::work);
        Ok(Self {
            pool: pool.map_err(|source| VectorError::Threads { threads, source })?,
            count,
            size,
            action_len,
            observation_len,
            info_len,
        })
    }

    /// Number of environments.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Length of one environment's action.
    pub fn action_len(&self) -> usize {
        self.action_len
    }

    /// Length of one environment's observation.
    pub fn observation_len(&self) -> usize {
        self.observation_len
    }

    /// Number of info values per environment.
    pub fn info_len(&self) -> usize {
        self.info_len
    }

    /// Begins an episode in each environment, or in each one whose entry of `mask` is `true`, with the given seed or
    /// the next one ([`Environment::reset`]). The rows of other environments are not changed.
    ///
    /// # Errors
    /// If a length is wrong; nothing is changed then. If an episode cannot begin.
    pub fn reset(
        &mut self,
        seeds: &[Option<u64>],
        mask: Option<&[bool]>,
        batch: &mut Batch<'_>,
    ) -> Result<(), VectorError> {
        check_count("seeds", self.count, seeds.len())?;
        if let Some(mask) = mask {
            check_count("entries of the mask", self.count, mask.len())?;
        }
        self.check(batch)?;
        self.each(|index, slot| {
            slot.order = match mask.is_none_or(|mask| mask[index]) {
                true => Order::Reset(seeds[index]),
                false => Order::Rest,
            };
        });
        self.run(batch)
    }

    /// Makes a control step in each environment, or begins its next episode if the last one ended. `actions` has one
    /// row per environment. Does not allocate unless an episode begins.
    ///
    /// # Errors
    /// If a length is wrong; nothing is changed then. If an environment rejects its action or fails; the others have
    /// made their step and all rows are written.
    pub fn step(&mut self, actions: &[f64], batch: &mut Batch<'_>) -> Result<(), VectorError> {
        let length = self.action_len;
        check_count("numbers of all actions", self.count * length, actions.len())?;
        self.check(batch)?;
        self.each(|index, slot| {
            slot.order = Order::Step;
            let own = &actions[index * length..][..length];
            slot.action.copy_from_slice(own);
        });
        self.run(batch)
    }

    /// Writes the final observation and info of environment `index` if the latest step ended its episode and began
    /// another one ([`Autoreset::SameStep`]). Returns `true` if it did.
    ///
    /// # Errors
    /// If there is no such environment, or a buffer has the wrong length.
    pub fn last(
        &self,
        index: usize,
        observation: &mut [f32],
        info: &mut [f64],
    ) -> Result<bool, VectorError> {
        check_count(
            "numbers of the observation",
            self.observation_len,
            observation.len(),
        )?;
        check_count("numbers of the info", self.info_len, info.len())?;
        self.with(index, |slot| {
            if slot.last.is_new {
                observation.copy_from_slice(&slot.last.observation);
                info.copy_from_slice(&slot.last.info);
            }
            slot.last.is_new
        })
    }

    /// Calls `look` with environment `index` and returns the result.
    ///
    /// # Errors
    /// If there is no such environment.
    pub fn look<R>(
        &self,
        index: usize,
        look: impl FnOnce(&Environment) -> R,
    ) -> Result<R, VectorError> {
        self.with(index, |slot| look(&slot.environment))
    }

    fn with<R>(&self, index: usize, look: impl FnOnce(&Slot) -> R) -> Result<R, VectorError> {
        let part = self.pool.parts().nth(index / self.size);
        let found = part.and_then(|part| part.0.get(index % self.size).map(look));
        found.ok_or_else(|| VectorError::Count {
            what: "the number of an environment",
            expected: format!("0 to {}", self.count - 1),
            actual: index,
        })
    }

    fn each(&self, mut work: impl FnMut(usize, &mut Slot)) {
        for (part, first) in self.pool.parts().zip((0..).step_by(self.size)) {
            let mut part = part;
            for (index, slot) in (first..).zip(&mut part.0) {
                work(index, slot);
            }
        }
    }

    /// Executes the requested operations and collects the results.
    fn run(&self, batch: &mut Batch<'_>) -> Result<(), VectorError> {
        let ran = self.pool.run();
        let (observation_len, info_len) = (self.observation_len, self.info_len);
        let mut failed = None;
        self.each(|index, slot| {
            if slot.order == Order::Rest {
                return;
            }
            let row = &mut batch.observations[index * observation_len..][..observation_len];
            row.copy_from_slice(slot.environment.observation());
            let row = &mut batch.infos[index * info_len..][..info_len];
            row.copy_from_slice(slot.environment.info());
            batch.rewards[index] = slot.step.reward;
            batch.terminated[index] = slot.step.terminated;
            batch.truncated[index] = slot.step.truncated;
            if let Some(source) = slot.error.take() {
                failed.get_or_insert((index, source));
            }
        });
        if let Err((part, message)) = ran {
            let first = part * self.size;
            return Err(VectorError::Panicked {
                first,
                last: (first + self.size).min(self.count) - 1,
                message,
            });
        }
        match failed {
            Some((index, source)) => Err(at(index)(source)),
            None => Ok(()),
        }
    }

    fn check(&self, batch: &Batch<'_>) -> Result<(), VectorError> {
        let count = self.count;
        for (what, expected, actual) in [
            (
                "numbers of all observations",
                count * self.observation_len,
                batch.observations.len(),
            ),
            ("rewards", count, batch.rewards.len()),
            ("flags for terminated", count, batch.terminated.len()),
            ("flags for truncated", count, batch.truncated.len()),
            (
                "numbers of all infos",
                count * self.info_len,
                batch.infos.len(),
            ),
        ] {
            check_count(what, expected, actual)?;
        }
        Ok(())
    }
}
