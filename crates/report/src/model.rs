//! The report as it stands in `report.json`: plain data, fields in fixed order, maps in the order of the block diagram.

use crate::costs::Costs;
use crate::sensitivity::Sensitivity;
use basrelief_kernel::{self as kernel, HardwareKind, facts};
use basrelief_reference::Quality;
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

    /// The machine's clock \[Hz\], where it has one.
    pub(crate) fn clock_hz(&self) -> Option<f64> {
        self.config.pointer("/clock/hz").and_then(serde_json::Value::as_f64).filter(|hz| *hz > 0.0)
    }

    /// Cycles of the frames: all but the [drain](Self::drain). None of a functional run.
    pub fn frame_cycles(&self) -> u64 {
        self.cycles.as_ref().map_or(0, |cycles| cycles.total.saturating_sub(self.drain()))
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

/// Where a unit's cycles went. busy + starved + blocked + memory + done = `cycles.total`.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Unit {
    /// The patent's reference numeral.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub numeral: Option<u32>,
    /// Steps made.
    pub steps: u64,
    /// Tokens emitted, over all outputs; of a unit without outputs, tokens taken.
    pub tokens: u64,
    /// Cycles at work.
    pub busy: u64,
    /// Cycles without a visible token, by input FIFO; every input is listed.
    pub starved: IndexMap<String, u64>,
    /// Cycles without a free slot, by output FIFO; every output is listed.
    pub blocked: IndexMap<String, u64>,
    /// Cycles waiting for credits or answers, by memory client; every client is listed.
    pub memory: IndexMap<String, u64>,
    /// Cycles after its last step.
    pub done: u64,
}

/// How full a FIFO was.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Fifo {
    /// Slots.
    pub depth: u64,
    /// Tokens that were pushed.
    pub tokens: u64,
    /// Most slots ever held.
    pub high_water: u64,
    /// `histogram[k]` = cycles with k slots held, k = 0 ..= depth; sums to `cycles.total`.
    pub histogram: Vec<u64>,
}

/// What a memory moved.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Memory {
    /// By name, in order of port number.
    pub clients: IndexMap<String, Client>,
    /// In order of number.
    pub channels: Vec<Channel>,
    /// When its buses moved data.
    pub bus: Bus,
}

/// When the buses of a memory moved data: one number per interval of equal length.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Bus {
    /// Length of an interval \[cycles\].
    pub interval: u64,
    /// Cycles in which a bus moved data, added up over all channels, by interval from cycle 0; what is left out is 0.
    pub busy: Vec<u64>,
}

/// What one channel of a memory moved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Channel {
    /// Bursts that found their row open.
    pub row_hits: u64,
    /// Bursts that found their bank closed.
    pub row_closed: u64,
    /// Bursts that found another row open.
    pub row_conflicts: u64,
    /// Changes between reading and writing.
    pub turn_arounds: u64,
    /// Refreshes.
    pub refreshes: u64,
    /// Cycles in which its bus moved data.
    pub bus_busy: u64,
    /// Sum over all cycles of the bursts that waited in its queue: divided by the cycles, the mean length of the queue.
    pub queued: u64,
}

/// What one client of a memory moved and how it was served.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Client {
    /// Read requests.
    pub reads: u64,
    /// Write requests.
    pub writes: u64,
    /// Bytes asked for by reads.
    pub read_bytes: u64,
    /// Bytes given by writes.
    pub write_bytes: u64,
    /// Bursts moved; a request that is not aligned moves more bytes than it asks for.
    pub bursts: u64,
    /// Bursts that found their row open.
    pub row_hits: u64,
    /// Bursts that found their bank closed.
    pub row_closed: u64,
    /// Bursts that found another row open.
    pub row_conflicts: u64,
    /// Cycles that its bursts waited in the queues of their channels, in view or not, beyond the one that each needs.
    pub queue_wait: u64,
    /// `latency[k]` = requests answered after 2^k cycles or more and less than twice that; what is left out is 0.
    pub latency: Vec<u64>,
}

impl Client {
    /// Bytes asked for, read and written.
    pub fn bytes(&self) -> u64 {
        self.read_bytes.saturating_add(self.write_bytes)
    }
}

/// What a cache's look-ups found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Cache {
    /// hits + misses + merged.
    pub look_ups: u64,
    /// The line was there.
    pub hits: u64,
    /// The line was requested from memory.
    pub misses: u64,
    /// The line was on its way.
    pub merged: u64,
}

