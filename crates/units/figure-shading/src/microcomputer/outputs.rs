//! Outputs of the microcomputer (10).

use crate::{FigureFlow, NormalLoad, RegisterOrder};
use basrelief_kernel::Step;
use std::sync::Arc;

/// One optional token per output.
pub(super) type CpuOutputs = (Option<RegisterOrder>, Option<Arc<NormalLoad>>, Option<FigureFlow>, Option<FigureFlow>);
/// Step of the microcomputer.
pub(super) type Out = Step<CpuOutputs>;

/// Returns a step without output.
pub(super) fn nothing(cycles: u64) -> Out {
    Step::after(cycles, (None, None, None, None)).busy(cycles.max(1))
}
