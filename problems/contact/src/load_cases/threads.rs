//! Work on all cases at the same time.

use nonsmooth::interruption::{interrupted, watched};
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Time between two looks at whether all cases are done and whether they are still wanted.
const INTERVAL: Duration = Duration::from_millis(2);

/// What `work` makes of the numbers below `count`, in their order: at the same time on as many threads as the pool has,
/// or, if `in_turn`, one after the other on the thread of the caller. Threads of the pool may share the work on one
/// case, so that those that wait for a case are threads of their own. An interruption of the caller reaches all.
pub(super) fn on_all<T: Send>(count: usize, in_turn: bool, work: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let threads = count.min(rayon::current_num_threads());
    if in_turn || threads < 2 {
        return (0..count).map(work).collect();
    }
    let (next, unwanted) = (AtomicUsize::new(0), Arc::new(AtomicBool::new(false)));
    let found: Mutex<Vec<Option<T>>> = Mutex::new((0..count).map(|_| None).collect());
    let take = || {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= count {
                return;
            }
            let result = work(number);
            found.lock().unwrap_or_else(PoisonError::into_inner)[number] = Some(result);
        }
    };
    thread::scope(|scope| {
        let begin = |_| {
            let unwanted = Arc::clone(&unwanted);
            scope.spawn(|| watched(move || unwanted.load(Ordering::Relaxed), take))
        };
        let threads: Vec<_> = (0..threads).map(begin).collect();
        while threads.iter().any(|thread| !thread.is_finished()) {
            unwanted.fetch_or(interrupted(), Ordering::Relaxed);
            thread::sleep(INTERVAL);
        }
        threads.into_iter().for_each(|thread| thread.join().unwrap_or_else(|panic| resume_unwind(panic)));
    });
    let found = found.into_inner().unwrap_or_else(PoisonError::into_inner);
    found.into_iter().map(|result| result.expect("invariant: every number has been taken")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_keep_their_order() {
        for in_turn in [false, true] {
            assert_eq!(on_all(7, in_turn, |number| 3 * number), [0, 3, 6, 9, 12, 15, 18]);
        }
    }

    #[test]
    fn an_interruption_of_the_caller_reaches_all() {
        let loops = |_| (0..u64::MAX).any(|_| interrupted());
        assert_eq!(watched(|| true, || on_all(3, false, loops)), [true; 3]);
    }
}
