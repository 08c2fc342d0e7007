//! Collection of the statistics of a machine.

use super::{SlowFifo, UnitStats};
use crate::client::Client;
use crate::connections::Clients;
use crate::hardware::Hardware;
use crate::machine::{Machine, Visitor};
use crate::periodic::PeriodicClient;
use crate::wires::Wires;
use crate::{BoundStage, MemorySystem, Unit};
use std::collections::BTreeSet;

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

    /// Reports the caches, then the requests in flight of every port, of the `used` clients. Requests that control a periodic client have
    /// no data. Last come the periodic clients that read.
    fn report_ports(&mut self, memories: &MemorySystem, used: &BTreeSet<usize>) {
        let clients = || used.iter().map(|&client| &memories.clients()[client]);
        let caches = clients().filter_map(|client| client.cache.as_ref());
        self.hardware.extend(caches.flat_map(|cache| Hardware::of_cache(&cache.name, &cache.config)));
        for Client { port, cache, control, .. } in clients() {
            let burst = memories.memories()[port.memory].burst_bytes;
            let data = cache.as_ref().map_or(burst, |cache| cache.config.line_bytes);
            let [lines, requests] = Hardware::of_port(&port.name, port.outstanding(), data);
            self.hardware.extend(control.is_none().then_some(lines).into_iter().chain([requests]));
        }
        for memory in memories.memories() {
            let reading = memory.periodic.iter().filter(|client| client.reads.bytes > 0);
            self.hardware.extend(reading.map(|PeriodicClient { client, reads, .. }| {
                Hardware::of_periodic_client(memories.client_name(*client), reads.bytes, memory.burst_bytes)
            }));
        }
    }
}

/// Collects statistics stage by stage.
#[derive(Default)]
struct StatsVisitor {
    stats: UnitStats,
    /// Memory clients of which a step can need credits. The others have no hardware.
    used: BTreeSet<usize>,
}

impl Visitor for StatsVisitor {
    fn stage<P: BoundStage>(&mut self, mut place: P) {
        let (stage, connections) = place.open();
        self.stats.place = stage.name().into();
        stage.unit.report_stats(&mut self.stats);
        self.stats.report_fifos(stage.name(), &connections.outputs);
        let clients = connections.clients.ids().iter().enumerate();
        self.used.extend(clients.filter(|&(place, _)| stage.unit.largest_step(place) > 0).map(|(_, id)| id));
    }
}

/// Collects the statistics of every unit of a machine. Call it after a run, not during one, because some statistics take a while.
pub fn unit_stats(machine: &mut impl Machine) -> UnitStats {
    let mut visitor = StatsVisitor::default();
    machine.wire(&mut visitor);
    visitor.stats.report_ports(machine.memories(), &visitor.used);
    visitor.stats
}
