//! Sends the latest state of a hand to all pages, 30 times per second.

use super::client::Update;
use super::feed::{Feed, Moment};
use super::state::{PendingOrder, state};
use axum::body::Bytes;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;
use tokio::sync::watch::Sender;
use tokio::time::{MissedTickBehavior, interval, sleep};

/// Time between two rows.
const INTERVAL: Duration = Duration::from_nanos(1_000_000_000 / 30);
/// Interval at which new rows are polled. The hand's thread must not spend time on waking another thread.
const LOOK: Duration = Duration::from_millis(3);

/// Sends the states of `feed` to pages until the final one. `told` is the latest order from the pages.
pub async fn pump(feed: &Feed, told: &Mutex<Option<PendingOrder>>, updates: &Sender<Update>) {
    let mut ticks = interval(INTERVAL);
    ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
    let mut newest = f64::NAN;
    let mut over = false;
    while !over {
        ticks.tick().await;
        feed.fade();
        // Requested only now; a row requested earlier would be one interval old.
        feed.want();
        let mut look = |moment: &Moment| {
            over = moment.over;
            let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
            let state = state(moment, told.as_mut()).into();
            let row = row(moment, feed.width()).filter(|_| moment.time != newest);
            updates.send_if_modified(|update| {
                let is_new = row.is_some() || update.state != state;
                update.state = state;
                if let Some(row) = row {
                    newest = moment.time;
                    (update.number, update.row) = (update.number + 1, row);
                }
                is_new
            });
        };
        while !feed.take(&mut look) {
            sleep(LOOK).await;
        }
    }
}

/// Encodes a row, or returns `None` if it is incomplete.
fn row(moment: &Moment, width: usize) -> Option<Bytes> {
    let is_whole = moment.time.is_finite() && moment.numbers.len() == width;
    is_whole.then(|| {
        let numbers = moment
            .numbers
            .iter()
            .flat_map(|number| number.to_le_bytes());
        moment
            .time
            .to_le_bytes()
            .into_iter()
            .chain(numbers)
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_is_its_time_then_its_numbers() {
        let mut moment = None;
        let feed = Feed::new(2);
        feed.want();
        feed.offer(|there| {
            there.time = 1.5;
            there.numbers.extend([2.0, f32::NAN]);
            moment = Some(there.clone());
        });
        let mut moment = moment.expect("a moment");
        let bytes = row(&moment, 2).expect("a row");
        assert_eq!(bytes.len(), 16);
        assert_eq!(bytes[..8], 1.5_f64.to_le_bytes());
        assert_eq!(bytes[8..12], 2.0_f32.to_le_bytes());
        moment.numbers.pop();
        assert!(row(&moment, 2).is_none());
    }
}
