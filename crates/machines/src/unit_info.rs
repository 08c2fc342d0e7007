//! The boxes of a block diagram, in words.

/// A box of the block diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UnitInfo {
    /// Name in the report.
    pub name: &'static str,
    /// The patent's reference numeral; empty where the patent has no such box.
    pub numeral: &'static str,
    /// What it does.
    pub role: &'static str,
    /// Where its code is.
    pub code: &'static str,
}

/// A row of the table.
pub(crate) const fn unit(name: &'static str, numeral: &'static str, role: &'static str, code: &'static str) -> UnitInfo {
    UnitInfo { name, numeral, role, code }
}
