//! Runs of a sweep that take place at once.

use super::{Case, Outcome, SweepError, SweepProgress, Swept};
use crate::execute::{available_threads, in_parts, with_threads};
use crate::run::Progress;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The outcomes of all combinations, and where the next one is taken from.
pub(super) struct Board<'a> {
    cases: Vec<Case>,
    next: AtomicUsize,
    /// Whether a run has failed so that the others stop, too.
    stopped: AtomicBool,
    shared: Mutex<Shared<'a>>,
}

struct Shared<'a> {
    swept: Swept,
    /// The part of each run that is done, from 0 to 1.
    fractions: Vec<f64>,
    progress: &'a mut (dyn FnMut(&SweepProgress<'_>) + Send),
    error: Option<SweepError>,
}

impl<'a> Board<'a> {
    pub(super) fn new(
        swept: Swept,
        progress: &'a mut (dyn FnMut(&SweepProgress<'_>) + Send),
    ) -> Self {
        let cases = Vec::from_iter(swept.cases.iter().map(|(case, _)| case.clone()));
        Self {
            next: AtomicUsize::new(0),
            stopped: AtomicBool::new(false),
            shared: Mutex::new(Shared {
                fractions: vec![0.0; cases.len()],
                swept,
                progress,
                error: None,
            }),
            cases,
        }
    }

    fn shared(&self) -> MutexGuard<'_, Shared<'a>> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether a run has failed so that no other can go on.
    pub(super) fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// Tells how far a run is.
    pub(super) fn tell(&self, at: usize, case: &Case, run: &Progress<'_>) {
        let mut shared = self.shared();
        shared.fractions[at] = run.fraction;
        let count = self.cases.len();
        let fraction = shared.fractions.iter().sum::<f64>() / count as f64;
        (shared.progress)(&SweepProgress {
            case: [at, count],
            name: &case.name,
            run,
            fraction,
        });
    }

    /// Enters the outcome of a run and writes what follows from all.
    pub(super) fn enter(
        &self,
        at: usize,
        outcome: Outcome,
        write: impl FnOnce(&mut Swept) -> Result<(), SweepError>,
    ) -> Result<(), SweepError> {
        let mut shared = self.shared();
        shared.fractions[at] = 1.0;
        shared.swept.cases[at].1 = outcome;
        write(&mut shared.swept)
    }

    /// Does `work` for every combination, for as many at once as there are `jobs`: each takes the next
    /// one as soon as it is free, and has its share of the available threads.
    ///
    /// # Errors
    /// The first error of `work`; what has not begun by then does not begin.
    pub(super) fn share(
        &self,
        jobs: NonZeroUsize,
        work: &(dyn Fn(usize, &Case) -> Result<(), SweepError> + Sync),
    ) -> Result<(), SweepError> {
        let jobs = jobs.get().min(self.cases.len());
        let threads = available_threads().get();
        in_parts(0..jobs, &|number| {
            // All shares together are the available threads.
            let share = NonZeroUsize::new((threads + number) / jobs);
            with_threads(share.unwrap_or(NonZeroUsize::MIN), || {
                while !self.is_stopped() {
                    let at = self.next.fetch_add(1, Ordering::Relaxed);
                    let Some(case) = self.cases.get(at) else {
                        return;
                    };
                    if let Err(error) = work(at, case) {
                        self.stopped.store(true, Ordering::Relaxed);
                        self.shared().error.get_or_insert(error);
                    }
                }
            });
        });
        self.shared().error.take().map_or(Ok(()), Err)
    }

    pub(super) fn into_swept(self) -> Swept {
        let shared = self.shared.into_inner();
        shared.unwrap_or_else(PoisonError::into_inner).swept
    }
}
