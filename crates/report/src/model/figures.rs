//! Counts of a machine and figures that follow from them.

use basrelief_kernel::{self as kernel, HardwareKind, stats};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

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

impl From<&stats::Figure> for Legend {
    fn from(figure: &stats::Figure) -> Self {
        let part = match figure.part.clone() {
            stats::FigureGroup::Alone => None,
            stats::FigureGroup::Work => Some(Part::Work),
            stats::FigureGroup::Route(name) => Some(Part::Route(name)),
            stats::FigureGroup::Started(name) => Some(Part::Started(name)),
            stats::FigureGroup::Needed(name) => Some(Part::Needed(name)),
            stats::FigureGroup::Process(name) => Some(Part::Process(name)),
            stats::FigureGroup::Column { table, title } => Some(Part::Column { table: table.into(), title: title.into() }),
        };
        Self { unit: figure.unit.into(), about: figure.about.into(), part }
    }
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
