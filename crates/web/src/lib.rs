//! The simulator of the web page: it maps questions to answers without file system, clock or threads. During an answer it fetches
//! data of a server through the page ([`HostPage`]).
//!
//! The page ([web/](../../../web)) runs this crate in a worker, as WebAssembly. A question is JSON followed by its files. An
//! answer is JSON followed by its pictures ([`Message`]). The caller owns a [`SimulationService`], which caches data for the next question: the
//! model, its reference images, and the measured differences from them.
//!
//! ```
//! use basrelief_web::{SimulationService, Message};
//! use serde_json::json;
//!
//! let mut service = SimulationService::default();
//! let ask = |service: &mut SimulationService, question| service.answer(&Message::from_json(question).into_bytes());
//! ask(&mut service, json!({"ask": "demo", "name": "cut-plane@1"}));
//! let run = json!({"ask": "run", "machine": "shade", "set": [["lanes", "4"]], "view": {"size": [32, 24]}});
//! let answer = Message::read(&ask(&mut service, run)).unwrap();
//! assert!(answer.json["error"].as_str().unwrap().contains("unknown parameter `lanes`"));
//! ```

#[cfg(target_arch = "wasm32")]
mod abi;
mod command;
mod comparison;
mod connection;
mod draft;
mod host_page;
mod loaded_input;
mod message;
mod render_result;
mod request;
mod service;
mod tiles;

pub use host_page::{HostPage, PageResponse};
pub use message::Message;
pub use service::SimulationService;
