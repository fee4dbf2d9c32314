//! Who may talk to the server: only pages of its own origin that know its token. Another page in the same browser gets
//! nothing: it does not know the token, and its requests carry another `Origin` or, by a name that leads to this machine,
//! another `Host`.

/// What a request is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Ruling {
    /// The page.
    Page,
    /// The page's WebSocket.
    Session,
    /// It may not be asked so.
    Forbidden,
    /// There is no such address.
    Unknown,
}

/// Knows the token and the port of a server.
pub(super) struct Guard {
    token: String,
    port: u16,
}

impl Guard {
    /// With a new token.
    ///
    /// # Errors
    /// If the system gives no random numbers.
    pub fn new(port: u16) -> Result<Guard, getrandom::Error> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes)?;
        Ok(Guard { token: bytes.iter().map(|byte| format!("{byte:02x}")).collect(), port })
    }

    /// The address of the page.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/?token={}", self.port, self.token)
    }

    /// What a request for a path is, given its headers.
    pub fn rule(&self, is_read: bool, path: &str, host: Option<&str>, origin: Option<&str>) -> Ruling {
        let hosts = [format!("127.0.0.1:{}", self.port), format!("localhost:{}", self.port)];
        let is_own_host = host.is_some_and(|host| hosts.iter().any(|own| own == host));
        let is_own_origin = origin.is_none_or(|origin| hosts.iter().any(|own| origin == format!("http://{own}")));
        let (path, query) = path.split_once('?').unwrap_or((path, ""));
        let knows = query.split('&').any(|part| part.strip_prefix("token=").is_some_and(|token| self.is_token(token)));
        if !is_read || !is_own_host || !is_own_origin || !knows {
            return Ruling::Forbidden;
        }
        match path {
            "/" => Ruling::Page,
            // Browsers always tell the origin of a WebSocket.
            "/session" if origin.is_some() => Ruling::Session,
            "/session" => Ruling::Forbidden,
            _ => Ruling::Unknown,
        }
    }

    /// Compares in a time that does not depend on the first difference.
    fn is_token(&self, token: &str) -> bool {
        let differs = |(a, b): (u8, u8)| a ^ b;
        token.len() == self.token.len() && token.bytes().zip(self.token.bytes()).map(differs).fold(0, |a, b| a | b) == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_origin_gets_nothing() {
        let guard = Guard { token: "0123".into(), port: 80 };
        let rule = |path, host, origin| guard.rule(true, path, host, origin);
        let (host, own) = (Some("127.0.0.1:80"), Some("http://127.0.0.1:80"));
        assert_eq!(rule("/?token=0123", host, None), Ruling::Page);
        assert_eq!(rule("/session?token=0123", host, own), Ruling::Session);
        assert_eq!(rule("/session?token=0123", Some("localhost:80"), Some("http://localhost:80")), Ruling::Session);
        assert_eq!(rule("/other?token=0123", host, None), Ruling::Unknown);
        let forbidden = [
            ("/", host, None),
            ("/?token=", host, None),
            ("/?token=0124", host, None),
            ("/?token=01234", host, None),
            ("/session?token=0123", host, None),
            ("/session?token=0123", host, Some("http://evil.example")),
            ("/session?token=0123", host, Some("null")),
            ("/session?token=0123", Some("evil.example:80"), own),
            ("/session", host, own),
            ("/?token=0123", None, None),
        ];
        for (path, host, origin) in forbidden {
            assert_eq!(rule(path, host, origin), Ruling::Forbidden, "{path} {host:?} {origin:?}");
        }
        assert_eq!(guard.rule(false, "/?token=0123", host, None), Ruling::Forbidden);
    }
}
