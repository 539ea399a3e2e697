//! Model of a rig with one finger, whose programs do the same as the real ones in a control period.

use super::periods::{Channel, Fate, Happening, Period};
use feeler_link::hand::{Permission, RigSpeed, RunClock};
use feeler_link::inboxes::{Expected, HandInbox, Inbox, RigInbox, SenseInbox};
use feeler_link::messages::JointCounts;
use feeler_link::messages::message::{
    CommandMessage, HandMode, Heartbeat, MessageHeader, NO_ELEMENT, NO_FINGER, PROTOCOL,
    ResumeMessage, StateMessage, StopMessage, TactileUpdate,
};
use feeler_link::transport::{Topic, encode, header};
use feeler_record::wire::{Message, Vector3};

/// Control period (s).
const PERIOD: f64 = 0.01;
/// Age above which data are stale (s).
const STALE: f64 = 0.035;
/// Timeout of the rig's watchdog, and maximum age of the data that its commands are based on (s).
const WATCHDOG: f64 = STALE + PERIOD;
/// Offsets of the programs' clocks from the first hand's clock (s).
const RIG_AHEAD: f64 = 100.0;
const SENSOR_AHEAD: f64 = -7.0;
/// Number of messages to the hands that are stored for replay.
const KEPT: usize = 12;

/// Violation of an invariant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Violation {
    MovedOnStaleData,
    MovedWhileStopped,
    TwoHands,
    DroveOnByItself,
}

/// A hand program.
#[derive(Debug, Clone)]
struct HandProgram {
    instance: u64,
    inbox: HandInbox,
    began: bool,
    moves: bool,
    /// Ids of orders that have arrived and have not been resumed.
    stopped_by: Vec<u64>,
    /// Ids of resumed orders.
    resumed: Vec<u64>,
}

#[derive(Debug, Clone)]
struct RigProgram {
    instance: u64,
    inbox: RigInbox,
}

#[derive(Debug, Clone)]
struct SensorProgram {
    instance: u64,
    inbox: SenseInbox,
}

/// A message in flight.
#[derive(Debug, Clone)]
struct Sent {
    channel: Channel,
    topic: Topic,
    bytes: Vec<u8>,
}

/// All programs, and the messages in flight between them.
#[derive(Debug, Clone)]
pub struct Rig {
    /// Number of control periods since the start.
    period: u64,
    hands: Vec<HandProgram>,
    has_first_hand: bool,
    is_frozen: bool,
    rig: Option<RigProgram>,
    sensor: Option<SensorProgram>,
    /// Number of programs that were started, which defines their instances.
    started: u64,
    on_its_way: Vec<Sent>,
    kept: Vec<Sent>,
    stops_said: u64,
    pub violations: Vec<Violation>,
}

fn expected() -> Expected {
    Expected {
        experiment: "model".into(),
        fingertips: vec!["tip".into()],
        joints: JointCounts::default(),
        speed: None,
    }
}

fn x(x: f64) -> Vector3 {
    Vector3 { x, y: 0.0, z: 0.0 }
}

impl Rig {
    /// State before any message has been sent.
    pub fn new() -> Self {
        let mut rig = Self {
            period: 1,
            hands: Vec::new(),
            has_first_hand: true,
            is_frozen: false,
            rig: None,
            sensor: None,
            started: 0,
            on_its_way: Vec::new(),
            kept: Vec::new(),
            stops_said: 0,
            violations: Vec::new(),
        };
        rig.start_hand();
        rig.start_rig();
        rig.start_sensor();
        rig
    }

    /// State with a hand that moves.
    pub fn at_work() -> Self {
        let mut rig = Self::new();
        let calm = Period {
            happening: Happening::Nothing,
            fate: Fate::Calm,
        };
        while !rig.moves() {
            rig.go_through(calm);
            assert!(rig.period < 50, "the hand does not start");
        }
        rig
    }

    pub fn has_rig(&self) -> bool {
        self.rig.is_some()
    }

    pub fn has_sensor(&self) -> bool {
        self.sensor.is_some()
    }

    pub fn has_first_hand(&self) -> bool {
        self.has_first_hand
    }

    pub fn has_second_hand(&self) -> bool {
        self.hands.len() > usize::from(self.has_first_hand)
    }

