//! Work on the host's other cores. Nothing that is computed depends on it: pieces of work share nothing that is written, and
//! what they give is put together in the order of the pieces, whichever was done first.
//!
//! Where no thread can be had (one core, WebAssembly, a process that may have no more of them), the same is done on the caller's.
//! A panic in a piece of work is a panic of who asks for its result.

mod later;
mod tasks;

pub use later::Later;
pub use tasks::{Tasks, tasks};

use std::cell::Cell;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::thread::{self, Builder};

/// Whether everything is to be done on the caller's thread.
static ALONE: AtomicBool = AtomicBool::new(false);

thread_local! {
    /// Whether this thread is a member of a crew.
    static IN_CREW: Cell<bool> = const { Cell::new(false) };
}

/// From now on no thread is started. For a process that may take little address space: each thread reserves a stack and a heap of
/// its own there, whether it needs them or not.
pub fn work_alone() {
    ALONE.store(true, Ordering::Relaxed);
}

/// How many pieces of work are done at once.
pub fn workers() -> usize {
    static CORES: OnceLock<usize> = OnceLock::new();
    if ALONE.load(Ordering::Relaxed) || IN_CREW.get() {
        return 1;
    }
    *CORES.get_or_init(|| thread::available_parallelism().map_or(1, usize::from))
}

/// Does two things at once; the first behind the second where there is no room.
pub fn both<A: Send, B>(aside: impl FnOnce() -> A + Send, here: impl FnOnce() -> B) -> (A, B) {
    if workers() == 1 {
        let second = here();
        return (aside(), second);
    }
    let work = Mutex::new(Some(aside));
    // Taken by whoever does it.
    let take = || work.lock().unwrap_or_else(PoisonError::into_inner).take();
    thread::scope(|scope| {
        let thread = Builder::new().spawn_scoped(scope, || take().map(|work| work()));
        let second = here();
        let first = take().map(|work| work()).or_else(|| thread.ok().and_then(|thread| joined(thread.join())));
        (first.expect("it was there to be taken once, and is done"), second)
    })
}

/// Does two things at once of which one may wait for the other; none, and nothing is done, where no thread can be had.
pub fn apart<A: Send, B>(aside: impl FnOnce() -> A + Send, here: impl FnOnce() -> B) -> Option<(A, B)> {
    if workers() == 1 {
        return None;
    }
    thread::scope(|scope| {
        let thread = Builder::new().spawn_scoped(scope, aside).ok()?;
        let second = here();
        Some((joined(thread.join()), second))
    })
}

/// What `work` makes of each item, in their order.
pub fn map<I: Send, T: Send>(items: Vec<I>, work: impl Fn(I) -> T + Sync) -> Vec<T> {
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
        done.extend(others.into_iter().flat_map(|thread| joined(thread.join())));
        done
    });
    done.sort_by_key(|(number, _)| *number);
    done.into_iter().map(|(_, made)| made).collect()
}

/// Does something on this thread alone, as a member of a crew does.
pub fn alone<T>(work: impl FnOnce() -> T) -> T {
    let before = IN_CREW.replace(true);
    let made = work();
    IN_CREW.set(before);
    made
}

/// Has so many threads do the same at once, the caller's among them: as a rule they take from one list what there is to do. Where
/// there are several, each works alone: the other cores have work of their own. Fewer do it where there are no more to be had.
pub fn crew(members: usize, work: impl Fn() + Sync) {
    if members <= 1 {
        return work();
    }
    let work = || alone(&work);
    thread::scope(|scope| {
        let others: Vec<_> = (1..members).filter_map(|_| Builder::new().spawn_scoped(scope, work).ok()).collect();
        work();
        others.into_iter().for_each(|thread| joined(thread.join()));
    });
}

/// Rows that are filled by one thread in one go: few enough for all to end together, and far more work than to ask for them.
const ROWS: usize = 16;

/// A plane of this width and height, row by row: `fill` is given the number of a row and its elements.
pub fn plane<T: Clone + Default + Send>(width: usize, height: usize, fill: impl Fn(usize, &mut [T]) + Sync) -> Vec<T> {
    let mut plane = vec![T::default(); width * height];
    if width > 0 {
        map(plane.chunks_mut(ROWS * width).enumerate().collect(), |(band, rows): (usize, &mut [T])| {
            for (row, elements) in rows.chunks_mut(width).enumerate() {
                fill(ROWS * band + row, elements);
            }
        });
    }
    plane
}

/// What a thread came to, its panic included.
fn joined<T>(result: thread::Result<T>) -> T {
    result.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
}

/// A thread of its own for some work, if it can be had.
fn spawned<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> io::Result<thread::JoinHandle<T>> {
    if workers() == 1 {
        return Err(io::ErrorKind::Unsupported.into());
    }
    Builder::new().spawn(work)
}

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
    fn results_come_in_the_order_of_the_items_whichever_was_done_first() {
        let squares: Vec<u64> = (0..20).map(|i| i * i).collect();
        assert_eq!(map((0..20).collect(), slow_square), squares);
        assert_eq!(map(Vec::new(), slow_square), []);
        assert_eq!(both(|| slow_square(1), || slow_square(9)), (1, 81));
    }

    #[test]
    fn a_plane_has_every_row_once() {
        for (width, height) in [(3, 100), (1, 1), (7, 16), (5, 0), (0, 5)] {
            let made = plane(width, height, |row, elements: &mut [usize]| {
                elements.iter_mut().enumerate().for_each(|(column, element)| *element += 1000 * row + column);
            });
            let expected: Vec<usize> = (0..height).flat_map(|row| (0..width).map(move |column| 1000 * row + column)).collect();
            assert_eq!(made, expected);
        }
    }

    #[test]
    fn of_two_things_apart_one_waits_for_the_other() {
        let (send, receive) = std::sync::mpsc::sync_channel(1);
        let sum = apart(move || receive.iter().sum::<u64>(), move || (1..=100).try_for_each(|n| send.send(n)));
        assert_eq!(sum, (workers() > 1).then_some((5050, Ok(()))));
        alone(|| assert_eq!(apart(|| (), || panic!("there is no thread for it")), None::<((), ())>));
    }

    #[test]
    fn of_two_things_on_one_thread_the_one_that_is_here_goes_first() {
        let order = Mutex::new(Vec::new());
        let done = |what| order.lock().unwrap().push(what);
        alone(|| both(|| done("aside"), || done("here")));
        assert_eq!(order.into_inner().unwrap(), ["here", "aside"]);
    }

    #[test]
    fn a_crew_works_at_once_and_each_member_alone() {
        let (barrier, alone) = (std::sync::Barrier::new(3), Mutex::new(Vec::new()));
        crew(3, || {
            barrier.wait();
            alone.lock().unwrap().push(workers());
        });
        assert_eq!(alone.into_inner().unwrap(), [1; 3]);
        let cores = thread::available_parallelism().map_or(1, usize::from);
        crew(1, || assert_eq!(workers(), cores));
        assert_eq!(workers(), cores, "afterwards, too");
    }

    #[test]
    fn a_panic_is_not_lost() {
        assert!(catch_unwind(|| both(|| panic!("aside"), || 1)).is_err());
        assert!(catch_unwind(|| map(vec![1, 2, 3], |i| assert_ne!(i, 2))).is_err());
        assert!(catch_unwind(|| Later::start(|| panic!("later")).get()).is_err());
    }
}
