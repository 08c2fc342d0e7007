//! Requests of the simulator to the page while it computes an answer.

use std::fmt::Debug;

/// Response of the page's server.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PageResponse {
    /// HTTP status.
    pub status: u16,
    /// ETag header.
    pub tag: String,
    /// Response body.
    pub body: Vec<u8>,
}

/// The page around the simulator.
pub trait HostPage: Debug {
    /// Fetches an address relative to the page. `fresh` bypasses the browser cache.
    ///
    /// # Errors
    /// If no response arrives.
    fn get(&self, address: &str, fresh: bool) -> Result<PageResponse, String>;

    /// Shows an intermediate picture, as a [`Message`](crate::Message).
    fn show(&self, picture: Vec<u8>);
}
