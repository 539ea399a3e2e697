//! Arbitrary input is decoded or rejected, without a panic.

use feeler_record::ros::{JointState, PointCloud2, WrenchStamped};
use feeler_record::tactile_array::TactileArray;
use feeler_record::wire::{Message, cdr};
use feeler_ros2::Attachment;
use feeler_ros2::message::*;
use proptest::prelude::*;

/// Decodes a message and, if it is valid, encodes and decodes it again.
fn decode<M: Message>(bytes: &[u8]) {
    if let Ok(message) = cdr::decode::<M>(bytes) {
        let mut again = Vec::new();
        cdr::encode(&message, &mut again).expect("a decoded message can be encoded");
        cdr::decode::<M>(&again).expect("an encoded message can be decoded");
    }
}

proptest! {
    #[test]
    fn messages(mut bytes in proptest::collection::vec(any::<u8>(), 0..300), is_cdr in any::<bool>()) {
        if is_cdr && bytes.len() >= 4 {
            bytes[..4].copy_from_slice(&[0, 1, 0, 0]);
        }
        decode::<JointState>(&bytes);
        decode::<PointCloud2>(&bytes);
        decode::<WrenchStamped>(&bytes);
        decode::<Clock>(&bytes);
        decode::<Float64MultiArray>(&bytes);
        decode::<TactileArray>(&bytes);
        decode::<TactileState>(&bytes);
        decode::<TriggerRequest>(&bytes);
        decode::<ListParametersRequest>(&bytes);
        decode::<NamesRequest<0>>(&bytes);
        decode::<SetParametersRequest<false>>(&bytes);
    }

    #[test]
    fn attachments(bytes in proptest::collection::vec(any::<u8>(), 0..100)) {
        if let Ok(attachment) = Attachment::decode(&bytes) {
            prop_assert_eq!(&attachment.encode()[..], &bytes[..]);
        }
    }
}
