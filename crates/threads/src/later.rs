//! Values computed in the background.

use crate::{joined, spawned};
use std::fmt;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

/// A value computed on a background thread, or by `get()` if no thread is available. If it is dropped, the thread finishes and its result
/// is discarded.
pub struct Later<T> {
    work: Work<T>,
    thread: Option<JoinHandle<Option<T>>>,
}

/// The work, until a thread takes it.
type Work<T> = Arc<Mutex<Option<Box<dyn FnOnce() -> T + Send>>>>;

impl<T: Send + 'static> Later<T> {
    /// Starts to compute the value.
    pub fn start(work: impl FnOnce() -> T + Send + 'static) -> Self {
        let mut later = Self::on_demand(work);
        let work = Arc::clone(&later.work);
        later.thread = spawned(move || done(&work)).ok();
        later
    }

    /// Computes the value at the first `get()`.
    pub fn on_demand(work: impl FnOnce() -> T + Send + 'static) -> Self {
        Self { work: Arc::new(Mutex::new(Some(Box::new(work)))), thread: None }
    }

    /// Returns the value when it is available. If its thread has not started, this call computes it.
    pub fn get(self) -> T {
        let value = done(&self.work).or_else(|| self.thread.and_then(|thread| joined(thread.join())));
        value.expect("work is done once, by its thread or by who asks for it")
    }
}

impl<T> fmt::Debug for Later<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Later")
    }
}

fn done<T>(work: &Work<T>) -> Option<T> {
    let taken = work.lock().unwrap_or_else(PoisonError::into_inner).take();
    taken.map(|work| work())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_the_same_whoever_computes_it() {
        assert_eq!(Later::start(|| 7).get(), 7);
        assert_eq!(Later::on_demand(|| 7).get(), 7);
    }
}
