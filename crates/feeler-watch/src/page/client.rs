//! The WebSocket connection to one page.

use super::state::PageMessage;
use axum::body::Bytes;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use std::pin::pin;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use tokio::sync::watch::Receiver;
use tokio::time::{MissedTickBehavior, interval, timeout};

/// Interval at which a page is pinged to check that it has read the sent messages.
const PING: Duration = Duration::from_secs(1);
/// Number of unanswered pings at which only the latest update is sent, so that a slow page misses rows.
const BEHIND: u64 = 2;
/// Number of unanswered pings at which the page is considered gone.
const GONE: u64 = 6;
/// Maximum time to send a message; after it, the connection is closed.
const PATIENCE: Duration = Duration::from_secs(5);

/// The latest row and state for all pages. There is no queue: an update that a slow page misses is replaced by the
/// next.
#[derive(Debug, Clone, Default)]
pub struct Update {
    /// Number of the row, increasing.
    pub number: u64,
    /// Encoded row.
    pub row: Bytes,
    /// State of the hand (JSON).
    pub state: Utf8Bytes,
}

/// Serves one page until either side closes the connection. Messages from the page are passed to `receive`.
pub async fn serve(socket: WebSocket, updates: Receiver<Update>, receive: impl Fn(PageMessage)) {
    let (sink, stream) = socket.split();
    let answered = AtomicU64::new(0);
    let outlet = Outlet {
        sink,
        answered: &answered,
        asked: 0,
        number: updates.borrow().number,
        state: Utf8Bytes::default(),
    };
    let mut listening = pin!(listen(stream, &answered, receive));
    tokio::select! {
        sent = outlet.keep_sending(updates) => if sent.is_ok() {
            // Closing with unread messages would reset the connection and lose data in flight.
            let _ = timeout(PATIENCE, listening).await;
        },
        () = &mut listening => {}
    }
}

/// Reads the messages from a page. Invalid messages are ignored.
async fn listen(
    mut stream: SplitStream<WebSocket>,
    answered: &AtomicU64,
    receive: impl Fn(PageMessage),
) {
    while let Some(Ok(message)) = stream.next().await {
        match message {
            Message::Text(text) => {
                if let Some(message) = PageMessage::read(&text) {
                    receive(message);
                }
            }
            Message::Pong(number) => {
                if let Ok(number) = <[u8; 8]>::try_from(&number[..]) {
                    answered.fetch_max(u64::from_le_bytes(number), Ordering::Relaxed);
                }
            }
            Message::Close(_) => break,
            Message::Binary(_) | Message::Ping(_) => {}
        }
    }
}

/// Sends updates to one page.
struct Outlet<'a> {
    sink: SplitSink<WebSocket, Message>,
    /// Number of the latest ping that the page answered.
    answered: &'a AtomicU64,
    /// Number of the latest ping that was sent.
    asked: u64,
    /// Number of the latest row sent.
    number: u64,
    state: Utf8Bytes,
}

/// Error if a page no longer receives.
struct Disconnected;

impl Outlet<'_> {
    /// Sends updates until the sender is dropped, and then the last update.
    async fn keep_sending(mut self, mut updates: Receiver<Update>) -> Result<(), Disconnected> {
        let mut pings = interval(PING);
        pings.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                changed = updates.changed() => if changed.is_err() {
                    // The sender was dropped.
                    break;
                },
                _ = pings.tick() => self.ping().await?,
            }
            // Cloned, because a borrow would block the next update while this one is sent.
            let update = updates.borrow_and_update().clone();
            if self.waiting() < BEHIND {
                self.show(update).await?;
            }
        }
        // Sent to slow pages, too, because it reports how the run ended.
        let last = updates.borrow().clone();
        self.show(last).await?;
        // The connection ends even if the close is not received.
        let _ = timeout(PATIENCE, self.sink.close()).await;
        Ok(())
    }

    /// Returns the number of unanswered pings.
    fn waiting(&self) -> u64 {
        let answered = self.answered.load(Ordering::Relaxed);
        self.asked.saturating_sub(answered)
    }

    async fn ping(&mut self) -> Result<(), Disconnected> {
        if self.waiting() >= GONE {
            return Err(Disconnected);
        }
        self.asked += 1;
        let number = Bytes::copy_from_slice(&self.asked.to_le_bytes());
        self.send(Message::Ping(number)).await
    }

    /// Sends the changed parts of `update`.
    async fn show(&mut self, update: Update) -> Result<(), Disconnected> {
        if update.number != self.number {
            self.number = update.number;
            self.send(Message::Binary(update.row)).await?;
        }
        if update.state != self.state {
            self.state = update.state.clone();
            self.send(Message::Text(update.state)).await?;
        }
        Ok(())
    }

    async fn send(&mut self, message: Message) -> Result<(), Disconnected> {
        match timeout(PATIENCE, self.sink.send(message)).await {
            Ok(Ok(())) => Ok(()),
            Ok(Err(_)) | Err(_) => Err(Disconnected),
        }
    }
}
