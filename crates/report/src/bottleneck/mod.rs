//! What limits a run, in one sentence that follows from the accounting (law 9).
//!
//! The rule, in order:
//!
//! 1. A run that ended in a deadlock or a fault is limited by that; its message says where.
//! 2. Take the cycles of the frames: what is shown behind the last limits nothing. Of the units that have finished by then, take
//!    the one with the most busy cycles, the first in the block diagram among equals. If it was busy for at least
//!    [`BOTTLENECK`] of the cycles up to its last step, it is the bottleneck: whatever else waits, waits for it.
//!    Cycles after its last step are left out, since what is behind it drains then.
//! 3. Otherwise follow the waits from there. At each unit take the largest of its busy cycles and its waits:
//!    - *busy*: this unit limits the run most, though not alone;
//!    - *memory*: the memory behind that port does, by bandwidth or by latency, as its data bus tells;
//!    - *starved*: go on at the unit that fills that FIFO;
//!    - *blocked*: go on at the unit that empties that FIFO.
//!
//!    Coming back to a unit closes a circle: no unit is slow by itself, the FIFO between them is too short for the
//!    latency around it.
//!
//! A weighted walk (each unit hands its waits on in proportion, so that shares of blame sum to 100 %) was rejected: at
//! a saturated bottleneck it blames the units before and after it for cycles they could not have saved.

use crate::model::{OutcomeKind, Report, Unit};
use crate::number::{about, thousands};
use indexmap::IndexMap;

/// Busy share of the cycles up to its last step from which a unit is the bottleneck, whatever else waits.
pub const BOTTLENECK: f64 = 0.9;
/// Busy share of a data bus from which bandwidth, and not latency, is what a memory lacks.
pub const SATURATED_BUS: f64 = 0.7;
/// Share of a run after a unit's last step from which it is worth a word.
const LONG_DRAIN: f64 = 0.05;

/// What limits a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Limit {
    /// A functional run has no time.
    NoTime,
    /// Deadlock or fault.
    Ended,
    /// This unit.
    Unit(String),
    /// The memory behind this client.
    Memory(String),
    /// Units that wait for each other: the FIFOs on the way round.
    Circle(Vec<String>),
}

/// What limits a run, and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Blame {
    /// What.
    pub limit: Limit,
    /// One sentence, without line breaks.
    pub sentence: String,
}

/// Why a unit did not work, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wait<'a> {
    /// No token in this FIFO.
    Starved(&'a str),
    /// No slot in this FIFO.
    Blocked(&'a str),
    /// No credit or answer at this client.
    Memory(&'a str),
}

/// All waits of a unit with their cycles, in the order starved, blocked, memory.
pub fn waits(unit: &Unit) -> impl Iterator<Item = (Wait<'_>, u64)> {
    let starved = unit.starved.iter().map(|(f, &n)| (Wait::Starved(f), n));
    let blocked = unit.blocked.iter().map(|(f, &n)| (Wait::Blocked(f), n));
    let memory = unit.memory.iter().map(|(c, &n)| (Wait::Memory(c), n));
    starved.chain(blocked).chain(memory)
}

/// The unit's largest wait, the first among equals; `None` if it never waited.
pub fn largest_wait(unit: &Unit) -> Option<(Wait<'_>, u64)> {
    waits(unit).filter(|&(_, n)| n > 0).reduce(|best, w| if w.1 > best.1 { w } else { best })
}

/// What limits this run.
pub fn blame(report: &Report) -> Blame {
    let ended = |sentence: String| Blame { limit: Limit::Ended, sentence };
    let message = report.outcome.message.as_deref().unwrap_or("no message");
    let prefix = match report.outcome.kind {
        OutcomeKind::Deadlock => return ended(capital(message)),
        OutcomeKind::Fault => return ended(format!("The run failed: {message}")),
        OutcomeKind::Complete => String::new(),
        OutcomeKind::Limit => "The limit of cycles was reached; until then ".into(),
        OutcomeKind::Stopped => "The run was stopped; until then ".into(),
    };
    let (Some(units), Some(_)) = (&report.units, &report.cycles) else {
        let sentence = "A functional run has no time: nothing limits it.".into();
        return Blame { limit: Limit::NoTime, sentence };
    };
    let plan = Plan { report, units, total: report.frame_cycles(), drain: report.drain() };
    let (limit, sentence) = plan.limit();
    Blame { limit, sentence: prefix + &sentence }
}

fn capital(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |first| first.to_uppercase().chain(chars).collect())
}

/// The block diagram as the report shows it: a FIFO's producer lists it as an output, its consumer as an input.
struct Plan<'a> {
    report: &'a Report,
    units: &'a IndexMap<String, Unit>,
    /// Cycles of the frames.
    total: u64,
    /// Those behind the last, when what was drawn is shown.
    drain: u64,
}

