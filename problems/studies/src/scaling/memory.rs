//! Peak memory of this process.

/// Lets the peak begin anew at what the process holds now, where the system can do that.
pub fn reset_peak() {
    // Elsewhere the peak stays that of the process so far.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// Peak resident memory (VmHWM of /proc/self/status), GiB; none where the system has no such file.
pub fn peak() -> Option<f64> {
    parse(&std::fs::read_to_string("/proc/self/status").ok()?)
}

fn parse(status: &str) -> Option<f64> {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes / (1024.0 * 1024.0))
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_high_water_mark_is_read() {
        assert_eq!(super::parse("Name:\tx\nVmPeak:\t 9 kB\nVmHWM:\t 2097152 kB\nVmRSS:\t 1 kB\n"), Some(2.0));
        assert_eq!(super::parse("Name:\tx\n"), None);
    }
}
