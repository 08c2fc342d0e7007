//! The machines: wiring and configuration, nothing else.
//!
//! | machine | device | block diagram |
//! |---|---|---|
//! | [`bump`] | Sony's quantized bump-mapping processor | [`bump::BumpProcessor`] |

pub mod bump;
mod counts;

pub use counts::Counts;

use basrelief_kernel::{Fifo, FifoConfig};

/// A FIFO as configured.
fn fifo<T>(name: &str, config: &FifoConfig) -> Fifo<T> {
    Fifo::new(name, config.depth as usize, u64::from(config.latency))
}
