//! State of the microcomputer (10) between steps.

use super::StoredPlane;
use super::limits::SpecularLimits;
use super::operand_access::OperandAccess;
use crate::dots::DotScan;
use crate::{ObjectIllumination, PolygonFigure, ShadingRegisters};
use basrelief_shading::RasterGrid;
use basrelief_signals::{Frame, ObjectInfo, Polygon, ShadingMode};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Processes of the CPU (11), with the patent's numerals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CpuProcess {
    /// 13: mode decision, and L and H.
    Mode,
    /// 15: flatness decision.
    Flatness,
    /// 17: specular-negligible decision.
    Specular,
    /// 20: load and start of circuit (50).
    Start,
    /// 22: brightness at the sample points.
    Brightness,
    /// 23: transfer to circuit (21).
    Transfer,
    /// 24: mean and its output.
    Mean,
    /// Steps 92, 94 and 95 of Figure 7.
    SamePlane,
}

impl CpuProcess {
    /// All processes in the order of their numbers, with their names in the report.
    pub const ALL: [(Self, &'static str); 8] = [
        (Self::Mode, "process_13"),
        (Self::Flatness, "process_15"),
        (Self::Specular, "process_17"),
        (Self::Start, "process_20"),
        (Self::Brightness, "process_22"),
        (Self::Transfer, "process_23"),
        (Self::Mean, "process_24"),
        (Self::SamePlane, "process_24_memory"),
    ];
}

/// Runs of a process, and their CPU cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProcessCounters {
    /// Runs.
    pub runs: u64,
    /// Cycles.
    pub cycles: u64,
}

/// A polygon that is decided but not yet shaded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct DecidedPolygon {
    pub(crate) polygon: Arc<Polygon>,
    /// Number of its buffer in memory (12).
    pub(crate) number: u64,
    pub(crate) registers: ShadingRegisters,
    pub(crate) reused: bool,
}

/// Mode, Ia and Is, from the display list or the configuration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct HostSettings {
    pub(crate) mode: ShadingMode,
    pub(crate) ia: f32,
    pub(crate) is: f32,
}

/// Phase of the CPU (11).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) enum CpuPhase {
    /// Waiting for the host.
    #[default]
    Idle,
    /// A frame has begun. The next step writes its mode to the mode register (14).
    WriteMode,
    /// Decided. The next step writes the flatness register (16).
    WriteFlat(DecidedPolygon),
    /// The next step writes the specular register (18).
    WriteSpecular(DecidedPolygon),
    /// The next step starts circuit (50), or leaves it idle.
    Start(DecidedPolygon),
    /// The next step computes the brightness.
    Shade(DecidedPolygon),
    /// Process 24 emits dots.
    Output {
        /// Polygon being drawn.
        figure: Arc<PolygonFigure>,
        /// Brightness of the polygon.
        brightness: [f32; 3],
    },
}

/// State of the microcomputer between steps: data from the host, the phase of the CPU (11), memory (12), counters.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MicrocomputerState {
    /// Mode, Ia and Is of the object.
    pub(crate) settings: HostSettings,
    pub(crate) frame: Option<Arc<Frame>>,
    pub(crate) object: Option<Arc<ObjectInfo>>,
    pub(crate) raster: RasterGrid,
    /// True if frame or object changed, so that L and H must be calculated.
    pub(crate) lights_changed: bool,
    pub(crate) illumination: Arc<ObjectIllumination>,
    /// Largest N.H that process 17 treats as negligible.
    pub(crate) limits: SpecularLimits,
    /// Polygons received, which is the number of the next one.
    pub(crate) polygons: u64,
    pub(crate) phase: CpuPhase,
    /// Position of process 24 in its polygon.
    pub(crate) dots: DotScan,
    /// Operands of the current work.
    pub(crate) operands: OperandAccess,
    /// Plane of Figure 7 in memory (12). `None` means void.
    pub(crate) plane: Option<StoredPlane>,
    /// Counters.
    pub counters: MicrocomputerCounters,
}

/// Counters of the microcomputer.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MicrocomputerCounters {
    /// Runs and cycles of the processes, indexed by [`CpuProcess`].
    pub processes: [ProcessCounters; 8],
    /// Polygons with a negligible specular term.
    pub specular_negligible: u64,
    /// Flat polygons.
    pub flat: u64,
    /// Flat polygons that reused the stored brightness.
    pub reused: u64,
    /// Starts of circuit (50).
    pub starts: u64,
    /// Dots emitted by process 24.
    pub dots: u64,
}
