//! Service of a memory with periodic clients (law 4).
//!
//! Their requests are known in advance, so no horizon waits for them. They are taken in only as far as requests of units need it:
//! between two requests of units nothing depends on them. [`Memory::finish_periodic`] takes in the rest at the end of a run.
//!
//! Engines take in different numbers of these requests ahead of time, but must count the same. So a memory has an *end*: the total of the
//! run, or the last data or flip of a unit if that is later, at a limit of cycles. All reads that arrive before the end count, and all bursts
//! whose column command is before it. Nothing at or after a [known lower bound](Memory::known_end) of the end is taken in or served
//! during the run.

use super::Memory;
use crate::Cycle;
use crate::client::Client;
use crate::periodic::{LateData, PeriodicControl};
use crate::port::{ArrivedRequest, Completion, Port};

/// Bursts of a read in one channel.
struct ChannelPart {
    channel: usize,
    /// Numbers of its first and last burst.
    bursts: (u64, u64),
    count: u64,
}

/// Times that bound the service of reads.
#[derive(Clone, Copy, Debug)]
struct ReadBounds {
    /// No later request of a unit arrives before this cycle, and no known one that is not split.
    units: Cycle,
    /// Lower bound of the end of the memory.
    end: Cycle,
}

impl Memory {
    /// As [`Memory::serve`], for a memory with periodic clients. Their reads are taken in one by one, as long as a request of a unit
    /// waits.
    pub(super) fn serve_among_periodic(&mut self, clients: &mut [Client], horizon: Cycle) -> bool {
        let waiting = (self.arrived, self.bursts);
        loop {
            let read = self.next_read();
            // Requests of units precede a read of the same cycle.
            let next = self.split_units(clients, horizon.min(read + 1));
            let end = self.known_end(next);
            self.serve_needed(clients, horizon.min(read), end);
            if self.is_idle() || read >= horizon {
                break;
            }
            // A request of a unit waits that arrives later than the read, or has its column command later.
            self.take_reads(clients, ReadBounds { units: horizon.min(next), end });
        }
        self.count_late_data(self.data_end);
        (self.arrived, self.bursts) != waiting
    }

    /// Takes in the reads that arrive before the end of a run of `total` cycles, and serves the bursts whose column command is before it.
    /// Does nothing if requests of units wait, because the run was stopped then.
    pub(crate) fn finish_periodic(&mut self, clients: &mut [Client], total: Cycle) {
        if self.periodic.is_empty() || !self.is_idle() {
            return;
        }
        let end = total.max(self.known_end(Cycle::UNKNOWN));
        loop {
            let read = self.next_read();
            self.serve_needed(clients, read, end);
            if read >= end {
                break;
            }
            self.take_reads(clients, ReadBounds { units: end, end });
            self.count_late_data(end);
        }
        self.count_late_data(end);
        self.periodic.iter_mut().for_each(|periodic| periodic.end(end));
        for LateData { channel, from, to } in std::mem::take(&mut self.late_data) {
            self.channels[channel].overrun += to.since(from.max(end));
            if from < end {
                self.bus.count_transfer(from, end);
            }
        }
    }

    /// Returns the arrival of the next read of a periodic client; unknown if there is none.
    fn next_read(&self) -> Cycle {
        self.periodic.iter().map(|periodic| periodic.next.0).min().unwrap_or(Cycle::UNKNOWN)
    }

    /// Returns a lower bound of the end of the memory. `next`: arrival of the next known request of a unit.
    fn known_end(&self, next: Cycle) -> Cycle {
        let arrival = if next.is_known() { next + 1 } else { Cycle::ZERO };
        self.data_end.max(self.last_control).max(arrival)
    }

