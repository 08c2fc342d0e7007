//! Outputs of a run other than its report: auxiliary outputs, charts, memory requests, PNG files, assets of the HTML page, traces, and
//! expectations.
//!
//! Each machine lists its [auxiliary outputs](aux_spec::AuxOutputSpec): a name, a form, and a function that makes the output from an
//! entry of the machine's log. A run makes only the outputs that its options select, and passes them to the observer.

pub(crate) mod aux_output;
pub(crate) mod aux_spec;
pub(crate) mod charts;
pub(crate) mod cost_maps;
pub(crate) mod defer;
pub(crate) mod expectation;
mod heat_map;
mod lettering;
pub(crate) mod page_assets;
pub(crate) mod png;
pub(crate) mod recorded_trace;
pub(crate) mod request_log;
pub(crate) mod steps;
pub(crate) mod texel;
mod tile_lines;
mod tile_pictures;
