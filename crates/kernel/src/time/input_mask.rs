//! Input masks of steps.

use crate::Demand;
use crate::capacity::MAX_LINKS;

/// The inputs of a step, one bit each, or the absence of a further step. It is a [`Demand`] in the form that timing needs: it is
/// read in every step, for each FIFO.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct InputMask(u16);

impl InputMask {
    /// There will be no further step.
    pub(crate) const NO_STEP: Self = Self(1 << MAX_LINKS);

    /// Converts the demand of a stage with this number of inputs.
    #[inline(always)]
    pub(crate) fn of(demand: Demand, inputs: usize) -> Self {
        if demand == Demand::Finished { Self::NO_STEP } else { Self(demand.of(inputs) as u16) }
    }

    /// The inputs, one bit each.
    #[inline(always)]
    pub(crate) fn inputs(self) -> u32 {
        u32::from(self.0) & Self::INPUTS
    }

    /// Converts back to a demand.
    pub(crate) fn demand(self) -> Demand {
        let inputs = self.inputs();
        match inputs.count_ones() {
            _ if self == Self::NO_STEP => Demand::Finished,
            0 => Demand::Nothing,
            1 => Demand::Only(inputs.trailing_zeros() as usize),
            _ => Demand::All,
        }
    }

    const INPUTS: u32 = (1 << MAX_LINKS) - 1;
}
