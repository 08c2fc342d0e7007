//! Parallel work. Results do not depend on it: tasks share no mutable state, and results are in the order of the tasks.
//!
//! Without threads (one core, WebAssembly, a limit of the process) the calling thread does all work. A panic in a task panics in the thread
//! that uses its result.

mod deferred;
mod tasks;

pub use deferred::Deferred;
pub use tasks::{TaskList, run_tasks};

use std::cell::Cell;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread::{self, Builder};

/// True if the calling thread must do all work.
static THREADS_DISABLED: AtomicBool = AtomicBool::new(false);

thread_local! {
    /// True in a thread of `run_on_workers`.
    static ON_WORKER: Cell<bool> = const { Cell::new(false) };
}

/// Starts no more threads. For a process with little address space, because each thread reserves a stack and a heap.
pub fn disable_threads() {
    THREADS_DISABLED.store(true, Ordering::Relaxed);
}

/// Returns the number of parallel workers.
pub fn workers() -> usize {
    static CORES: OnceLock<usize> = OnceLock::new();
    if THREADS_DISABLED.load(Ordering::Relaxed) || ON_WORKER.get() {
        return 1;
    }
    *CORES.get_or_init(|| thread::available_parallelism().map_or(1, usize::from))
}

/// Runs two closures in parallel. Without a second thread the second closure, which is in the foreground, runs first.
pub fn join<A: Send, B>(aside: impl FnOnce() -> A + Send, here: impl FnOnce() -> B) -> (A, B) {
    if workers() == 1 {
        let second = here();
        return (aside(), second);
    }
    let work = Mutex::new(Some(aside));
    // Taken by the first thread that is ready.
    let take = || work.lock().unwrap_or_else(PoisonError::into_inner).take();
    thread::scope(|scope| {
        let thread = Builder::new().spawn_scoped(scope, || take().map(|work| work()));
        let second = here();
        let first = take().map(|work| work()).or_else(|| thread.ok().and_then(|thread| value_or_panic(thread.join())));
        (first.expect("it was there to be taken once, and is done"), second)
    })
}

/// Runs two closures concurrently. They may wait for each other. Returns `None` and runs nothing if no thread is available.
pub fn join_concurrent<A: Send, B>(aside: impl FnOnce() -> A + Send, here: impl FnOnce() -> B) -> Option<(A, B)> {
    if workers() == 1 {
        return None;
    }
    thread::scope(|scope| {
        let thread = Builder::new().spawn_scoped(scope, aside).ok()?;
        let second = here();
        Some((value_or_panic(thread.join()), second))
    })
}

/// Maps the items in parallel; the results keep their order.
pub fn par_map<I: Send, T: Send>(items: Vec<I>, work: impl Fn(I) -> T + Sync) -> Vec<T> {
    let workers = workers().min(items.len());
    if workers <= 1 {
        return items.into_iter().map(work).collect();
    }
    let queue = Mutex::new(items.into_iter().enumerate());
    let next = || queue.lock().unwrap_or_else(PoisonError::into_inner).next();
    let run = || {
        let mut done = Vec::new();
        while let Some((number, item)) = next() {
            done.push((number, work(item)));
        }
        done
    };
    let mut done = thread::scope(|scope| {
        let others: Vec<_> = (1..workers).filter_map(|_| Builder::new().spawn_scoped(scope, run).ok()).collect();
        let mut done = run();
        done.extend(others.into_iter().flat_map(|thread| value_or_panic(thread.join())));
        done
    });
    done.sort_by_key(|(number, _)| *number);
    done.into_iter().map(|(_, made)| made).collect()
}

/// Runs a closure without parallelism.
pub fn sequential<T>(work: impl FnOnce() -> T) -> T {
    let before = ON_WORKER.replace(true);
    let made = work();
    ON_WORKER.set(before);
    made
}

/// Runs the same closure on this number of threads, including the caller. The closure typically takes tasks from a common list. With
/// several threads, each works without further parallelism. Fewer threads run it if no more are available.
pub fn run_on_workers(members: usize, work: impl Fn() + Sync) {
    if members <= 1 {
        return work();
    }
    let work = || sequential(&work);
    thread::scope(|scope| {
        let others: Vec<_> = (1..members).filter_map(|_| Builder::new().spawn_scoped(scope, work).ok()).collect();
        work();
        others.into_iter().for_each(|thread| value_or_panic(thread.join()));
    });
}

