//! Additions to the machines that only a simulation needs: exact rendering style and auxiliary outputs.

use crate::outputs::aux_output::AuxOutputInfo;
use crate::outputs::aux_spec::AuxOutputSpec;
use crate::outputs::{defer, texel};
use basrelief_brightness::Components;
use basrelief_deferred_renderer::{LightingMode, TexelCentre};
use basrelief_machines::bump::BumpProcessorConfig;
use basrelief_machines::defer::DeferConfig;
use basrelief_machines::shade::ShadeConfig;
use basrelief_machines::texel::TexelMachineConfig;
use basrelief_machines::{MachineInfo, MachineSpec, ReferenceFilter, for_machine};
use basrelief_reference::{self as reference, LevelRule, PyramidLevels, RenderOptions, RenderStyle, ShadingModel, TextureFilter};
use basrelief_signals::TexelFilter;
use basrelief_texel_value_generator::{IlluminanceMode, MipMode};

/// A machine that can be compared with a reference image.
pub(crate) trait SimulatedMachine: MachineSpec {
    /// Auxiliary outputs of the machine.
    const AUX_OUTPUTS: &'static [AuxOutputSpec<Self, Self::Log>] = &[];

    /// Returns the style of the reference image.
    fn exact_style(&self) -> RenderStyle;
}

/// Returns the auxiliary outputs of a machine.
pub fn aux_outputs(machine: &MachineInfo) -> Vec<AuxOutputInfo> {
    fn of<S: SimulatedMachine>(_: &S) -> Vec<AuxOutputInfo> {
        S::AUX_OUTPUTS.iter().map(|output| output.info).collect()
    }
    for_machine!(&machine.default_config(), spec => of(spec))
}

impl SimulatedMachine for BumpProcessorConfig {
    fn exact_style(&self) -> RenderStyle {
        let options = RenderOptions {
            filter: match self.reference.filter {
                ReferenceFilter::Nearest => TextureFilter::Nearest,
                ReferenceFilter::Bilinear => TextureFilter::Bilinear,
                ReferenceFilter::Trilinear => TextureFilter::Trilinear,
            },
            components: match self.brightness.components {
                Components::Combined => reference::BrightnessComponents::Combined,
                Components::Separate => reference::BrightnessComponents::Separate,
            },
            two_sided_lighting: self.geometry.two_sided_lighting,
            ..RenderOptions::default()
        };
        options.into()
    }
}

impl SimulatedMachine for ShadeConfig {
    /// Phong shading in every mode, so that the errors of all modes and shortcuts are comparable. The device has no textures, and its
    /// highlights have the colour of the light.
    fn exact_style(&self) -> RenderStyle {
        let options = RenderOptions {
            filter: TextureFilter::None,
            components: reference::BrightnessComponents::Separate,
            two_sided_lighting: self.geometry.two_sided_lighting,
            ..RenderOptions::default()
        };
        RenderStyle { shading: ShadingModel::Phong, options }
    }
}

impl SimulatedMachine for TexelMachineConfig {
    const AUX_OUTPUTS: &'static [AuxOutputSpec<Self, Self::Log>] = texel::AUX_OUTPUTS;

    /// Exact mapping with the machine's own filter, so that the difference is the error of the division points.
    fn exact_style(&self) -> RenderStyle {
        let filter = match (self.mip.mode, self.look_up.filter) {
            (MipMode::Off, TexelFilter::Nearest) => TextureFilter::Nearest,
            (MipMode::Off, TexelFilter::Bilinear) => TextureFilter::Bilinear,
            (MipMode::Nearest, TexelFilter::Nearest) => TextureFilter::NearestMipNearest,
            (MipMode::Nearest, TexelFilter::Bilinear) => TextureFilter::BilinearMipNearest,
            (MipMode::Trilinear, TexelFilter::Nearest) => TextureFilter::NearestMipLinear,
            (MipMode::Trilinear, TexelFilter::Bilinear) => TextureFilter::Trilinear,
        };
        let options = RenderOptions {
            filter,
            level: LevelRule::AlongScanLine,
            two_sided_lighting: self.geometry.two_sided_lighting,
            ..RenderOptions::default()
        };
        let shading = match self.illuminance.mode {
            IlluminanceMode::Off => ShadingModel::Texture,
            IlluminanceMode::Gouraud => ShadingModel::Gouraud,
        };
        RenderStyle { shading, options }
    }
}

impl SimulatedMachine for DeferConfig {
    const AUX_OUTPUTS: &'static [AuxOutputSpec<Self, Self::Log>] = defer::AUX_OUTPUTS;

    /// Trilinear interpolation in the device's own pyramid, with the wrap modes of the textures.
    fn exact_style(&self) -> RenderStyle {
        let centre = match self.defer.texel_centre {
            TexelCentre::Half => reference::TexelCentre::Half,
            TexelCentre::Integer => reference::TexelCentre::Integer,
        };
        let options = RenderOptions {
            filter: TextureFilter::Trilinear,
            pyramid: PyramidLevels::Tiled { tile: self.tile.format().size, centre },
            two_sided_lighting: self.geometry.two_sided_lighting,
            ..RenderOptions::default()
        };
        let shading = if self.defer.lighting == LightingMode::Gouraud { ShadingModel::Gouraud } else { ShadingModel::Texture };
        RenderStyle { shading, options }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outputs::aux_output::AuxForm;
    use basrelief_machines::MACHINES;

    /// Lines are selected by name alone, and the name of a picture is the name of its file.
    #[test]
    fn aux_output_names_are_unique() {
        let all: Vec<_> = MACHINES.iter().flat_map(aux_outputs).collect();
        let is_lines = |output: &AuxOutputInfo| output.form == AuxForm::Lines;
        for (n, one) in all.iter().enumerate() {
            let same = |other: &&AuxOutputInfo| other.name == one.name && is_lines(other) == is_lines(one);
            assert_eq!(all[n..].iter().filter(same).count(), 1, "{}", one.name);
        }
    }
}
