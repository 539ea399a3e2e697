//! Work on all processors, whose results are taken in order.

use std::num::NonZero;
use std::sync::mpsc::sync_channel;
use std::thread;

/// Does `work` on each of `items`, on as many threads as there are processors, and gives `take` what comes of each, in the order of
/// the items. Threads are two items ahead of that at most.
///
/// # Errors
/// The first one of `take`, after which no other work begins.
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
            // Where a thread panicked, the scope does, too.
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
    fn results_come_in_order_of_the_items_however_long_each_takes() {
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
    fn an_error_ends_the_work() {
        let items = vec![(); 10_000];
        let begun = AtomicUsize::new(0);
        let count = |_: &()| begun.fetch_add(1, Ordering::Relaxed);
        assert_eq!(in_order(&items, count, |_, _| Err("full")), Err("full"));
        assert!(begun.into_inner() < 10_000);
    }
}
