//! The report as it stands in `report.json`: plain data. Fields have a fixed order; maps have the order of the block diagram.

pub mod costs;
mod figures;
mod host;
mod memory;
mod pictures;
mod run;
pub mod sensitivity;
mod timing;

pub use costs::{Costs, ObjectCost, Others, PolygonCost, Spent};
pub use figures::{Derived, Figure, Hardware, Legend, Part};
pub use host::{Host, RealPath};
pub use memory::{Bus, Cache, Channel, Client, Memory};
pub use pictures::{Difference, Picture, PictureQuality};
pub use run::{Cycles, Input, Outcome, OutcomeKind, Report, Size};
pub use sensitivity::{Change, ComesTo, Measure, Moved, Sensitivity};
pub use timing::{CriticalPath, FULLY_PIPELINED, Fifo, Limit, PathPart, PathPolygon, PathPolygons, UNBOUNDED_FIFO, Unit};
