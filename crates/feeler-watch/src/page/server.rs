//! HTTP server on a background thread, reachable from this computer only.

use super::access::Address;
use super::client::Update;
use super::download::Progress;
use super::feed::Feed;
use super::pump::pump;
use super::site::{Live, MAX_PAGES, Site, Subject, answer};
use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use std::io;
use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::pin::pin;
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::Duration;
use tokio::net::{TcpListener, TcpSocket, TcpStream};
use tokio::runtime::{Builder, Runtime};
use tokio::sync::{Semaphore, oneshot, watch};
use tokio::time::{sleep, timeout};

/// Maximum number of open connections without a WebSocket.
const MAX_ASKING: usize = 16;
/// Maximum number of connections that wait to be accepted.
const BACKLOG: u32 = 16;
/// Size of a connection's send buffer in bytes. A page that does not read receives no more than this.
const SEND_BUFFER: u32 = 128 * 1024;
/// Maximum time to receive a request.
const ASKING: Duration = Duration::from_secs(5);
/// Maximum time to send a response, or the next part of a long one.
const ANSWERING: Duration = Duration::from_secs(60);
/// Time to wait after a failed accept.
const REST: Duration = Duration::from_millis(50);
/// Maximum time to wait for pages to read pending messages when the server stops.
const FAREWELL: Duration = Duration::from_secs(2);

/// Errors when starting the server.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// The port is not available.
    #[error("failed to listen on port {port}: {source}; use a free port, or 0 for any")]
    Port {
        /// The port.
        port: u16,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The token could not be created.
    #[error("failed to read the OS random source: {0}")]
    Token(#[from] getrandom::Error),
    /// The server's thread could not be started.
    #[error("failed to start the server: {0}")]
    Thread(#[from] io::Error),
}

/// A listening socket with the address of its page.
pub struct PageListener {
    runtime: Runtime,
    listener: TcpListener,
    /// Address of the page.
    pub address: Address,
}

impl PageListener {
    /// Listens on `port` of the loopback interface; 0 selects a free port.
    ///
    /// # Errors
    /// If the port is not free, or the operating system provides no random numbers.
    pub fn open(port: u16) -> Result<Self, ServerError> {
        let runtime = Builder::new_current_thread().enable_all().build()?;
        let listener = {
            let _entered = runtime.enter();
            listen(port).map_err(|source| ServerError::Port { port, source })?
        };
        let address = Address::draw(listener.local_addr()?.port())?;
        Ok(Self {
            runtime,
            listener,
            address,
        })
    }

    /// Serves `page` and the states of `feed`. Orders from the page are sent in the name of `by`.
    ///
    /// # Errors
    /// If the thread cannot be started.
    pub fn serve_live(
        self,
        page: String,
        feed: Arc<Feed>,
        by: &'static str,
    ) -> Result<Server, ServerError> {
        let (updates, receiver) = watch::channel(Update::default());
        let live = Live {
            feed,
            by,
            told: Mutex::default(),
            updates: receiver,
        };
        self.serve(page, Subject::Live(live), updates)
    }

    /// Serves `page` and the `recording` that it shows.
    ///
    /// # Errors
    /// If the thread cannot be started.
    pub fn serve_recording(self, page: String, recording: PathBuf) -> Result<Server, ServerError> {
        let (updates, _) = watch::channel(Update::default());
        self.serve(page, Subject::Recording(recording), updates)
    }

    fn serve(
        self,
        page: String,
        subject: Subject,
        updates: watch::Sender<Update>,
    ) -> Result<Server, ServerError> {
        let site = Arc::new(Site {
            address: self.address,
            page: page.into(),
            subject,
            pages: Arc::new(Semaphore::new(MAX_PAGES as usize)),
        });
        let (closing, closed) = oneshot::channel();
        let (runtime, listener) = (self.runtime, self.listener);
        let serving = move || runtime.block_on(keep_serving(listener, site, updates, closed));
        Ok(Server {
            _closing: closing,
            thread: Some(thread::Builder::new().name("page".into()).spawn(serving)?),
        })
    }
}

fn listen(port: u16) -> io::Result<TcpListener> {
    let socket = TcpSocket::new_v4()?;
    // On other systems, this would let other programs listen on the same port.
    #[cfg(unix)]
    socket.set_reuseaddr(true)?;
    socket.set_send_buffer_size(SEND_BUFFER)?;
    socket.bind(SocketAddr::from((Ipv4Addr::LOCALHOST, port)))?;
    socket.listen(BACKLOG)
}

/// A running server. When dropped, it stops after pages have received the final state of their feed, if any.
pub struct Server {
    /// Dropped to stop the server.
    _closing: oneshot::Sender<()>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Waits up to two seconds until pages have received the final state of the feed.
    pub fn wait_for_last(mut self) {
        if let Some(thread) = self.thread.take() {
            // The thread does not panic.
            let _ = thread.join();
        }
    }
}

/// Serves until the feed ends or `closed` resolves.
async fn keep_serving(
    listener: TcpListener,
    site: Arc<Site>,
    updates: watch::Sender<Update>,
    closed: oneshot::Receiver<()>,
) {
    let pumping = async {
        match &site.subject {
            Subject::Live(live) => pump(&live.feed, &live.told, &updates).await,
            Subject::Recording(_) => std::future::pending().await,
        }
    };
    tokio::select! {
        () = accept(listener, &site) => {}
        () = pumping => {}
        _ = closed => {}
    }
    // Pages end when the sender is dropped.
    drop(updates);
    let _ = timeout(FAREWELL, site.pages.acquire_many(MAX_PAGES)).await;
}

async fn accept(listener: TcpListener, site: &Arc<Site>) {
    let router = Router::new().fallback(answer).with_state(Arc::clone(site));
    let asking = Arc::new(Semaphore::new(MAX_ASKING));
    loop {
        let Ok((stream, peer)) = listener.accept().await else {
            sleep(REST).await;
            continue;
        };
        // Connections above the limit are closed at once, not queued.
        let Ok(place) = Arc::clone(&asking).try_acquire_owned() else {
            continue;
        };
        if peer.ip().is_loopback() {
            let router = router.clone();
            tokio::spawn(async move {
                serve(stream, router).await;
                drop(place);
            });
        }
    }
}

/// Serves one connection until it closes or is upgraded to a WebSocket.
async fn serve(stream: TcpStream, router: Router) {
    // Rows are small and must arrive without delay.
    let _ = stream.set_nodelay(true);
    let progress = Progress::default();
    let router = router.layer(Extension(progress.clone()));
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(ASKING)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
        .with_upgrades();
    let mut connection = pin!(connection);
    // Malformed requests and closed connections are ignored.
    while timeout(ANSWERING, connection.as_mut()).await.is_err() && progress.was_made() {}
}
