//! Values that a unit caches for speed and that are not part of its state.

use std::ops::{Deref, DerefMut};

/// A cached value that follows from the rest of a unit's state: computed if missing, and kept until the state changes.
///
/// It is a field of the state, so code that replaces or resets the state need not know of it. It holds no information beyond the other
/// fields. So two of them always compare equal, a clone is empty, and the field is marked `#[serde(skip)]`.
///
/// ```
/// use basrelief_kernel::Cached;
///
/// #[derive(Default)]
/// struct State {
///     side: u32,
///     area: Cached<u32>,
/// }
///
/// let mut state = State { side: 3, ..State::default() };
/// assert_eq!(*state.area.get_or_insert_with(|| state.side * state.side), 9);
/// state = State { side: 4, ..State::default() };
/// assert!(state.area.is_none(), "with another state comes another area");
/// ```
#[derive(Debug)]
pub struct Cached<T>(Option<T>);

impl<T> Default for Cached<T> {
    fn default() -> Self {
        Self(None)
    }
}

impl<T> Clone for Cached<T> {
    fn clone(&self) -> Self {
        Self(None)
    }
}

impl<T> PartialEq for Cached<T> {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl<T> Deref for Cached<T> {
    type Target = Option<T>;

    #[inline]
    fn deref(&self) -> &Option<T> {
        &self.0
    }
}

impl<T> DerefMut for Cached<T> {
    #[inline]
    fn deref_mut(&mut self) -> &mut Option<T> {
        &mut self.0
    }
}
