//! Work without the interpreter's lock: on a number of threads, and until the user interrupts it.

use crate::failure::invalid;
use helfrich_std::execute::{Interruption, interruptible, with_threads};
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::cell::RefCell;
use std::num::NonZeroUsize;
use std::rc::Rc;
use std::time::{Duration, Instant};

/// Time between looks for signals.
const BETWEEN_LOOKS: Duration = Duration::from_millis(50);

/// Does `work` so that whatever it prepares runs on this number of threads, 1 to 1024, or on all.
pub(crate) fn prepared_for<R>(
    threads: Option<usize>,
    work: impl FnOnce() -> PyResult<R>,
) -> PyResult<R> {
    let Some(threads) = threads else {
        // The system takes longer to count them than a small evaluation does.
        return work();
    };
    let threads = NonZeroUsize::new(threads).filter(|threads| threads.get() <= 1024);
    let out_of_range = || invalid("threads is out of range: 1 to 1024 are possible");
    with_threads(threads.ok_or_else(out_of_range)?, work)
}

/// Does `work` on this number of threads, 1 to 1024, or all, without the interpreter's lock, until the user
/// interrupts it.
pub(crate) fn on_threads<R: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce() -> R + Send,
) -> PyResult<R> {
    in_steps(py, threads, || {
        let watch = Rc::new(Watch::default());
        let own = Rc::clone(&watch);
        let done = interruptible(Interruption::by_look(move || own.ends()), work);
        done.ok_or_else(|| watch.error.take())
    })?
    .map_err(|error| error.unwrap_or_else(|| PyKeyboardInterrupt::new_err(())))
}

/// The same for `work` that looks for signals after each step, and keeps what it has done.
pub(crate) fn in_steps<R: Send>(
    py: Python<'_>,
    threads: Option<usize>,
    work: impl FnOnce() -> R + Send,
) -> PyResult<R> {
    prepared_for(threads, || Ok(py.detach(work)))
}

/// Looks for signals, as those of Ctrl-C, while work is done, and for the end that somebody asks for.
#[derive(Default)]
pub(crate) struct Watch {
    last: RefCell<Option<Instant>>,
    error: RefCell<Option<PyErr>>,
}

impl Watch {
    /// Whether work has to end.
    pub(crate) fn ends(&self) -> bool {
        let now = Instant::now();
        let is_early = |last: Instant| now.duration_since(last) < BETWEEN_LOOKS;
        if self.error.borrow().is_some() {
            return true;
        }
        if self.last.borrow().is_some_and(is_early) {
            return false;
        }
        *self.last.borrow_mut() = Some(now);
        match Python::attach(|py| py.check_signals()) {
            Ok(()) => false,
            Err(error) => {
                self.fail(error);
                true
            }
        }
    }

    /// Ends the work with an error.
    pub(crate) fn fail(&self, error: PyErr) {
        self.error.borrow_mut().get_or_insert(error);
    }

    /// The error that ended the work.
    pub(crate) fn into_error(self) -> Option<PyErr> {
        self.error.into_inner()
    }
}
