//! Service of a memory with periodic clients (law 4).
//!
//! Their requests are known in advance, so no horizon waits for them. They are taken in only as far as requests of units need it:
//! between two requests of units nothing depends on them. [`Memory::finish_periodic`] takes in the rest at the end of a run.

use super::Memory;
use crate::Cycle;
use crate::client::Client;
use crate::periodic::{FlipTiming, LateData};
use crate::port::{Completion, Port};

impl Memory {
    /// As [`Memory::serve`], for a memory with periodic clients. Requests and column commands are taken in order of time, as long
    /// as a request of a unit waits.
    pub(super) fn serve_among_periodic(&mut self, clients: &mut [Client], horizon: Cycle) -> bool {
        let waiting = (self.arrived, self.bursts);
        if self.periodic_bursts == 0 {
            self.serve_before_periodic(clients, horizon);
        }
        while !self.is_idle()
            && let Some(next) = self.next_event(clients)
            && next <= horizon + 1
        {
            // A request that arrives in the cycle before `next` comes into view at `next`, where older bursts go first. So the steps
            // of this loop do not depend on the horizon.
            self.serve_up_to(clients, next);
            if next > horizon || self.is_idle() {
                break;
            }
            self.split_in_order(clients, next);
            self.serve_up_to(clients, next);
        }
        self.count_data(self.data_end);
        (self.arrived, self.bursts) != waiting
    }

    /// Serves the final choices up to the next request of a periodic client. No burst of such a client may wait.
    fn serve_before_periodic(&mut self, clients: &mut [Client], horizon: Cycle) {
        let arrivals = self.periodic.iter().map(|periodic| periodic.next.0);
        let until = arrivals.min().map_or(horizon, |arrival| arrival.min(horizon));
        self.split_in_order(clients, until);
        for channel in 0..self.channels.len() {
            while let Some(served) = self.channels[channel].serve(until) {
                self.moved(channel, clients, served);
            }
        }
    }

    /// Takes in the periodic requests that arrive before the end of a run of `total` cycles, and serves the bursts whose column
    /// command is before it. Does nothing if requests of units wait, because the run was stopped then.
    pub(crate) fn finish_periodic(&mut self, clients: &mut [Client], total: Cycle) {
        if self.periodic.is_empty() || !self.is_idle() {
            return;
        }
        while let Some(next) = self.next_event(clients)
            && next < total
        {
            self.serve_up_to(clients, next);
            self.split_in_order(clients, next);
            self.serve_up_to(clients, next);
        }
        self.split_in_order(clients, total);
        self.count_data(total);
        self.periodic.iter_mut().for_each(|periodic| periodic.end(total));
        for LateData { channel, from, to } in std::mem::take(&mut self.late_data) {
            self.channels[channel].overrun += to.since(from.max(total));
            if from < total {
                self.bus.count_transfer(from, total);
            }
        }
    }

    /// Counts the data of periodic clients that have moved by `until`, a lower bound of the end of the run.
    fn count_data(&mut self, until: Cycle) {
        let bus = &mut self.bus;
        self.late_data.retain(|&LateData { from, to, .. }| {
            let is_late = to > until;
            if !is_late {
                bus.count_transfer(from, to);
            }
            is_late
        });
    }

    /// Returns a lower bound of the next column command; `None` if there is nothing to serve.
    fn next_event(&mut self, clients: &[Client]) -> Option<Cycle> {
        let columns = self.channels.iter_mut().filter_map(|channel| channel.next_column());
        let users = self.ports.iter().filter_map(|&port| clients[port].port.next_arrival());
        let periodic = self.periodic.iter().map(|periodic| periodic.next.0).filter(|arrival| arrival.is_known());
        let arrivals = users.chain(periodic);
        columns.chain(arrivals.map(|arrival| arrival + 1)).min()
    }

    /// Serves the bursts whose column command is at `next` or before. `next` is a lower bound of the next column command, so these
    /// choices are final.
    fn serve_up_to(&mut self, clients: &mut [Client], next: Cycle) {
        for channel in 0..self.channels.len() {
            while self.channels[channel].next_column().is_some_and(|column| column <= next)
                && let Some(served) = self.channels[channel].serve(Cycle::UNKNOWN)
            {
                self.moved(channel, clients, served);
            }
        }
    }

    /// Splits the requests that arrived before `horizon`, in order of (arrival, port number, issue). Periodic clients have the last
    /// port numbers.
    fn split_in_order(&mut self, clients: &mut [Client], horizon: Cycle) {
        loop {
            let user = self.next_port(clients, horizon);
            let periodic = self.periodic.iter_mut().min_by_key(|periodic| periodic.next.0);
            let first = periodic.as_ref().map_or(Cycle::UNKNOWN, |periodic| periodic.next.0);
            if let Some((client, until)) = user
                && clients[client].port.next_arrival().is_some_and(|arrival| arrival <= first)
            {
                let until = until.min(first + 1);
                match clients[client].flips {
                    None => self.split_from(client, &mut clients[client].port, until),
                    Some(flips) => self.flip(&mut clients[client].port, flips, until),
                }
            } else if let Some(periodic) = periodic.filter(|_| first < horizon) {
                let (client, bytes) = (periodic.client, periodic.reads.bytes);
                if let (arrival, Some(address)) = periodic.pass() {
                    self.read(client, &mut clients[client].port, arrival, (address, bytes));
                }
            } else {
                return;
            }
        }
    }

    /// Takes in a read of a periodic client.
    fn read(&mut self, client: usize, port: &mut Port, arrival: Cycle, (address, bytes): (u64, u32)) {
        port.issue(arrival, address, bytes, false);
        // Only the requests and bursts of units are counted as waiting.
        let waiting = self.bursts;
        self.arrived += 1;
        self.split_from(client, port, arrival + 1);
        self.periodic_bursts += self.bursts - waiting;
        self.bursts = waiting;
    }

    /// Takes in the flips of a port that arrived before `until`. They flip the periodic client at this place.
    fn flip(&mut self, port: &mut Port, (place, timing): (usize, FlipTiming), until: Cycle) {
        while let Some((request, r, (first, last))) = port.split(until, self.burst) {
            self.arrived -= 1;
            // A flip moves no data.
            let counts = &mut port.counts;
            *(if r.write { &mut counts.write_bytes } else { &mut counts.read_bytes }) -= u64::from(r.bytes);
            let held = self.periodic[place].flip(timing, r.arrival, r.address);
            let view = r.arrival + 1;
            let answer = held.max(view + self.least_latency);
            if let Some(in_flight) = port.notes.as_mut().and_then(|notes| notes.in_flight.as_mut()) {
                in_flight.up(r.arrival);
            }
            port.note(request, Completion { arrival: r.arrival, row: view, column: view, end: answer, answer: Cycle::UNKNOWN });
            (first..=last).for_each(|_| port.moved(request, answer));
        }
    }
}
