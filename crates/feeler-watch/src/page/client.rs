//! One page that looks: what it gets, and what it says.

use super::state::Request;
use axum::body::Bytes;
use axum::extract::ws::{Message, Utf8Bytes, WebSocket};
use futures_util::stream::{SplitSink, SplitStream};
use futures_util::{SinkExt, StreamExt};
use std::pin::pin;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;
use tokio::sync::watch::Receiver;
use tokio::time::{MissedTickBehavior, interval, timeout};

/// A page is asked so often whether it has read what was sent.
const PING: Duration = Duration::from_secs(1);
/// While so many questions wait for their answers, nothing else is sent but the last update: a page that is slow misses rows.
const BEHIND: u64 = 2;
/// With so many, nobody is there.
const GONE: u64 = 6;
/// A message that the system does not take for so long is not sent, and nothing after it.
const PATIENCE: Duration = Duration::from_secs(5);

/// The newest of what pages get. There is no queue: what a page is too slow for is replaced by the next.
#[derive(Debug, Clone, Default)]
pub struct Update {
    /// Number of the row.
    pub number: u64,
    /// The row.
    pub row: Bytes,
    /// What the hand is about.
    pub state: Utf8Bytes,
}

/// Serves one page until either side has enough; `order` gets what it asks for.
pub async fn serve(socket: WebSocket, updates: Receiver<Update>, order: impl Fn(Request)) {
    let (sink, stream) = socket.split();
    let answered = AtomicU64::new(0);
    let outlet = Outlet {
        sink,
        answered: &answered,
        asked: 0,
        number: updates.borrow().number,
        state: Utf8Bytes::default(),
    };
    let mut listening = pin!(listen(stream, &answered, order));
    tokio::select! {
        sent = outlet.keep_sending(updates) => if sent.is_ok() {
            // Whoever leaves with messages unread takes back what is still on its way to the page.
            let _ = timeout(PATIENCE, listening).await;
        },
        () = &mut listening => {}
    }
}

/// Takes in what a page says. What makes no sense changes nothing.
async fn listen(mut stream: SplitStream<WebSocket>, answered: &AtomicU64, order: impl Fn(Request)) {
    while let Some(Ok(message)) = stream.next().await {
        match message {
            Message::Text(text) => {
                if let Some(request) = Request::read(&text) {
                    order(request);
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

/// The way to a page.
struct Outlet<'a> {
    sink: SplitSink<WebSocket, Message>,
    /// The number of the newest question that the page answered.
    answered: &'a AtomicU64,
    /// The number of the newest that it was asked.
    asked: u64,
    /// What it has seen.
    number: u64,
    state: Utf8Bytes,
}

/// That nobody takes what is sent.
struct Gone;

impl Outlet<'_> {
    /// Sends what is new until there is nothing more to come, and then the last of it.
    async fn keep_sending(mut self, mut updates: Receiver<Update>) -> Result<(), Gone> {
        let mut pings = interval(PING);
        pings.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            tokio::select! {
                changed = updates.changed() => if changed.is_err() {
                    // There is nothing more to come.
                    break;
                },
                _ = pings.tick() => self.ping().await?,
            }
            // It is not borrowed while it is sent: the next update waits for nobody.
            let update = updates.borrow_and_update().clone();
            if self.waiting() < BEHIND {
                self.show(update).await?;
            }
        }
        // A page that is behind gets it, too: it says how everything ended.
        let last = updates.borrow().clone();
        self.show(last).await?;
        // Where it is not taken, the connection ends all the same.
        let _ = timeout(PATIENCE, self.sink.close()).await;
        Ok(())
    }

    /// Questions that wait for an answer. A page cannot answer what it was not asked.
    fn waiting(&self) -> u64 {
        let answered = self.answered.load(Ordering::Relaxed);
        self.asked.saturating_sub(answered)
    }

    async fn ping(&mut self) -> Result<(), Gone> {
        if self.waiting() >= GONE {
            return Err(Gone);
        }
        self.asked += 1;
        let number = Bytes::copy_from_slice(&self.asked.to_le_bytes());
        self.send(Message::Ping(number)).await
    }

    /// Sends what is new of `update`.
    async fn show(&mut self, update: Update) -> Result<(), Gone> {
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

    async fn send(&mut self, message: Message) -> Result<(), Gone> {
        match timeout(PATIENCE, self.sink.send(message)).await {
            Ok(Ok(())) => Ok(()),
            Ok(Err(_)) | Err(_) => Err(Gone),
        }
    }
}