/// A chain of work and waits, without gap or overlap, from the first cycle to the end of the last frame. Another may be as long:
/// what something costs is told by [`Limit`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct CriticalPath {
    /// The sum over all parts.
    pub cycles: u64,
    /// Longest first.
    pub parts: Vec<PathPart>,
    /// The same cycles by polygon, where costs were asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polygons: Option<PathPolygons>,
}

/// Cycles of a critical path by polygon: a stretch is for what the step is for that it begins with. `listed` + `others` + `elsewhere` =
/// `cycles` of the path.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PathPolygons {
    /// Those with most of it, most first.
    pub listed: Vec<PathPolygon>,
    /// Cycles for all other polygons.
    pub others: u64,
    /// Cycles for objects and frames, and none of their polygons; and for nobody.
    pub elsewhere: u64,
}

/// A polygon's part of a critical path.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PathPolygon {
    /// Number of its frame, from 0.
    pub frame: u32,
    /// Number in its frame, from 0, in the order of the display list.
    pub polygon: u32,
    /// Number of its object; absent where it has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub object: Option<u32>,
    /// \[cycles\]
    pub cycles: u64,
}

/// All stretches of a critical path that are spent on one thing.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct PathPart {
    /// Name of a unit, FIFO or memory client; empty for what is left in flight at the end.
    pub resource: String,
    /// Of a unit `occupancy` or `latency`; of a FIFO `FIFO`, which is its latency and one token per cycle, or `slot`; of a request
    /// `arrival`, `bus`, `bank`, `data`, `order` or `cache`; or `rest`.
    pub what: String,
    /// \[cycles\]
    pub cycles: u64,
    /// Of these, those within each frame.
    pub frames: Vec<u64>,
}

/// What a run would take with something made ideal: cycles of its frames, without the drain behind the last. A full run with `set`
/// takes exactly these.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Limit {
    /// What is made ideal: name of a unit, FIFO, memory or cache; or two of them.
    pub resource: String,
    /// How.
    pub what: String,
    /// Parameters, as `--set` takes them.
    pub set: Vec<String>,
    /// Cycles of the frames then.
    pub cycles: u64,
    /// Cycles fewer than as it was.
    pub saved: u64,
}

/// Equal pieces of hardware: no area and no energy, but counts that one can multiply.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Hardware {
    /// Where: name of the unit, of the FIFO, or of the cache.
    pub place: String,
    /// What it is.
    pub kind: HardwareKind,
    /// What it is for.
    pub about: String,
    /// How many: operators, or words.
    pub count: u64,
    /// Width of each \[bits\].
    pub width: u32,
}

impl Hardware {
    /// Bits that it holds; 0 where it computes.
    pub fn bits(&self) -> u64 {
        if self.kind.computes() { 0 } else { self.count.saturating_mul(u64::from(self.width)) }
    }
}

impl From<&kernel::Hardware> for Hardware {
    fn from(hardware: &kernel::Hardware) -> Self {
        let kernel::Hardware { place, kind, about, count, width } = hardware;
        Self { place: place.clone(), kind: *kind, about: (*about).into(), count: *count, width: *width }
    }
}

/// One figure of a machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Figure {
    /// How many.
    Count(u64),
    /// How much.
    Real(f64),
    /// In words.
    Text(String),
    /// One per level, object, frame ...
    List(Vec<Figure>),
}

impl From<u64> for Figure {
    fn from(n: u64) -> Self {
        Self::Count(n)
    }
}

impl From<f64> for Figure {
    fn from(x: f64) -> Self {
        Self::Real(x)
    }
}

impl From<&str> for Figure {
    fn from(text: &str) -> Self {
        Self::Text(text.into())
    }
}

impl<T: Into<Figure>> From<Vec<T>> for Figure {
    fn from(list: Vec<T>) -> Self {
        Self::List(list.into_iter().map(Into::into).collect())
    }
}

impl Figure {
    /// Its value, if it is a number.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Count(n) => Some(*n as f64),
            Self::Real(x) => Some(*x),
            Self::Text(_) | Self::List(_) => None,
        }
    }
}

/// What a figure of a machine means.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Legend {
    /// Unit of measure, in the plural; absent for a ratio.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// What it is.
    pub about: String,
    /// What it is told side by side with; absent where it stands alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<Part>,
}

/// What a figure is told side by side with.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Part {
    /// With all that is divided by it: it is the work of the machine.
    Work,
    /// With what else is counted on the route of this name.
    Route(String),
    /// With the other cycles of the circuit of this name: those in which it was started.
    Started(String),
    /// With the other cycles of the circuit of this name: those whose results were needed.
    Needed(String),
    /// With what else is counted of the process of this name.
    Process(String),
    /// With the other columns of a table.
    Column {
        /// Name of the table.
        table: String,
        /// Title of the column.
        title: String,
    },
}

