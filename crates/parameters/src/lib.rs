//! Parameters of the machines, declared in tables that hold every property of each parameter.
//!
//! A unit declares its configuration once, with [`parameters!`]. The struct, its defaults, its range checks, the lines of `basrelief
//! describe`, the JSON schema and the nearest-name hint for a mistyped key follow from that declaration. No property of a parameter
//! is written twice.
//!
//! ```
//! use basrelief_parameters::{parameters, Parameters};
//!
//! parameters! {
//!     /// A divider.
//!     pub struct DividerConfig {
//!         /// Cycles from operand to quotient.
//!         latency: u32 = 16, unit: "cycles", Assumed("iterative radix-4"), range: 1..=1024;
//!         /// A new division may start every cycle.
//!         pipelined: bool = false, unit: "", Assumed("the smaller circuit");
//!     }
//! }
//!
//! let table = DividerConfig::table();
//! assert_eq!(table[0].key, "latency");
//! assert_eq!(table[0].unit, "cycles");
//! let config: DividerConfig = basrelief_parameters::load("", &[("latency", "32")]).unwrap();
//! assert_eq!(config.latency, 32);
//! let error = basrelief_parameters::load::<DividerConfig>("", &[("latincy", "32")]).unwrap_err();
//! assert!(error.to_string().contains("did you mean `latency`"));
//! ```

mod error;
mod fields;
mod json;
mod load;
#[doc(hidden)]
pub mod private;
mod settings;
mod suggestion;
mod table;
mod toml_fault;
mod user_settings;

pub use error::{ConfigError, RangeError};
pub use fields::{Field, FieldMut, Fields, ParameterValue, from_json, to_json};
pub use json::ReportConfig;
pub use load::{Loader, is_given, load};
pub use strsim::osa_distance as edit_distance;
pub use suggestion::nearest;
pub use table::{Effect, Parameter, Parameters, Provenance, as_option, resolved, value_of};
pub use toml_fault::{FieldPositions, TomlFault};
pub use user_settings::UserSettings;

/// Tests the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
