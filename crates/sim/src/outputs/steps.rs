//! Steps of a run as a list.

use crate::analysis::attribution::{AttributionProbe, TokenSample};
use crate::observer::NoObserver;
use crate::options::{RunInput, RunOptions};
use crate::run::result::RunError;
use crate::run::{run, timeline_layout};
use basrelief_timeline::{StepList, TimelineStep};
use std::num::NonZeroU64;
use std::ops::Range;

/// Every token has its pixels.
const ALL: TokenSample = TokenSample { every: NonZeroU64::MIN, polygons: false };

/// Runs an input and lists the steps and waits of all units in these cycles, each with its arguments. The steps of a unit are in order
/// of time. The list takes about 100 bytes per cycle and unit.
///
/// # Errors
/// See [`RunError`].
pub fn list_steps(input: RunInput, options: &RunOptions, cycles: Range<u64>) -> Result<Vec<TimelineStep>, RunError> {
    let mut layout = timeline_layout(&input, options)?;
    (layout.from, layout.to) = (cycles.start, cycles.end);
    let stages = layout.diagram.stages.clone();
    let mut list = StepList::new(layout);
    let mut probe = AttributionProbe::new(&options.config, &stages, Some(ALL), &options.budget, &mut list);
    run(input, options, &mut NoObserver, Some(&mut probe))?;
    probe.finish()?;
    Ok(list.finish())
}
