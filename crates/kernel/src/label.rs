//! What tokens are about, for who asks. The kernel hands it on and does not look into it.

/// What a token says that it is about. Its meaning is between the machine, which labels its FIFOs, and the probe that reads it; all
/// zeros where nobody has said.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Label(pub [u64; 3]);
