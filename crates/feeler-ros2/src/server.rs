//! A service that a node serves.

use crate::attachment::Attachment;
use crate::node::{NodeError, wall_clock_ns};
use crate::token::Token;
use crate::type_description::Service;
use feeler_record::wire::cdr;
use std::sync::mpsc::{TrySendError, sync_channel};
use std::thread;
use zenoh::liveliness::LivelinessToken;
use zenoh::query::{Query, Queryable};
use zenoh::{Session, Wait};

/// Requests that wait for the ones before them; more are refused.
const MAX_WAITING: usize = 16;

/// What answers requests.
pub trait Answer<S: Service>: FnMut(S::Request) -> S::Response + Send + 'static {}

impl<S: Service, F: FnMut(S::Request) -> S::Response + Send + 'static> Answer<S> for F {}

/// A service that is served for as long as this is kept.
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
        // It ends when the queryable does, which has the other side.
        let work = move || {
            for query in requests {
                if let Err(why) = reply::<S>(&query, &mut answer) {
                    refuse(&query, &why);
                }
            }
        };
        thread::Builder::new().name("service".into()).spawn(work)?;
        // Zenoh's thread must not wait.
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
            _token: session
                .liveliness()
                .declare_token(token.to_string())
                .wait()?,
        })
    }
}

/// Answers a request; why not, if it is none.
fn reply<S: Service>(query: &Query, answer: &mut impl Answer<S>) -> Result<(), String> {
    let beside = query
        .attachment()
        .ok_or("an attachment expected, found none")?;
    let beside = Attachment::decode(&beside.to_bytes()).map_err(|e| e.to_string())?;
    let request = query.payload().ok_or("a request expected, found none")?;
    let request = cdr::decode::<S::Request>(&request.to_bytes()).map_err(|e| e.to_string())?;
    let mut bytes = Vec::new();
    cdr::encode(&answer(request), &mut bytes).map_err(|e| e.to_string())?;
    // The caller knows its request by number and sender.
    let beside = Attachment {
        stamp_ns: wall_clock_ns(),
        ..beside
    };
    let reply = query.reply(query.key_expr().clone(), bytes);
    let reply = reply.attachment(&beside.encode()[..]);
    reply.wait().map_err(|e| e.to_string())
}

/// Tells who asked that he gets no answer, and why.
fn refuse(query: &Query, why: &str) {
    // Who has gone needs not be told.
    let _ = query.reply_err(why).wait();
}
