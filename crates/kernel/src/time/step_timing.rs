//! Results of steps, and compile-time knowledge of stages.

/// What a step did, as far as time depends on it. What it asked of memories stands in [`StepRequestsView`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct StepTiming {
    /// Cycles the unit is kept, >= 1.
    pub(crate) occupancy: u64,
    /// Cycles from start to delivery.
    pub(crate) latency: u64,
    /// Outputs that got a token, one bit each.
    pub(crate) outputs: u32,
    /// Whether its delivery passes a mark.
    pub(crate) marked: bool,
}

/// What the compiler knows of a stage: how many FIFOs it has on its two sides, and whether it uses memory. A step is some dozens of
/// instructions, and takes two thirds more where it must ask for these.
pub(crate) trait StageArity {
    /// Inputs, where it is known how many.
    const INPUTS: Option<usize>;
    /// Outputs, where it is known how many.
    const OUTPUTS: Option<usize>;
    /// Whether it may have memory clients.
    const HAS_MEMORY: bool;
}

/// Nothing is known.
pub(crate) struct AnyArity;

impl StageArity for AnyArity {
    const INPUTS: Option<usize> = None;
    const OUTPUTS: Option<usize> = None;
    const HAS_MEMORY: bool = true;
}
