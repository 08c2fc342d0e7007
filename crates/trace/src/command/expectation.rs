//! Results that a trace expects of a machine.

use super::fields::fields;
use crate::data::Digest;
use crate::parameter_value::ParameterValue;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Bytes moved by one client of a memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ExpectedTraffic {
    /// Bytes read.
    pub read_bytes: u64,
    /// Bytes written.
    pub write_bytes: u64,
}

/// Maximum number of expectations of a trace. `verify` replays the trace for each.
pub const MAX_EXPECTATIONS: usize = 64;

fields! {
    /// Expected results of a machine: replaying the trace is a test. Missing fields are not checked.
    pub struct ExpectedResults {} optional {
        /// Machine, such as `bump`.
        machine: Option<String>,
        /// Settings other than the defaults, by dotted name.
        config: BTreeMap<String, ParameterValue>,
        /// Total \[cycles\].
        cycles: Option<u64>,
        /// Render cycles of each frame.
        frames: Vec<u64>,
        /// Bytes by memory and client.
        memories: BTreeMap<String, BTreeMap<String, ExpectedTraffic>>,
        /// Digests of the RGB8 rows of each picture, in order of time.
        images: Vec<Digest>,
    }
}

impl Default for ExpectedResults {
    /// Expects nothing.
    fn default() -> Self {
        Self {
            machine: None,
            config: BTreeMap::new(),
            cycles: None,
            frames: Vec::new(),
            memories: BTreeMap::new(),
            images: Vec::new(),
        }
    }
}

impl ExpectedResults {
    /// Returns true if no result is expected. A machine and its settings are no results.
    pub fn is_empty(&self) -> bool {
        let traffic = self.memories.values().all(BTreeMap::is_empty);
        self.cycles.is_none() && self.frames.is_empty() && self.images.is_empty() && traffic
    }

    /// Returns the approximate memory \[bytes\]: the share of a map node per entry, and the capacity of texts.
    pub(crate) fn bytes(&self) -> u64 {
        const PLACE: usize = 160;
        let settings = self.config.iter().map(|(name, value)| PLACE + name.len() + value.bytes());
        let clients = |(name, clients): (&String, &BTreeMap<String, _>)| {
            let own = clients.keys().map(|client| PLACE + client.len());
            4 * PLACE + name.len() + own.sum::<usize>()
        };
        let lists = size_of_val(&*self.frames) + size_of_val(&*self.images) + self.machine.as_ref().map_or(0, String::len);
        let maps = settings.sum::<usize>() + self.memories.iter().map(clients).sum::<usize>();
        (size_of::<Self>() + 2 * lists + maps) as u64
    }
}
