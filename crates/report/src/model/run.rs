//! The report of one run.

use super::costs::Costs;
use super::figures::{Derived, Figure, Hardware, Legend};
use super::host::Host;
use super::memory::{Cache, Client, Memory};
use super::pictures::{Picture, PictureQuality};
use super::sensitivity::{Measure, Sensitivity};
use super::timing::{CriticalPath, Fifo, Limit, Unit};
use basrelief_signals::Camera;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One run. Everything but `host` is the same to the bit whatever engine, host or number of threads made it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// `basrelief-report/1`.
    pub schema: String,
    /// Version of the simulator.
    pub version: String,
    /// The machine, as `--machine` names it.
    pub machine: String,
    /// What was drawn.
    pub input: Input,
    /// How the run ended.
    pub outcome: Outcome,
    /// The machine's configuration, every default filled in, in groups as in TOML.
    pub config: serde_json::Value,
    /// Camera, light and view of the last frame.
    pub camera: Camera,
    /// Size of the pictures.
    pub size: Size,
    /// Simulated time; this and the next four are absent from a functional run, which has no time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycles: Option<Cycles>,
    /// Where the cycles of each unit went, by name, in the order of the block diagram.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<IndexMap<String, Unit>>,
    /// How full each FIFO was, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fifos: Option<IndexMap<String, Fifo>>,
    /// What each memory moved, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memories: Option<IndexMap<String, Memory>>,
    /// What each cache's look-ups found, by name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub caches: Option<IndexMap<String, Cache>>,
    /// What limits the run, most first: what it would take with one thing made ideal. Measured, by timing the same work again; absent
    /// where it was not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<Vec<Limit>>,
    /// What the end of the last frame waited for, back to the first cycle; there where `limits` is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub critical_path: Option<CriticalPath>,
    /// Who the cycles of the units were for; absent where nobody has asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub costs: Option<Costs>,
    /// What it comes to with each assumed parameter changed, one at a time; absent where nobody has asked.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity: Option<Sensitivity>,
    /// What the machine is built of, unit by unit, each before the FIFOs that it fills; then caches.
    #[serde(default)]
    pub hardware: Vec<Hardware>,
    /// What the machine counts, as its units name it: fragments, searches, table look-ups ...
    pub figures: IndexMap<String, Figure>,
    /// What `figures` mean, by the same names.
    #[serde(default)]
    pub legend: IndexMap<String, Legend>,
    /// The machine's pictures against the exact ones; absent where none were drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quality: Option<PictureQuality>,
    /// The pictures in order of time, the final one last.
    pub image: Vec<Picture>,
    /// Figures that follow from the others, each with its formula.
    pub derived: IndexMap<String, Derived>,
    /// What the reader should know, one sentence each.
    pub warnings: Vec<String>,
    /// How fast the host was: the only part that differs between equal runs; absent where reports are to be compared.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub host: Option<Host>,
}

impl Report {
    /// Cycles behind the last frame, in which what was drawn is shown. Of a run that was cut short nothing is known to be
    /// behind its last frame.
    pub fn drain(&self) -> u64 {
        let ended = self.cycles.as_ref().filter(|c| self.outcome.kind == OutcomeKind::Complete && !c.frames.is_empty());
        ended.map_or(0, |cycles| cycles.drain)
    }

    /// Of the drain, what this unit has behind its last step: all or nothing. Who has finished by the end of the last frame is
    /// told in the cycles of the frames.
    pub(crate) fn drain_of(&self, unit: &Unit) -> u64 {
        if unit.done >= self.drain() { self.drain() } else { 0 }
    }

    /// Bytes that all memories moved, saturating, as a report may come from a file; none of a functional run.
    pub fn memory_bytes(&self) -> Option<u64> {
        let clients = self.memories.as_ref()?.values().flat_map(|memory| memory.clients.values());
        Some(clients.map(Client::bytes).fold(0, u64::saturating_add))
    }

    /// The measures that a sensitivity analysis compares.
    pub fn measure(&self) -> Measure {
        Measure {
            cycles: self.frame_cycles(),
            bytes: self.memory_bytes().unwrap_or(0),
            psnr_db: self.quality.as_ref().map(|quality| quality.last.psnr_db),
        }
    }

    /// The machine's clock \[Hz\], where it has one.
    pub(crate) fn clock_hz(&self) -> Option<f64> {
        self.config.pointer("/clock/hz").and_then(serde_json::Value::as_f64).filter(|hz| *hz > 0.0)
    }

    /// Cycles of the frames: all but the [drain](Self::drain). None of a functional run.
    pub fn frame_cycles(&self) -> u64 {
        self.cycles.as_ref().map_or(0, |cycles| cycles.total.saturating_sub(self.drain()))
    }

    /// Number of figure `name` of the machine.
    pub fn device_number(&self, name: &str) -> Option<f64> {
        self.figures.get(name).and_then(Figure::number)
    }
}

/// What was drawn.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Input {
    /// `scene`, `demo`, `trace` ...
    pub kind: String,
    /// File name or name of the demo, without the path.
    pub name: String,
    /// SHA-256 of the canonical commands, in hexadecimal; empty where the run ended before the last of them.
    pub sha256: String,
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Outcome {
    /// In one word.
    pub kind: OutcomeKind,
    /// What is stuck, or what went wrong.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
}

/// How a run ended, in one word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OutcomeKind {
    /// Sources exhausted, FIFOs empty, no unit holds tokens.
    Complete,
    /// Nothing could ever start again, and something was left.
    Deadlock,
    /// The limit of cycles was reached.
    Limit,
    /// The caller stopped it.
    Stopped,
    /// A unit could not go on.
    Fault,
}

/// Width and height of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Size {
    /// \[pixels\].
    pub width: u32,
    /// \[pixels\].
    pub height: u32,
}

/// Simulated time \[cycles\].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Cycles {
    /// 1 + the last cycle in which anything moved.
    pub total: u64,
    /// From the end of one frame to the end of the next.
    pub frames: Vec<u64>,
    /// From the end of the last frame to the end of the run. `frames` and `drain` sum to `total`.
    pub drain: u64,
}
