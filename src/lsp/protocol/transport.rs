//! Messages over a pair of byte streams (Language Server Protocol 3.17, "Base Protocol"). A message that cannot be read is
//! answered with an error, and what follows it is read: an editor with a mistake keeps its server.

use std::io::{self, BufRead, Read, Write};
use std::thread::{self, JoinHandle};

use crossbeam_channel::{Sender, bounded, select, unbounded};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, RequestId, Response, ResponseError};
use serde::Serialize;
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
                        Ok(message) => write(&mut output, &Written::from(&message))?,
                        Err(_) => return Ok(()),
                    },
                    recv(refusals) -> answer => match answer {
                        Ok(answer) => write(&mut output, &answer)?,
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

/// A message as it is written. `Message` itself is serialized through a copy of all its values.
#[derive(Serialize, Default)]
struct Written<'m> {
    jsonrpc: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<&'m RequestId>,
    #[serde(skip_serializing_if = "Option::is_none")]
    method: Option<&'m str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    params: Option<&'m Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    result: Option<&'m Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<&'m ResponseError>,
}

impl<'m> From<&'m Message> for Written<'m> {
    fn from(message: &'m Message) -> Self {
        let params = |params: &'m Value| Some(params).filter(|params| !params.is_null());
        let empty = Written { jsonrpc: "2.0", ..Written::default() };
        match message {
            Message::Request(of) => {
                Written { id: Some(&of.id), method: Some(&of.method), params: params(&of.params), ..empty }
            }
            Message::Notification(of) => Written { method: Some(&of.method), params: params(&of.params), ..empty },
            Message::Response(Response { id, response_result }) => Written {
                id: Some(id),
                result: response_result.as_ref().ok(),
                error: response_result.as_ref().err(),
                ..empty
            },
        }
    }
}

fn write(output: &mut dyn Write, message: &impl Serialize) -> io::Result<()> {
    let body = serde_json::to_vec(message)?;
    write!(output, "Content-Length: {}\r\n\r\n", body.len())?;
    output.write_all(&body)?;
    output.flush()
}

/// A message of its JSON; `None` if it is none.
fn message(json: Value) -> Option<Message> {
    let Value::Object(mut fields) = json else { return None };
    let id = fields.remove("id").filter(|id| !id.is_null()).map(serde_json::from_value::<RequestId>);
    let id = id.transpose().ok()?;
    match (id, fields.remove("method")) {
        (id, Some(Value::String(method))) => {
            let params = fields.remove("params").unwrap_or_default();
            Some(match id {
                Some(id) => Request { id, method, params }.into(),
                None => Notification { method, params }.into(),
            })
        }
        (Some(id), None) => {
            let response_result =
                match (fields.remove("error").filter(|error| !error.is_null()), fields.remove("result")) {
                    (Some(error), _) => Err(serde_json::from_value(error).ok()?),
                    (None, Some(result)) => Ok(result),
                    (None, None) => return None,
                };
            Some(Response { id, response_result }.into())
        }
        _ => None,
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
        let json = serde_json::from_str(&text).or_else(|_| serde_json::from_str(&without_lone_surrogates(&text)));
        let message = match json.ok().and_then(message) {
            Some(message) => message,
            None => {
                let answer = refusal(&text);
                report(answer["error"]["message"].as_str().unwrap_or_default());
                if refuse.send(answer).is_err() {
                    return Ok(());
                }
                continue;
            }
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
    fn messages_are_written_as_the_protocol_says_and_read_again() {
        let id = || RequestId::from("a".to_string());
        let messages: [Message; 6] = [
            Request { id: 3.into(), method: "m".into(), params: json!({ "a": [1] }) }.into(),
            Request { id: id(), method: "m".into(), params: Value::Null }.into(),
            Notification { method: "n".into(), params: json!({}) }.into(),
            Response { id: id(), response_result: Ok(Value::Null) }.into(),
            Response { id: 4.into(), response_result: Ok(json!("é")) }.into(),
            Response::new_err(5.into(), -32600, "no".into()).into(),
        ];
        for sent in messages {
            let (mut ours, mut theirs) = (Vec::new(), Vec::new());
            write(&mut ours, &Written::from(&sent)).unwrap();
            sent.write(&mut theirs).unwrap();
            let body = |bytes: &[u8]| -> Value {
                let text = std::str::from_utf8(bytes).unwrap();
                let (length, body) = text.strip_prefix("Content-Length: ").unwrap().split_once("\r\n\r\n").unwrap();
                assert_eq!(length.parse(), Ok(body.len()));
                serde_json::from_str(body).unwrap()
            };
            assert_eq!(body(&ours), body(&theirs));
            let read = message(body(&ours)).unwrap();
            assert_eq!(format!("{read:?}"), format!("{sent:?}"));
        }
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
