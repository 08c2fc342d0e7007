//! What a unit keeps beside its state only to be fast.

use std::ops::{Deref, DerefMut};

/// What follows from the rest of a unit's state: worked out when it is missing, and kept until that changes.
///
/// It is a field of the state, so that whoever puts a state in or resets it by assignment need not think of it; but it says
/// nothing that the other fields do not say. So two are always equal, a copy has none, and it is not written: its field is
/// marked `#[serde(skip)]`.
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
