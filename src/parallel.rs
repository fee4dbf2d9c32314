//! A pool of threads: they take tasks in order, and send results to the calling thread. Results do not depend on which
//! thread does which task.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{self, Sender};
use std::thread;

/// A number of threads that was asked for, or that of the cores.
pub fn threads(asked: Option<u16>) -> usize {
    asked.map_or_else(|| thread::available_parallelism().map_or(1, usize::from), usize::from)
}

/// The context of a task.
pub struct TaskContext<'d, T> {
    task: usize,
    sender: &'d Sender<(usize, T)>,
    is_over: &'d (dyn Fn() -> bool + Sync),
}

impl<T> TaskContext<'_, T> {
    /// Whether the work should stop; a task that then returns need not submit a result.
    pub fn is_over(&self) -> bool {
        (self.is_over)()
    }

    /// Submits a result; a task may submit several.
    pub fn submit(&self, result: T) {
        // Infallible: the receiver outlives the threads.
        let _ = self.sender.send((self.task, result));
    }
}

/// Runs the tasks `0..` on a number of threads (at least one), each task on one of them.
///
/// Calls `each` on the calling thread with each result and the number of its task, in the order of arrival. Once `stop`
/// or `each` returns true no further task is started; results of running tasks are still passed to `each`.
pub fn work<T: Send>(
    tasks: usize,
    threads: usize,
    stop: &(dyn Fn() -> bool + Sync),
    task: &(dyn Fn(usize, &TaskContext<'_, T>) + Sync),
    each: &mut dyn FnMut(usize, T) -> ControlFlow<()>,
) {
    let (next, is_broken_off) = (AtomicUsize::new(0), AtomicBool::new(false));
    let is_over = || is_broken_off.load(Ordering::Relaxed) || stop();
    thread::scope(|scope| {
        let (sender, results) = mpsc::channel();
        let (next, is_over) = (&next, &is_over);
        let work = move |sender: Sender<(usize, T)>| {
            while !is_over() {
                let at = next.fetch_add(1, Ordering::Relaxed);
                if at >= tasks {
                    return;
                }
                task(at, &TaskContext { task: at, sender: &sender, is_over });
            }
        };
        let mut is_alone = true;
        for _ in 0..threads.clamp(1, tasks.max(1)) {
            let sender = sender.clone();
            // If the system refuses threads, those that started do all tasks; without any, the calling thread does.
            if thread::Builder::new().spawn_scoped(scope, move || work(sender)).is_err() {
                break;
            }
            is_alone = false;
        }
        if is_alone {
            work(sender.clone());
        }
        drop(sender);
        while let Ok((at, result)) = results.recv() {
            if each(at, result).is_break() {
                is_broken_off.store(true, Ordering::Relaxed);
            }
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn squares(threads: usize, enough: usize) -> Vec<(usize, usize)> {
        let mut found = Vec::new();
        let square = |at: usize, task_context: &TaskContext<'_, usize>| task_context.submit(at * at);
        work(100, threads, &|| false, &square, &mut |at, result| {
            found.push((at, result));
            if found.len() >= enough { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        });
        found.sort_unstable();
        found
    }

    #[test]
    fn every_task_is_done_once_on_any_number_of_threads() {
        let all: Vec<(usize, usize)> = (0..100).map(|at| (at, at * at)).collect();
        for threads in [0, 1, 3, 200] {
            assert_eq!(squares(threads, usize::MAX), all);
        }
    }

    #[test]
    fn nothing_is_begun_once_it_is_enough() {
        let none = |_: usize, _: &TaskContext<'_, ()>| panic!("was begun");
        work(100, 2, &|| true, &none, &mut |_, ()| ControlFlow::Continue(()));
        assert!(squares(2, 5).len() >= 5);
    }
}