    pub fn is_frozen(&self) -> bool {
        self.is_frozen
    }

    pub fn stops_said(&self) -> u64 {
        self.stops_said
    }

    pub fn moves(&self) -> bool {
        self.hands.iter().any(|hand| hand.moves)
    }

    /// Time on the first hand's clock (s).
    fn now(&self) -> f64 {
        self.period as f64 * PERIOD
    }

    fn draw_instance(&mut self) -> u64 {
        self.started += 1;
        self.started
    }

    fn start_hand(&mut self) {
        let instance = self.draw_instance();
        let clock = RunClock::new(RigSpeed::Times(1.0), PERIOD, STALE / PERIOD);
        self.hands.push(HandProgram {
            instance,
            inbox: HandInbox::new(&[1], clock, expected()),
            began: false,
            moves: false,
            stopped_by: Vec::new(),
            resumed: Vec::new(),
        });
    }

    fn start_rig(&mut self) {
        let instance = self.draw_instance();
        let inbox = RigInbox::new((1, instance), WATCHDOG, expected());
        self.rig = Some(RigProgram { instance, inbox });
    }

    fn start_sensor(&mut self) {
        let instance = self.draw_instance();
        let inbox = SenseInbox::new(0, 1, (1, 1), expected());
        self.sensor = Some(SensorProgram { instance, inbox });
    }

    /// Simulates a control period.
    pub fn go_through(&mut self, Period { happening, fate }: Period) {
        self.happen(happening);
        self.beat();
        self.deliver(fate, &[Channel::Heartbeats, Channel::Orders]);
        self.measure();
        self.deliver(fate, &[Channel::States, Channel::Forces]);
        self.decide();
        self.deliver(fate, &[Channel::Commands, Channel::Modes]);
        self.drive();
        self.period += 1;
    }

    fn happen(&mut self, happening: Happening) {
        match happening {
            Happening::Nothing => {}
            Happening::KillRig => self.rig = None,
            Happening::StartRig => self.start_rig(),
            Happening::KillSensor => self.sensor = None,
            Happening::StartSensor => self.start_sensor(),
            Happening::KillHand => {
                self.hands.remove(0);
                (self.has_first_hand, self.is_frozen) = (false, false);
            }
            Happening::FreezeHand => self.is_frozen = true,
            Happening::ThawHand => self.is_frozen = false,
            Happening::StartSecondHand => self.start_hand(),
            Happening::Stop => self.order_stop(),
            Happening::Resume => {
                let holds = self
                    .hands
                    .iter()
                    .flat_map(|hand| hand.inbox.holds.in_force());
                let number = holds.map(|hold| hold.number).next();
                self.order_resume(number.unwrap_or(1));
            }
            Happening::ResumeAnother => self.order_resume(99),
            Happening::Replay => self.on_its_way.extend(self.kept.iter().cloned()),
        }
    }

    fn order_stop(&mut self) {
        self.stops_said += 1;
        let stop = StopMessage {
            protocol: PROTOCOL,
            from: "operator".into(),
            id: self.stops_said,
        };
        self.send(Channel::Orders, Topic::Stop, &stop);
    }

    fn order_resume(&mut self, number: u64) {
        let resume = ResumeMessage {
            protocol: PROTOCOL,
            from: "operator".into(),
            number,
        };
        self.send(Channel::Orders, Topic::Resume, &resume);
    }

    fn send<M: Message>(&mut self, channel: Channel, topic: Topic, message: &M) {
        let bytes = encode(message).unwrap();
        self.on_its_way.push(Sent {
            channel,
            topic,
            bytes,
        });
    }

