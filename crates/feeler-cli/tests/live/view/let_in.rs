//! Access control of the live page.

use super::viewed::{SLOWLY, Viewed};
use crate::program::folder;

const UPGRADE: [&str; 4] = [
    "Upgrade: websocket",
    "Connection: Upgrade",
    "Sec-WebSocket-Version: 13",
    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==",
];

#[test]
fn page_requires_the_token_and_the_right_host() {
    let viewed = Viewed::run(&folder("view-let-in"), &[SLOWLY]);
    let (host, path) = (format!("Host: {}", viewed.host()), viewed.path());
    let page = format!("GET {path}");
    let (status, head, body) = viewed.ask(&page, &[&host]);
    assert_eq!(status, 200);
    assert!(body.contains(r#"<div id="live">"#));
    let head = head.to_lowercase();
    for header in [
        "content-security-policy: default-src 'none'",
        "referrer-policy: no-referrer",
        "x-content-type-options: nosniff",
        "cache-control: no-store",
    ] {
        assert!(head.contains(header), "{header} in {head}");
    }
    let port = viewed.host().split(':').nth(1).expect("a port");
    let by_name = format!("Host: localhost:{port}");
    assert_eq!(viewed.ask(&page, &[&by_name]).0, 200);
    let evil = ["Host: evil.example", "Host: 127.0.0.1", "X: y"];
    for host in evil {
        let (status, head, body) = viewed.ask(&page, &[host]);
        assert!(
            status == 403 && body.contains("expected the address"),
            "{host}: {head}"
        );
    }
    let (status, _, body) = viewed.ask(&page, &[&host, "Origin: http://evil.example"]);
    assert!(status == 403 && body.contains("evil.example"), "{body}");
    let wrong = format!("GET /{}/", "0".repeat(path.len() - 2));
    for wrong in ["GET /", "GET /live", "GET /../", &wrong] {
        let (status, _, body) = viewed.ask(wrong, &[&host]);
        assert!(status == 403 && body.contains("token"), "{wrong}: {body}");
    }
    let post = format!("POST {path}");
    assert_eq!(viewed.ask(&post, &[&host, "Content-Length: 0"]).0, 404);
    viewed.interrupt();
}

#[test]
fn socket_requires_the_origin_of_the_page() {
    let viewed = Viewed::run(&folder("view-socket-let-in"), &[SLOWLY]);
    let (host, path) = (format!("Host: {}", viewed.host()), viewed.path());
    let socket = format!("GET {path}live");
    for foreign in ["Origin: http://evil.example", "Origin: null", "X: y"] {
        let headers = [&UPGRADE[..], &[&host, foreign]].concat();
        let (status, _, body) = viewed.ask(&socket, &headers);
        assert!(
            status == 403 && body.contains("got one from"),
            "{foreign}: {body}"
        );
    }
    let origin = format!("Origin: http://{}", viewed.host());
    let headers = [&UPGRADE[..], &[&host, &origin]].concat();
    let wrong = format!("GET /{}/live", "f".repeat(path.len() - 2));
    assert_eq!(viewed.ask(&wrong, &headers).0, 403);
    // At most eight authorized clients are accepted at a time.
    let mut sockets: Vec<_> = (0..8).map(|_| viewed.socket()).collect();
    let (status, _, body) = viewed.ask(&socket, &headers);
    assert!(status == 503 && body.contains("8 pages"), "{body}");
    sockets.pop();
    viewed.interrupt();
}

#[test]
fn silent_connections_block_neither_the_run_nor_the_page() {
    let viewed = Viewed::run(&folder("view-silent"), &[SLOWLY]);
    let mut silent = Vec::new();
    for _ in 0..8 {
        silent.push(std::net::TcpStream::connect(viewed.host()).expect("a connection"));
    }
    assert!(viewed.page().contains("page-data"));
    viewed.interrupt();
}
