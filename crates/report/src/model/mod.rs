//! The report as it stands in `report.json`: plain data. Fields have a fixed order; maps have the order of the block diagram.
//!
//! The schema is public. A `schemars(rename)` keeps the name that a type has there.

pub mod costs;
mod display;
mod figures;
mod host;
mod memory;
mod pictures;
mod run;
pub mod sensitivity;
mod timing;

pub use costs::{Costs, CycleBreakdown, ObjectCost, PolygonCost, UnlistedCosts};
pub use display::Display;
pub use figures::{Derived, Figure, FigureGroup, Hardware, HardwareArea, Legend};
pub use host::{Host, RealPath};
pub use memory::{Bus, Cache, Channel, Client, Memory, MemoryBytes};
pub use pictures::{Difference, LargestError, LeastQuality, Picture, PictureQuality};
pub use run::{Cycles, Input, Outcome, OutcomeKind, Report, Size};
pub(crate) use sensitivity::PERCENT_PER_DB;
pub use sensitivity::{ComesTo, Measure, MeasureChange, ParameterChange, Sensitivity};
pub use timing::{
    ALWAYS_HITS, Bottlenecks, CriticalPath, FULLY_PIPELINED, Fifo, IDEAL_MEMORY, NO_DISPLAY, PathPart, PathPolygon, PathPolygons,
    RelaxedCycles, RelaxedSet, UNBOUNDED_FIFO, Unit,
};
