//! What the process has used so far, where the system tells.

/// Seconds spent on the processor.
pub(crate) fn cpu() -> f64 {
    let own = std::fs::read_to_string("/proc/self/schedstat").ok();
    own.and_then(|s| s.split(' ').next()?.parse::<f64>().ok()).map_or_else(
        || std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0.0, |d| d.as_secs_f64()),
        |ns| ns * 1e-9,
    )
}

/// Peak and present resident memory in bytes, where the system tells.
pub(crate) fn resident() -> (usize, usize) {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let field = |name: &str| {
        let line = status.lines().find(|l| l.starts_with(name))?;
        line.split_whitespace().nth(1)?.parse::<usize>().ok()
    };
    (field("VmHWM:").unwrap_or(0) * 1024, field("VmRSS:").unwrap_or(0) * 1024)
}
