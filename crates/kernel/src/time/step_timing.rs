//! Results of steps, and compile-time knowledge of stages.

/// The part of a step's result on which timing depends. Its memory requests are in
/// [`StepRequestsView`](crate::step_requests::StepRequestsView).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct StepTiming {
    /// Cycles for which the step occupies the unit, >= 1.
    pub(crate) occupancy: u64,
    /// Cycles from start to delivery.
    pub(crate) latency: u64,
    /// Cycles from the last memory answer to delivery, at least.
    pub(crate) after_data: u32,
    /// Outputs that got a token, one bit each.
    pub(crate) outputs: u32,
    /// True if its delivery passes a mark.
    pub(crate) marked: bool,
    /// True if it keeps its unit until its last memory answer.
    pub(crate) blocking: bool,
}

/// Compile-time knowledge of a stage: its numbers of FIFOs, and whether it uses memory. A step takes some dozens of instructions,
/// and two thirds more without this knowledge.
pub(crate) trait StageArity {
    /// Number of inputs, if known.
    const INPUTS: Option<usize>;
    /// Number of outputs, if known.
    const OUTPUTS: Option<usize>;
    /// True if it may have memory clients.
    const HAS_MEMORY: bool;
}

/// No knowledge.
pub(crate) struct AnyArity;

impl StageArity for AnyArity {
    const INPUTS: Option<usize> = None;
    const OUTPUTS: Option<usize> = None;
    const HAS_MEMORY: bool = true;
}
