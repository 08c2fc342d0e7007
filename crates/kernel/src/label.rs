//! Labels of tokens, for probes. The kernel passes them on and does not read them.

/// Label of a token. Its meaning is an agreement between the machine, which labels its FIFOs, and the probe that reads it. All
/// zeros: no label.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Label(pub [u64; 3]);
