//! What the microcomputer (10) keeps between steps.

use super::Limits;
use super::Plane;
use crate::dots::Dots;
use crate::{Figure, Illumination, Registers};
use basrelief_shading::Raster;
use basrelief_signals::{Frame, ObjectInfo, Polygon, ShadingMode};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Processes of the CPU (11), under the patent's numerals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Process {
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

impl Process {
    /// All, in the order of their numbers, with their names in the report.
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

/// Runs of a process, and the CPU cycles they took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ProcessCounters {
    /// Runs.
    pub runs: u64,
    /// Cycles.
    pub cycles: u64,
}

/// A polygon that is decided, not yet shaded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Decided {
    pub(crate) polygon: Arc<Polygon>,
    /// Where memory (12) has it: its number.
    pub(crate) number: u64,
    pub(crate) registers: Registers,
    pub(crate) reused: bool,
}

/// Mode, Ia and Is, as the display list or the configuration has them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Settings {
    pub(crate) mode: ShadingMode,
    pub(crate) ia: f32,
    pub(crate) is: f32,
}

/// What the CPU (11) is at.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) enum Phase {
    /// Waits for the host.
    #[default]
    Idle,
    /// A frame has begun: its mode is next written to the mode register (14).
    WriteMode,
    /// Decided: the flatness register (16) is next.
    WriteFlat(Decided),
    /// Then the specular register (18).
    WriteSpecular(Decided),
    /// Then circuit (50) is started, or not.
    Start(Decided),
    /// Brightness is next.
    Shade(Decided),
    /// Process 24 puts out dots.
    Output {
        /// The polygon.
        figure: Arc<Figure>,
        /// Its brightness.
        brightness: [f32; 3],
    },
}

/// Everything the microcomputer remembers: what the host has sent, what the CPU (11) is at, memory (12), counters.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MicrocomputerState {
    /// Mode, Ia and Is of the object.
    pub(crate) settings: Settings,
    pub(crate) frame: Option<Arc<Frame>>,
    pub(crate) object: Option<Arc<ObjectInfo>>,
    pub(crate) raster: Raster,
    /// Frame or object are new: L and H are to be calculated again.
    pub(crate) lights_changed: bool,
    pub(crate) illumination: Arc<Illumination>,
    /// Largest N.H that process 17 calls negligible.
    pub(crate) limits: Limits,
    /// Polygons taken: the number of the one that is next.
    pub(crate) polygons: u64,
    pub(crate) phase: Phase,
    /// Where process 24 is in its polygon.
    pub(crate) dots: Dots,
    /// Memory (12), Figure 7; `None` is void.
    pub(crate) plane: Option<Plane>,
    /// What it has counted.
    pub counters: MicrocomputerCounters,
}

/// What the microcomputer has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MicrocomputerCounters {
    /// Runs and cycles of its processes, by number of the [`Process`].
    pub processes: [ProcessCounters; 8],
    /// Polygons whose specular term was found negligible.
    pub specular_negligible: u64,
    /// Polygons found flat.
    pub flat: u64,
    /// Of these, polygons that took the stored brightness.
    pub reused: u64,
    /// Starts of circuit (50).
    pub starts: u64,
    /// Dots put out by process 24.
    pub dots: u64,
}
