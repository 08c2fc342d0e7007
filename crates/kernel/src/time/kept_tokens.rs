//! Delivered tokens of a FIFO, for probes and critical paths.

use crate::Cycle;

/// The delivery of a token whose producer has memory clients.
#[derive(Clone, Copy, Debug)]
pub(super) struct AnsweredDelivery {
    pub(super) at: Cycle,
    /// Memory client, as the producer numbers it, that gave the step its last answer; of equally late ones the first. Meaningless if
    /// the step waited for no answer.
    pub(super) last_client: u8,
}

/// The kept tokens of a FIFO.
#[derive(Clone, Debug, Default)]
pub(super) struct KeptTokens {
    /// For each token the first cycle in which it can be popped.
    pub(super) visible: Vec<Cycle>,
    /// Their deliveries; empty if the producer has no memory client.
    pub(super) deliveries: Vec<AnsweredDelivery>,
}
