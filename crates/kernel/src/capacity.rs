//! The most connections that a unit can have.

/// Most inputs or outputs of one unit.
pub const MAX_LINKS: usize = 8;
/// Most memory clients of one unit.
pub const MAX_CLIENTS: usize = 4;
