//! Messages over a pair of byte streams (Language Server Protocol 3.17, "Base Protocol"). A message that cannot be read is
//! answered with an error, and what follows it is read: an editor with a mistake keeps its server.

use std::io::{self, BufRead, Read, Write};
use std::thread::{self, JoinHandle};

use crossbeam_channel::{Sender, bounded, select, unbounded};
use lsp_server::{Connection, ErrorCode, Message};
use serde_json::{Value, json};

/// Maximum size of a message, bytes. What claims to be longer is not a message.
const MAX_BYTES: usize = 1 << 30;
/// The header with the size of a message, in lower case.
const LENGTH: &str = "content-length:";

/// The threads that read and write.
pub struct Transport {
    reader: JoinHandle<io::Result<()>>,
    writer: JoinHandle<io::Result<()>>,
}

impl Transport {
    /// Starts to read messages from one stream and to write them to another. `report` is told what could not be read.
    pub fn start(
        mut input: impl BufRead + Send + 'static,
        mut output: impl Write + Send + 'static,
        mut report: impl FnMut(&str) + Send + 'static,
    ) -> (Connection, Transport) {
        let (sender, outgoing) = unbounded::<Message>();
        let (refuse, refusals) = bounded::<Value>(0);
        let writer = thread::spawn(move || {
            let mut refusals = refusals;
            loop {
                select! {
                    recv(outgoing) -> message => match message {
                        Ok(message) => message.write(&mut output)?,
                        Err(_) => return Ok(()),
                    },
                    recv(refusals) -> answer => match answer {
                        Ok(answer) => write!(output, "Content-Length: {}\r\n\r\n{answer}", answer.to_string().len())
                            .and_then(|()| output.flush())?,
                        // The reader has ended, the server not yet.
                        Err(_) => refusals = crossbeam_channel::never(),
                    },
                }
            }
        });
        // All that has come is read at once: what a later message makes void need not be begun.
        let (incoming, receiver) = unbounded();
        let reader = thread::spawn(move || read(&mut input, &incoming, &refuse, &mut report));
        (Connection { sender, receiver }, Transport { reader, writer })
    }

    /// Waits until the client has sent `exit` or closed its stream, and all is written.
    ///
    /// # Errors
    ///
    /// Those of the streams.
    pub fn join(self) -> io::Result<()> {
        let panicked = |_| Err(io::Error::other("a thread of the connection panicked"));
        self.reader.join().unwrap_or_else(panicked)?;
        self.writer.join().unwrap_or_else(panicked)
    }
}

/// Reads messages until `exit`, the end of the stream, or the end of the server.
fn read(
    input: &mut dyn BufRead,
    incoming: &Sender<Message>,
    refuse: &Sender<Value>,
    report: &mut dyn FnMut(&str),
) -> io::Result<()> {
    while let Some(length) = next_length(input)? {
        let mut bytes = Vec::new();
        if (&mut *input).take(length as u64).read_to_end(&mut bytes)? < length {
            return Ok(());
        }
        let text = String::from_utf8_lossy(&bytes);
        let message = match serde_json::from_str::<Message>(&text) {
            Ok(message) => message,
            Err(_) => match serde_json::from_str::<Message>(&without_lone_surrogates(&text)) {
                Ok(message) => message,
                Err(_) => {
                    let answer = refusal(&text);
                    report(answer["error"]["message"].as_str().unwrap_or_default());
                    if refuse.send(answer).is_err() {
                        return Ok(());
                    }
                    continue;
                }
            },
        };
        let is_exit = matches!(&message, Message::Notification(notification) if notification.method == "exit");
        if incoming.send(message).is_err() || is_exit {
            return Ok(());
        }
    }
    Ok(())
}

/// Reads headers up to a message; returns its size. Lines that are no headers are skipped, as after a message whose size
/// was wrong. `None` at the end of the stream.
fn next_length(input: &mut dyn BufRead) -> io::Result<Option<usize>> {
    let mut length = None;
    let mut line = Vec::new();
    loop {
        line.clear();
        // A line without an end is no header.
        if (&mut *input).take(1 << 16).read_until(b'\n', &mut line)? == 0 {
            return Ok(None);
        }
        let text = String::from_utf8_lossy(&line).to_ascii_lowercase();
        if let Some((_, value)) = text.rsplit_once(LENGTH) {
            length = value.trim().parse().ok().filter(|length| *length <= MAX_BYTES);
        } else if text.trim().is_empty()
            && let Some(length) = length.take()
        {
            return Ok(Some(length));
        }
    }
}

/// The answer to a text that is no message: under its id, if it has one.
fn refusal(text: &str) -> Value {
    let read = serde_json::from_str::<Value>(&without_lone_surrogates(text));
    let (id, code, why) = match &read {
        Ok(value) => {
            let id = value.get("id").filter(|id| id.is_number() || id.is_string());
            (id.cloned(), ErrorCode::InvalidRequest, "this JSON is no request, response or notification".to_string())
        }
        Err(error) => (None, ErrorCode::ParseError, format!("a message is not JSON: {error}")),
    };
    json!({ "jsonrpc": "2.0", "id": id, "error": { "code": code as i32, "message": why } })
}

