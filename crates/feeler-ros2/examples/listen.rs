//! Subscribes to the topics of a hand's node and counts messages. Requires no router: the hand connects to the endpoint
//! of this program.
//!
//! ```text
//! cargo run --release -p feeler-ros2 --features zenoh --example listen -- tcp/127.0.0.1:7449 20
//! feeler ros2 runs/first --ros-connect tcp/127.0.0.1:7449      # in another terminal
//! ```

use feeler_record::ros::{JointState, PointCloud2, TFMessage, WrenchStamped};
use feeler_record::wire::{Message, cdr};
use feeler_ros2::message::TactileState;
use feeler_ros2::{Node, NodeConfig, NodeError, NodeName, Qos, Subscription};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::sleep;
use std::time::Duration;

/// Subscribes to `topic` and counts valid messages.
fn count<M: Message>(
    node: &mut Node,
    topic: &str,
) -> Result<(Subscription, Arc<AtomicU64>), NodeError> {
    let count = Arc::new(AtomicU64::new(0));
    let counted = Arc::clone(&count);
    let subscription = node.subscribe::<M>(topic, Qos::DEFAULT, move |bytes, _| {
        if cdr::decode::<M>(bytes).is_ok() {
            counted.fetch_add(1, Ordering::Relaxed);
        }
    })?;
    Ok((subscription, count))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let place = arguments
        .next()
        .ok_or("expected an endpoint to listen on, such as tcp/127.0.0.1:7449")?;
    let seconds = arguments
        .next()
        .map_or(Ok(10.0), |seconds| seconds.parse())?;
    let mut node = Node::open(NodeConfig {
        name: NodeName::new(0, "/", "listener")?,
        connect: Vec::new(),
        listen: vec![place],
    })?;
    let mut topics = vec![
        (
            "/joint_states".to_string(),
            count::<JointState>(&mut node, "/joint_states")?,
        ),
        ("/tf".to_string(), count::<TFMessage>(&mut node, "/tf")?),
    ];
    for finger in 0..2 {
        let topic = |name| format!("/finger_{finger}/{name}");
        for (topic, counted) in [
            (
                topic("wrench"),
                count::<WrenchStamped>(&mut node, &topic("wrench"))?,
            ),
            (
                topic("taxels"),
                count::<PointCloud2>(&mut node, &topic("taxels"))?,
            ),
            (
                topic("tactile"),
                count::<TactileState>(&mut node, &topic("tactile"))?,
            ),
        ] {
            topics.push((topic, counted));
        }
    }
    sleep(Duration::from_secs_f64(seconds));
    for (topic, (_, count)) in &topics {
        let count = count.load(Ordering::Relaxed);
        println!("{topic} {count} messages, {:.1} Hz", count as f64 / seconds);
    }
    Ok(())
}
