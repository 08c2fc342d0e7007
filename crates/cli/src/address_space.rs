//! How much memory the process may have at all (`ulimit -v`). Whoever asks for more is ended by a signal, with no word about the
//! file that asked for it: so no more than that is granted to files in the first place.

use basrelief_input::{Budget, Size};
use std::fs;

/// What is not counted against a budget: the machine, what the allocator keeps between what it has given out, and a stack and a
/// heap for the thread that waits for Ctrl-C \[bytes\].
const RESERVE: u64 = 128 << 20;

/// A budget of so much, or of what there is. Where that is limited, there will be no threads to help: each would reserve more of it
/// than most models take.
pub fn budget(limit: Size) -> Budget {
    let left = left();
    if left.is_some() {
        basrelief_threads::work_alone();
    }
    match left {
        Some(left) if left < limit.0 => {
            Budget::with_advice(left, "the system grants no more (`ulimit -v`): raise that, if this input is to be trusted")
        }
        _ => Budget::new(limit.0),
    }
}

/// What may still be taken of the address space, where there is a limit, and the system tells of it (Linux) \[bytes\].
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
    fn what_is_left_is_the_limit_less_what_is_taken_and_a_reserve() {
        let limits =
            |limit: &str| format!("Limit  Soft Limit  Hard Limit  Units\nMax address space  {limit}  unlimited  bytes\n");
        assert_eq!(left_of(&limits("209715200"), STATUS), Some(71 << 20));
        assert_eq!(left_of(&limits("1048576"), STATUS), Some(0));
        assert_eq!(left_of(&limits("unlimited"), STATUS), None);
        assert_eq!(left_of("", STATUS), None);
    }
}
