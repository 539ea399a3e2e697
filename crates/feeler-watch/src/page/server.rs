//! The server: a thread of its own, for browsers of this computer.

use super::access::Address;
use super::client::Update;
use super::download::Progress;
use super::feed::Feed;
use super::pump::pump;
use super::site::{Live, MOST_PAGES, Site, Subject, answer};
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

/// Connections that ask for something, or have not asked yet; pages that look are not among them.
const MOST_ASKING: usize = 16;
/// Connections that the system keeps until they are accepted.
const BACKLOG: u32 = 16;
/// Bytes on their way that the system keeps for a connection: a page that does not read gets no more.
const SEND_BUFFER: u32 = 128 * 1024;
/// A request is to be there within this time.
const ASKING: Duration = Duration::from_secs(5);
/// An answer is to be taken within this time, and of a long one the next part.
const ANSWERING: Duration = Duration::from_secs(60);
/// Where the system has no connections to give, it is asked again after this time.
const REST: Duration = Duration::from_millis(50);
/// Pages are waited for this long in the end: a page that is behind has to take what is on its way first.
const FAREWELL: Duration = Duration::from_secs(2);

/// Why nothing is served.
#[derive(Debug, thiserror::Error)]
pub enum ServerError {
    /// The port is not to be had.
    #[error(
        "port {port} of this computer cannot be listened at: {source}; expected a free one, or 0 for any"
    )]
    Port {
        /// The port.
        port: u16,
        /// What the system said.
        source: io::Error,
    },
    /// There are no random numbers for a token.
    #[error("the system gives no random numbers for the token: {0}")]
    Token(#[from] getrandom::Error),
    /// There is no thread to serve on.
    #[error("the server cannot begin: {0}")]
    Thread(#[from] io::Error),
}

/// A place where a page can be served.
pub struct Door {
    runtime: Runtime,
    listener: TcpListener,
    /// Where that is.
    pub address: Address,
}

impl Door {
    /// At `port` of this computer, which nobody else reaches; at any where that is 0.
    ///
    /// # Errors
    /// When the port is not free, or the system gives no random numbers.
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

    /// Serves `page` here, and what `feed` has, whose orders are given as from `by`.
    ///
    /// # Errors
    /// When there is no thread for it.
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

    /// Serves `page` here, and the `recording` that it is of.
    ///
    /// # Errors
    /// When there is no thread for it.
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
            pages: Arc::new(Semaphore::new(MOST_PAGES as usize)),
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
    // Elsewhere this would let others listen at the same port.
    #[cfg(unix)]
    socket.set_reuseaddr(true)?;
    socket.set_send_buffer_size(SEND_BUFFER)?;
    socket.bind(SocketAddr::from((Ipv4Addr::LOCALHOST, port)))?;
    socket.listen(BACKLOG)
}

/// A server at work, until it is dropped. Pages get the last moment of their feed, where it has one, before it ends.
pub struct Server {
    /// Dropped to say that the server is to end.
    _closing: oneshot::Sender<()>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    /// Waits until pages have the last moment of the feed, but no longer than two seconds.
    pub fn wait_for_last(mut self) {
        if let Some(thread) = self.thread.take() {
            // It does not panic, and would have said so.
            let _ = thread.join();
        }
    }
}

/// Serves until the feed is over or `closed`.
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
    // Pages see by this that nothing more comes.
    drop(updates);
    let _ = timeout(FAREWELL, site.pages.acquire_many(MOST_PAGES)).await;
}

async fn accept(listener: TcpListener, site: &Arc<Site>) {
    let router = Router::new().fallback(answer).with_state(Arc::clone(site));
    let asking = Arc::new(Semaphore::new(MOST_ASKING));
    loop {
        let Ok((stream, peer)) = listener.accept().await else {
            sleep(REST).await;
            continue;
        };
        // One too many is closed at once: nobody who waits is told that it may come to something.
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

/// Answers what comes over one connection, up to its end or to a socket.
async fn serve(stream: TcpStream, router: Router) {
    // Rows are small, and are to be seen at once.
    let _ = stream.set_nodelay(true);
    let progress = Progress::default();
    let router = router.layer(Extension(progress.clone()));
    let connection = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(ASKING)
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(router))
        .with_upgrades();
    let mut connection = pin!(connection);
    // Who asks nonsense, or leaves, is not answered.
    while timeout(ANSWERING, connection.as_mut()).await.is_err() && progress.was_made() {}
}
