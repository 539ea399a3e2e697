//! Stopping a hand through its stop server, also under floods and attacks.
#![cfg(feature = "zenoh")]

use crate::lab::{lab, listening, of};
use crate::ports::unused_endpoint;
use feeler_link::security::{Authority, Right, Validity};
use feeler_link::stop_server::wire::{Datagram, Verdict, parse};
use feeler_link::stop_server::{
    Credentials, StopAnswer, StopCallError, StopGuard, StopServer, call_stop,
};
use ring::hmac;
use std::net::{SocketAddr, TcpStream, UdpSocket};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use std::{fs, thread};

/// Handler that counts its orders.
fn counting() -> impl Fn(u64, &str) -> StopAnswer + Send + Sync + 'static {
    let orders = AtomicU64::new(0);
    move |_, from| StopAnswer {
        order: orders.fetch_add(1, Ordering::Relaxed) + 1,
        stopped: format!("stop requested by {from}"),
    }
}

/// Opens a stop server on an unused port with the certificate in `folder`, and returns its endpoint.
fn door(folder: &Path) -> (StopServer, [String; 1]) {
    let endpoints = [unused_endpoint().replace("tcp", "tls")];
    let door = StopServer::open(&endpoints, Some(folder), "bench", counting());
    (door.expect("a door"), endpoints)
}

fn refused(called: Result<StopAnswer, StopCallError>) -> String {
    match called {
        Err(StopCallError::Refused(why)) => why,
        other => panic!("expected a refusal, got {other:?}"),
    }
}

#[test]
fn a_call_is_one_order_and_returns_the_hands_answer() {
    let endpoints = [unused_endpoint()];
    let _door = StopServer::open(&endpoints, None, "bench", counting()).expect("a door");
    let first = call_stop(&endpoints, None, "bench", (1, "the \x1b[31mswitch")).expect("an answer");
    assert_eq!(first.order, 1);
    assert_eq!(first.stopped, "stop requested by the \\u{1b}[31mswitch");
    let long = "x".repeat(1000);
    let second = call_stop(&endpoints, None, "bench", (2, &long)).expect("an answer");
    assert_eq!((second.order, second.stopped.len()), (2, 256));
    let other = refused(call_stop(&endpoints, None, "bank", (3, "me")));
    assert!(
        other.contains("expected rig \"bench\", got \"bank\""),
        "{other}"
    );
}

#[test]
fn only_certificates_with_the_right_may_stop() {
    let lab = lab("door", &["hand", "order", "stop", "sense-0", "watch"]);
    let mut authority = Authority::open(&lab).unwrap();
    authority
        .certify("lost", &[Right::Order], Validity::days(1))
        .unwrap();
    authority.withdraw("lost", &[Right::Order]).unwrap();
    authority
        .certify("old", &[Right::Order], Validity::that_ended(1))
        .unwrap();
    let strangers = crate::lab::lab("door-strangers", &["order"]);
    fs::copy(lab.join("ca.pem"), of(&strangers, "order").join("ca.pem")).unwrap();

    let (_door, endpoints) = door(&of(&lab, "hand"));
    let call = |folder: &Path| call_stop(&endpoints, Some(folder), "bench", (4, "me"));
    assert_eq!(call(&of(&lab, "order")).expect("an answer").order, 1);
    assert_eq!(call(&of(&lab, "stop")).expect("an answer").order, 2);
    let why = |folder: &Path| refused(call(folder));
    assert!(why(&of(&lab, "sense-0")).contains("sense-0.1 does not grant"));
    assert!(why(&of(&lab, "watch")).contains("watch.1 does not grant"));
    assert!(why(&lab.join("lost/order")).contains("order.2 is withdrawn"));
    assert!(why(&lab.join("old/order")).contains("order.3: CertExpired"));
    assert!(why(&of(&strangers, "order")).contains("expected a valid one of this lab"));
    // A certificate with the key of another one.
    let copy = lab.join("copy");
    fs::create_dir(&copy).unwrap();
    for (right, file) in [
        ("order", "ca.pem"),
        ("order", "cert.pem"),
        ("stop", "key.pem"),
    ] {
        fs::copy(of(&lab, right).join(file), copy.join(file)).unwrap();
    }
    assert!(why(&copy).contains("not by the key"));
    assert_eq!(call(&of(&lab, "order")).expect("an answer").order, 3);
}

#[test]
fn answers_are_accepted_only_from_a_hand() {
    let lab = lab("door-false", &["order", "sense-0"]);
    let (_door, endpoints) = door(&of(&lab, "sense-0"));
    let called = call_stop(&endpoints, Some(&of(&lab, "order")), "bench", (5, "me"));
    let error = called.unwrap_err().to_string();
    assert!(
        error.contains("no hand answered") && error.contains("sense-0.1"),
        "{error}"
    );
}

