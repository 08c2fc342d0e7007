//! The path: I/O port (104), network (106), bus (108).

use crate::config::PathConfig;
use crate::tokens::{Content, EncodedTile, Parcel};
use basrelief_kernel::facts::Facts;
use basrelief_kernel::{Demand, HardwareKind, Step, Traffic, Unit};
use basrelief_signals::Control;
use serde::{Deserialize, Serialize};

/// What the path has counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PathCounters {
    /// Bytes carried.
    pub bytes: u64,
}

/// Everything the path remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PathState {
    /// What the last transfer left of a cycle \[bit cycles per second\].
    pub left: u128,
    /// What it has counted.
    pub counters: PathCounters,
}

/// The path (104, 106, 108): so many bits per second, and a latency from a request to its answer.
///
/// What it carries keeps it for its bytes at its rate; the remainder of a division is carried on, so that nothing is rounded
/// in the long run. A tile comes a latency later than the path lets it through; so there can be as many tiles in flight as the
/// FIFO behind it has slots (law 2), which are the requests in flight times the tiles of each. The polygons come as one answer: only the first of
/// them waits for the latency.
#[derive(Clone, Debug)]
pub struct Path {
    bits_per_second: u128,
    hz: u128,
    latency: u64,
    /// Tiles in flight, and bytes of the largest.
    receives: [u32; 2],
    /// Everything it remembers.
    pub state: PathState,
}

impl Path {
    /// A path seen from a device with a clock of `hz`, that takes tiles of up to `tile_bytes`.
    pub fn new(config: &PathConfig, hz: u64, tile_bytes: u32) -> Self {
        let latency = u64::try_from(u128::from(config.latency_us) * u128::from(hz) / 1_000_000).unwrap_or(u64::MAX);
        Self {
            bits_per_second: config.bits_per_second.into(),
            hz: hz.into(),
            latency,
            receives: [config.requests * config.tiles_per_request, tile_bytes],
            state: PathState::default(),
        }
    }

    /// Cycles that the path is kept by this many bytes.
    fn carry(&mut self, bytes: u64) -> u64 {
        self.state.counters.bytes += bytes;
        self.state.left += u128::from(bytes) * 8 * self.hz;
        let cycles = self.state.left / self.bits_per_second;
        self.state.left %= self.bits_per_second;
        u64::try_from(cycles).unwrap_or(u64::MAX)
    }
}

impl Unit for Path {
    basrelief_kernel::role!("network (106), I/O port (104), bus (108): rate, latency");
    type In = Option<Parcel>;
    type Out = (Option<Control>, Option<EncodedTile>);

    fn demand(&self) -> Demand {
        Demand::All
    }

    fn step(&mut self, parcel: Option<Parcel>, _: &mut Traffic) -> Step<Self::Out> {
        let Some(Parcel { bytes, content }) = parcel else { return Step::after(0, (None, None)) };
        let carried = self.carry(bytes);
        match content {
            Content::Asked(control) => {
                let cycles = carried.saturating_add(self.latency);
                Step::after(cycles, (Some(control), None)).busy(cycles.max(1))
            }
            Content::Mesh(control) => Step::after(carried, (Some(control), None)).busy(carried.max(1)),
            Content::Tile(tile) => {
                let latency = carried.saturating_add(self.latency);
                Step::after(latency, (None, Some(tile))).busy(carried.max(1))
            }
        }
    }

    fn tell(&self, facts: &mut Facts) {
        facts.figure("path_bytes", self.state.counters.bytes, "bytes", "What the path carried");
        let [tiles, bytes] = self.receives;
        facts.hardware(HardwareKind::Table, "receive buffer of the I/O port (104): tiles", tiles, 8 * bytes);
    }
}
