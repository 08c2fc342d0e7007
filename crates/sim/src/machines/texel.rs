//! The texture mapping system as a [`MachineSpec`].

use super::spec::{Logs, MachineSpec};
use crate::costs::CostPoints;
use crate::drive::picture;
use crate::exhibits::spec::ExhibitSpec;
use crate::exhibits::texel::{EXHIBITS, TexelLog};
use crate::methods::{MethodSpec, MethodSpecs, Number};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_machines::texel::{self, TexelMachineConfig, TextureMappingSystem};
use basrelief_machines::{ConfigProblem, FrontConfig, FrontEnd, UnitStats};
use basrelief_reference::{LevelRule, Options, Shading, Style, TextureFilter};
use basrelief_signals::TexelFilter;
use basrelief_texel_value_generator::{Division, IlluminanceMode, Method, MipMode};

impl MachineSpec for TexelMachineConfig {
    const NAME: &'static str = texel::NAME;
    const ABOUT: &'static str = "Sun's texture mapping system with its texel value generator";
    const DIAGRAM: &'static str = texel::DIAGRAM;
    const DEMOS: &'static [&'static str] = &["corridor", "turntable"];
    const EXHIBITS: &'static [ExhibitSpec<Self, Self::Log>] = EXHIBITS;
    const METHODS: Option<MethodSpecs<Self>> =
        Some(MethodSpecs { bound: |c| c.texel.error_bound, error: "displacement_largest", methods: &METHODS });
    const COST_POINTS: CostPoints = CostPoints { drawn: "texels", shown: &["pixels"] };
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
            (MipMode::Off, TexelFilter::Nearest) => TextureFilter::Nearest,
            (MipMode::Off, TexelFilter::Bilinear) => TextureFilter::Bilinear,
            (MipMode::Nearest, TexelFilter::Nearest) => TextureFilter::NearestMipNearest,
            (MipMode::Nearest, TexelFilter::Bilinear) => TextureFilter::BilinearMipNearest,
            (MipMode::Trilinear, TexelFilter::Nearest) => TextureFilter::NearestMipLinear,
            (MipMode::Trilinear, TexelFilter::Bilinear) => TextureFilter::Trilinear,
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

    fn warnings(&self, facts: &UnitStats) -> Vec<String> {
        texel::warnings(facts)
    }
}

/// The ways to choose division points. Those at fixed places divide as seldom as the bound allows.
const METHODS: [MethodSpec<TexelMachineConfig>; 6] = [
    MethodSpec {
        name: |_| "adaptive".into(),
        settings: |_| vec!["texel.method=adaptive".into()],
        set: |c, _| c.texel.method = Method::Adaptive,
        number: Number::Absent,
    },
    MethodSpec {
        name: |n| if n == 1 { "fixed, every pixel".into() } else { format!("fixed, every {n} pixels") },
        settings: |n| vec!["texel.method=fixed".into(), "texel.points=0".into(), format!("texel.interval={n}")],
        set: |c, n| (c.texel.method, c.texel.points, c.texel.interval) = (Method::Fixed, 0, n),
        number: Number::Largest,
    },
    MethodSpec {
        name: |n| format!("fixed, {n} point{} per line", if n == 1 { "" } else { "s" }),
        settings: |n| vec!["texel.method=fixed".into(), format!("texel.points={n}")],
        set: |c, n| (c.texel.method, c.texel.points) = (Method::Fixed, n),
        number: Number::Smallest,
    },
    MethodSpec {
        name: |n| format!("subpolygons of {n} pixels"),
        settings: |n| vec!["texel.method=subpolygon".into(), format!("texel.interval={n}")],
        set: |c, n| (c.texel.method, c.texel.interval) = (Method::Subpolygon, n),
        number: Number::Largest,
    },
    MethodSpec {
        name: |_| "exact".into(),
        settings: |_| vec!["texel.method=exact".into(), "divider.division=two".into()],
        set: |c, _| (c.texel.method, c.divider.division) = (Method::Exact, Division::Two),
        number: Number::Absent,
    },
    MethodSpec {
        name: |_| "exact by one reciprocal".into(),
        settings: |_| vec!["texel.method=exact".into(), "divider.division=reciprocal".into()],
        set: |c, _| (c.texel.method, c.divider.division) = (Method::Exact, Division::Reciprocal),
        number: Number::Absent,
    },
];

impl<F: FrontEnd> Logs<TexelLog> for TextureMappingSystem<F> {
    fn keep_log(&mut self) {
        self.keep_log();
    }

    fn drain_log(&mut self, finished: &[FinishedFrame]) -> Vec<(u32, TexelLog)> {
        let logs = self.drain_logs(finished.len()).into_iter().zip(finished);
        logs.map(|(frame, of)| (of.index, TexelLog { frame, picture: picture(of.clone()) })).collect()
    }
}
