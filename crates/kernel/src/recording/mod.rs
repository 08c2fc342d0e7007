//! The tape: the work of a run, step by step and stage by stage, without any time. From it every time follows again, under other
//! FIFOs, memories and caches (laws 3 and 6: what a step does depends on no time).
//!
//! A stage's steps are one stream of bytes. Steps that take, keep, deliver and ask the same - all but the addresses - are of one
//! *class*; there are places for 255 of them at a time, and a step of a class that has its place is a byte, followed by its
//! addresses, each as the difference from the last one of its client; of look-ups each line once. Streams come in [reels](RecordingChunk): a piece of each, as the run
//! goes on, so that nobody need hold them whole.

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
