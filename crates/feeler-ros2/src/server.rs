//! Service servers.

use crate::attachment::Attachment;
use crate::node_error::NodeError;
use crate::token::Token;
use crate::type_description::Service;
use crate::wall_clock::wall_clock_ns;
use feeler_record::wire::cdr;
use std::sync::mpsc::{TrySendError, sync_channel};
use std::thread;
use zenoh::liveliness::LivelinessToken;
use zenoh::query::{Query, Queryable};
use zenoh::{Session, Wait};

/// Maximum number of waiting requests of a service; further ones are rejected.
const MAX_WAITING: usize = 16;

/// Handler of a service's requests.
pub trait Answer<S: Service>: FnMut(S::Request) -> S::Response + Send + 'static {}

impl<S: Service, F: FnMut(S::Request) -> S::Response + Send + 'static> Answer<S> for F {}

/// Server of a service. Dropping it ends the service.
pub(crate) struct Server {
    _queryable: Queryable<()>,
    _token: LivelinessToken,
}

impl Server {
    pub(crate) fn declare<S: Service>(
        session: &Session,
        key: String,
        token: &Token,
        mut answer: impl Answer<S>,
    ) -> Result<Self, NodeError> {
        let (waiting, requests) = sync_channel::<Query>(MAX_WAITING);
        // Ends when the queryable is dropped, as its callback owns the sender.
        let work = move || {
            for query in requests {
                if let Err(why) = reply::<S>(&query, &mut answer) {
                    refuse(&query, &why);
                }
            }
        };
        thread::Builder::new().name("service".into()).spawn(work)?;
        // Zenoh's thread must not block.
        let callback = move |query| match waiting.try_send(query) {
            Ok(()) => {}
            Err(TrySendError::Full(query) | TrySendError::Disconnected(query)) => {
                refuse(&query, "busy with other requests");
            }
        };
        let queryable = session
            .declare_queryable(key)
            .complete(true)
            .callback(callback);
        Ok(Self {
            _queryable: queryable.wait()?,
            _token: token.declare(session)?,
        })
    }
}

/// Replies to a request.
///
/// # Errors
/// Returns the reason if the request is invalid or the reply fails.
fn reply<S: Service>(query: &Query, answer: &mut impl Answer<S>) -> Result<(), String> {
    let beside = query
        .attachment()
        .ok_or("expected an attachment, found none")?;
    let beside = Attachment::decode(&beside.to_bytes()).map_err(|e| e.to_string())?;
    let request = query.payload().ok_or("expected a request, found none")?;
    let request = cdr::decode::<S::Request>(&request.to_bytes()).map_err(|e| e.to_string())?;
    let mut bytes = Vec::new();
    cdr::encode(&answer(request), &mut bytes).map_err(|e| e.to_string())?;
    // The client matches the response to its request by sequence number and source.
    let beside = Attachment {
        stamp_ns: wall_clock_ns(),
        ..beside
    };
    let reply = query.reply(query.key_expr().clone(), bytes);
    let reply = reply.attachment(&beside.encode()[..]);
    reply.wait().map_err(|e| e.to_string())
}

/// Replies with an error that contains the reason.
fn refuse(query: &Query, why: &str) {
    // The client may have disconnected.
    let _ = query.reply_err(why).wait();
}
