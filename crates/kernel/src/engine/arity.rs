//! Stages of a recording: their numbers of FIFOs are known when a run begins, but not at compile time.

use super::step_source::StepSource;
use super::timed::RunAhead;
use crate::Probe;
use crate::time::{AnyArity, MachineTiming, StageArity};

/// A number of inputs and outputs, with or without memory clients.
struct FixedArity<const I: usize, const O: usize, const MEMORY: bool>;

impl<const I: usize, const O: usize, const MEMORY: bool> StageArity for FixedArity<I, O, MEMORY> {
    const INPUTS: Option<usize> = Some(I);
    const OUTPUTS: Option<usize> = Some(O);
    const HAS_MEMORY: bool = MEMORY;
}

/// Advances a stage, with code specialized for common numbers of FIFOs. A step of unspecialized code takes two thirds longer.
pub(super) fn advance<P: Probe, W: StepSource>(walk: &mut RunAhead<'_, P>, number: usize, work: &mut W) {
    let stage = &walk.time.shape.stages[number];
    match ([stage.inputs.len(), stage.outputs.len()], !stage.clients.is_empty()) {
        ([0, 1], false) => walk.advance::<FixedArity<0, 1, false>, W>(number, work),
        ([1, 0], true) => walk.advance::<FixedArity<1, 0, true>, W>(number, work),
        ([1, 1], false) => walk.advance::<FixedArity<1, 1, false>, W>(number, work),
        ([1, 1], true) => walk.advance::<FixedArity<1, 1, true>, W>(number, work),
        ([1, 2], false) => walk.advance::<FixedArity<1, 2, false>, W>(number, work),
        ([2, 1], false) => walk.advance::<FixedArity<2, 1, false>, W>(number, work),
        ([2, 1], true) => walk.advance::<FixedArity<2, 1, true>, W>(number, work),
        ([2, 2], false) => walk.advance::<FixedArity<2, 2, false>, W>(number, work),
        ([2, 2], true) => walk.advance::<FixedArity<2, 2, true>, W>(number, work),
        ([3, 2], false) => walk.advance::<FixedArity<3, 2, false>, W>(number, work),
        _ => walk.advance::<AnyArity, W>(number, work),
    }
}

/// Advances stages without units, round by round, until no step can start.
///
/// `advance` advances a stage. `after_round` is called after each round, before the memories are served. `read_more` reads the next
/// steps once a stage needs them.
pub(super) fn run_stored_steps<P: Probe, W, E>(
    walk: &mut RunAhead<'_, P>,
    sources: &mut [W],
    advance: impl Fn(&mut RunAhead<'_, P>, usize, &mut W),
    mut after_round: impl FnMut(&mut RunAhead<'_, P>, &mut [W]) -> Result<(), E>,
    mut read_more: impl FnMut(&MachineTiming, &mut [W]) -> Result<(), E>,
) -> Result<(), E> {
    loop {
        walk.begin();
        for (number, source) in sources.iter_mut().enumerate() {
            advance(walk, number, source);
        }
        after_round(walk, sources)?;
        if walk.goes_on() {
            continue;
        }
        if !walk.round.needs_more_steps {
            return Ok(());
        }
        read_more(walk.time, sources)?;
    }
}
