//! The figure shading device as a [`MachineSpec`].

use super::spec::{Logs, MachineSpec, ShortCut};
use crate::costs::CostPoints;
use basrelief_machines::shade::{self, FigureShadingDevice, ShadeConfig};
use basrelief_machines::{ConfigProblem, FrontConfig, FrontEnd, UnitStats};
use basrelief_reference::{Components, Options, Shading, Style, TextureFilter};

impl MachineSpec for ShadeConfig {
    const NAME: &'static str = shade::NAME;
    const ABOUT: &'static str = "Hitachi's figure shading device";
    const DIAGRAM: &'static str = shade::DIAGRAM;
    const DEMOS: &'static [&'static str] = &["ellipsoid", "cut-plane", "goblet"];
    const SHORT_CUTS: &'static [ShortCut<Self>] = &[
        ("specular-negligible", |c| c.shortcut.specular_negligible.enabled = false),
        ("flatness", |c| c.shortcut.flatness.enabled = false),
        ("same-plane", |c| c.shortcut.same_plane.enabled = false),
    ];
    const COST_POINTS: CostPoints = CostPoints { drawn: "pixels", shown: &["tested_pixels", "pixels"] };
    type Machine<F: FrontEnd> = FigureShadingDevice<F>;
    type Log = ();

    fn build<F: FrontEnd>(&self, front: F) -> Result<FigureShadingDevice<F>, ConfigProblem> {
        FigureShadingDevice::new(front, self)
    }

    fn front(&self) -> FrontConfig {
        self.into()
    }

    /// Phong, whatever the mode: the price of every mode and short cut is told in the same money. The device has no
    /// textures, and a highlight of the light's colour.
    fn exact_style(&self) -> Style {
        let options = Options {
            filter: TextureFilter::None,
            components: Components::Separate,
            two_sided_lighting: self.geometry.two_sided_lighting,
            ..Options::default()
        };
        Style { shading: Shading::Phong, options }
    }

    fn warnings(&self, facts: &UnitStats) -> Vec<String> {
        shade::warnings(facts)
    }
}

impl<F: FrontEnd> Logs<()> for FigureShadingDevice<F> {}
