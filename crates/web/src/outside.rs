//! What the simulator asks of the page while it answers.

use std::fmt::Debug;

/// What has come from the server that the page comes from.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Got {
    /// Status of the answer.
    pub status: u16,
    /// Its ETag.
    pub tag: String,
    /// Its body.
    pub body: Vec<u8>,
}

/// The page around the simulator.
pub trait Outside: Debug {
    /// Gets what is at an address, relative to the page; `fresh`: not what the browser has kept.
    ///
    /// # Errors
    /// A sentence, where no answer has come.
    fn get(&self, address: &str, fresh: bool) -> Result<Got, String>;

    /// Shows a picture that a better one follows, as a [`Parcel`](crate::Parcel).
    fn show(&self, picture: Vec<u8>);
}
