//! The path: I/O port (104), network (106), bus (108).

use crate::config::PathConfig;
use crate::tokens::{EncodedTile, ResponseContent, TileResponse};
use basrelief_kernel::stats::UnitStats;
use basrelief_kernel::{Demand, HardwareKind, MemoryPorts, Step, Unit};
use basrelief_signals::Control;
use serde::{Deserialize, Serialize};

/// Counters of the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PathCounters {
    /// Bytes transferred.
    pub bytes: u64,
}

/// State of the path between steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PathState {
    /// Fraction of a cycle left by the last transfer \[bit cycles per second\].
    pub left: u128,
    /// Counters.
    pub counters: PathCounters,
}

/// Path (104, 106, 108): a bit rate, and a latency from a request to its answer.
///
/// A transfer occupies the path for its bytes at its rate. The remainder of a division carries over, so that no rounding error
/// accumulates. A tile arrives one latency after its transfer. The number of tiles in flight is therefore the number of slots of
/// the FIFO behind the path (law 2): the requests in flight times the tiles of each. The polygons arrive as one answer: only the
/// first of them waits for the latency.
#[derive(Clone, Debug)]
pub struct Path {
    bits_per_second: u128,
    hz: u128,
    latency: u64,
    /// Tiles in flight, and bytes of the largest tile.
    receives: [u32; 2],
    /// State between steps.
    pub state: PathState,
}

impl Path {
    /// Creates a path for a device with a clock of `hz` that accepts tiles of up to `tile_bytes`.
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

    /// Returns the occupancy of the path by this many bytes \[cycles\].
    fn carry(&mut self, bytes: u64) -> u64 {
        self.state.counters.bytes += bytes;
        self.state.left += u128::from(bytes) * 8 * self.hz;
        let cycles = self.state.left / self.bits_per_second;
        self.state.left %= self.bits_per_second;
        u64::try_from(cycles).unwrap_or(u64::MAX)
    }
}

impl Unit for Path {
    basrelief_kernel::unit_info!("network (106), I/O port (104), bus (108): rate, latency");
    type In = Option<TileResponse>;
    type Out = (Option<Control>, Option<EncodedTile>);

    fn demand(&self) -> Demand {
        Demand::All
    }

    fn step(&mut self, parcel: Option<TileResponse>, _: &mut MemoryPorts) -> Step<Self::Out> {
        let Some(TileResponse { bytes, content }) = parcel else { return Step::after(0, (None, None)) };
        let carried = self.carry(bytes);
        match content {
            ResponseContent::Asked(control) => Step::during(carried.saturating_add(self.latency), 0, (Some(control), None)),
            ResponseContent::Mesh(control) => Step::during(carried, 0, (Some(control), None)),
            ResponseContent::Tile(tile) => Step::during(carried, self.latency, (None, Some(tile))),
        }
    }

    fn report_stats(&self, stats: &mut UnitStats) {
        stats.figure("path_bytes", self.state.counters.bytes, "bytes", "Bytes over the path");
        let [tiles, bytes] = self.receives;
        stats.hardware(HardwareKind::Table, "receive buffer of the I/O port (104): tiles", tiles, 8 * bytes);
    }
}