    /// Splits the requests of units that arrived before `until`, in order. Returns the arrival of the next one; unknown if none is known.
    fn split_units(&mut self, clients: &mut [Client], until: Cycle) -> Cycle {
        while self.arrived > 0 {
            let Some((client, first, second)) = self.first_ports(clients) else { break };
            if first >= until {
                return first;
            }
            let until = until.min(second);
            match clients[client].control {
                None => self.split_from(client, &mut clients[client].port, until),
                Some((place, control)) => self.control(&mut clients[client].port, place, control, until),
            }
        }
        Cycle::UNKNOWN
    }

    /// Serves the choices that are final, given that all later requests arrive at `until` or later. In a channel without bursts of units it
    /// serves bursts with a column command before `end` only.
    fn serve_needed(&mut self, clients: &mut [Client], until: Cycle, end: Cycle) {
        for channel in 0..self.channels.len() {
            while self.channels[channel].has_units() || self.channels[channel].next_column().is_some_and(|column| column < end) {
                let Some(served) = self.channels[channel].serve(until) else { break };
                self.moved(channel, clients, served, end);
            }
        }
    }

    /// Takes in the next read of a periodic client, and further ones before any request of a unit as long as no burst waits.
    fn take_reads(&mut self, clients: &mut [Client], bounds: ReadBounds) {
        loop {
            let Some(periodic) = self.periodic.iter_mut().min_by_key(|periodic| periodic.next.0) else { return };
            let until = if bounds.units.is_known() { bounds.units } else { periodic.next.0 + 1 };
            let (client, bytes) = (periodic.client, periodic.reads.bytes);
            let (arrival, address) = periodic.pass(until);
            let next = self.next_read();
            if let Some(address) = address {
                // Bursts at the first view of a later burst, or before it, go first.
                let until = bounds.end.min(next.min(bounds.units) + 2);
                let read = ArrivedRequest { arrival, address, bytes, write: false };
                self.read(client, &mut clients[client].port, read, ReadBounds { units: until, ..bounds });
            }
            if next >= bounds.units || self.bursts + self.periodic_bursts > 0 {
                return;
            }
        }
    }

    /// Takes in a read of a periodic client. Serves it if no burst waits and its column commands are before `bounds.units`.
    fn read(&mut self, client: usize, port: &mut Port, r: ArrivedRequest, bounds: ReadBounds) {
        port.issue(r.arrival, r.address, r.bytes, r.write);
        let Some((request, r, (first, last))) = port.split(r.arrival + 1, self.burst) else { return };
        if self.notes_arrivals {
            self.note_arrival(client, port, &r, first, last);
        }
        let Some(by) = self.piece else {
            return (first..=last).for_each(|number| self.push_periodic(number, client, request, &r));
        };
        let pieces = (by.split(first).0, by.split(last).0);
        for piece in pieces.0..=pieces.1.min(pieces.0 + self.channels_by.by - 1) {
            let part = self.part_of(piece, pieces.1, by.by, (first, last));
            if self.read_at_once(client, port, request, &r, &part, bounds) {
                continue;
            }
            for piece in (piece..=pieces.1).step_by(self.channels.len()) {
                let bursts = part.bursts.0.max(piece * by.by)..=part.bursts.1.min(piece * by.by + by.by - 1);
                bursts.for_each(|number| self.push_periodic(number, client, request, &r));
            }
        }
    }

    /// Returns the part of a read that lies in the channel of `piece`, its first piece there of `by` bursts. `last`: last piece of the read.
    fn part_of(&self, piece: u64, last: u64, by: u64, bursts: (u64, u64)) -> ChannelPart {
        let (more, _) = self.channels_by.split(last - piece);
        let end = piece + more * self.channels_by.by;
        let (low, high) = (piece * by, end * by + by - 1);
        let bursts = (bursts.0.max(low), bursts.1.min(high));
        let count = (more + 1) * by - (bursts.0 - low) - (high - bursts.1);
        ChannelPart { channel: self.channels_by.split(piece).1 as usize, bursts, count }
    }

