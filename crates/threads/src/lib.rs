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
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
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

// Threads get their work through a pointer. Compiled for each closure, these functions took 0.6 instead of 0.2 MB of the
// program.

/// Runs two closures in parallel. Without a second thread the second closure, which is in the foreground, runs first.
pub fn join<A: Send, B>(aside: impl FnOnce() -> A + Send, here: impl FnOnce() -> B) -> (A, B) {
    // The first thread that is ready takes the work.
    let (work, result) = (Mutex::new(Some(aside)), Mutex::new(None));
    let take_and_run = || {
        if let Some(work) = take(&work) {
            *lock(&result) = Some(work());
        }
    };
    let (mut here, mut second) = (Some(here), None);
    let run = &mut || {
        second = here.take().map(|work| work());
        take_and_run();
    };
    run_beside(usize::from(workers() > 1), &take_and_run, run);
    take(&result).zip(second).expect("each closure was there to be taken once, and is done")
}

/// Runs two closures concurrently. They may wait for each other. Returns `None` and runs nothing if no thread is available.
pub fn join_concurrent<A: Send, B>(aside: impl FnOnce() -> A + Send, here: impl FnOnce() -> B) -> Option<(A, B)> {
    let (mut aside, mut first, mut here, mut second) = (Some(aside), None, Some(here), None);
    run_concurrent(&mut || first = aside.take().map(|work| work()), &mut || second = here.take().map(|work| work()));
    first.zip(second)
}

/// Runs both closures, or none if no thread is available.
fn run_concurrent(aside: &mut (dyn FnMut() + Send), here: &mut dyn FnMut()) {
    if workers() == 1 {
        return;
    }
    thread::scope(|scope| {
        if let Ok(thread) = Builder::new().spawn_scoped(scope, aside) {
            here();
            value_or_panic(thread.join());
        }
    });
}

/// Runs `aside` on this number of threads, or on fewer if no more are available, and meanwhile `here` in the calling thread.
fn run_beside(threads: usize, aside: &(dyn Fn() + Sync), here: &mut dyn FnMut()) {
    if threads == 0 {
        return here();
    }
    thread::scope(|scope| {
        let others: Vec<_> = (0..threads).filter_map(|_| Builder::new().spawn_scoped(scope, aside).ok()).collect();
        here();
        others.into_iter().for_each(|thread| value_or_panic(thread.join()));
    });
}

/// Maps the items in parallel; the results keep their order.
pub fn par_map<I: Send, T: Send>(items: Vec<I>, work: impl Fn(I) -> T + Sync) -> Vec<T> {
    let places: Vec<_> = items.into_iter().map(|item| (Mutex::new(Some(item)), Mutex::new(None))).collect();
    run_numbered(places.len(), &|number| {
        let (item, made) = &places[number];
        if let Some(item) = take(item) {
            *lock(made) = Some(work(item));
        }
    });
    places.into_iter().filter_map(|(_, made)| take(&made)).collect()
}

/// Runs `work` once with each number below `count`, on all workers.
fn run_numbered(count: usize, work: &(dyn Fn(usize) + Sync)) {
    let next = AtomicUsize::new(0);
    let take_and_run = || {
        while let Some(number) = Some(next.fetch_add(1, Ordering::Relaxed)).filter(|number| *number < count) {
            work(number);
        }
    };
    run_beside(workers().min(count).saturating_sub(1), &take_and_run, &mut || take_and_run());
}

/// Locks a value, even if a thread panicked while it held the lock: the panic itself is not lost.
pub fn lock<T>(of: &Mutex<T>) -> MutexGuard<'_, T> {
    of.lock().unwrap_or_else(PoisonError::into_inner)
}

fn take<T>(from: &Mutex<Option<T>>) -> Option<T> {
    lock(from).take()
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
    run_beside(members - 1, &work, &mut || work());
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
