//! The most connections that a unit can have.

/// Maximum number of inputs or outputs of one unit.
pub const MAX_LINKS: usize = 8;
/// Maximum memory clients of one unit.
pub const MAX_CLIENTS: usize = 4;
