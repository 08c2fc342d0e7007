//! Values computed in the background.

use crate::{spawn, take, value_or_panic};
use std::fmt;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

/// A value computed on a background thread, or by `get()` if no thread is available. If it is dropped, the thread finishes and its result
/// is discarded.
pub struct Deferred<T> {
    work: SharedWork<T>,
    thread: Option<JoinHandle<Option<T>>>,
}

/// The work, until a thread takes it.
type SharedWork<T> = Arc<Mutex<Option<Box<dyn FnOnce() -> T + Send>>>>;

impl<T: Send + 'static> Deferred<T> {
    /// Starts to compute the value.
    pub fn start(work: impl FnOnce() -> T + Send + 'static) -> Self {
        let mut deferred = Self::on_demand(work);
        let work = Arc::clone(&deferred.work);
        deferred.thread = spawn(move || take_and_run(&work)).ok();
        deferred
    }

    /// Computes the value at the first `get()`.
    pub fn on_demand(work: impl FnOnce() -> T + Send + 'static) -> Self {
        Self { work: Arc::new(Mutex::new(Some(Box::new(work)))), thread: None }
    }

    /// Returns the value when it is available. If its thread has not started, this call computes it.
    pub fn get(self) -> T {
        let value = take_and_run(&self.work).or_else(|| self.thread.and_then(|thread| value_or_panic(thread.join())));
        value.expect("work is done once, by its thread or by who asks for it")
    }
}

impl<T> fmt::Debug for Deferred<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Deferred")
    }
}

fn take_and_run<T>(work: &SharedWork<T>) -> Option<T> {
    take(work).map(|work| work())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_the_same_whoever_computes_it() {
        assert_eq!(Deferred::start(|| 7).get(), 7);
        assert_eq!(Deferred::on_demand(|| 7).get(), 7);
    }
}
