//! The simulator of the web page: it maps questions to answers without file system, clock or threads. During an answer it fetches
//! data of a server through the page ([`Outside`]).
//!
//! The page ([web/](../../../web)) runs this crate in a worker, as WebAssembly. A question is JSON followed by its files. An
//! answer is JSON followed by its pictures ([`Parcel`]). The caller owns a [`Desk`], which caches data for the next question: the
//! model, its exact pictures, and the measured differences from them.
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