#[test]
fn calls_succeed_under_floods_and_idle_connections() {
    let lab = lab("door-flood", &["hand", "order"]);
    let (_hand, endpoint) = listening(&of(&lab, "hand"));
    let endpoints = [endpoint];
    let folder = of(&lab, "hand");
    let door = StopServer::open(&endpoints, Some(&folder), "bench", counting()).expect("a door");
    let address = door.addresses()[0];
    let silent: Vec<TcpStream> = (0..120)
        .map(|_| TcpStream::connect(address).expect("a connection"))
        .collect();
    let over = Arc::new(AtomicBool::new(false));
    let flood = |bytes: Vec<u8>| {
        let over = Arc::clone(&over);
        thread::spawn(move || {
            let socket = UdpSocket::bind("127.0.0.1:0").expect("a socket");
            while !over.load(Ordering::Relaxed) {
                let _ = socket.send_to(&bytes, address);
            }
        })
    };
    let garbage = Datagram::Stop {
        nonce: [1; 16],
        cookie: [2; 32],
        rig: "bench".into(),
        from: "attacker".into(),
        proof: None,
    };
    let floods = [flood(vec![7; 1400]), flood(garbage.bytes())];
    let certificate = of(&lab, "order");
    let answers: Vec<_> = (0..3)
        .map(|_| call_stop(&endpoints, Some(&certificate), "bench", (6, "me")))
        .collect();
    over.store(true, Ordering::Relaxed);
    for flood in floods {
        flood.join().expect("no panic");
    }
    for (order, answer) in (1..).zip(answers) {
        assert_eq!(answer.expect("an answer").order, order);
    }
    drop(silent);
}

/// StopGuard with `secret`, and the senders of its orders.
fn guard(folder: &Path, secret: u8) -> (StopGuard, Arc<Mutex<Vec<String>>>) {
    let callers = Arc::new(Mutex::new(Vec::new()));
    let told = Arc::clone(&callers);
    let answering = move |_, from: &str| {
        told.lock().unwrap().push(from.to_string());
        StopAnswer::default()
    };
    let credentials = Credentials::read(folder).expect("credentials");
    let secret = hmac::Key::new(hmac::HMAC_SHA256, &[secret; 32]);
    let credentials = Some(Arc::new(credentials));
    let guard = StopGuard::new(secret, "bench", credentials, Arc::new(answering));
    (guard, callers)
}

/// Stop datagram of `caller` after the challenge of `guard` at the time `now` (s).
fn call(
    guard: &mut StopGuard,
    certificate: &Path,
    caller: SocketAddr,
    nonce: u8,
    now: u64,
) -> Vec<u8> {
    let nonce = [nonce; 16];
    let hello = Datagram::Hello { nonce }.bytes();
    let challenge = guard.answer(caller, &hello, Duration::from_secs(now));
    let challenge = challenge.and_then(|bytes| parse(&bytes));
    let Some(Datagram::Challenge { cookie, .. }) = challenge else {
        panic!("no challenge");
    };
    let (rig, from) = ("bench".to_string(), "me".to_string());
    let unproven = Datagram::Stop {
        nonce,
        cookie,
        rig: rig.clone(),
        from: from.clone(),
        proof: None,
    };
    let credentials = Credentials::read(certificate).expect("credentials");
    let proof = Some(credentials.prove(&unproven).expect("a signature"));
    let proven = Datagram::Stop {
        nonce,
        cookie,
        rig,
        from,
        proof,
    };
    proven.bytes()
}

#[test]
fn replayed_calls_are_not_new_orders() {
    let lab = lab("door-replay", &["hand", "order"]);
    let (hand, order) = (of(&lab, "hand"), of(&lab, "order"));
    let caller: SocketAddr = "10.0.0.6:5000".parse().unwrap();
    let other: SocketAddr = "10.0.0.7:5000".parse().unwrap();
    let time = Duration::from_secs;
    let (mut first, callers) = guard(&hand, 1);
    let stop = call(&mut first, &order, caller, 1, 9);
    let answer = first.answer(caller, &stop, time(9)).expect("an answer");
    let taken = matches!(
        parse(&answer),
        Some(Datagram::Answer {
            verdict: Verdict::Taken(_),
            ..
        })
    );
    assert!(taken);
    // Repeated immediately and while its challenge is valid: the same answer, and no new order.
    for now in [9, 19] {
        assert_eq!(first.answer(caller, &stop, time(now)), Some(answer.clone()));
    }
    assert_eq!(*callers.lock().unwrap(), ["me"]);
    // Rejected if late, from another address, or after a restart of the hand.
    assert_eq!(first.answer(caller, &stop, time(20)), None);
    assert_eq!(first.answer(other, &stop, time(9)), None);
    let (mut second, callers) = guard(&hand, 2);
    assert_eq!(second.answer(caller, &stop, time(9)), None);
    assert!(callers.lock().unwrap().is_empty());
}

#[test]
fn one_address_cannot_exhaust_the_signature_checks() {
    let lab = lab("door-budget", &["hand", "order", "sense-0"]);
    let (mut guard, callers) = guard(&of(&lab, "hand"), 1);
    let many: SocketAddr = "10.0.0.6:5000".parse().unwrap();
    let other: SocketAddr = "10.0.0.7:5000".parse().unwrap();
    let now = Duration::from_secs(1);
    let refusals = (0..100).filter(|n| {
        let stop = call(&mut guard, &of(&lab, "sense-0"), many, *n, 1);
        guard.answer(many, &stop, now).is_some()
    });
    assert_eq!(refusals.count(), 20);
    let stop = call(&mut guard, &of(&lab, "order"), other, 1, 1);
    assert!(guard.answer(other, &stop, now).is_some());
    assert_eq!(callers.lock().unwrap().len(), 1);
}