type Named<'a> = (&'a str, &'a Unit);

impl<'a> Plan<'a> {
    fn limit(&self) -> (Limit, String) {
        let by_work =
            self.named().filter(|(_, u)| u.done >= self.drain).reduce(|best, u| if u.1.busy > best.1.busy { u } else { best });
        let Some(busiest) = by_work.filter(|(_, u)| u.busy > 0) else {
            return (Limit::Ended, "no unit made a step.".into());
        };
        if self.busy_share(busiest.1) >= BOTTLENECK {
            return self.bottleneck(busiest);
        }
        let mut path = vec![busiest];
        loop {
            let Some(&(name, unit)) = path.last() else { return self.most(busiest) };
            let next = match largest_wait(unit).filter(|&(_, n)| n > unit.busy) {
                None => return self.most((name, unit)),
                Some((Wait::Memory(client), n)) => return self.memory((name, unit), client, n),
                Some((Wait::Starved(fifo), _)) => self.producer(fifo),
                Some((Wait::Blocked(fifo), _)) => self.consumer(fifo),
            };
            let Some(next) = next else { return self.most((name, unit)) };
            if let Some(first) = path.iter().position(|&(n, _)| n == next.0) {
                return self.circle(path.get(first..).unwrap_or(&path));
            }
            path.push(next);
        }
    }

    fn named(&self) -> impl Iterator<Item = Named<'a>> + use<'a> {
        self.units.iter().map(|(name, unit)| (name.as_str(), unit))
    }

