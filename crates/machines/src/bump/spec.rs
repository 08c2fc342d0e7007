//! The quantized bump-mapping processor as a [`MachineSpec`].

use super::{BumpProcessor, BumpProcessorConfig};
use crate::front::{FrontConfig, FrontEnd};
use crate::problem::ConfigProblem;
use crate::spec::{CostPoints, LoggingMachine, MachineSpec};
use basrelief_kernel::AreaModel;
use basrelief_kernel::stats::UnitStats;

impl MachineSpec for BumpProcessorConfig {
    const NAME: &'static str = super::NAME;
    const ABOUT: &'static str = "Sony's quantized bump-mapping processor";
    const DIAGRAM: &'static str = super::DIAGRAM;
    const DEMOS: &'static [&'static str] = &["golf-ball", "coin", "brick", "mixed", "sphere"];
    const COST_POINTS: CostPoints = CostPoints { drawn: "fragments", shown: &["tested_pixels", "pixels"] };
    type Machine = BumpProcessor;
    type Log = ();

    fn build(&self, front: FrontEnd) -> Result<BumpProcessor, ConfigProblem> {
        BumpProcessor::new(front, self)
    }

    fn front(&self) -> FrontConfig {
        self.into()
    }

    fn area_model(&self) -> AreaModel {
        AreaModel { area: self.area.clone(), operators: self.operators.clone(), hz: self.clock.hz }
    }

    fn warnings(&self, facts: &UnitStats) -> Vec<String> {
        super::warnings(self, facts)
    }
}

impl LoggingMachine<()> for BumpProcessor {}
