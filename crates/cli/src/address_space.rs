//! Address space limit of the process (`ulimit -v`). A process that exceeds it dies by a signal without naming the input. Therefore the
//! memory limit for inputs stays below it.

use basrelief_input::{ByteSize, MemoryPool};
use std::fs;

/// Memory that the limit does not count: the machine, reserves of the allocator, and stack and heap of the signal thread \[bytes\].
const RESERVE: u64 = 128 << 20;

/// Returns the memory limit. With an address space limit no threads are started, because each would reserve more than most models need.
pub fn budget(limit: ByteSize) -> MemoryPool {
    let left = left();
    if left.is_some() {
        basrelief_threads::disable_threads();
    }
    match left {
        Some(left) if left < limit.0 => {
            MemoryPool::of_process(left, "the system grants no more (`ulimit -v`): raise that, if this input is to be trusted")
        }
        _ => MemoryPool::new(limit.0),
    }
}

/// Returns the free address space, if there is a limit and the system reports it (Linux) \[bytes\].
fn left() -> Option<u64> {
    let limits = fs::read_to_string("/proc/self/limits").ok()?;
    let status = fs::read_to_string("/proc/self/status").ok()?;
    left_of(&limits, &status)
}

fn left_of(limits: &str, status: &str) -> Option<u64> {
    let number = |text: &str, name: &str| -> Option<u64> {
        text.lines().find_map(|line| line.strip_prefix(name))?.split_whitespace().next()?.parse().ok()
    };
    let (limit, taken) = (number(limits, "Max address space")?, number(status, "VmSize:")? << 10);
    Some(limit.saturating_sub(taken).saturating_sub(RESERVE))
}

#[cfg(test)]
mod tests {
    use super::*;

    const STATUS: &str = "Name:\tbasrelief\nVmPeak:\t 9999 kB\nVmSize:\t  1024 kB\n";

    #[test]
    fn limit_is_address_space_minus_use_and_reserve() {
        let limits =
            |limit: &str| format!("Limit  Soft Limit  Hard Limit  Units\nMax address space  {limit}  unlimited  bytes\n");
        assert_eq!(left_of(&limits("209715200"), STATUS), Some(71 << 20));
        assert_eq!(left_of(&limits("1048576"), STATUS), Some(0));
        assert_eq!(left_of(&limits("unlimited"), STATUS), None);
        assert_eq!(left_of("", STATUS), None);
    }
}
