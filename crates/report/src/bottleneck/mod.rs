//! The bottleneck of a run, in a few sentences that follow from the cycle accounting (law 9).
//!
//! The rule, in order:
//!
//! 1. A run that ended in a deadlock or a fault has no other bottleneck; its message names the place.
//! 2. Consider render cycles only: the tail limits nothing. Take the units that finish with the last frame, and of these the
//!    unit with the most busy cycles; of equal ones the first in the block diagram. If it was busy for at least [`BOTTLENECK`] of the
//!    cycles up to its last step, it is the bottleneck. Cycles after its last step do not count, because the units behind it drain
//!    then.
//! 3. Otherwise follow the stalls from that unit. At each unit take the largest of its busy cycles and its stalls:
//!    - *busy*: this unit is the main bottleneck;
//!    - *memory*: the memory of that port is the bottleneck, by bandwidth or by latency, depending on its data bus; or the display, if
//!      the requests of that port wait for its refresh;
//!    - *starved*: continue at the producer of that FIFO;
//!    - *blocked*: continue at the consumer of that FIFO.
//!
//!    A path that returns to a unit is a circle: no unit is slow by itself, and the FIFO between them is too short for the latency of
//!    the circle.
//!
//! A weighted walk, in which each unit passes its stalls on in proportion so that all shares sum to 100 %, was rejected: at a saturated
//! bottleneck it blames the units before and after it for cycles that they cannot save.

use crate::model::{OutcomeKind, Report, Unit};
use crate::number::{percent_in_words, thousands};
use indexmap::IndexMap;

/// Busy share of the cycles up to its last step at which a unit counts as the bottleneck.
pub const BOTTLENECK: f64 = 0.9;
/// Busy share of a data bus at which bandwidth, not latency, limits a memory.
pub const SATURATED_BUS: f64 = 0.7;
/// Share of a run after the last step of a unit that the sentence mentions.
const LONG_DRAIN: f64 = 0.05;

/// Bottleneck of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum BottleneckKind {
    /// A functional run has no time.
    NoTime,
    /// Deadlock or fault.
    Ended,
    /// A unit.
    Unit(String),
    /// The memory of this client.
    Memory(String),
    /// The display, for which a unit waits through this client.
    Display(String),
    /// Units that wait for each other, with the FIFOs between them.
    Circle(Vec<String>),
}

/// Bottleneck of a run, in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnosis {
    /// Kind and name.
    pub limit: BottleneckKind,
    /// One sentence, without line breaks.
    pub sentence: String,
}

/// Cause of a stall, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stall<'a> {
    /// This input FIFO is empty.
    Starved(&'a str),
    /// This output FIFO is full.
    Blocked(&'a str),
    /// This memory client has no credit or no response.
    Memory(&'a str),
}

/// Returns all stalls of a unit with their cycles, in the order starved, blocked, memory.
pub fn stalls(unit: &Unit) -> impl Iterator<Item = (Stall<'_>, u64)> {
    let starved = unit.starved.iter().map(|(f, &n)| (Stall::Starved(f), n));
    let blocked = unit.blocked.iter().map(|(f, &n)| (Stall::Blocked(f), n));
    let memory = unit.memory.iter().map(|(c, &n)| (Stall::Memory(c), n));
    starved.chain(blocked).chain(memory)
}

/// Returns the largest stall of a unit, the first of equal ones. `None` if the unit never stalled.
pub fn largest_stall(unit: &Unit) -> Option<(Stall<'_>, u64)> {
    stalls(unit).filter(|&(_, n)| n > 0).reduce(|best, w| if w.1 > best.1 { w } else { best })
}

/// Finds the bottleneck of a run.
pub fn diagnose(report: &Report) -> Diagnosis {
    let ended = |sentence: String| Diagnosis { limit: BottleneckKind::Ended, sentence };
    let message = report.outcome.message.as_deref().unwrap_or("no message");
    let prefix = match report.outcome.kind {
        OutcomeKind::Deadlock => return ended(capitalized(message)),
        OutcomeKind::Fault => return ended(format!("The run failed: {message}")),
        OutcomeKind::Complete => String::new(),
        OutcomeKind::Limit => "The run reached its cycle limit. ".into(),
        OutcomeKind::Stopped => "The run was stopped early. ".into(),
    };
    let (Some(units), Some(_)) = (&report.units, &report.cycles) else {
        let sentence = "A functional run has no timing, so it has no bottleneck.".into();
        return Diagnosis { limit: BottleneckKind::NoTime, sentence };
    };
    let plan = StallSearch { report, units, total: report.frame_cycles(), drain: report.drain() };
    let (limit, sentence) = plan.find_bottleneck();
    Diagnosis { limit, sentence: prefix + &sentence }
}

fn capitalized(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |first| first.to_uppercase().chain(chars).collect())
}

/// The block diagram as the report shows it: a FIFO's producer lists it as an output, its consumer as an input.
struct StallSearch<'a> {
    report: &'a Report,
    units: &'a IndexMap<String, Unit>,
    /// Cycles of the frames.
    total: u64,
    /// Tail \[cycles\].
    drain: u64,
}

