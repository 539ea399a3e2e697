//! Parallel work whose results are processed in order.

use std::num::NonZero;
use std::sync::mpsc::sync_channel;
use std::thread;

/// Runs `work` on each of `items` on all processors and passes each result to `take`, in the order of the items.
/// Threads run ahead by at most two items.
///
/// # Errors
/// Returns the first error of `take`. No further work starts after it.
pub fn in_order<T: Sync, R: Send, E>(
    items: &[T],
    work: impl Fn(&T) -> R + Sync,
    mut take: impl FnMut(&T, R) -> Result<(), E>,
) -> Result<(), E> {
    let threads = thread::available_parallelism().map_or(1, NonZero::get);
    let work = &work;
    thread::scope(|scope| {
        let begin = |first: usize| {
            let (sender, receiver) = sync_channel(1);
            scope.spawn(move || {
                for item in items.iter().skip(first).step_by(threads) {
                    if sender.send(work(item)).is_err() {
                        break;
                    }
                }
            });
            receiver
        };
        let receivers: Vec<_> = (0..threads.min(items.len())).map(begin).collect();
        for (item, receiver) in items.iter().zip(receivers.iter().cycle()) {
            // If a thread panicked, the scope panics, too.
            let Ok(result) = receiver.recv() else { break };
            take(item, result)?;
        }
        Ok(())
    })
}

#[cfg(test)]
mod tests {
    use super::in_order;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread::sleep;
    use std::time::Duration;

    #[test]
    fn results_are_in_the_order_of_the_items() {
        let items: Vec<u64> = (0..40).collect();
        let mut taken = Vec::new();
        let slow_first = |&item: &u64| {
            sleep(Duration::from_micros(500 * (40 - item)));
            item * item
        };
        let took: Result<(), ()> = in_order(&items, slow_first, |&item, square| {
            taken.push((item, square));
            Ok(())
        });
        assert_eq!(took, Ok(()));
        assert!(taken.iter().copied().eq(items.iter().map(|&i| (i, i * i))));
        assert_eq!(in_order(&[0; 0], |_| (), |_, ()| Err(())), Ok(()));
    }

    #[test]
    fn an_error_stops_the_work() {
        let items = vec![(); 10_000];
        let begun = AtomicUsize::new(0);
        let count = |_: &()| begun.fetch_add(1, Ordering::Relaxed);
        assert_eq!(in_order(&items, count, |_, _| Err("full")), Err("full"));
        assert!(begun.into_inner() < 10_000);
    }
}
