//! A limit on the size of files (`ulimit -f`).

/// From now on a write beyond the limit fails like one to a full disk. Left alone, the system ends the program by
/// SIGXFSZ, without a word.
#[cfg(unix)]
pub fn let_large_writes_fail() {
    static REACHED: std::sync::atomic::AtomicBool = std::sync::atomic::AtomicBool::new(false);
    // Where it cannot be done, the program ends without a word, as others do.
    let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, &REACHED);
}

/// Other systems have no such limit.
#[cfg(not(unix))]
pub fn let_large_writes_fail() {}