/// A unit with its name.
#[derive(Clone, Copy)]
struct NamedUnit<'a> {
    name: &'a str,
    unit: &'a Unit,
}

impl<'a> StallSearch<'a> {
    fn find_bottleneck(&self) -> (BottleneckKind, String) {
        let by_work = self
            .named_units()
            .filter(|named| named.unit.done >= self.drain)
            .reduce(|best, named| if named.unit.busy > best.unit.busy { named } else { best });
        let Some(busiest) = by_work.filter(|named| named.unit.busy > 0) else {
            return (BottleneckKind::Ended, "No unit made a step.".into());
        };
        if self.busy_share(busiest.unit) >= BOTTLENECK {
            return self.saturated_unit(busiest);
        }
        let mut path = vec![busiest];
        loop {
            let Some(&last) = path.last() else { return self.main_bottleneck(busiest) };
            let next = match largest_stall(last.unit).filter(|&(_, n)| n > last.unit.busy) {
                None => return self.main_bottleneck(last),
                Some((Stall::Memory(client), n)) => return self.memory_bottleneck(last, client, n),
                Some((Stall::Starved(fifo), _)) => self.producer(fifo),
                Some((Stall::Blocked(fifo), _)) => self.consumer(fifo),
            };
            let Some(next) = next else { return self.main_bottleneck(last) };
            if let Some(first) = path.iter().position(|named| named.name == next.name) {
                return self.waiting_circle(path.get(first..).unwrap_or(&path));
            }
            path.push(next);
        }
    }

    fn named_units(&self) -> impl Iterator<Item = NamedUnit<'a>> + use<'a> {
        self.units.iter().map(|(name, unit)| NamedUnit { name, unit })
    }

