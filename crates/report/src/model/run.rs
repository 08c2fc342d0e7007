//! The report of one run.

use super::costs::Costs;
use super::display::Display;
use super::figures::{Derived, Figure, Hardware, HardwareArea, Legend};
use super::host::Host;
use super::memory::{Cache, Memory, MemoryBytes};
use super::pictures::{Picture, PictureQuality};
use super::sensitivity::{Measure, Sensitivity};
use super::timing::{Bottlenecks, CriticalPath, Fifo, Unit, read_bottlenecks};
use crate::number::round6;
use basrelief_signals::Camera;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Report of one run. All parts except `host` are equal to the bit on every engine, host and number of threads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    /// `basrelief-report/3`.
    pub schema: String,
    /// Version of the simulator.
    pub version: String,
    /// Identity of the build: the version, and a hash over the sources of the simulator. Absent in reports of version 0.1.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub build: String,
    /// Machine, as in `--machine`.
    pub machine: String,
    /// Input of the run.
    pub input: Input,
    /// End of the run.
    pub outcome: Outcome,
    /// Configuration of the machine with all defaults, in groups as in TOML.
    pub config: serde_json::Value,
    /// Camera, light and viewer of the last frame.
    pub camera: Camera,
    /// Size of the images.
    pub size: Size,
    /// Simulated time. A functional run has no timing, so it has no `cycles`, `units`, `fifos`, `memories` and `caches`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycles: Option<Cycles>,
    /// Cycle breakdown of each unit, in the order of the block diagram.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub units: Option<IndexMap<String, Unit>>,
    /// Occupancy of each FIFO.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fifos: Option<IndexMap<String, Fifo>>,
    /// Traffic of each memory.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub memories: Option<IndexMap<String, Memory>>,
    /// Bytes of all memories.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bytes: Option<MemoryBytes>,
    /// Scan-out and flips of the display. Absent in reports of version 0.1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub display: Option<Display>,
    /// Hits and misses of each cache.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub caches: Option<IndexMap<String, Cache>>,
    /// Bottlenecks as relaxations. Measured by resimulation; absent if they were not.
    #[serde(alias = "limits", default, skip_serializing_if = "Option::is_none", deserialize_with = "read_bottlenecks")]
    pub bottlenecks: Option<Bottlenecks>,
    /// Critical path that ends with the last frame. Present if `bottlenecks` is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub critical_path: Option<CriticalPath>,
    /// Cycles per object and polygon, with `--costs`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub costs: Option<Costs>,
    /// Change of the run when one assumed parameter changes, with `--sensitivity`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensitivity: Option<Sensitivity>,
    /// Hardware of each unit, followed by the FIFOs that it fills; then caches.
    #[serde(default)]
    pub hardware: Vec<Hardware>,
    /// Counts of the machine, such as fragments, searches and table lookups.
    pub figures: IndexMap<String, Figure>,
    /// Unit of measure and meaning of each figure.
    #[serde(default)]
    pub legend: IndexMap<String, Legend>,
    /// Quality of the images against reference images. Absent if no reference images were drawn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quality: Option<PictureQuality>,
    /// Images in order of time; the final image is last.
    pub image: Vec<Picture>,
    /// Figures derived from the other figures, each with its formula.
    pub derived: IndexMap<String, Derived>,
    /// Warnings, one sentence each.
    pub warnings: Vec<String>,
    /// Speed of the host: the only part that differs between equal runs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub host: Option<Host>,
}

/// Figure with the frame of each picture.
const PICTURE_FRAME: &str = "picture_frame";

impl Report {
    /// Returns the tail: cycles after the last frame, in which memory takes the last pixels. In version 0.1 the display read the frame
    /// in them. The tail of an incomplete run is unknown; the result is then 0.
    pub fn drain(&self) -> u64 {
        let ended = self.cycles.as_ref().filter(|c| self.outcome.is_complete() && !c.frames.is_empty());
        ended.map_or(0, |cycles| cycles.drain)
    }

