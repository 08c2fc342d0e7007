//! Control tokens that arrive on two inputs and leave as one.

use basrelief_kernel::MemoryPorts;
use basrelief_signals::{Control, Flow};

/// Tokens of two inputs, paired.
pub(crate) enum PairedInput<A, B> {
    /// The same control token on both inputs.
    Control(Control),
    /// One item from each input.
    Items(A, B),
    /// No input, or a mismatch, which ends the run with a message.
    Nothing,
}

/// Pairs the tokens of two inputs that carry the same control tokens and equal numbers of items between them.
#[inline(always)]
pub(crate) fn pair<A, B>(unit: &str, inputs: (Option<Flow<A>>, Option<Flow<B>>), traffic: &mut MemoryPorts) -> PairedInput<A, B> {
    match inputs {
        (Some(Flow::Item(a)), Some(Flow::Item(b))) => PairedInput::Items(a, b),
        (Some(Flow::Control(a)), Some(Flow::Control(b))) if std::mem::discriminant(&a) == std::mem::discriminant(&b) => {
            PairedInput::Control(a)
        }
        (None, None) => PairedInput::Nothing,
        _ => {
            traffic.fault(format!("{unit}: its two inputs carry tokens that do not belong together; report this as a defect"));
            PairedInput::Nothing
        }
    }
}