    fn producer(&self, fifo: &str) -> Option<NamedUnit<'a>> {
        self.named_units().find(|named| named.unit.blocked.contains_key(fifo))
    }

    fn consumer(&self, fifo: &str) -> Option<NamedUnit<'a>> {
        self.named_units().find(|named| named.unit.starved.contains_key(fifo))
    }

    fn busy_share(&self, unit: &Unit) -> f64 {
        let active = self.total.saturating_sub(self.cycles_after_last_step(unit));
        if active == 0 { 0.0 } else { unit.busy as f64 / active as f64 }
    }

    /// Cycles of the frames after its last step.
    fn cycles_after_last_step(&self, unit: &Unit) -> u64 {
        unit.done.saturating_sub(self.drain)
    }

    fn of_total(&self, cycles: u64) -> String {
        percent_in_words(if self.total == 0 { 0.0 } else { cycles as f64 / self.total as f64 })
    }

    /// True if the sentence mentions the cycles after the last step.
    fn ends_early(&self, unit: &Unit) -> bool {
        self.cycles_after_last_step(unit) as f64 >= LONG_DRAIN * self.total as f64
    }

    fn saturated_unit(&self, NamedUnit { name, unit }: NamedUnit<'a>) -> (BottleneckKind, String) {
        let drains = self.ends_early(unit);
        let up_to = if drains { " up to its last step" } else { "" };
        let busy = percent_in_words(self.busy_share(unit));
        let mut sentence =
            format!("Bottleneck: {}, busy {busy} of the cycles{up_to}.{}", label(name, unit), self.waiting_neighbour(name));
        if drains {
            sentence +=
                &format!(" The last {} of the run drain the units behind it.", self.of_total(self.cycles_after_last_step(unit)));
        }
        (BottleneckKind::Unit(name.into()), sentence)
    }

    fn main_bottleneck(&self, NamedUnit { name, unit }: NamedUnit<'a>) -> (BottleneckKind, String) {
        let busy = percent_in_words(self.busy_share(unit));
        let own = largest_stall(unit).map_or(String::new(), |(wait, n)| {
            let what = match wait {
                Stall::Starved(fifo) => format!("for a token from `{fifo}`"),
                Stall::Blocked(fifo) => format!("for a slot in `{fifo}`"),
                Stall::Memory(client) => format!("for port `{client}`"),
            };
            format!(" It waits {what} {} of the time.", self.of_total(n))
        });
        let up_to = if self.ends_early(unit) { " up to its last step" } else { "" };
        let sentence = format!(
            "Main bottleneck: {}, busy {busy} of the cycles{up_to}, so no unit is saturated.{}{own}",
            label(name, unit),
            self.waiting_neighbour(name)
        );
        (BottleneckKind::Unit(name.into()), sentence)
    }

    /// Returns a sentence about the neighbour that waits most for `name`; empty if none waits. Blocked neighbours come first: backpressure
    /// shows that work was ready, starvation only that there was none.
    fn waiting_neighbour(&self, name: &str) -> String {
        let caused = |how: &'static str| {
            let all = self.named_units().filter(move |named| named.name != name).flat_map(stalls_of);
            let by = move |wait: Stall<'_>| match wait {
                Stall::Starved(fifo) if how == "starved" => self.producer(fifo),
                Stall::Blocked(fifo) if how == "blocked" => self.consumer(fifo),
                _ => None,
            };
            let ours = all.filter(move |&(_, wait, n)| n > 0 && by(wait).is_some_and(|by| by.name == name));
            ours.map(move |(victim, _, n)| (victim, how, n)).reduce(|best, c| if c.2 > best.2 { c } else { best })
        };
        let largest = caused("blocked").or_else(|| caused("starved"));
        largest.map_or(String::new(), |(victim, how, n)| format!(" `{victim}` is {how} by it {} of the time.", self.of_total(n)))
    }

    fn memory_bottleneck(&self, NamedUnit { name, unit }: NamedUnit<'a>, client: &str, cycles: u64) -> (BottleneckKind, String) {
        let memory = self.report.memories.iter().flatten().find(|(_, m)| m.clients.contains_key(client));
        if memory.is_some_and(|(_, memory)| memory.clients[client].waits_for_display()) {
            let (unit, share) = (label(name, unit), self.of_total(cycles));
            let sentence = format!("Bottleneck: the display. {unit} waits for its refresh {share} of the cycles.");
            return (BottleneckKind::Display(client.into()), sentence);
        }
        let memory = memory.map_or("behind it", |(name, _)| name.as_str());
        let bus = self.report.derived.get(&format!("{memory}.bus_utilization")).map_or(String::new(), |bus| {
            let share = percent_in_words(bus.value);
            if bus.value >= SATURATED_BUS {
                format!(" Its data bus is busy {share}: bandwidth is the limit.")
            } else {
                format!(" Its data bus is busy only {share}: latency is the limit, not bandwidth.")
            }
        });
        let sentence = format!(
            "Bottleneck: memory `{memory}`. {} waits for its port `{client}` {} of the cycles.{bus}",
            label(name, unit),
            self.of_total(cycles)
        );
        (BottleneckKind::Memory(client.into()), sentence)
    }

    fn waiting_circle(&self, path: &[NamedUnit<'a>]) -> (BottleneckKind, String) {
        let waits = path.iter().filter_map(|NamedUnit { name, unit }| {
            largest_stall(unit).and_then(|(wait, n)| match wait {
                Stall::Starved(fifo) => Some((fifo, format!("`{name}` waits {} for a token from `{fifo}`", self.of_total(n)))),
                Stall::Blocked(fifo) => Some((fifo, format!("`{name}` waits {} for a slot in `{fifo}`", self.of_total(n)))),
                Stall::Memory(_) => None,
            })
        });
        let (mut fifos, texts): (Vec<String>, Vec<String>) = waits.map(|(fifo, text)| (fifo.to_owned(), text)).unzip();
        fifos.sort();
        fifos.dedup();
        let depths = fifos.iter().map(|f| self.depth(f)).collect::<Vec<_>>().join(", ");
        let sentence = format!(
            "Bottleneck: units that wait for each other. Of the cycles, {}. No unit is slow by itself; more FIFO slots may help \
             ({depths}).",
            texts.join(", ")
        );
        (BottleneckKind::Circle(fifos), sentence)
    }

    /// Slots of a FIFO, as the parameter that sets them, where it has one of its own.
    fn depth(&self, fifo: &str) -> String {
        let depth = self.report.fifos.as_ref().and_then(|all| all.get(fifo)).map_or(0, |f| f.depth);
        let own = self.report.config.get("fifo").is_none_or(|fifos| fifos.get(fifo).is_some());
        if own { format!("fifo.{fifo}.depth = {}", thousands(depth)) } else { format!("{fifo} has {}", thousands(depth)) }
    }
}

fn stalls_of<'a>(NamedUnit { name, unit }: NamedUnit<'a>) -> impl Iterator<Item = (&'a str, Stall<'a>, u64)> {
    stalls(unit).map(move |(wait, n)| (name, wait, n))
}

fn label(name: &str, unit: &Unit) -> String {
    unit.numeral.map_or(format!("`{name}`"), |n| format!("`{name}` ({n})"))
}

#[cfg(test)]
mod tests;