    /// Returns the cycles that the breakdown of every unit covers: the render cycles, or all cycles if a unit works after the last
    /// frame. So the percentages of two units can be compared.
    pub(crate) fn breakdown_cycles(&self) -> u64 {
        let drain = self.drain();
        let all_done = self.units.iter().flatten().all(|(_, unit)| unit.done >= drain);
        self.cycles.as_ref().map_or(0, |cycles| cycles.total.saturating_sub(if all_done { drain } else { 0 }))
    }

    /// Returns the bytes that all memories moved; `None` for a functional run.
    pub fn memory_bytes(&self) -> Option<u64> {
        self.bytes.map(|bytes| bytes.moved)
    }

    /// Counts the bytes of memories from their bursts.
    pub(crate) fn count_bytes(&mut self) {
        let Self { memories, config, .. } = self;
        let burst_bytes = |name: &str| config.get("memory")?.get(name)?.get("burst_bytes")?.as_u64();
        for (name, memory) in memories.iter_mut().flatten() {
            memory.count_bytes(burst_bytes(name));
        }
        self.bytes = self.memories.as_ref().map(|memories| MemoryBytes::sum(memories.values().map(|memory| memory.bytes)));
    }

    /// Returns the area of the machine; `None` for a report of a version without areas.
    pub fn hardware_area(&self) -> Option<HardwareArea> {
        Some(HardwareArea::sum(&self.hardware)).filter(|area| area.area_ge > 0)
    }

    /// Returns the measures that a sensitivity analysis compares.
    pub fn measure(&self) -> Measure {
        Measure {
            cycles: self.frame_cycles(),
            frame_ms: self.frame_ms().map(round6),
            bytes: self.memory_bytes().unwrap_or(0),
            area_ge: self.hardware_area().map_or(0, |area| area.area_ge),
            psnr_db: self.quality.as_ref().map(|quality| quality.min.psnr_db),
        }
    }

    /// Returns the clock of the machine \[Hz\], if it has one.
    pub(crate) fn clock_hz(&self) -> Option<f64> {
        self.config.pointer("/clock/hz").and_then(serde_json::Value::as_f64).filter(|hz| *hz > 0.0)
    }

    /// Returns the mean time of a whole frame \[ms\]. `None` without a clock or a whole frame.
    pub fn frame_ms(&self) -> Option<f64> {
        let cycles = self.cycles_of_frames();
        let sum = cycles.iter().map(|cycles| *cycles as f64).sum::<f64>();
        Some(1e3 * sum / (cycles.len() as f64 * self.clock_hz()?)).filter(|ms| ms.is_finite())
    }

    /// Returns the number of finished frames.
    pub fn frames(&self) -> u64 {
        self.cycles_of_frames().len() as u64
    }

    /// Returns the end of a caption that names the last frame among several, such as ", frame 3 of 3"; empty if there is one image only.
    pub fn last_frame_suffix(&self) -> String {
        let images = self.image.len();
        if images > 1 { format!(", frame {images} of {images}") } else { String::new() }
    }

    /// Returns the render cycles of each finished frame: those of its pictures together.
    pub fn cycles_of_frames(&self) -> Vec<u64> {
        let Some(cycles) = &self.cycles else { return vec![] };
        let frames = self.frames_of_pictures();
        let mut sums = vec![0_u64; frames.iter().max().map_or(0, |last| last + 1)];
        frames.iter().zip(&cycles.frames).for_each(|(frame, cycles)| sums[*frame] = sums[*frame].saturating_add(*cycles));
        // A stopped run may have shown pictures of a frame that it did not finish.
        let finished = self.device_number("frames").filter(|_| self.figures.contains_key(PICTURE_FRAME));
        sums.truncate(finished.map_or(usize::MAX, |frames| frames as usize));
        sums
    }

