//! Attribution: assigns each step to a frame, object, polygon and pixels.

mod flow;
mod origin;
mod polygon_index;
mod probe;

pub(crate) use flow::{FlowEvents, StepTokens, TokenFlow};
pub use origin::TokenSample;
pub(crate) use origin::{PolygonNumbers, TokenOrigin};
pub use probe::{AttributionProbe, last_stage};
