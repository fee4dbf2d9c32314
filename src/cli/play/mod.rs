//! `hypedc play`: a page in the browser, on this machine only, in which a world is played, inspected, changed and
//! searched. The page speaks to a session of [`crate::studio`] over a WebSocket.

mod carrier;
pub(in crate::cli) mod export;
mod files;
mod guard;
mod language;

use std::io::{self, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::sync::Arc;
use std::time::Duration;

use tiny_http::{Header, Request, Response, Server, StatusCode};

use crate::compile::{Changes, NumberSetting};
use crate::watch::Watch;

use super::Exit;
use super::args::PlayArgs;
use super::disk::is_regular;
use super::report::{load_changed, plain_error};
use super::watches::Interrupt;

use carrier::Carrier;
use guard::{Guard, Ruling};

/// The page, built from `studio/`.
const PAGE: &str = include_str!("../../../studio/dist/play.html");
/// The time between two looks at whether ctrl-C was pressed.
const TURN: Duration = Duration::from_millis(100);

pub(super) fn run(args: &PlayArgs) -> io::Result<Exit> {
    let named = [Some(&args.file), args.level.map.as_ref(), args.level.reading.legend.as_ref()];
    for path in named.into_iter().flatten() {
        if let Err(error) = is_regular(crate::compile::level_file(path)) {
            plain_error(&format!("cannot read `{}`: {}", path.display(), files::reason(&error)))?;
            return Ok(Exit::Refused);
        }
    }
    let numbers = match numbers(args) {
        Ok(numbers) => numbers,
        Err(why) => {
            plain_error(&why)?;
            return Ok(Exit::Refused);
        }
    };
    if !numbers.is_empty() {
        // An unknown name is told now, not by a page that does not change.
        let settings = args.numbers.fixed();
        let changes = Changes { numbers: &settings, ..Changes::default() };
        if load_changed(&args.file, args.level.file(), &changes)?.is_none() {
            return Ok(Exit::Refused);
        }
    }
    if let Some(target) = &args.export {
        return export::run(args, target);
    }
    let listener = match TcpListener::bind(SocketAddr::from((Ipv4Addr::LOCALHOST, args.port))) {
        Ok(listener) => listener,
        Err(error) => {
            plain_error(&format!("cannot listen on port {}: {error}; choose another one with `--port`", args.port))?;
            return Ok(Exit::Refused);
        }
    };
    // Connections inherit it: an answer must not wait until the browser has acknowledged the one before.
    socket2::SockRef::from(&listener).set_tcp_nodelay(true)?;
    let guard = Guard::new(listener.local_addr()?.port()).map_err(io::Error::other)?;
    let url = guard.url();
    let server = Server::from_listener(listener, None).map_err(io::Error::other)?;
    let carrier = Arc::new(Carrier::new(args, numbers));
    writeln!(io::stdout(), "{url}")?;
    writeln!(io::stderr(), "playing {}; ctrl-C ends it", args.file.display())?;
    if !args.no_open && open::that_detached(&url).is_err() {
        writeln!(io::stderr(), "no browser could be started: open the address above in one")?;
    }
    let interrupt = Interrupt::new();
    while !interrupt.stop() {
        if let Some(request) = server.recv_timeout(TURN)? {
            serve(request, &guard, &carrier);
        }
    }
    Ok(Exit::Yes)
}

/// The numbers that the sliders of the page show at first.
fn numbers(args: &PlayArgs) -> Result<Vec<(String, f64)>, String> {
    if let Some(why) = args.numbers.refusal() {
        return Err(why);
    }
    let number = |setting: NumberSetting<'_>| {
        let value = setting.value.parse().ok().filter(|value: &f64| value.is_finite());
        let value = value.ok_or_else(|| format!("`play` sets plain numbers: `--set {}=310`", setting.path))?;
        Ok((setting.path.to_string(), value))
    };
    args.numbers.fixed().into_iter().map(number).collect()
}

/// Answers one request. A client that is gone is no error.
fn serve(request: Request, guard: &Guard, carrier: &Arc<Carrier>) {
    let header = |name: &'static str| {
        let found = request.headers().iter().find(|header| header.field.equiv(name));
        found.map(|header| header.value.as_str().to_string())
    };
    let is_read = *request.method() == tiny_http::Method::Get;
    let ruling = guard.rule(is_read, request.url(), header("Host").as_deref(), header("Origin").as_deref());
    let refused = |code: u16, why: &str| Response::from_string(why).with_status_code(StatusCode(code));
    let _ = match ruling {
        Ruling::Page => request.respond(headers().into_iter().fold(Response::from_string(PAGE), Response::with_header)),
        Ruling::Session => match header("Sec-WebSocket-Key") {
            Some(key) => {
                carrier.carry(request, &key);
                Ok(())
            }
            None => request.respond(refused(400, "this address is for the page's WebSocket")),
        },
        Ruling::Forbidden => request.respond(refused(403, "open the address that `hypedc play` has printed")),
        Ruling::Unknown => request.respond(refused(404, "there is nothing here")),
    };
}

/// The headers of the page: nothing from elsewhere is loaded, no other page may show it.
fn headers() -> Vec<Header> {
    let all = [
        ("Content-Type", "text/html; charset=utf-8"),
        (
            "Content-Security-Policy",
            "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
             connect-src 'self' ws:; worker-src blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
        ),
        ("Referrer-Policy", "no-referrer"),
        ("X-Content-Type-Options", "nosniff"),
        ("Cross-Origin-Opener-Policy", "same-origin"),
        ("Cross-Origin-Resource-Policy", "same-origin"),
        ("Cache-Control", "no-store"),
    ];
    all.iter().filter_map(|(name, value)| Header::from_bytes(*name, *value).ok()).collect()
}
