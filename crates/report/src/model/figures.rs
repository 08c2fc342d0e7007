//! Counts of a machine and figures that follow from them.

use basrelief_kernel::{self as kernel, HardwareKind, OperandFormat, stats};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Equal pieces of hardware: counts, widths and area.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Hardware {
    /// Unit, FIFO, cache or port.
    pub place: String,
    /// Kind of hardware.
    pub kind: HardwareKind,
    /// Purpose.
    #[serde(rename = "description", alias = "about")]
    pub about: String,
    /// Number of operators or words.
    pub count: u64,
    /// Width of each word, or of the first operand \[bits\].
    pub width: u32,
    /// Width of the second operand \[bits\]; number of ways for tag comparators. Absent for storage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by: Option<u32>,
    /// Number format of operators; absent for storage.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub format: Option<OperandFormat>,
    /// Ports of storage; absent for operators.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ports: Option<u32>,
    /// Bits that one port of all banks reads in a cycle; absent for operators.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub port_bits: Option<u64>,
    /// Area of all pieces.
    #[serde(flatten)]
    pub area: HardwareArea,
}

/// Area of hardware.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct HardwareArea {
    /// Logic \[gate equivalents\].
    #[serde(default)]
    pub logic_ge: u64,
    /// Flip-flops: registers, pipeline registers, words of small tables and FIFOs \[bits\].
    #[serde(default)]
    pub register_bits: u64,
    /// Memory macros \[bits\].
    #[serde(default)]
    pub memory_bits: u64,
    /// Logic, flip-flops and memory macros \[gate equivalents\].
    #[serde(default)]
    pub area_ge: u64,
    /// Largest delay of a cycle \[FO4\]; 0 for storage.
    #[serde(default)]
    pub depth_fo4: u64,
}

impl HardwareArea {
    /// Returns the area of two parts together.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            logic_ge: self.logic_ge.saturating_add(other.logic_ge),
            register_bits: self.register_bits.saturating_add(other.register_bits),
            memory_bits: self.memory_bits.saturating_add(other.memory_bits),
            area_ge: self.area_ge.saturating_add(other.area_ge),
            depth_fo4: self.depth_fo4.max(other.depth_fo4),
        }
    }

    /// Returns the area of all pieces together.
    pub fn sum<'a>(pieces: impl IntoIterator<Item = &'a Hardware>) -> Self {
        pieces.into_iter().fold(Self::default(), |sum, piece| sum.and(piece.area))
    }
}

impl From<kernel::Area> for HardwareArea {
    fn from(area: kernel::Area) -> Self {
        let whole = |x: f64| x.round() as u64;
        Self {
            logic_ge: whole(area.logic_ge),
            register_bits: area.register_bits,
            memory_bits: area.memory_bits,
            area_ge: whole(area.area_ge),
            depth_fo4: whole(area.depth_fo4),
        }
    }
}

impl Hardware {
    /// Describes equal pieces with their area.
    pub fn new(piece: &kernel::Hardware, model: &kernel::AreaModel) -> Self {
        let computes = piece.kind.computes();
        Self {
            place: piece.place.clone(),
            kind: piece.kind,
            about: piece.about.into(),
            count: piece.count,
            width: piece.width,
            by: computes.then_some(piece.by),
            format: computes.then_some(piece.format),
            ports: (!computes).then_some(piece.ports),
            port_bits: (!computes).then(|| piece.port_bits()),
            area: model.of(piece).into(),
        }
    }

    /// Returns the stored bits; 0 for operators.
    pub fn bits(&self) -> u64 {
        if self.kind.computes() { 0 } else { self.count.saturating_mul(u64::from(self.width)) }
    }
}

/// One figure of a machine.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "expected a number, a text, or a list of them")]
pub enum Figure {
    /// Count.
    Count(u64),
    /// Real number.
    Real(f64),
    /// Text.
    Text(String),
    /// One value per level, object or frame.
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
    /// Returns the value, if it is a number.
    pub fn number(&self) -> Option<f64> {
        match self {
            Self::Count(n) => Some(*n as f64),
            Self::Real(x) => Some(*x),
            Self::Text(_) | Self::List(_) => None,
        }
    }
}

/// Meaning of a figure.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Legend {
    /// Unit of measure in the plural; absent for a ratio.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// Meaning.
    #[serde(rename = "description", alias = "about")]
    pub about: String,
    /// Group of figures that it belongs to, if any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub part: Option<FigureGroup>,
}

/// Group of figures that belong together.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Part")]
#[serde(rename_all = "snake_case")]
pub enum FigureGroup {
    /// The work of the machine, such as fragments. Other figures are divided by it.
    Work,
    /// Counts of the route with this name.
    Route(String),
    /// Cycles in which the circuit with this name was started.
    Started(String),
    /// Cycles of the circuit with this name whose results were needed.
    Needed(String),
    /// Counts of the process with this name.
    Process(String),
    /// A column of a table.
    Column {
        /// Name of the table.
        table: String,
        /// Title of the column.
        title: String,
    },
}

impl From<&stats::FigureValue> for Figure {
    fn from(value: &stats::FigureValue) -> Self {
        match value {
            stats::FigureValue::Count(n) => Self::Count(*n),
            stats::FigureValue::Real(x) => Self::Real(*x),
            stats::FigureValue::Counts(counts) => counts.clone().into(),
            stats::FigureValue::Reals(reals) => reals.clone().into(),
        }
    }
}

impl From<&stats::UnitFigure> for Legend {
    fn from(figure: &stats::UnitFigure) -> Self {
        let part = match figure.part.clone() {
            stats::FigureGroup::Alone => None,
            stats::FigureGroup::Work => Some(FigureGroup::Work),
            stats::FigureGroup::Route(name) => Some(FigureGroup::Route(name)),
            stats::FigureGroup::Started(name) => Some(FigureGroup::Started(name)),
            stats::FigureGroup::Needed(name) => Some(FigureGroup::Needed(name)),
            stats::FigureGroup::Process(name) => Some(FigureGroup::Process(name)),
            stats::FigureGroup::Column { table, title } => Some(FigureGroup::Column { table: table.into(), title: title.into() }),
        };
        Self { unit: figure.unit.into(), about: figure.about.into(), part }
    }
}

/// Figure derived from other figures.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Derived {
    /// Rounded to 6 decimals.
    pub value: f64,
    /// Unit of measure; `1` for a ratio.
    pub unit: String,
    /// Formula, in keys of this report.
    pub formula: String,
}
