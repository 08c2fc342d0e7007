//! The server: HTTP/1.1 over TCP with one thread per connection, fair to clients that compete for connections.

mod connections;
mod files;
mod group_hashes;
mod hosts;
pub(crate) mod http;
mod index;
pub(crate) mod listen;
mod scenes;
mod semaphore;

pub use files::StaticFiles;
pub use index::index_page;
pub use listen::{ListeningServer, ServerLimits};
pub use scenes::SceneService;
