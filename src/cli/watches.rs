//! The command line's watches: ctrl-C, a time budget, and a progress line on a terminal.

use std::io::{self, IsTerminal};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::parallel::TaskContext;
use crate::watch::{Progress, Watch};

/// Whether ctrl-C was pressed. The handler can be set only once in a process.
pub(super) fn interrupted() -> &'static Arc<AtomicBool> {
    static INTERRUPTED: OnceLock<Arc<AtomicBool>> = OnceLock::new();
    INTERRUPTED.get_or_init(|| {
        let flag = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&flag);
        // Without a handler, ctrl-C ends the process as usual, which is fine, too.
        let _ = ctrlc::set_handler(move || {
            if seen.swap(true, Ordering::SeqCst) {
                // The second ctrl-C forces the exit.
                std::process::exit(130);
            }
        });
        flag
    })
}

/// A watch that only ctrl-C stops.
pub(super) struct Interrupt(&'static AtomicBool);

impl Interrupt {
    pub fn new() -> Self {
        Interrupt(interrupted())
    }
}

impl Watch for Interrupt {
    fn stop(&self) -> bool {
        self.0.load(Ordering::SeqCst)
    }
}

/// A watch over a task among many: it stops with the run, and after a time.
pub(super) struct TaskWatch<'w, T> {
    task: &'w TaskContext<'w, T>,
    until: Option<Instant>,
}

impl<'w, T> TaskWatch<'w, T> {
    /// Starts the clock, if there is a limit.
    pub fn new(task: &'w TaskContext<'w, T>, seconds: Option<f64>) -> Self {
        let limit = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
        TaskWatch { task, until: limit.and_then(|limit| Instant::now().checked_add(limit)) }
    }
}

impl<T: Send> Watch for TaskWatch<'_, T> {
    fn stop(&self) -> bool {
        self.task.is_over() || self.until.is_some_and(|until| Instant::now() >= until)
    }
}

/// A watch over one search, with a time limit and a progress line.
pub(super) struct CommandWatch {
    interrupted: &'static AtomicBool,
    started: Instant,
    seconds: Option<f64>,
    bar: ProgressBar,
    shown: Mutex<Option<Instant>>,
}

impl CommandWatch {
    /// Starts the clock.
    pub fn new(what: &str, seconds: Option<f64>) -> Self {
        CommandWatch::counting((what, "nodes"), seconds)
    }

    /// Starts the clock for work that is counted in something else than nodes.
    pub fn counting((what, unit): (&str, &str), seconds: Option<f64>) -> Self {
        let target =
            if io::stderr().is_terminal() { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target);
        let style = ProgressStyle::with_template(&format!("{{spinner}} {{prefix}}  {{pos}} {unit}  {{msg}}"));
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
        bar.set_prefix(what.to_string());
        CommandWatch { interrupted: interrupted(), started: Instant::now(), seconds, bar, shown: Mutex::new(None) }
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }

    /// Whether ctrl-C was pressed.
    pub fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::SeqCst)
    }

    /// Removes the progress line.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// The same watch for work that has only a part of the time, if that is limited.
    pub fn part(&self, part: f64) -> PartWatch<'_> {
        PartWatch { whole: self, seconds: self.seconds.map(|seconds| part * seconds) }
    }
}

/// A watch over the first part of the time of another.
pub(super) struct PartWatch<'w> {
    whole: &'w CommandWatch,
    seconds: Option<f64>,
}

impl Watch for PartWatch<'_> {
    fn stop(&self) -> bool {
        self.whole.stop() || self.seconds.is_some_and(|limit| self.whole.seconds() >= limit)
    }

    fn progress(&self, progress: Progress) {
        self.whole.progress(progress);
    }
}

impl Watch for CommandWatch {
    fn stop(&self) -> bool {
        self.is_interrupted() || self.seconds.is_some_and(|limit| self.seconds() >= limit)
    }

    fn progress(&self, progress: Progress) {
        if self.bar.is_hidden() {
            return;
        }
        let now = Instant::now();
        let mut shown = self.shown.lock().unwrap_or_else(PoisonError::into_inner);
        if shown.is_some_and(|last| now - last < Duration::from_millis(100)) {
            return;
        }
        *shown = Some(now);
        self.bar.set_position(progress.nodes);
        let elapsed = self.seconds();
        let speed = progress.nodes as f64 / elapsed.max(1e-3);
        // The budget that ends first; an unlimited one does not count.
        let by_nodes = progress.budget.saturating_sub(progress.nodes) as f64 / speed.max(1e-3);
        let left = self.seconds.map_or(by_nodes, |limit| by_nodes.min(limit - elapsed)).max(0.0);
        let places = if progress.places > 0 { format!("{} places  ", progress.places) } else { String::new() };
        self.bar.set_message(format!("{speed:.0}/s  {places}{elapsed:.0} s, at most {left:.0} s left"));
    }
}
