//! Clients of memories.

use crate::cache::Cache;
use crate::diagram::ClientTopology;
use crate::periodic::PeriodicControl;
use crate::port::Port;

/// A client: a port, with or without a cache in front of it, of a unit or periodic.
#[derive(Clone, Debug)]
pub(crate) struct Client {
    pub(crate) port: Port,
    pub(crate) cache: Option<Cache>,
    /// True if it belongs to no unit and issues its requests by itself.
    pub(crate) is_periodic: bool,
    /// If its requests control a periodic client: the place of that client in its memory, and their effect.
    pub(crate) control: Option<(usize, PeriodicControl)>,
}

impl Client {
    /// Describes the client for probes; `stages` use it.
    pub(crate) fn topology(&self, stages: Vec<usize>) -> ClientTopology {
        let Self { port, cache, .. } = self;
        let cache = cache.as_ref().map(|cache| cache.name.clone());
        ClientTopology { name: port.name.clone(), memory: port.memory, stages, credits: port.outstanding(), cache }
    }
}