    /// Sends the heartbeats of all programs.
    fn beat(&mut self) {
        let now = self.now();
        let frozen = self.is_frozen;
        let first = self.has_first_hand;
        let is_heard = |&(index, hand): &(usize, &HandProgram)| {
            let is_frozen = frozen && first && index == 0;
            let stands_back = !hand.began && hand.inbox.hand_ahead(now, hand.instance).is_some();
            !is_frozen && !stands_back
        };
        let hands = self.hands.iter().enumerate().filter(is_heard);
        let hands =
            hands.map(|(_, hand)| ("hand", hand.instance, if hand.began { 100.0 } else { 0.0 }));
        let rig = self.rig.iter().map(|rig| ("world", rig.instance, 100.0));
        let sensor = self
            .sensor
            .iter()
            .map(|sensor| ("sense", sensor.instance, 100.0));
        let programs: Vec<_> = hands.chain(rig).chain(sensor).collect();
        for (program, instance, rate) in programs {
            let is_sense = program == "sense";
            let heartbeat = Heartbeat {
                protocol: PROTOCOL,
                instance,
                program: program.into(),
                finger: if is_sense { 0 } else { NO_FINGER },
                experiment: "model".into(),
                fingertip: if is_sense {
                    "tip".into()
                } else {
                    String::new()
                },
                sequence: self.period,
                rate,
                speed: 1.0,
                ..Heartbeat::default()
            };
            let topic = Topic::Heartbeat(heartbeat.place().unwrap());
            self.send(Channel::Heartbeats, topic, &heartbeat);
        }
    }

    /// Sends the measurements of rig and sensor. A message's sequence number is the period of the measurement.
    fn measure(&mut self) {
        let (now, period) = (self.now(), self.period);
        if let Some(rig) = &mut self.rig {
            let here = now + RIG_AHEAD;
            rig.inbox.time = here;
            let state = StateMessage {
                header: header(rig.instance, period, here).echoing(rig.inbox.echo, here),
                position: vec![x(0.0)],
                velocity: vec![x(0.0)],
                ..StateMessage::default()
            };
            self.send(Channel::States, Topic::State, &state);
        }
        if let Some(sensor) = &self.sensor {
            let here = now + SENSOR_AHEAD;
            let echo = sensor.inbox.echo_at(here);
            let update = TactileUpdate {
                header: header(sensor.instance, period, here).echoing(echo, here),
                largest_element: NO_ELEMENT,
                forces: vec![x(0.0)],
                shear_rate: vec![0.0],
                slip_mask: vec![0],
                invalid_mask: vec![0],
                ..TactileUpdate::default()
            };
            self.send(Channel::Forces, Topic::Tactile(0), &update);
        }
    }

    /// Delivers the messages of `channels` according to `fate`.
    fn deliver(&mut self, fate: Fate, channels: &[Channel]) {
        let of_now = |sent: &Sent| channels.contains(&sent.channel);
        let (mut now, mut later): (Vec<_>, Vec<_>) = self.on_its_way.drain(..).partition(of_now);
        match fate {
            Fate::Calm => {}
            Fate::Held(held) => {
                let (kept, rest) = now.into_iter().partition(|sent| sent.channel == held);
                now = rest;
                later.extend::<Vec<Sent>>(kept);
            }
            Fate::Lost(lost) => now.retain(|sent| sent.channel != lost),
            Fate::Twice(twice) => {
                let again: Vec<_> = now
                    .iter()
                    .filter(|sent| sent.channel == twice)
                    .cloned()
                    .collect();
                now.splice(0..0, again.into_iter().rev());
            }
        }
        self.on_its_way = later;
        for sent in now {
            self.hand_over(&sent);
        }
    }

    /// Delivers a message to all its receivers.
    fn hand_over(&mut self, sent: &Sent) {
        let now = self.now();
        if matches!(sent.channel, Channel::States | Channel::Forces) {
            self.kept.push(sent.clone());
            let surplus = self.kept.len().saturating_sub(KEPT);
            self.kept.drain(..surplus);
        }
        for hand in &mut self.hands {
            if matches!(sent.channel, Channel::Commands | Channel::Modes) {
                continue;
            }
            let before = hand.inbox.holds.in_force().to_vec();
            let _ = hand.inbox.take(sent.topic, &sent.bytes, now);
            hand.note_orders(sent, &before);
        }
        if let Some(rig) = &mut self.rig {
            let _ = rig.inbox.take(sent.topic, &sent.bytes, now + RIG_AHEAD);
        }
        if let Some(sensor) = &mut self.sensor {
            let _ = sensor
                .inbox
                .take(sent.topic, &sent.bytes, now + SENSOR_AHEAD);
        }
    }