    /// Returns the frame of each picture, from 0. A machine that shows several pictures of a frame states it.
    pub(crate) fn frames_of_pictures(&self) -> Vec<usize> {
        let count = self.pictures() as usize;
        let mut stated: Vec<usize> = match self.figures.get(PICTURE_FRAME) {
            Some(Figure::List(frames)) => frames.iter().filter_map(Figure::number).map(|frame| frame as usize).collect(),
            _ => vec![],
        };
        let next = stated.iter().max().map_or(0, |last| last.saturating_add(1));
        if next == 0 || next > count || stated.len() > count {
            return (0..count).collect();
        }
        // The figure lacks the pictures of a frame that was not finished.
        stated.resize(count, next);
        stated
    }

    /// Returns the pictures that the machine drew: the entries of `cycles.frames`.
    pub(crate) fn pictures(&self) -> u64 {
        self.cycles.as_ref().map_or(0, |cycles| cycles.frames.len() as u64)
    }

    /// Returns the term for a picture: `frame`, unless a frame has several.
    pub(crate) fn picture_term(&self) -> &'static str {
        if self.frames_of_pictures().is_sorted_by(|a, b| a < b) { "frame" } else { "picture" }
    }

    /// Returns the render cycles: all cycles without the [tail](Self::drain). 0 for a functional run.
    pub fn frame_cycles(&self) -> u64 {
        self.cycles.as_ref().map_or(0, |cycles| cycles.total.saturating_sub(self.drain()))
    }

    /// Returns the term for [`frame_cycles`](Self::frame_cycles): `render cycles`, or `cycles` for an incomplete run, whose last frame
    /// is unfinished.
    pub(crate) fn cycles_term(&self) -> &'static str {
        if self.outcome.is_complete() { "render cycles" } else { "cycles" }
    }

    /// Returns the frames over which totals are averaged, at least 1. `None` for an incomplete run: its totals include an unfinished
    /// frame, so a mean per frame would be wrong.
    pub(crate) fn averaged_frames(&self) -> Option<u64> {
        self.outcome.is_complete().then(|| self.frames().max(1))
    }

    /// Returns the value of a figure of the machine, if it is a number.
    pub fn device_number(&self, name: &str) -> Option<f64> {
        self.figures.get(name).and_then(Figure::number)
    }
}

/// Input of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Input {
    /// Kind: `scene`, `demo`, `trace` and others.
    pub kind: String,
    /// Name of the file without its path, or of the demo.
    pub name: String,
    /// SHA-256 of the canonical commands, texels by their digests, in hexadecimal. Empty if the run ended before the last command.
    pub sha256: String,
}

/// End of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Outcome {
    /// Kind of the end.
    pub kind: OutcomeKind,
    /// Blocked units of a deadlock, or the reason of a fault.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
}

impl Outcome {
    /// Returns true if the run finished.
    pub fn is_complete(&self) -> bool {
        self.kind == OutcomeKind::Complete
    }
}

/// Kind of the end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum OutcomeKind {
    /// All sources are exhausted, all FIFOs are empty, and no unit holds tokens.
    Complete,
    /// No unit could start a step, and work was left.
    Deadlock,
    /// The run reached its cycle limit.
    Limit,
    /// The caller stopped it.
    Stopped,
    /// A unit failed.
    Fault,
}

impl OutcomeKind {
    /// Returns the name as in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::Complete => "complete",
            Self::Deadlock => "deadlock",
            Self::Limit => "limit",
            Self::Stopped => "stopped",
            Self::Fault => "fault",
        }
    }
}

/// Width and height of an image.
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
    /// Last cycle with activity, plus 1: memory has taken the last pixel. The display does not count.
    pub total: u64,
    /// Render cycles of each frame: from the end of the frame before it until its last pixel is written, which is a posted write. If a
    /// mode shows several pictures of a frame, of each picture; `figures.picture_frame` has their frames.
    pub frames: Vec<u64>,
    /// Cycles from the end of the last frame to the end of the run, in which memory takes the last pixels. `frames` and `write_tail` sum
    /// to `total`.
    #[serde(rename = "write_tail", alias = "scan_out_tail", alias = "drain")]
    pub drain: u64,
}
