//! The tape: the work of a run, step by step and stage by stage, without any time. From it every time follows again, under other
//! FIFOs, memories and caches (laws 3 and 6: what a step does depends on no time).
//!
//! A stage's steps are one stream of bytes. Steps that take, keep, deliver and ask the same - all but the addresses - are of one
//! *class*; there are places for 255 of them at a time, and a step of a class that has its place is a byte, followed by its
//! addresses, each as the difference from the last one of its client; of look-ups each line once. Streams come in [reels](Reel): a piece of each, as the run
//! goes on, so that nobody need hold them whole.

mod ahead;
mod bytes;
mod class;
mod read;
mod reel;
mod write;

pub use bytes::TapeError;
pub(crate) use read::Reader;
pub use reel::Reel;
pub(crate) use write::Writer;
