//! The simulator behind the page: questions in, answers out, no file system, no clock, no thread. What it needs of a server while it
//! answers, it asks of the page ([`Outside`]).
//!
//! The page ([web/](../../../web)) runs this crate in a worker, as WebAssembly. A question is JSON, with the files that it brings
//! behind it; an answer is JSON, with the pictures behind it ([`Parcel`]). Whoever asks holds a [`Desk`], which keeps what the next
//! question is likely to need: the model, its exact pictures, how far the machine's were from them.
//!
//! ```
//! use basrelief_web::{Desk, Parcel};
//! use serde_json::json;
//!
//! let mut desk = Desk::default();
//! let ask = |desk: &mut Desk, question| desk.answer(&Parcel::of(question).into_bytes());
//! ask(&mut desk, json!({"ask": "demo", "name": "cut-plane@1"}));
//! let run = json!({"ask": "run", "machine": "shade", "set": [["lanes", "4"]], "view": {"size": [32, 24]}});
//! let answer = Parcel::read(&ask(&mut desk, run)).unwrap();
//! assert!(answer.json["error"].as_str().unwrap().contains("unknown parameter `lanes`"));
//! ```

#[cfg(target_arch = "wasm32")]
mod abi;
mod ask;
mod command;
mod desk;
mod outside;
mod parcel;
mod path;
mod shown;

pub use desk::Desk;
pub use outside::{Got, Outside};
pub use parcel::Parcel;
