//! The texture mapping system as a [`MachineSpec`].

use super::{TexelMachineConfig, TextureMappingSystem};
use crate::front::{FrontConfig, FrontEnd};
use crate::methods::{MethodNumber, MethodSpec, MethodSpecs};
use crate::problem::ConfigProblem;
use crate::spec::{CostPoints, LoggingMachine, MachineSpec};
use basrelief_frame_buffer::FinishedFrame;
use basrelief_kernel::AreaModel;
use basrelief_kernel::stats::UnitStats;
use basrelief_texel_value_generator::{Division, FrameLog, Method};

/// Log of a frame.
#[derive(Debug)]
pub struct TexelLog {
    /// Spans and displacements.
    pub frame: FrameLog,
    /// The finished picture.
    pub picture: FinishedFrame,
}

impl MachineSpec for TexelMachineConfig {
    const NAME: &'static str = super::NAME;
    const ABOUT: &'static str = "Sun's texture mapping system with its texel value generator";
    const DIAGRAM: &'static str = super::DIAGRAM;
    const DEMOS: &'static [&'static str] = &["corridor", "turntable"];
    const METHODS: Option<MethodSpecs<Self>> =
        Some(MethodSpecs { bound: |c| c.texel.error_bound, error: "displacement_largest", methods: &METHODS });
    const COST_POINTS: CostPoints = CostPoints { drawn: "texels", shown: &["pixels"] };
    type Machine = TextureMappingSystem;
    type Log = TexelLog;

    fn build(&self, front: FrontEnd) -> Result<TextureMappingSystem, ConfigProblem> {
        TextureMappingSystem::new(front, self)
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

/// Methods that choose division points. Fixed methods divide as rarely as the error bound allows.
const METHODS: [MethodSpec<TexelMachineConfig>; 6] = [
    MethodSpec {
        name: |_| "adaptive".into(),
        settings: |_| vec!["texel.method=adaptive".into()],
        set: |c, _| c.texel.method = Method::Adaptive,
        number: MethodNumber::Absent,
    },
    MethodSpec {
        name: |n| if n == 1 { "fixed, every pixel".into() } else { format!("fixed, every {n} pixels") },
        settings: |n| vec!["texel.method=fixed".into(), "texel.points=0".into(), format!("texel.interval={n}")],
        set: |c, n| (c.texel.method, c.texel.points, c.texel.interval) = (Method::Fixed, 0, n),
        number: MethodNumber::Largest,
    },
    MethodSpec {
        name: |n| format!("fixed, {n} point{} per line", if n == 1 { "" } else { "s" }),
        settings: |n| vec!["texel.method=fixed".into(), format!("texel.points={n}")],
        set: |c, n| (c.texel.method, c.texel.points) = (Method::Fixed, n),
        number: MethodNumber::Smallest,
    },
    MethodSpec {
        name: |n| format!("subpolygons of {n} pixels"),
        settings: |n| vec!["texel.method=subpolygon".into(), format!("texel.interval={n}")],
        set: |c, n| (c.texel.method, c.texel.interval) = (Method::Subpolygon, n),
        number: MethodNumber::Largest,
    },
    MethodSpec {
        name: |_| "exact".into(),
        settings: |_| vec!["texel.method=exact".into(), "divider.division=two".into()],
        set: |c, _| (c.texel.method, c.divider.division) = (Method::Exact, Division::Two),
        number: MethodNumber::Absent,
    },
    MethodSpec {
        name: |_| "exact by one reciprocal".into(),
        settings: |_| vec!["texel.method=exact".into(), "divider.division=reciprocal".into()],
        set: |c, _| (c.texel.method, c.divider.division) = (Method::Exact, Division::Reciprocal),
        number: MethodNumber::Absent,
    },
];

impl LoggingMachine<TexelLog> for TextureMappingSystem {
    fn keep_log(&mut self) {
        self.keep_log();
    }

    fn drain_log(&mut self, finished: &[FinishedFrame]) -> Vec<(u32, TexelLog)> {
        let logs = self.drain_logs(finished.len()).into_iter().zip(finished);
        logs.map(|(frame, of)| (of.index, TexelLog { frame, picture: of.clone() })).collect()
    }
}
