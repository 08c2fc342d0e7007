//! The quantized bump-mapping processor as a [`MachineSpec`].

use super::spec::{Logs, MachineSpec};
use crate::costs::CostPoints;
use basrelief_brightness::Components;
use basrelief_machines::bump::{self, BumpProcessor, BumpProcessorConfig};
use basrelief_machines::{ConfigProblem, FrontConfig, FrontEnd, ReferenceFilter, UnitStats};
use basrelief_reference::{self as reference, Options, Style, TextureFilter};

impl MachineSpec for BumpProcessorConfig {
    const NAME: &'static str = bump::NAME;
    const ABOUT: &'static str = "Sony's quantized bump-mapping processor";
    const DIAGRAM: &'static str = bump::DIAGRAM;
    const DEMOS: &'static [&'static str] = &["golf-ball", "coin", "brick", "mixed", "sphere"];
    const COST_POINTS: CostPoints = CostPoints { drawn: "fragments", shown: &["tested_pixels", "pixels"] };
    type Machine<F: FrontEnd> = BumpProcessor<F>;
    type Log = ();

    fn build<F: FrontEnd>(&self, front: F) -> Result<BumpProcessor<F>, ConfigProblem> {
        BumpProcessor::new(front, self)
    }

    fn front(&self) -> FrontConfig {
        self.into()
    }

    fn exact_style(&self) -> Style {
        let options = Options {
            filter: match self.reference.filter {
                ReferenceFilter::Nearest => TextureFilter::Nearest,
                ReferenceFilter::Bilinear => TextureFilter::Bilinear,
                ReferenceFilter::Trilinear => TextureFilter::Trilinear,
            },
            components: match self.brightness.components {
                Components::Combined => reference::Components::Combined,
                Components::Separate => reference::Components::Separate,
            },
            two_sided_lighting: self.geometry.two_sided_lighting,
            ..Options::default()
        };
        options.into()
    }

    fn warnings(&self, facts: &UnitStats) -> Vec<String> {
        bump::warnings(self, facts)
    }
}

impl<F: FrontEnd> Logs<()> for BumpProcessor<F> {}
