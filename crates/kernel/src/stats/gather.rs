//! Collection of the statistics of a machine.

use super::{SlowFifo, UnitStats};
use crate::client::Client;
use crate::hardware::Hardware;
use crate::machine::{Machine, Visitor};
use crate::wires::Wires;
use crate::{BoundStage, MemorySystem, Unit};

impl UnitStats {
    /// Reports the FIFOs that a unit fills: those of known width, and those that its rates make slow.
    fn report_fifos(&mut self, unit: &str, outputs: &dyn Wires) {
        for link in (0..outputs.count()).map(|i| outputs.link(i)).filter(|link| link.bits() > 0) {
            self.hardware.push(Hardware::of_fifo(link.name(), link.depth() as u64, link.bits(), link.latency()));
        }
        for rate in std::mem::take(&mut self.rates) {
            assert!(rate.output < outputs.count(), "{unit} tells the rate of output {}", rate.output);
            self.slow_fifos.extend(SlowFifo::of(outputs.link(rate.output), rate));
        }
    }

    /// Reports the caches, then the requests in flight of every port. A periodic client has no credits. Requests that control one have no
    /// data.
    fn report_ports(&mut self, memories: &MemorySystem) {
        let caches = memories.clients().iter().filter_map(|client| client.cache.as_ref());
        self.hardware.extend(caches.flat_map(|cache| Hardware::of_cache(&cache.name, &cache.config)));
        for Client { port, cache, control, .. } in memories.clients().iter().filter(|client| !client.is_periodic) {
            let burst = memories.memories()[port.memory].burst_bytes;
            let data = cache.as_ref().map_or(burst, |cache| cache.config.line_bytes);
            let [lines, requests] = Hardware::of_port(&port.name, port.outstanding(), data);
            self.hardware.extend(control.is_none().then_some(lines).into_iter().chain([requests]));
        }
    }
}

/// Collects the statistics of every unit of a machine. Call it after a run, not during one, because some statistics take a while.
pub fn unit_stats(machine: &mut impl Machine) -> UnitStats {
    struct StatsVisitor(UnitStats);
    impl Visitor for StatsVisitor {
        fn stage<P: BoundStage>(&mut self, mut place: P) {
            let (stage, connections) = place.open();
            self.0.place = stage.name().into();
            stage.unit.report_stats(&mut self.0);
            self.0.report_fifos(stage.name(), &connections.outputs);
        }
    }
    let mut gather = StatsVisitor(UnitStats::default());
    machine.wire(&mut gather);
    gather.0.report_ports(machine.memories());
    gather.0
}
