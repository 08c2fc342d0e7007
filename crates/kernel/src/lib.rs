//! Time, FIFOs, memories, engines and cycle accounting.

mod account;
mod cache;
mod config;
pub mod contract;
mod cycle;
mod engine;
mod fifo;
mod link;
mod memory;
mod memory_system;
mod occupancy;
pub mod plan;
mod probe;
mod report;
mod stage;
mod topology;
pub mod traffic;
pub mod unit;
mod wiring;

pub use account::{Account, Cause};
pub use cache::CacheCounts;
pub use config::{CacheConfig, FifoConfig, MemoryConfig};
pub use cycle::Cycle;
pub use engine::{Engine, Limits, run, run_functional, run_with};
pub use fifo::Fifo;
pub use link::Link;
pub use memory::PortCounts;
pub use memory_system::MemorySystem;
pub use probe::{Interval, NoProbe, Probe, Recorder};
pub use report::{CacheReport, FifoReport, MemoryReport, Outcome, PortReport, RunReport, UnitReport};
pub use stage::Stage;
pub use topology::{StageTopology, topology};
pub use traffic::{Request, Traffic};
pub use unit::{Demand, Step, Unit};
pub use wiring::{Clients, Inputs, MAX_CLIENTS, MAX_LINKS, Machine, Outputs, Visitor, Wires};

pub(crate) use stage::Clock;
