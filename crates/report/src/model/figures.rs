//! Counts of a machine and figures that follow from them.

use basrelief_kernel::{self as kernel, HardwareKind, stats};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Equal pieces of hardware: counts and widths, without area and energy.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Hardware {
    /// Unit, FIFO or cache.
    pub place: String,
    /// Kind of hardware.
    pub kind: HardwareKind,
    /// Purpose.
    #[serde(rename = "description", alias = "about")]
    pub about: String,
    /// Number of operators or words.
    pub count: u64,
    /// Width of each \[bits\].
    pub width: u32,
}

impl Hardware {
    /// Returns the stored bits; 0 for operators.
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