    /// Serves a part of a read if all of its column commands are before `bounds.units`, no burst waits in its channel, and it lies in one
    /// row. Returns false otherwise, or if its bursts are recorded.
    fn read_at_once(
        &mut self,
        client: usize,
        port: &mut Port,
        request: u64,
        r: &ArrivedRequest,
        part: &ChannelPart,
        bounds: ReadBounds,
    ) -> bool {
        if self.notes_periodic {
            return false;
        }
        let burst = self.burst_at(part.bursts.0, client, request, r);
        let last = self.burst_at(part.bursts.1, client, request, r);
        if (burst.bank, burst.row) != (last.bank, last.row) {
            return false;
        }
        let Some(run) = self.channels[part.channel].serve_run(&burst, part.count, bounds.units) else { return false };
        port.counts.rows.count(run.row);
        port.counts.rows.hits += part.count - 1;
        port.counts.queue_wait += run.queued - part.count;
        self.count_data(LateData { channel: part.channel, from: run.data.0, to: run.data.1 }, bounds.end);
        port.moved(request, part.count, run.data.1);
        true
    }

    /// Appends a burst of a read to its channel.
    fn push_periodic(&mut self, number: u64, client: usize, request: u64, r: &ArrivedRequest) {
        let (channel, address) = self.place(number * self.burst.by);
        let burst = self.burst_in(address, client, request, r);
        self.channels[channel].push(burst);
        self.channels[channel].periodic += 1;
        self.periodic_bursts += 1;
    }

    /// Counts data of a periodic client that have moved by `end`, a lower bound of the end of the memory. Keeps later data for
    /// [`Memory::count_late_data`].
    #[inline]
    pub(super) fn count_data(&mut self, data: LateData, end: Cycle) {
        if data.to <= end {
            self.bus.count_transfer(data.from, data.to);
        } else {
            self.late_data.push(data);
        }
    }

    /// Counts the data of periodic clients that have moved by `end`.
    fn count_late_data(&mut self, end: Cycle) {
        let bus = &mut self.bus;
        self.late_data.retain(|data| {
            if data.to <= end {
                bus.count_transfer(data.from, data.to);
            }
            data.to > end
        });
    }

    /// Takes in the requests of a port that arrived before `until`. They control the periodic client at this place.
    fn control(&mut self, port: &mut Port, place: usize, control: PeriodicControl, until: Cycle) {
        while let Some((request, ArrivedRequest { arrival, address, .. })) = port.take_without_data(until) {
            self.arrived -= 1;
            self.last_control = self.last_control.max(arrival + 1);
            let held = self.periodic[place].control(control, arrival, address);
            let view = arrival + 1;
            let answer = held.max(view + self.least_latency);
            if let Some(in_flight) = port.notes.as_mut().and_then(|notes| notes.in_flight.as_mut()) {
                in_flight.up(arrival);
            }
            port.note(request, Completion { arrival, row: view, column: view, end: answer, answer: Cycle::UNKNOWN });
            port.moved(request, 1, answer);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Cycle, MemoryConfig, MemorySystem, PeriodicReads, Request};

    #[test]
    fn data_before_a_late_request_are_not_kept() {
        let mut system = MemorySystem::default();
        let config = MemoryConfig::default();
        let memory = system.add_memory("m", &config);
        let unit = system.add_client("u", memory, 4);
        // Each read crosses from one row to the next, so its bursts are served one by one.
        let base = u64::from(config.row_bytes) * u64::from(config.channels) - 32;
        system.add_periodic_client("v", memory, PeriodicReads { period: 200, bytes: 64, base, stride: 0, span: 1 });
        system.issue(unit, Cycle(1_000_000), &Request { client: 0, write: false, address: 0, bytes: 32 });
        system.serve_before(Cycle(2_000_000));
        let memory = &system.memories()[memory];
        assert_eq!(memory.arrived, 0);
        assert!(memory.late_data.capacity() < 100, "{} of 5,000 reads", memory.late_data.capacity());
    }
}
