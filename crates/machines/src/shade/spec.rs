//! The figure shading device as a [`MachineSpec`].

use super::{FigureShadingDevice, ShadeConfig};
use crate::front::{FrontConfig, FrontEnd};
use crate::problem::ConfigProblem;
use crate::spec::{CostPoints, LoggingMachine, MachineSpec, Shortcut};
use basrelief_kernel::AreaModel;
use basrelief_kernel::stats::UnitStats;

impl MachineSpec for ShadeConfig {
    const NAME: &'static str = super::NAME;
    const ABOUT: &'static str = "Hitachi's figure shading device";
    const DIAGRAM: &'static str = super::DIAGRAM;
    const DEMOS: &'static [&'static str] = &["ellipsoid", "cut-plane", "goblet"];
    const SHORTCUTS: &'static [Shortcut<Self>] = &[
        ("specular-negligible", |c| c.shortcut.specular_negligible.enabled = false),
        ("flatness", |c| c.shortcut.flatness.enabled = false),
        ("same-plane", |c| c.shortcut.same_plane.enabled = false),
    ];
    const COST_POINTS: CostPoints = CostPoints { drawn: "pixels", shown: &["tested_pixels", "pixels"] };
    type Machine = FigureShadingDevice;
    type Log = ();

    fn build(&self, front: FrontEnd) -> Result<FigureShadingDevice, ConfigProblem> {
        FigureShadingDevice::new(front, self)
    }

    fn front(&self) -> FrontConfig {
        self.into()
    }

    fn area_model(&self) -> AreaModel {
        AreaModel { area: self.area.clone(), operators: self.operators.clone(), hz: self.clock.hz }
    }

    fn warnings(&self, facts: &UnitStats) -> Vec<String> {
        super::warnings(facts)
    }
}

impl LoggingMachine<()> for FigureShadingDevice {}
