//! The wish that a computation end before its result: an interrupt key, a closed window.
//!
//! Between evaluations, an observer ends a run. Inside an evaluation or a subproblem, only the code that computes can
//! stop. Whoever waits says by [`watched`] how it is asked; long loops ask [`interrupted`] once per pass, and give up.
//! Both belong to the thread that computes: nothing is shared, and where nobody watches, nothing is asked and no result
//! depends on it.

use std::cell::{Cell, RefCell};
use std::time::{Duration, Instant};

/// Time between two questions: loops ask more often than an answer is worth.
const INTERVAL: Duration = Duration::from_millis(50);

/// Who is asked, and what was said.
struct Watch {
    wants_end: Box<dyn FnMut() -> bool>,
    /// When the next question is due.
    due: Instant,
    interrupted: bool,
}

thread_local! {
    static WATCH: RefCell<Option<Watch>> = const { RefCell::new(None) };
    static DEADLINE: Cell<Option<Instant>> = const { Cell::new(None) };
}

/// Puts the watch of the caller back, also after a panic.
struct Restored(Option<Watch>);

impl Drop for Restored {
    fn drop(&mut self) {
        WATCH.set(self.0.take());
    }
}

/// Does some work on this thread; `wants_end` is asked now and then whether the work shall end before its result. A
/// watch inside a watch takes its place until it ends.
///
/// ```
/// use nonsmooth::interruption::{interrupted, watched};
/// let passes = watched(|| true, || (1..).find(|_| interrupted()));
/// assert!(passes.is_some());
/// assert!(!interrupted());
/// ```
pub fn watched<T>(wants_end: impl FnMut() -> bool + 'static, work: impl FnOnce() -> T) -> T {
    let watch = Watch { wants_end: Box::new(wants_end), due: Instant::now(), interrupted: false };
    let _before = Restored(WATCH.replace(Some(watch)));
    work()
}

/// Puts the deadline of the caller back, also after a panic.
struct FormerDeadline(Option<Instant>);

impl Drop for FormerDeadline {
    fn drop(&mut self) {
        DEADLINE.set(self.0);
    }
}

/// Does some work on this thread that shall end by a deadline, or earlier if the watch says so. Returns whether the
/// deadline has passed, too.
pub(crate) fn until<T>(deadline: Option<Instant>, work: impl FnOnce() -> T) -> (T, bool) {
    let _before = FormerDeadline(DEADLINE.replace(deadline));
    (work(), is_late())
}

fn is_late() -> bool {
    DEADLINE.get().is_some_and(|deadline| deadline <= Instant::now())
}

/// Whether the work of this thread shall end before its result. Once true, it stays true until the watch ends.
pub fn interrupted() -> bool {
    if is_late() {
        return true;
    }
    let due = WATCH.with_borrow(|watch| match watch {
        None => false,
        Some(watch) => watch.interrupted || watch.due <= Instant::now(),
    });
    // Whoever is asked may compute something of its own: the place is free meanwhile.
    let Some(mut watch) = (if due { WATCH.take() } else { None }) else { return false };
    watch.interrupted = watch.interrupted || (watch.wants_end)();
    watch.due = Instant::now() + INTERVAL;
    let interrupted = watch.interrupted;
    WATCH.set(Some(watch));
    interrupted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_watch_inside_a_watch_takes_its_place_until_it_ends() {
        let until = |wanted: bool| {
            let begin = Instant::now();
            while !interrupted() && begin.elapsed() < 3 * INTERVAL {}
            assert_eq!(interrupted(), wanted);
        };
        until(false);
        watched(
            || true,
            || {
                watched(|| false, || until(false));
                let panicked = std::panic::catch_unwind(|| watched(|| false, || panic!("inside")));
                assert!(panicked.is_err());
                until(true);
            },
        );
        until(false);
    }

    #[test]
    fn a_deadline_ends_work_and_leaves_the_watch_its_place() {
        let loops = || (0..u64::MAX).any(|_| interrupted());
        assert_eq!(until(Some(Instant::now() + INTERVAL), loops), (true, true));
        let later = Instant::now() + 1000 * INTERVAL;
        assert_eq!(watched(|| true, || until(Some(later), loops)), (true, false));
        assert!(!interrupted());
    }

    #[test]
    fn whoever_is_asked_may_compute_as_well() {
        let asks = || watched(|| true, || (0..u64::MAX).any(|_| interrupted()));
        assert!(watched(asks, || (0..u64::MAX).any(|_| interrupted())));
    }
}