impl From<&facts::Value> for Figure {
    fn from(value: &facts::Value) -> Self {
        match value {
            facts::Value::Count(n) => Self::Count(*n),
            facts::Value::Real(x) => Self::Real(*x),
            facts::Value::Counts(counts) => counts.clone().into(),
            facts::Value::Reals(reals) => reals.clone().into(),
        }
    }
}

impl From<&facts::Figure> for Legend {
    fn from(figure: &facts::Figure) -> Self {
        let part = match figure.part.clone() {
            facts::Part::Alone => None,
            facts::Part::Work => Some(Part::Work),
            facts::Part::Route(name) => Some(Part::Route(name)),
            facts::Part::Started(name) => Some(Part::Started(name)),
            facts::Part::Needed(name) => Some(Part::Needed(name)),
            facts::Part::Process(name) => Some(Part::Process(name)),
            facts::Part::Column { table, title } => Some(Part::Column { table: table.into(), title: title.into() }),
        };
        Self { unit: figure.unit.into(), about: figure.about.into(), part }
    }
}

/// The machine's pictures against the exact ones.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PictureQuality {
    /// Of the final picture.
    #[serde(flatten)]
    pub last: Quality,
    /// Of the final picture, in steps of its 8-bit values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub difference: Option<Difference>,
    /// Of each picture in order of time; empty where only the final one was compared.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub frames: Vec<Quality>,
}

/// Absolute differences of 8-bit values, red, green and blue alike, over the pixels covered in either picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Difference {
    /// Rounded to 6 decimals \[steps of 1/255\].
    pub mean: f64,
    /// \[steps of 1/255\].
    pub largest: u8,
}

/// A picture that was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Picture {
    /// File name, without the path.
    pub file: String,
    /// SHA-256 of its RGB rows, 8 bits per component, top row first, in hexadecimal; not of the file.
    pub sha256: String,
}

/// A figure that follows from others.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Derived {
    /// Rounded to 6 decimals.
    pub value: f64,
    /// Unit of measure; `1` for a ratio.
    pub unit: String,
    /// How it follows, in names of this report.
    pub formula: String,
}

/// How fast the host was.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Host {
    /// From start to end \[s\].
    pub wall_s: f64,
    /// From the first to the last simulated step, without import, reference, metrics or writing \[s\].
    pub simulate_s: f64,
    /// Simulated cycles per second of `simulate_s`; absent from a functional run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cycles_per_s: Option<f64>,
    /// Fragments, or dots, per second of `simulate_s`.
    pub fragments_per_s: f64,
    /// What a real path has carried, and when pictures were there; absent where nothing came from a server.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<RealPath>,
}

/// A real path, as the host has measured it; beside `first_picture_ms`, `final_picture_ms`, `picture_ms` and `path_bytes` of the
/// modelled one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RealPath {
    /// From the request for the scene to the first picture \[ms\].
    pub first_picture_ms: f64,
    /// From there to the last picture of the first frame \[ms\].
    pub final_picture_ms: f64,
    /// To each picture, from the end of the frame before \[ms\].
    pub picture_ms: Vec<f64>,
    /// To each picture, from the request for the scene \[ms\].
    pub picture_at_ms: Vec<f64>,
    /// Of `first_picture_ms`, how long the path had nothing to do, since the host was at work \[ms\]: the rest is what the path took.
    pub first_picture_idle_ms: f64,
    /// The same of `final_picture_ms` \[ms\].
    pub final_picture_idle_ms: f64,
    /// Connections opened.
    pub connections: u64,
    /// Requests made.
    pub requests: u64,
    /// Bytes of requests.
    pub request_bytes: u64,
    /// Bytes of the scene, compressed.
    pub scene_bytes: u64,
    /// Tiles that have come.
    pub tiles: u64,
    /// Their bytes.
    pub tile_bytes: u64,
    /// Tiles that were to be asked for and were not, since their view was left for the next.
    pub abandoned_tiles: u64,
    /// Bytes received beside scene and tiles: heads of answers, and answers that were of no use.
    pub head_bytes: u64,
}

impl Report {
    /// Number of figure `name` of the machine.
    pub fn device_number(&self, name: &str) -> Option<f64> {
        self.figures.get(name).and_then(Figure::number)
    }
}
