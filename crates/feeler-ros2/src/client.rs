//! Service clients.

use crate::attachment::{Attachment, Gid};
use crate::node_error::NodeError;
use crate::token::Token;
use crate::type_description::Service;
use crate::wall_clock::wall_clock_ns;
use feeler_record::wire::cdr;
use std::marker::PhantomData;
use std::time::Duration;
use zenoh::liveliness::LivelinessToken;
use zenoh::query::{ConsolidationMode, QueryTarget, Reply};
use zenoh::{Session, Wait};

/// Client of a service. Dropping it ends the client.
pub struct Client<S> {
    session: Session,
    key: String,
    gid: Gid,
    /// Sequence number of the latest request.
    sequence: i64,
    _token: LivelinessToken,
    _service: PhantomData<fn(S)>,
}

impl<S: Service> Client<S> {
    pub(crate) fn declare(
        session: &Session,
        key: String,
        token: &Token,
    ) -> Result<Self, NodeError> {
        Ok(Self {
            session: session.clone(),
            key,
            gid: token.gid(),
            sequence: 0,
            _token: token.declare(session)?,
            _service: PhantomData,
        })
    }

    /// Identifier of this client, which is unique in the graph.
    pub fn gid(&self) -> Gid {
        self.gid
    }

    /// Sends `request` and waits for the response, for at most `timeout`.
    ///
    /// # Errors
    /// If there is no server, it refuses the request, or it does not respond in time.
    pub fn call(
        &mut self,
        request: &S::Request,
        timeout: Duration,
    ) -> Result<S::Response, NodeError> {
        let mut bytes = Vec::new();
        cdr::encode(request, &mut bytes)?;
        self.sequence += 1;
        let attachment = Attachment {
            sequence: self.sequence,
            stamp_ns: wall_clock_ns(),
            gid: self.gid,
        };
        let query = self
            .session
            .get(&self.key)
            .payload(bytes)
            .attachment(&attachment.encode()[..])
            .target(QueryTarget::AllComplete)
            .consolidation(ConsolidationMode::None)
            .timeout(timeout);
        let replies = query.wait()?;
        while let Ok(reply) = replies.recv() {
            if let Some(response) = self.response(&reply)? {
                return Ok(response);
            }
        }
        Err(NodeError::NoResponse {
            service: S::NAME,
            timeout: timeout.as_secs_f64(),
        })
    }

    /// Decodes a reply to the latest request. Returns `None` for a reply to an earlier one.
    fn response(&self, reply: &Reply) -> Result<Option<S::Response>, NodeError> {
        let refused = |why: String| NodeError::Refused {
            service: S::NAME,
            why,
        };
        let sample = reply.result().map_err(|error| {
            let why = String::from_utf8_lossy(&error.payload().to_bytes()).into_owned();
            refused(why)
        })?;
        let beside = sample.attachment().map(|bytes| bytes.to_bytes());
        let beside = beside.and_then(|bytes| Attachment::decode(&bytes).ok());
        let is_ours =
            |beside: Attachment| (beside.sequence, beside.gid) == (self.sequence, self.gid);
        if !beside.is_some_and(is_ours) {
            return Ok(None);
        }
        let response = cdr::decode(&sample.payload().to_bytes());
        response
            .map(Some)
            .map_err(|error| refused(error.to_string()))
    }
}