/// JSON in which each half of a pair of surrogates that stands alone is U+FFFD. Texts of JavaScript can contain such
/// halves; both count as one unit of UTF-16, so that positions stay the same.
fn without_lone_surrogates(json: &str) -> String {
    let unit = |at: usize| {
        let digits = json.get(at..at + 6)?.strip_prefix("\\u")?;
        u16::from_str_radix(digits, 16).ok().filter(|_| !digits.starts_with('+'))
    };
    let (mut out, mut at) = (String::with_capacity(json.len()), 0);
    while let Some(next) = json.get(at..).and_then(|rest| rest.find('\\')) {
        out.push_str(json.get(at..at + next).unwrap_or_default());
        at += next;
        let (length, is_lone) = match unit(at) {
            Some(0xd800..=0xdbff) if unit(at + 6).is_some_and(|low| (0xdc00..=0xdfff).contains(&low)) => (12, false),
            Some(0xd800..=0xdfff) => (6, true),
            // An escaped backslash does not escape what follows it.
            _ => (json.get(at + 1..).and_then(|rest| rest.chars().next()).map_or(1, |c| 1 + c.len_utf8()), false),
        };
        out.push_str(if is_lone { "\\ufffd" } else { json.get(at..at + length).unwrap_or_default() });
        at += length;
    }
    out.push_str(json.get(at..).unwrap_or_default());
    out
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;
    use std::sync::{Arc, Mutex};

    use proptest::prelude::*;

    use super::*;

    fn framed(body: &str) -> Vec<u8> {
        format!("Content-Length: {}\r\n\r\n{body}", body.len()).into_bytes()
    }

    #[derive(Clone, Default)]
    struct Shared(Arc<Mutex<Vec<u8>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().extend_from_slice(bytes);
            Ok(bytes.len())
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    /// The methods of the messages that arrive, and all that is written.
    fn received(bytes: Vec<u8>) -> (Vec<String>, String) {
        let output = Shared::default();
        let (connection, transport) = Transport::start(Cursor::new(bytes), output.clone(), |_| {});
        let methods = connection.receiver.iter().map(|message| match message {
            Message::Request(request) => request.method,
            Message::Notification(notification) => {
                format!("{} {}", notification.method, notification.params["text"].as_str().unwrap_or_default())
            }
            Message::Response(_) => "response".to_string(),
        });
        let methods = methods.collect();
        drop(connection);
        transport.join().unwrap();
        let written = String::from_utf8(output.0.lock().unwrap().clone()).unwrap();
        (methods, written)
    }

    #[test]
    fn a_message_that_cannot_be_read_is_answered_and_the_next_one_is_read() {
        let good = framed(r#"{"jsonrpc":"2.0","id":1,"method":"hover","params":{}}"#);
        let cases: [(Vec<u8>, &str); 6] = [
            (framed("{"), r#""code":-32700"#),
            (framed("\u{1}\u{2}"), r#""code":-32700"#),
            (framed(r#"{"id":7,"method":3}"#), r#""id":7"#),
            (framed(r#"[1, 2]"#), r#""code":-32600"#),
            (b"Content-Length: 3\r\n\r\n\xff\xfe\xfd".to_vec(), r#""code":-32700"#),
            (b"Content-Length: many\r\nrubbish\r\n\r\n{}\r\n".to_vec(), ""),
        ];
        for (bad, answer) in cases {
            let shown = String::from_utf8_lossy(&bad).into_owned();
            let (methods, written) = received([bad, good.clone()].concat());
            assert_eq!(methods, ["hover"], "after {shown:?}");
            assert!(written.contains(answer), "{shown:?}: {written}");
        }
    }

    /// What a later message makes void can be given up only if the later one is read before the earlier one is done.
    #[test]
    fn messages_are_read_before_the_server_takes_them() {
        let one = framed(r#"{"jsonrpc":"2.0","id":1,"method":"hover","params":{}}"#);
        let (connection, transport) = Transport::start(Cursor::new(one.repeat(100)), Shared::default(), |_| {});
        transport.reader.join().unwrap().unwrap();
        assert_eq!(connection.receiver.len(), 100);
    }

    #[test]
    fn a_lone_surrogate_is_a_replacement_character() {
        let text = r#"{"method":"a","params":{"text":"x\ud800y \\ud800 \ud83d\ude00 \udc00\ud800"}}"#;
        let (methods, written) = received(framed(text));
        assert_eq!(methods, ["a x\u{fffd}y \\ud800 \u{1f600} \u{fffd}\u{fffd}"]);
        assert_eq!(written, "");
    }

    #[test]
    fn nothing_is_read_after_exit() {
        let exit = framed(r#"{"jsonrpc":"2.0","method":"exit"}"#);
        let (methods, _) = received([exit.clone(), exit].concat());
        assert_eq!(methods, ["exit "]);
    }

    proptest! {
        /// Whatever arrives, reading ends, and the answers are JSON.
        #[test]
        fn any_bytes_are_survived(bytes: Vec<u8>, body: String) {
            let (_, written) = received([bytes, framed(&body)].concat());
            for answer in written.split("Content-Length: ").skip(1) {
                let (_, json) = answer.split_once("\r\n\r\n").unwrap();
                serde_json::from_str::<Value>(json).unwrap();
            }
        }

        /// Only lone halves change.
        #[test]
        fn json_keeps_its_meaning(text: String) {
            let json = serde_json::to_string(&text).unwrap();
            prop_assert_eq!(without_lone_surrogates(&json), json);
        }
    }
}
