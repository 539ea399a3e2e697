//! A program that serves a page, and a minimal client in place of a browser.

use crate::program::{Ended, feeler, run};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ChildStdout, Command, Stdio};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket, client};

/// One control step of 10 ms takes half a second, so that a run outlasts a test.
pub const SLOWLY: &str = "--speed=0.02";

/// A program that serves a page.
pub struct Viewed {
    /// `None` once the program has ended.
    child: Option<Child>,
    output: BufReader<ChildStdout>,
    /// The address of the page.
    pub url: String,
}

impl Viewed {
    /// Starts a run of the reference experiment in `folder` and waits for its page.
    pub fn run(folder: &Path, more: &[&str]) -> Self {
        let arguments = [
            "run",
            "cap-closing",
            "--sensing=direct",
            "--out=run",
            "--view",
        ];
        Self::start(folder, &[&arguments[..], more].concat())
    }

    /// Runs the reference experiment for a second without a page into `alone`, then starts the same run with a page,
    /// at `speed`, into `run`.
    pub fn beside_alone(folder: &Path, speed: &str) -> Self {
        let limit = "--set=time_limit=1";
        let arguments = ["run", "cap-closing", "--sensing=direct", "--out=alone"];
        run(folder, &[&arguments[..], &[limit]].concat());
        Self::run(folder, &[speed, limit])
    }

    /// Starts the program with `arguments`.
    pub fn start(folder: &Path, arguments: &[&str]) -> Self {
        Self::spawn(feeler(folder, &[arguments, &["--no-open"]].concat()))
    }

    /// Like [`Self::start`], but with a complete `command`.
    pub fn spawn(mut command: Command) -> Self {
        let piped = command.stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = piped.spawn().expect("the program");
        let mut output = BufReader::new(child.stdout.take().expect("its output"));
        let mut line = String::new();
        output.read_line(&mut line).expect("a line");
        let url = line.trim_end().strip_prefix("live page: ");
        let url = url
            .unwrap_or_else(|| panic!("no address in {line:?}"))
            .into();
        Self {
            child: Some(child),
            output,
            url,
        }
    }

    /// Host and port.
    pub fn host(&self) -> &str {
        self.url.split('/').nth(2).expect("a host")
    }

    /// Path of the page.
    pub fn path(&self) -> String {
        let token = self.url.split('/').nth(3).expect("a token");
        format!("/{token}/")
    }

    /// Sends a request with this request line and these headers. Returns status, head and body of the response.
    pub fn ask(&self, line: &str, headers: &[&str]) -> (u16, String, String) {
        let (status, head, body) = self.ask_bytes(line, headers);
        (status, head, String::from_utf8(body).expect("text"))
    }

    /// Like [`Self::ask`], but returns the body as bytes.
    pub fn ask_bytes(&self, line: &str, headers: &[&str]) -> (u16, String, Vec<u8>) {
        let mut stream = TcpStream::connect(self.host()).expect("a connection");
        let headers = [headers, &["Connection: close"]].concat().join("\r\n");
        write!(stream, "{line} HTTP/1.1\r\n{headers}\r\n\r\n").expect("a request");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("an answer");
        let gap = answer.windows(4).position(|bytes| bytes == b"\r\n\r\n");
        let (head, body) = answer.split_at(gap.expect("a head and a body"));
        let head = String::from_utf8(head.to_vec()).expect("text");
        let status = head.split(' ').nth(1);
        let status = status.and_then(|status| status.parse().ok());
        (status.expect("a status"), head, body[4..].to_vec())
    }

    /// Requests the page like a browser.
    pub fn page(&self) -> String {
        let host = format!("Host: {}", self.host());
        let (status, _, body) = self.ask(&format!("GET {}", self.path()), &[&host]);
        assert_eq!(status, 200, "{body}");
        body
    }

    /// The data embedded in the page.
    pub fn data(&self) -> Value {
        page_data(&self.page())
    }

    /// Opens the page's WebSocket.
    pub fn socket(&self) -> WebSocket<TcpStream> {
        let socket = self.data()["live"]["socket"]
            .as_str()
            .expect("a socket")
            .to_string();
        let url = format!("ws://{}{socket}", self.host());
        let mut request = url.into_client_request().expect("a request");
        let origin = format!("http://{}", self.host())
            .parse()
            .expect("an origin");
        request.headers_mut().insert("Origin", origin);
        let stream = TcpStream::connect(self.host()).expect("a connection");
        let (socket, _) = client(request, stream).expect("a socket");
        socket
    }

    /// Waits until the program prints a line that contains `words`.
    pub fn says(&mut self, words: &str) {
        let mut line = String::new();
        while !line.contains(words) {
            line.clear();
            let read = self.output.read_line(&mut line).expect("a line");
            assert!(read > 0, "the program ended without {words:?}");
        }
    }

    /// Interrupts the program like Ctrl-C, and waits for its end.
    pub fn interrupt(self) -> Ended {
        let id = self.child.as_ref().expect("the program").id().to_string();
        let status = Command::new("kill").args(["-INT", &id]).status();
        assert!(status.expect("kill").success());
        self.wait()
    }

    /// Waits until the program ends.
    pub fn wait(mut self) -> Ended {
        let mut rest = Vec::new();
        self.output.read_to_end(&mut rest).expect("its output");
        let child = self.child.take().expect("the program");
        let mut output = child.wait_with_output().expect("its end");
        output.stdout = rest;
        Ended::of(output)
    }
}

/// Kills the program if it still runs, for example after a failed test.
impl Drop for Viewed {
    fn drop(&mut self) {
        if let Some(child) = &mut self.child {
            // The program may have ended already.
            let _ = child.kill();
            let _ = child.wait();
        }
    }
}

/// The data embedded in `page`.
pub fn page_data(page: &str) -> Value {
    let (_, rest) = page.split_once(r#"id="page-data">"#).expect("page data");
    let (data, _) = rest.split_once("</script>").expect("its end");
    serde_json::from_str(data).expect("JSON")
}

/// Waits for the next row of a socket, and returns its time and its values.
pub fn next_row(socket: &mut WebSocket<TcpStream>) -> (f64, Vec<f32>) {
    loop {
        if let Message::Binary(bytes) = socket.read().expect("a message") {
            let (time, numbers) = bytes.split_first_chunk().expect("a time");
            let numbers = numbers.chunks_exact(4);
            let numbers =
                numbers.map(|number| f32::from_le_bytes(number.try_into().expect("four")));
            return (f64::from_le_bytes(*time), numbers.collect());
        }
    }
}

/// Waits for the next state of a socket for which `is_wanted` returns `true`.
pub fn wait_for(socket: &mut WebSocket<TcpStream>, is_wanted: impl Fn(&Value) -> bool) -> Value {
    loop {
        if let Message::Text(text) = socket.read().expect("a message") {
            let state = serde_json::from_str(&text).expect("JSON");
            if is_wanted(&state) {
                return state;
            }
        }
    }
}
