//! The texture mapping system as a [`MachineSpec`].

use super::spec::{Logs, MachineSpec};
use crate::drive::picture;
use crate::exhibits::spec::ExhibitSpec;
use crate::exhibits::texel::{EXHIBITS, TexelLog};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_machines::texel::{self, TexelMachineConfig, TextureMappingSystem};
use basrelief_machines::{ConfigProblem, Facts, FrontConfig, FrontEnd};
use basrelief_reference::{LevelRule, Options, Shading, Style, TextureFilter};
use basrelief_signals::Filter;
use basrelief_texel_value_generator::{IlluminanceMode, MipMode};

impl MachineSpec for TexelMachineConfig {
    const NAME: &'static str = texel::NAME;
    const ABOUT: &'static str = "Sun's texture mapping system with its texel value generator";
    const DIAGRAM: &'static str = texel::DIAGRAM;
    const DEMOS: &'static [&'static str] = &["corridor", "turntable"];
    const EXHIBITS: &'static [ExhibitSpec<Self, Self::Log>] = EXHIBITS;
    type Machine<F: FrontEnd> = TextureMappingSystem<F>;
    type Log = TexelLog;

    fn build<F: FrontEnd>(&self, front: F) -> Result<TextureMappingSystem<F>, ConfigProblem> {
        TextureMappingSystem::new(front, self)
    }

    fn front(&self) -> FrontConfig {
        self.into()
    }

    /// Exact mapping, by the filter that the machine has: what is lost then is lost by division points.
    fn exact_style(&self) -> Style {
        let filter = match (self.mip.mode, self.look_up.filter) {
            (MipMode::Off, Filter::Nearest) => TextureFilter::Nearest,
            (MipMode::Off, Filter::Bilinear) => TextureFilter::Bilinear,
            (MipMode::Nearest, Filter::Nearest) => TextureFilter::NearestMipNearest,
            (MipMode::Nearest, Filter::Bilinear) => TextureFilter::BilinearMipNearest,
            (MipMode::Trilinear, Filter::Nearest) => TextureFilter::NearestMipLinear,
            (MipMode::Trilinear, Filter::Bilinear) => TextureFilter::Trilinear,
        };
        let options = Options {
            filter,
            level: LevelRule::AlongScanLine,
            two_sided_lighting: self.geometry.two_sided_lighting,
            ..Options::default()
        };
        let shading = match self.illuminance.mode {
            IlluminanceMode::Off => Shading::Texture,
            IlluminanceMode::Gouraud => Shading::Gouraud,
        };
        Style { shading, options }
    }

    fn warnings(&self, facts: &Facts) -> Vec<String> {
        texel::warnings(facts)
    }
}

impl<F: FrontEnd> Logs<TexelLog> for TextureMappingSystem<F> {
    fn keep_log(&mut self) {
        self.keep_log();
    }

    fn drain_log(&mut self, finished: &[FinishedFrame]) -> Vec<(u32, TexelLog)> {
        let logs = self.drain_logs(finished.len()).into_iter().zip(finished);
        logs.map(|(frame, of)| (of.index, TexelLog { frame, picture: picture(of.clone()) })).collect()
    }
}