/// Rows per task: few enough to balance the load, enough to outweigh the cost of a task.
const ROWS: usize = 16;

/// Fills a plane of this width and height; `fill` receives the number of a row and its elements.
pub fn par_fill_rows<T: Clone + Default + Send>(width: usize, height: usize, fill: impl Fn(usize, &mut [T]) + Sync) -> Vec<T> {
    let mut plane = vec![T::default(); width * height];
    if width > 0 {
        par_map(plane.chunks_mut(ROWS * width).enumerate().collect(), |(band, rows): (usize, &mut [T])| {
            for (row, elements) in rows.chunks_mut(width).enumerate() {
                fill(ROWS * band + row, elements);
            }
        });
    }
    plane
}

/// Returns the result of a thread, or continues its panic.
fn value_or_panic<T>(result: thread::Result<T>) -> T {
    result.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

/// Starts a thread, if one is available.
fn spawn<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> io::Result<thread::JoinHandle<T>> {
    if workers() == 1 {
        return Err(io::ErrorKind::Unsupported.into());
    }
    Builder::new().spawn(work)
}

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::catch_unwind;

    /// Takes longer for earlier items.
    fn slow_square(i: u64) -> u64 {
        thread::sleep(std::time::Duration::from_millis(20 - i));
        i * i
    }

    #[test]
    fn map_keeps_order_of_items() {
        let squares: Vec<u64> = (0..20).map(|i| i * i).collect();
        assert_eq!(par_map((0..20).collect(), slow_square), squares);
        assert_eq!(par_map(Vec::new(), slow_square), []);
        assert_eq!(join(|| slow_square(1), || slow_square(9)), (1, 81));
    }

    #[test]
    fn a_plane_has_every_row_once() {
        for (width, height) in [(3, 100), (1, 1), (7, 16), (5, 0), (0, 5)] {
            let made = par_fill_rows(width, height, |row, elements: &mut [usize]| {
                elements.iter_mut().enumerate().for_each(|(column, element)| *element += 1000 * row + column);
            });
            let expected: Vec<usize> = (0..height).flat_map(|row| (0..width).map(move |column| 1000 * row + column)).collect();
            assert_eq!(made, expected);
        }
    }

    #[test]
    fn concurrent_closures_may_wait_for_each_other() {
        let (send, receive) = std::sync::mpsc::sync_channel(1);
        let sum = join_concurrent(move || receive.iter().sum::<u64>(), move || (1..=100).try_for_each(|n| send.send(n)));
        assert_eq!(sum, (workers() > 1).then_some((5050, Ok(()))));
        sequential(|| assert_eq!(join_concurrent(|| (), || panic!("there is no thread for it")), None::<((), ())>));
    }

    #[test]
    fn foreground_runs_first_on_one_thread() {
        let order = Mutex::new(Vec::new());
        let done = |what| order.lock().unwrap().push(what);
        sequential(|| join(|| done("aside"), || done("here")));
        assert_eq!(order.into_inner().unwrap(), ["here", "aside"]);
    }

    #[test]
    fn a_crew_works_at_once_and_each_member_alone() {
        let (barrier, alone) = (std::sync::Barrier::new(3), Mutex::new(Vec::new()));
        run_on_workers(3, || {
            barrier.wait();
            alone.lock().unwrap().push(workers());
        });
        assert_eq!(alone.into_inner().unwrap(), [1; 3]);
        let cores = thread::available_parallelism().map_or(1, usize::from);
        run_on_workers(1, || assert_eq!(workers(), cores));
        assert_eq!(workers(), cores, "afterwards, too");
    }

    #[test]
    fn a_panic_is_not_lost() {
        assert!(catch_unwind(|| join(|| panic!("aside"), || 1)).is_err());
        assert!(catch_unwind(|| par_map(vec![1, 2, 3], |i| assert_ne!(i, 2))).is_err());
        assert!(catch_unwind(|| Deferred::start(|| panic!("later")).get()).is_err());
    }
}