    fn producer(&self, fifo: &str) -> Option<Named<'a>> {
        self.named().find(|(_, u)| u.blocked.contains_key(fifo))
    }

    fn consumer(&self, fifo: &str) -> Option<Named<'a>> {
        self.named().find(|(_, u)| u.starved.contains_key(fifo))
    }

    fn busy_share(&self, unit: &Unit) -> f64 {
        let active = self.total.saturating_sub(self.done(unit));
        if active == 0 { 0.0 } else { unit.busy as f64 / active as f64 }
    }

    /// Cycles of the frames after its last step.
    fn done(&self, unit: &Unit) -> u64 {
        unit.done.saturating_sub(self.drain)
    }

    fn of_total(&self, cycles: u64) -> String {
        about(if self.total == 0 { 0.0 } else { cycles as f64 / self.total as f64 })
    }

    /// Whether the cycles after its last step are worth a word.
    fn drains(&self, unit: &Unit) -> bool {
        self.done(unit) as f64 >= LONG_DRAIN * self.total as f64
    }

    fn bottleneck(&self, (name, unit): Named<'a>) -> (Limit, String) {
        let drains = self.drains(unit);
        let up_to = if drains { " up to its last step" } else { "" };
        let busy = about(self.busy_share(unit));
        let mut sentence =
            format!("{} limits this run: busy {busy} of the cycles{up_to}{}", label(name, unit), self.victim(name));
        if drains {
            sentence += &format!("; the last {} of the run drain what is behind it", self.of_total(self.done(unit)));
        }
        (Limit::Unit(name.into()), sentence + ".")
    }

    fn most(&self, (name, unit): Named<'a>) -> (Limit, String) {
        let busy = about(self.busy_share(unit));
        let own = largest_wait(unit).map_or(String::new(), |(wait, n)| {
            let what = match wait {
                Wait::Starved(fifo) => format!("for a token from {fifo}"),
                Wait::Blocked(fifo) => format!("for a slot in {fifo}"),
                Wait::Memory(client) => format!("for port {client}"),
            };
            format!("; it waits {what} {} of the time", self.of_total(n))
        });
        let up_to = if self.drains(unit) { " up to its last step" } else { "" };
        let sentence = format!(
            "{} limits this run most, though not alone: busy {busy} of the cycles{up_to}{}{own}.",
            label(name, unit),
            self.victim(name)
        );
        (Limit::Unit(name.into()), sentence)
    }

    /// The neighbour that waits most for `name`, as a clause; empty if none does. Blocked ones come first: back-pressure
    /// shows that work was there and had to wait, starvation only that there was none.
    fn victim(&self, name: &str) -> String {
        let caused = |how: &'static str| {
            let all = self.named().filter(move |&(n, _)| n != name).flat_map(waits_of);
            let by = move |wait: Wait<'_>| match wait {
                Wait::Starved(fifo) if how == "starved" => self.producer(fifo),
                Wait::Blocked(fifo) if how == "blocked" => self.consumer(fifo),
                _ => None,
            };
            let ours = all.filter(move |&(_, wait, n)| n > 0 && by(wait).is_some_and(|(by, _)| by == name));
            ours.map(move |(victim, _, n)| (victim, how, n)).reduce(|best, c| if c.2 > best.2 { c } else { best })
        };
        caused("blocked")
            .or_else(|| caused("starved"))
            .map_or(String::new(), |(victim, how, n)| format!("; {victim} is {how} by it {} of the time", self.of_total(n)))
    }

    fn memory(&self, (name, unit): Named<'a>, client: &str, cycles: u64) -> (Limit, String) {
        let memory = self.report.memories.iter().flatten().find(|(_, m)| m.clients.contains_key(client));
        let memory = memory.map_or("behind it", |(name, _)| name.as_str());
        let bus = self.report.derived.get(&format!("{memory}.bus_utilisation")).map_or(String::new(), |bus| {
            let share = about(bus.value);
            if bus.value >= SATURATED_BUS {
                format!("; its data bus is busy {share}: bandwidth")
            } else {
                format!("; its data bus is busy only {share}: latency, not bandwidth")
            }
        });
        let sentence = format!(
            "memory {memory} limits this run: {} waits for its port {client} {} of the cycles{bus}.",
            label(name, unit),
            self.of_total(cycles)
        );
        (Limit::Memory(client.into()), sentence)
    }

    fn circle(&self, path: &[Named<'a>]) -> (Limit, String) {
        let waits = path.iter().filter_map(|&(name, unit)| {
            largest_wait(unit).and_then(|(wait, n)| match wait {
                Wait::Starved(fifo) => Some((fifo, format!("{name} for a token from {fifo} {}", self.of_total(n)))),
                Wait::Blocked(fifo) => Some((fifo, format!("{name} for a slot in {fifo} {}", self.of_total(n)))),
                Wait::Memory(_) => None,
            })
        });
        let (mut fifos, texts): (Vec<String>, Vec<String>) = waits.map(|(fifo, text)| (fifo.to_owned(), text)).unzip();
        fifos.sort();
        fifos.dedup();
        let depths = fifos.iter().map(|f| self.depth(f)).collect::<Vec<_>>().join(", ");
        let sentence = format!(
            "a circle of waits limits this run: {} of the cycles; no unit is slow by itself, more slots may help ({depths}).",
            texts.join(", ")
        );
        (Limit::Circle(fifos), sentence)
    }

    /// Slots of a FIFO, as the parameter that sets them, where it has one of its own.
    fn depth(&self, fifo: &str) -> String {
        let depth = self.report.fifos.as_ref().and_then(|all| all.get(fifo)).map_or(0, |f| f.depth);
        let own = self.report.config.get("fifo").is_none_or(|fifos| fifos.get(fifo).is_some());
        if own { format!("fifo.{fifo}.depth = {}", thousands(depth)) } else { format!("{fifo} has {}", thousands(depth)) }
    }
}

fn waits_of<'a>((name, unit): Named<'a>) -> impl Iterator<Item = (&'a str, Wait<'a>, u64)> {
    waits(unit).map(move |(wait, n)| (name, wait, n))
}

fn label(name: &str, unit: &Unit) -> String {
    unit.numeral.map_or(name.into(), |n| format!("{name} ({n})"))
}

#[cfg(test)]
mod tests;
