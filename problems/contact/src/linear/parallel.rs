//! Work on several threads, with results that do not depend on their number. Only here is rayon called for loops: its
//! code is compiled anew for every kind of loop, so that all loops are one.

use rayon::prelude::*;
use std::sync::{Mutex, PoisonError};

/// Does `work` for every number below `count`.
pub fn for_each(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().for_each(work);
}

/// What `work` makes of the numbers below `count`, in their order.
pub fn map<T: Send>(count: usize, work: &(dyn Fn(usize) -> T + Sync)) -> Vec<T> {
    let results: Vec<Mutex<Option<T>>> = (0..count).map(|_| Mutex::new(None)).collect();
    for_each(count, &|index| {
        let result = work(index);
        *results[index].lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
    });
    let result = |slot: Mutex<Option<T>>| slot.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.into_iter().map(|slot| result(slot).expect("invariant: every number has its result")).collect()
}

/// Does `work` for every part, given its number.
pub fn for_parts<'v, V: Send + 'v>(
    parts: impl IntoIterator<Item = &'v mut [V]>,
    work: &(dyn Fn(usize, &mut [V]) + Sync),
) {
    // Each is locked once, by the thread that works on it.
    let parts: Vec<Mutex<&mut [V]>> = parts.into_iter().map(Mutex::new).collect();
    for_each(parts.len(), &|index| work(index, &mut parts[index].lock().unwrap_or_else(PoisonError::into_inner)));
}

/// The results of two pieces of work, on two threads where that is worth it.
pub fn join<A: Send, B: Send>(
    is_worth_it: bool,
    first: impl FnOnce() -> A + Send,
    second: impl FnOnce() -> B + Send,
) -> (A, B) {
    if is_worth_it { rayon::join(first, second) } else { (first(), second()) }
}
