//! One budget for everything that a file can make this program hold.

use std::cell::Cell;
use std::rc::Rc;

/// Bytes that an input may make this program hold, all its parts together. Whoever is about to allocate for an input asks
/// first. Clones share what is left.
#[derive(Clone, Debug)]
pub struct Budget {
    limit: u64,
    left: Rc<Cell<u64>>,
}

/// Something would need more than is left.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{what} needs {needed} bytes, and {left} are left of the {limit} bytes that an input may take; \
     use less of it, or raise --memory-limit"
)]
pub struct OverBudget {
    /// What was to be held.
    pub what: String,
    /// Bytes that it needs.
    pub needed: u64,
    /// Bytes that are left.
    pub left: u64,
    /// Bytes of the whole budget.
    pub limit: u64,
}

impl Budget {
    /// Where the user names no limit: 1 GiB.
    pub const DEFAULT_LIMIT: u64 = 1 << 30;

    /// A budget of so many bytes.
    pub fn new(limit: u64) -> Self {
        Self { limit, left: Rc::new(Cell::new(limit)) }
    }

    /// Bytes of which nothing is taken yet.
    pub fn left(&self) -> u64 {
        self.left.get()
    }

    /// Takes bytes that are about to be allocated for `what`.
    ///
    /// # Errors
    /// If they are not left; then none are taken.
    pub fn take(&self, needed: u64, what: impl FnOnce() -> String) -> Result<(), OverBudget> {
        let left = self.left.get();
        match left.checked_sub(needed) {
            Some(rest) => {
                self.left.set(rest);
                Ok(())
            }
            None => Err(OverBudget { what: what(), needed, left, limit: self.limit }),
        }
    }

    /// Gives back bytes that were freed.
    pub fn give_back(&self, bytes: u64) {
        self.left.set(self.left.get().saturating_add(bytes).min(self.limit));
    }
}

impl Default for Budget {
    fn default() -> Self {
        Self::new(Self::DEFAULT_LIMIT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_left_is_not_taken() {
        let budget = Budget::new(100);
        let same = budget.clone();
        budget.take(60, || "a".into()).unwrap();
        let error = same.take(50, || "texture `b`".into()).unwrap_err().to_string();
        assert!(error.starts_with("texture `b` needs 50 bytes, and 40 are left of the 100 bytes"), "{error}");
        assert!(error.contains("--memory-limit"), "{error}");
        assert_eq!(same.left(), 40);
        same.give_back(30);
        assert_eq!(budget.left(), 70);
        same.give_back(1000);
        assert_eq!(budget.left(), 100, "never more than the limit");
    }
}
