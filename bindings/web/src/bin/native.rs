//! Answers requests natively: one a line, as the module in WebAssembly answers them. Before each answer the seconds that
//! it took. `cargo run --release -p hypedc-web --bin native`

#![allow(clippy::print_stdout, reason = "the answers are what it is for")]
#![allow(clippy::disallowed_methods, reason = "it looks at the clock")]

use std::io::{self, BufRead, Write};
use std::time::Instant;

use hypedc_web::Host;

fn main() -> io::Result<()> {
    let mut host = Host::new(|_| {});
    for request in io::stdin().lock().lines() {
        let request = request?;
        let before = Instant::now();
        let answer = host.answer(&request);
        println!("{:.9} {answer}", before.elapsed().as_secs_f64());
        io::stdout().flush()?;
    }
    Ok(())
}