    /// Executes a control step of each hand that is not frozen.
    fn decide(&mut self) {
        let (now, period) = (self.now(), self.period);
        let frozen = self.is_frozen.then_some(0);
        for index in 0..self.hands.len() {
            let hand = &mut self.hands[index];
            hand.moves = false;
            if Some(index) == frozen {
                continue;
            }
            let instance = hand.instance;
            if !hand.began && hand.inbox.hand_ahead(now, instance).is_some() {
                continue;
            }
            let step = hand.inbox.sent.newest() + 1;
            hand.inbox.sent.sent(step, now);
            let token = hand.inbox.sent.token(step);
            hand.moves = hand.began && hand.inbox.verdict(now, STALE, false) == Permission::Move;
            hand.began |= hand.inbox.may_begin(now, STALE);
            self.violations.extend(hand.violations(period));
            let command = hand.command(step, token);
            let mode = HandMode {
                header: header(instance, step, now),
                token,
                ..HandMode::default()
            };
            self.send(Channel::Commands, Topic::Command, &command);
            self.send(Channel::Modes, Topic::Mode, &mode);
        }
        if self.hands.iter().filter(|hand| hand.moves).count() > 1 {
            self.violations.push(Violation::TwoHands);
        }
    }

    /// Drives the rig by its latest command, while that is fresh.
    fn drive(&mut self) {
        let now = self.now() + RIG_AHEAD;
        let is_there = |instance| self.hands.iter().any(|hand| hand.instance == instance);
        let Some(rig) = &mut self.rig else { return };
        let moves = rig
            .inbox
            .drive(now, WATCHDOG)
            .is_some_and(|v| v[0][0] != 0.0);
        // The hand has been gone for longer than the watchdog's timeout. One more second allows for delayed messages.
        let hand = rig
            .inbox
            .peers()
            .all()
            .iter()
            .find(|peer| peer.refused.is_none());
        let silent = hand.is_none_or(|hand| now - hand.heard > 1.0 + WATCHDOG);
        let gone = hand.is_none_or(|hand| !is_there(hand.heartbeat.instance));
        if moves && silent && gone {
            self.violations.push(Violation::DroveOnByItself);
        }
    }
}

impl HandProgram {
    /// Tracks stop and resume orders independently of the hand's own list.
    fn note_orders(&mut self, sent: &Sent, before: &[feeler_link::hand::ActiveStop]) {
        use feeler_link::hand::Cause;
        match sent.topic {
            Topic::Stop => {
                let stop: StopMessage = feeler_link::inboxes::read(&sent.bytes).unwrap();
                let known = [&self.stopped_by, &self.resumed];
                if !known.iter().any(|known| known.contains(&stop.id)) {
                    self.stopped_by.push(stop.id);
                }
            }
            Topic::Resume => {
                let resume: ResumeMessage = feeler_link::inboxes::read(&sent.bytes).unwrap();
                let resumed = before.iter().find(|hold| hold.number == resume.number);
                if let Some(Cause::Order(id)) = resumed.map(|hold| hold.cause) {
                    self.stopped_by.retain(|stop| *stop != id);
                    self.resumed.push(id);
                }
            }
            _ => {}
        }
    }

    fn command(&self, step: u64, token: u64) -> CommandMessage {
        let state = self.inbox.state();
        let time = state.time.min(self.inbox.time_of(0));
        CommandMessage {
            header: MessageHeader {
                clock: state.clock.clock().unwrap_or_default(),
                ..header(self.instance, step, state.clock.to_rig(time))
            },
            token,
            state_sequence: self.inbox.state_sequence(),
            joint_velocity: vec![x(if self.moves { 0.1 } else { 0.0 })],
        }
    }

    /// Violations by moving in this `period`, judged by the true times of the measurements.
    fn violations(&self, period: u64) -> Vec<Violation> {
        if !self.moves {
            return Vec::new();
        }
        let state = self.inbox.state_sequence();
        let update = self.inbox.fingers()[0].newest.as_ref();
        let felt = update.map_or(0, |update| update.header.sequence);
        let age = (period - state.min(felt)) as f64 * PERIOD;
        let stale = (age > STALE).then_some(Violation::MovedOnStaleData);
        let stopped = (!self.stopped_by.is_empty()).then_some(Violation::MovedWhileStopped);
        stale.into_iter().chain(stopped).collect()
    }
}
