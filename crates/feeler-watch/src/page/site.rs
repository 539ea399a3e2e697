//! Answers HTTP requests.

use super::access::{Address, Wanted};
use super::client::{self, Update};
use super::download::{Progress, download};
use super::feed::Feed;
use super::state::{PageMessage, PendingOrder, Request as Order};
use axum::body::Bytes;
use axum::extract::{FromRequestParts, Request, State, WebSocketUpgrade};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderValue, REFERRER_POLICY,
    X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::{Semaphore, watch};

/// Maximum number of open pages.
pub const MAX_PAGES: u32 = 8;
/// Maximum size of a page's message in bytes.
const LONGEST_MESSAGE: usize = 1024;
/// Maximum number of bytes that wait to be sent.
const LONGEST_WAITING: usize = 1 << 20;

/// State of the server.
pub struct Site {
    /// Address of the page.
    pub address: Address,
    /// HTML of the page.
    pub page: Bytes,
    /// Subject of the page.
    pub subject: Subject,
    /// Permits for opening further pages.
    pub pages: Arc<Semaphore>,
}

/// Subject of a page.
pub enum Subject {
    /// The recording in this file.
    Recording(PathBuf),
    /// A running hand.
    Live(Live),
}

/// A running hand.
pub struct Live {
    /// Exchange with the hand.
    pub feed: Arc<Feed>,
    /// Sender name of orders from the pages.
    pub by: &'static str,
    /// Latest order from the pages.
    pub told: Mutex<Option<PendingOrder>>,
    /// Updates for the pages.
    pub updates: watch::Receiver<Update>,
}

impl Live {
    fn receive(&self, message: PageMessage) {
        match message {
            PageMessage::Order(order) => self.order(order),
            PageMessage::Felt(felt) => self.feed.play(felt),
        }
    }

    fn order(&self, order: Order) {
        match order {
            Order::Stop => self.feed.stop(self.by),
            Order::Resume => self.feed.resume(),
        }
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        *told = Some(PendingOrder::now(order));
    }
}

/// Answers a request.
pub async fn answer(State(site): State<Arc<Site>>, request: Request) -> Response {
    let admitted = site
        .address
        .admit(request.method(), request.uri(), request.headers());
    let response = match admitted {
        Ok(Wanted::Page) => {
            let html = HeaderValue::from_static("text/html; charset=utf-8");
            ([(CONTENT_TYPE, html)], site.page.clone()).into_response()
        }
        Ok(Wanted::Socket) => socket(Arc::clone(&site), request).await,
        Ok(Wanted::Recording) => match &site.subject {
            Subject::Recording(path) => recording(path, &request),
            Subject::Live(_) => {
                nothing("The recording is still being written, in the folder of the run.")
            }
        },
        Ok(Wanted::Nothing) => nothing("Not found. This server provides only its page, by GET."),
        Err(refusal) => (StatusCode::FORBIDDEN, format!("{refusal}\n")).into_response(),
    };
    (guarded(&site.address), response).into_response()
}

fn nothing(said: &str) -> Response {
    (StatusCode::NOT_FOUND, format!("{said}\n")).into_response()
}

fn recording(path: &Path, request: &Request) -> Response {
    let progress = request.extensions().get::<Progress>();
    download(path, progress.cloned().unwrap_or_default())
        .unwrap_or_else(|error| nothing(&format!("{}: {error}", path.display())))
}

async fn socket(site: Arc<Site>, request: Request) -> Response {
    let (mut parts, _) = request.into_parts();
    let upgrade = match WebSocketUpgrade::from_request_parts(&mut parts, &()).await {
        Ok(upgrade) => upgrade,
        Err(rejection) => return rejection.into_response(),
    };
    if let Subject::Recording(_) = &site.subject {
        return nothing("This page shows a recording and has no live data.");
    }
    let Ok(place) = Arc::clone(&site.pages).try_acquire_owned() else {
        let said = format!("At most {MAX_PAGES} pages can be open. Close one of them.\n");
        return (StatusCode::SERVICE_UNAVAILABLE, said).into_response();
    };
    upgrade
        .max_message_size(LONGEST_MESSAGE)
        .max_frame_size(LONGEST_MESSAGE)
        .write_buffer_size(0)
        .max_write_buffer_size(LONGEST_WAITING)
        .on_upgrade(move |socket| async move {
            if let Subject::Live(live) = &site.subject {
                client::serve(socket, live.updates.clone(), |message| {
                    live.receive(message)
                })
                .await;
            }
            drop(place);
        })
}

/// Returns headers that prevent framing, caching and requests to other hosts.
fn guarded(address: &Address) -> HeaderMap {
    let sockets = address.hosts().map(|host| format!("ws://{host}")).join(" ");
    let policy = format!(
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; \
         connect-src 'self' {sockets}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    );
    let mut headers = HeaderMap::new();
    if let Ok(policy) = HeaderValue::try_from(policy) {
        headers.insert(CONTENT_SECURITY_POLICY, policy);
    }
    headers.insert(REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    headers.insert(X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers
}
