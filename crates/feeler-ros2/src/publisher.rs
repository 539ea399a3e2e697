//! Publishers of topics.

use crate::attachment::{Attachment, Gid};
use crate::node_error::NodeError;
use crate::qos::{Durability, History, Qos, Reliability};
use crate::token::Token;
use crate::wall_clock::wall_clock_ns;
use feeler_record::wire::{Message, cdr};
use std::marker::PhantomData;
use zenoh::liveliness::LivelinessToken;
use zenoh::qos::CongestionControl;
use zenoh::{Session, Wait};
use zenoh_ext::{AdvancedPublisher, AdvancedPublisherBuilderExt, CacheConfig};

/// Publisher of messages of type `M` on one topic. Dropping it ends the publisher.
pub struct Publisher<M> {
    outlet: Outlet,
    gid: Gid,
    sequence: i64,
    /// Reused buffer for encoded messages.
    bytes: Vec<u8>,
    _token: LivelinessToken,
    _message: PhantomData<fn(M)>,
}

enum Outlet {
    /// Late subscribers receive nothing.
    Volatile(zenoh::pubsub::Publisher<'static>),
    /// Late subscribers query a cache of published messages.
    Cached(AdvancedPublisher<'static>),
}

impl<M: Message> Publisher<M> {
    pub(crate) fn declare(
        session: &Session,
        key: String,
        token: &Token,
        qos: Qos,
    ) -> Result<Self, NodeError> {
        let congestion = match (qos.reliability, qos.history) {
            (Reliability::Reliable, History::KeepAll) => CongestionControl::Block,
            _ => CongestionControl::Drop,
        };
        let publisher = session
            .declare_publisher(key)
            .congestion_control(congestion);
        let outlet = match qos.durability {
            Durability::Volatile => Outlet::Volatile(publisher.wait()?),
            Durability::TransientLocal => {
                let depth = match qos.history {
                    History::KeepLast(depth) => depth,
                    History::KeepAll => usize::MAX,
                };
                let cache = CacheConfig::default().max_samples(depth);
                let publisher = publisher.advanced().cache(cache).publisher_detection();
                Outlet::Cached(publisher.wait()?)
            }
        };
        Ok(Self {
            outlet,
            gid: token.gid(),
            sequence: 0,
            bytes: Vec::new(),
            _token: token.declare(session)?,
            _message: PhantomData,
        })
    }

    /// Publishes `message`. If the network is congested, drops the message; if the quality of service is reliable and
    /// keeps all messages, blocks instead.
    ///
    /// # Errors
    /// If the message cannot be encoded, or the session is closed.
    pub fn publish(&mut self, message: &M) -> Result<(), NodeError> {
        self.bytes.clear();
        cdr::encode(message, &mut self.bytes)?;
        self.sequence += 1;
        let attachment = Attachment {
            sequence: self.sequence,
            stamp_ns: wall_clock_ns(),
            gid: self.gid,
        };
        let (bytes, attachment) = (&self.bytes[..], &attachment.encode()[..]);
        match &self.outlet {
            Outlet::Volatile(outlet) => outlet.put(bytes).attachment(attachment).wait()?,
            Outlet::Cached(outlet) => outlet.put(bytes).attachment(attachment).wait()?,
        }
        Ok(())
    }
}
