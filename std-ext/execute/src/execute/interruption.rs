//! Work that ends early because somebody has asked for it.
//!
//! Formulas and kernels know nothing of this. The loops of [`Parallel`](super::Parallel) look for a request at
//! their start and after each [`SLICE`] of slots. They leave the rest undone and unwind the stack of the
//! calling thread, without a panic's message, up to [`interruptible`]: nobody sees results that are not
//! complete, and those of work that is completed are the same as ever.

use helfrich::element::Slots;
use std::cell::RefCell;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::rc::Rc;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Number of slots that are computed between two looks for a request: those of the most expensive methods take
/// a fraction of a second.
pub const SLICE: usize = 512;

/// A request to end work, and the way to find out about it.
#[derive(Clone, Default)]
pub struct Interruption {
    requested: Arc<AtomicBool>,
    look: Option<Rc<dyn Fn() -> bool>>,
}

impl Interruption {
    /// A request that somebody makes by setting this flag, such as a handler of signals.
    pub fn by_flag(requested: Arc<AtomicBool>) -> Self {
        Self {
            requested,
            look: None,
        }
    }

    /// A request that is made when `look` returns true. It is called by the thread that does the work, often.
    pub fn by_look(look: impl Fn() -> bool + 'static) -> Self {
        Self {
            requested: Arc::default(),
            look: Some(Rc::new(look)),
        }
    }

    /// Whether the request has been made.
    fn is_requested(&self) -> bool {
        if self.requested.load(Ordering::Relaxed) {
            return true;
        }
        let is_new = self.look.as_ref().is_some_and(|look| look());
        if is_new {
            self.requested.store(true, Ordering::Relaxed);
        }
        is_new
    }
}

impl fmt::Debug for Interruption {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut debug = f.debug_struct("Interruption");
        debug.field("requested", &self.requested).finish()
    }
}

thread_local! {
    /// The request for which the loops of this thread look.
    static HERE: RefCell<Option<Interruption>> = const { RefCell::new(None) };
}

/// Does `work`, whose loops on this thread look for a request to end; `None` if it has ended early.
pub fn interruptible<R>(interruption: Interruption, work: impl FnOnce() -> R) -> Option<R> {
    /// Restores the previous request, also when the stack is unwound.
    struct Restored(Option<Interruption>);
    impl Drop for Restored {
        fn drop(&mut self) {
            HERE.replace(self.0.take());
        }
    }
    let _restored = Restored(HERE.replace(Some(interruption)));
    unless_interrupted(work)
}

/// The payload with which the stack is unwound.
struct Interrupted;

/// The result of a part of [`interruptible`] work; `None` if it has ended early. What it was changing is then
/// incomplete, and should be dropped.
pub fn unless_interrupted<R>(work: impl FnOnce() -> R) -> Option<R> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(result) => Some(result),
        Err(payload) if payload.is::<Interrupted>() => None,
        Err(panic) => resume_unwind(panic),
    }
}

/// Ends the work under way if this has been requested: loops that are not those of
/// [`Parallel`](super::Parallel) call this function now and then.
pub fn look_for_interruption() {
    // Writers are flushed while the stack is unwound.
    if !std::thread::panicking() && Loop::here().ends() {
        resume_unwind(Box::new(Interrupted));
    }
}

/// The request for which a loop looks, on any of its threads.
pub(super) struct Loop(Option<Arc<AtomicBool>>);

impl Loop {
    /// The request for the loops of this thread.
    pub(super) fn here() -> Self {
        let here = |here: &Option<Interruption>| Some(Arc::clone(&here.as_ref()?.requested));
        Self(HERE.with_borrow(here))
    }

    /// Whether the loop has to end.
    fn ends(&self) -> bool {
        let Some(requested) = &self.0 else {
            return false;
        };
        // Threads that a loop has started have no request of their own, and look at the flag only.
        let here = HERE.with_borrow(Clone::clone);
        here.is_some_and(|here| here.is_requested()) || requested.load(Ordering::Relaxed)
    }

    /// Calls `work` with all slots, a slice at a time if somebody may request the end.
    #[inline]
    pub(super) fn for_slices<O: Slots>(
        &self,
        mut start: usize,
        slots: O,
        mut work: impl FnMut(usize, O),
    ) {
        if self.0.is_none() {
            return work(start, slots);
        }
        let mut left = Some(slots);
        while let Some(slots) = left.take()
            && !self.ends()
        {
            if slots.count() > SLICE {
                let (slice, others) = slots.split_at(SLICE);
                work(start, slice);
                start += SLICE;
                left = Some(others);
            } else {
                work(start, slots);
            }
        }
    }
}
