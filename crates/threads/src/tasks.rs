//! Work that leads to more work.

use crate::{lock, run_on_workers, workers};
use std::collections::VecDeque;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// A list of tasks, in order.
#[derive(Debug)]
pub struct TaskList<T> {
    list: Mutex<TaskQueue<T>>,
    changed: Condvar,
}

#[derive(Debug)]
struct TaskQueue<T> {
    waiting: VecDeque<T>,
    /// Number of running tasks, each of which may add tasks.
    under_way: usize,
}

/// Executes tasks and those added meanwhile, on all workers.
pub fn run_tasks<T: Send>(first: impl IntoIterator<Item = T>, work: impl Fn(T, &TaskList<T>) + Sync) {
    let list = TaskQueue { waiting: first.into_iter().collect(), under_way: 0 };
    let tasks = TaskList { list: Mutex::new(list), changed: Condvar::new() };
    run_on_workers(workers(), || {
        while let Some(task) = tasks.next() {
            let _end = RunningTask(&tasks);
            work(task, &tasks);
        }
    });
}

impl<T> TaskList<T> {
    /// Adds tasks at the end of the list.
    pub fn add(&self, more: impl IntoIterator<Item = T>) {
        self.lock().waiting.extend(more);
        self.changed.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, TaskQueue<T>> {
        lock(&self.list)
    }

    /// The next, waited for as long as there may be one.
    fn next(&self) -> Option<T> {
        let idle = |list: &mut TaskQueue<T>| list.waiting.is_empty() && list.under_way > 0;
        let mut list = self.changed.wait_while(self.lock(), idle).unwrap_or_else(PoisonError::into_inner);
        let task = list.waiting.pop_front()?;
        list.under_way += 1;
        Some(task)
    }
}

/// A task that is being done: it is over, too, where it panics, or the others would wait for ever.
struct RunningTask<'a, T>(&'a TaskList<T>);

impl<T> Drop for RunningTask<'_, T> {
    fn drop(&mut self) {
        self.0.lock().under_way -= 1;
        self.0.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::panic::catch_unwind;
    use std::thread::sleep;
    use std::time::Duration;

    #[test]
    fn tasks_include_added_work() {
        for alone in [false, true] {
            let done = Mutex::new(Vec::new());
            let halve = || {
                run_tasks([64_u32], |n, tasks| {
                    // An idle worker must not stop while another may add tasks.
                    sleep(Duration::from_millis(1));
                    done.lock().unwrap().push(n);
                    tasks.add((n > 1).then_some([n / 2, n / 2]).into_iter().flatten());
                });
            };
            if alone {
                crate::sequential(halve)
            } else {
                halve()
            }
            let mut done = done.into_inner().unwrap();
            done.sort_unstable();
            assert_eq!(done.len(), 127);
            assert_eq!(done.iter().sum::<u32>(), 7 * 64);
        }
        run_tasks([], |(): (), _| unreachable!());
    }

    #[test]
    fn a_panic_is_not_lost_and_nobody_waits_for_it() {
        assert!(catch_unwind(|| run_tasks([1, 2, 3, 4], |n, _| assert_ne!(n, 3))).is_err());
    }
}
