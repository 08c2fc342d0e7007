//! Recordings: the work of a run, step by step and stage by stage, without times. All times can be computed again from it, under
//! other FIFOs, memories and caches (laws 3 and 6: the work of a step does not depend on time).
//!
//! The steps of a stage are one stream of bytes. Steps that are equal in demand, times, outputs and requests - in
//! everything except addresses - form a *class*. Work after data and blocking are optional fields, so recordings without them have the
//! bytes of earlier versions. Up to 255 classes have a place at a time. A step of such a class is one byte,
//! followed by its addresses, each as the difference from the last address of its client. Look-ups list each line once. Streams
//! come in [chunks](RecordingChunk) as the run goes on, so no program needs to hold them whole.

mod bytes;
mod chunk;
mod decoded;
mod read;
mod step_class;
mod write;

pub use bytes::RecordingError;
pub use chunk::RecordingChunk;
pub(crate) use read::RecordingReader;
pub(crate) use write::RecordingWriter;
