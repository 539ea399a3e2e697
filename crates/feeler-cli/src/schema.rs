//! `feeler schema`

use super::{CommandError, Outcome};
use feeler_link::{message as linked, topic};
use feeler_record::wire::Message;
use feeler_record::{self, channels};
use std::io::Write;

#[derive(Debug, clap::Args)]
pub struct Arguments {
    /// Message to print alone, as in TactileUpdate or feeler_msgs/msg/TactileUpdate: nothing but its text,
    /// for a program to read [default: all, each after a line with its name and where it goes]
    name: Option<String>,
}

/// A message's type, its text, and where it goes.
struct Schema {
    name: &'static str,
    text: &'static str,
    place: String,
}

impl Schema {
    fn recorded<M: Message>(topic: &str) -> Self {
        Self {
            name: M::SCHEMA_NAME,
            text: M::SCHEMA,
            place: format!("recorded as {}", of_any_finger(topic)),
        }
    }

    fn linked<M: Message>(topic: topic::Topic) -> Self {
        Self {
            name: M::SCHEMA_NAME,
            text: M::SCHEMA,
            place: format!("linked as {}", of_any_finger(&topic.key("RIG"))),
        }
    }

    fn is_called(&self, name: &str) -> bool {
        let short = self.name.rsplit('/').next();
        self.name == name || short == Some(name)
    }
}

/// Prints the ROS 2 message text of what is recorded and linked.
pub fn schema(arguments: &Arguments, out: &mut dyn Write) -> Result<Outcome, CommandError> {
    let schemas = recorded().into_iter().chain(linked());
    let Some(name) = &arguments.name else {
        for Schema { name, text, place } in schemas {
            writeln!(out, "#### {name}, {place}\n{text}")?;
        }
        return Ok(Outcome::Done);
    };
    let schemas: Vec<_> = schemas.collect();
    let Some(schema) = schemas.iter().find(|schema| schema.is_called(name)) else {
        let names: Vec<_> = schemas.iter().map(|schema| schema.name).collect();
        return Err(format!("no message {name:?}; expected one of {}", names.join(", ")).into());
    };
    write!(out, "{}", schema.text)?;
    Ok(Outcome::Done)
}

fn recorded() -> [Schema; 13] {
    use feeler_record::Topic;
    [
        Schema::recorded::<channels::Tactile>(&Topic::Tactile(0).name()),
        Schema::recorded::<channels::Flags>(&Topic::Flags(0).name()),
        Schema::recorded::<channels::Joints>(&Topic::Joints(0).name()),
        Schema::recorded::<channels::Command>(&Topic::Command(0).name()),
        Schema::recorded::<channels::Fingertip>(&Topic::Fingertip(0).name()),
        Schema::recorded::<channels::TorqueSensor>(&Topic::TorqueSensor.name()),
        Schema::recorded::<channels::Cap>(&Topic::Cap.name()),
        Schema::recorded::<channels::Task>(&Topic::Task.name()),
        Schema::recorded::<channels::Findings>(&Topic::Findings.name()),
        Schema::recorded::<channels::ObjectPose>(&Topic::Object.name()),
        Schema::recorded::<channels::TrueSlip>(&Topic::TrueSlip.name()),
        Schema::recorded::<feeler_record::Image>(&Topic::Image(0).name()),
        Schema::recorded::<channels::Moments>(feeler_record::sensed::MOMENTS_TOPIC),
    ]
}

fn linked() -> [Schema; 9] {
    use topic::Topic;
    [
        Schema::linked::<linked::TactileUpdate>(Topic::Tactile(0)),
        Schema::linked::<linked::Picture>(Topic::Picture(0)),
        Schema::linked::<linked::DirectForces>(Topic::DirectForces(0)),
        Schema::linked::<linked::HandMode>(Topic::Mode),
        Schema::linked::<linked::HandCommand>(Topic::Command),
        Schema::linked::<linked::HandState>(Topic::State),
        Schema::linked::<linked::Heartbeat>(Topic::Heartbeat),
        Schema::linked::<linked::Stop>(Topic::Stop),
        Schema::linked::<linked::Resume>(Topic::Resume),
    ]
}

/// `topic` with N for the number of its finger, which is 0.
fn of_any_finger(topic: &str) -> String {
    topic.replace("finger/0/", "finger/N/")
}
