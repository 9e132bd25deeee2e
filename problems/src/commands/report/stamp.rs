//! When, by what and where a report was written.

use std::time::{SystemTime, UNIX_EPOCH};

/// One line: date, versions, system, processor, threads.
pub fn stamp() -> String {
    let build = if cfg!(debug_assertions) { "with debug assertions" } else { "optimized" };
    format!(
        "Written {} by problems {} on nonsmooth {} (built {build}), {} {}, {} threads.",
        SystemTime::now().duration_since(UNIX_EPOCH).map_or_else(|_| "before 1970".into(), |now| date(now.as_secs())),
        env!("CARGO_PKG_VERSION"),
        nonsmooth::VERSION,
        std::env::consts::OS,
        std::env::consts::ARCH,
        rayon::current_num_threads()
    )
}

/// Seconds since the beginning of 1970 as date and time of UTC, ISO 8601.
fn date(seconds: u64) -> String {
    const DAY: u64 = 86_400;
    let (mut days, time) = (seconds / DAY, seconds % DAY);
    let is_leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while days >= 365 + u64::from(is_leap(year)) {
        days -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let months = [31, 28 + u64::from(is_leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 0;
    while days >= months[month] {
        days -= months[month];
        month += 1;
    }
    let [hour, minute, second] = [time / 3600, time / 60 % 60, time % 60];
    format!("{year}-{:02}-{:02}T{hour:02}:{minute:02}:{second:02}Z", month + 1, days + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_of_leap_years_and_ends_of_months_are_right() {
        // Checked with `date -u -d @…`.
        let known = [
            (0, "1970-01-01T00:00:00Z"),
            (951_782_399, "2000-02-28T23:59:59Z"),
            (951_782_400, "2000-02-29T00:00:00Z"),
            (1_709_251_199, "2024-02-29T23:59:59Z"),
            (1_767_225_599, "2025-12-31T23:59:59Z"),
            (4_107_542_400, "2100-03-01T00:00:00Z"),
        ];
        for (seconds, text) in known {
            assert_eq!(date(seconds), text);
        }
    }
}
