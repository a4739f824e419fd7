//! Whether there is memory for a solve, asked before it starts: a process that takes more than there is is ended
//! without a word.

use crate::backend::SolveError;

/// Below this need [bytes] the system is not asked.
const SMALL: u64 = 64 << 20;

/// Refuses a solve that needs more memory than is free. On systems where that is not known nothing is refused.
///
/// # Errors
/// [`SolveError::Memory`] with both sizes.
pub(crate) fn check(backend: &'static str, needed: u64, widest: usize) -> Result<(), SolveError> {
    match available().filter(|_| needed > SMALL) {
        Some(available) if needed > available => Err(SolveError::Memory {
            backend,
            needed,
            available,
            widest,
        }),
        _ => Ok(()),
    }
}

/// Memory that this process can still take [bytes]: the least of what the system has free, what is left of its control
/// group's limit, and what is left of its limit of address space.
#[cfg(target_os = "linux")]
pub fn available() -> Option<u64> {
    let limits = [
        linux::free(),
        linux::group_left(),
        linux::address_space_left(),
    ];
    limits.into_iter().flatten().min()
}

/// Not known on this system.
#[cfg(not(target_os = "linux"))]
pub fn available() -> Option<u64> {
    None
}

#[cfg(target_os = "linux")]
mod linux {
    use std::fs::read_to_string;
    use std::path::Path;

    /// The number after a key, as it stands.
    fn field(text: &str, key: &str) -> Option<u64> {
        let mut lines = text.lines();
        let rest = lines.find_map(|line| line.strip_prefix(key))?;
        rest.split_whitespace().next()?.parse().ok()
    }

    /// `MemAvailable` of proc(5).
    pub fn free() -> Option<u64> {
        let kilobytes = field(&read_to_string("/proc/meminfo").ok()?, "MemAvailable:")?;
        kilobytes.checked_mul(1024)
    }

    /// Of the process's control group (version 2) and of all those around it, the least that is left of a limit.
    pub fn group_left() -> Option<u64> {
        let groups = read_to_string("/proc/self/cgroup").ok()?;
        let own = groups.lines().find_map(|line| line.strip_prefix("0::/"))?;
        let root = Path::new("/sys/fs/cgroup");
        let folders = Path::new(own).ancestors();
        folders.filter_map(|folder| left(&root.join(folder))).min()
    }

    /// The limit less what is in use; pages of files that can be dropped at any time do not count.
    fn left(folder: &Path) -> Option<u64> {
        let number = |name: &str| read_to_string(folder.join(name)).ok()?.trim().parse().ok();
        let (limit, used): (u64, u64) = (number("memory.max")?, number("memory.current")?);
        let statistics = read_to_string(folder.join("memory.stat")).unwrap_or_default();
        let files = field(&statistics, "inactive_file ").unwrap_or(0);
        Some(limit.saturating_sub(used.saturating_sub(files)))
    }

    /// What `ulimit -v` leaves.
    pub fn address_space_left() -> Option<u64> {
        let limit = rustix::process::getrlimit(rustix::process::Resource::As).current?;
        let status = read_to_string("/proc/self/status").ok()?;
        let used = field(&status, "VmSize:")?.saturating_mul(1024);
        Some(limit.saturating_sub(used))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_any_machine_has_is_refused_with_both_sizes() {
        let refused = check("clarabel", u64::MAX, 201);
        match available() {
            Some(available) => assert!(
                matches!(refused, Err(SolveError::Memory { needed: u64::MAX, available: now, widest: 201, .. })
                    if now.abs_diff(available) < available / 2)
            ),
            None => assert_eq!(refused, Ok(())),
        }
        assert_eq!(check("clarabel", SMALL, 10), Ok(()));
    }
}
