//! The tables by name, each with what its figures are shares of.

use super::table::Table;
use super::{bottlenecks, costs, hardware, sections, sensitivity};
use crate::model::{Report, Sensitivity};
use crate::number::thousands;
use crate::work;

/// Tables that belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tables {
    /// What it takes with one thing made ideal.
    Limits,
    /// Where the cycles of each unit went.
    Units,
    /// How full each FIFO was.
    Fifos,
    /// What clients moved, and how busy channels were.
    Memories,
    /// What look-ups found.
    Caches,
    /// Whom the cycles of the units were for.
    Costs,
    /// What each assumption moves.
    Sensitivity,
    /// Routes, circuits, processes and lists that only some machines have.
    Machine,
    /// What the machine is built of.
    Hardware,
    /// What the machine counted.
    Figures,
    /// Each picture against the exact one.
    Quality,
    /// What follows from the figures.
    Derived,
}

impl Tables {
    /// All, in the order in which they are shown.
    pub const ALL: [Self; 12] = [
        Self::Limits,
        Self::Units,
        Self::Fifos,
        Self::Memories,
        Self::Caches,
        Self::Costs,
        Self::Sensitivity,
        Self::Machine,
        Self::Hardware,
        Self::Figures,
        Self::Quality,
        Self::Derived,
    ];

    /// As one asks for them.
    pub fn name(self) -> &'static str {
        match self {
            Self::Limits => "limits",
            Self::Units => "units",
            Self::Fifos => "fifos",
            Self::Memories => "memories",
            Self::Caches => "caches",
            Self::Costs => "costs",
            Self::Sensitivity => "sensitivity",
            Self::Machine => "machine",
            Self::Hardware => "hardware",
            Self::Figures => "figures",
            Self::Quality => "quality",
            Self::Derived => "derived",
        }
    }

    /// What they tell, in a few words.
    pub fn about(self) -> &'static str {
        match self {
            Self::Limits => "What it takes with one thing made ideal",
            Self::Units => "Where the cycles of each unit went",
            Self::Fifos => "How full each FIFO was",
            Self::Memories => "What clients moved, and how busy channels were",
            Self::Caches => "What look-ups found",
            Self::Costs => "Whom the cycles of the units were for, of a run with --costs",
            Self::Sensitivity => "What each assumption moves, of a run with --sensitivity",
            Self::Machine => "Routes, circuits, processes and lists that only some machines have",
            Self::Hardware => "What the machine is built of, by kind",
            Self::Figures => "What the machine counted",
            Self::Quality => "Each picture against the exact one",
            Self::Derived => "What follows from the figures",
        }
    }

    /// The tables that have rows, each with a line that says what its shares and counts are of.
    pub(super) fn of(self, report: &Report) -> Vec<(String, Table)> {
        let captioned = |caption: String, table: Table| if table.is_empty() { vec![] } else { vec![(caption, table)] };
        let plain = |table| captioned(String::new(), table);
        match self {
            Self::Limits => captioned(in_frames(report, "cycles of the frames", &[]), bottlenecks::table(report)),
            Self::Units => {
                captioned(in_frames(report, "shares of the cycles of the frames", &working_on(report)), sections::units(report))
            }
            Self::Fifos => {
                captioned(in_frames(report, "in the cycles of the frames", &filled_behind(report)), sections::fifos(report))
            }
            Self::Memories => {
                let total = report.cycles.as_ref().map_or(0, |cycles| cycles.total);
                let caption = format!("of the whole run, {} cycles; waits in cycles", thousands(total));
                let channels = format!("{caption}; frames %: of all channels, in the cycles of the frames");
                [captioned(caption, sections::memories(report)), captioned(channels, sections::channels(report))].concat()
            }
            Self::Caches => captioned("of the whole run; shares of the look-ups".into(), sections::caches(report)),
            Self::Costs => {
                let all = report.costs.as_ref().map_or(0, |costs| costs.unit_cycles);
                let caption = format!("shares of the cycles of all units, {}", thousands(all));
                costs::tables(report).into_iter().flat_map(|table| captioned(caption.clone(), table)).collect()
            }
            Self::Sensitivity => report.sensitivity.iter().flat_map(sensitivity_tables).collect(),
            Self::Machine => {
                let own = [sections::routes(report), sections::circuits(report), sections::processes(report)];
                let lists = work::tables(report);
                own.into_iter().chain(lists.iter().map(sections::columns)).flat_map(plain).collect()
            }
            Self::Hardware => plain(hardware::totals(report)),
            Self::Figures => plain(sections::figures(report)),
            Self::Quality => plain(sections::quality(report)),
            Self::Derived => plain(sections::derived(report)),
        }
    }
}

/// What moves, then what came to no end.
fn sensitivity_tables(of: &Sensitivity) -> Vec<(String, Table)> {
    let tables = [(sensitivity::caption(of), sensitivity::changes(of)), (String::new(), sensitivity::failed(of))];
    tables.into_iter().filter(|(_, table)| !table.is_empty()).collect()
}

/// What a table is of, and names of what is told in all cycles of the run instead.
fn in_frames(report: &Report, what: &str, others: &[&str]) -> String {
    let Some(cycles) = &report.cycles else { return String::new() };
    let rest = if others.is_empty() {
        String::new()
    } else {
        format!("; {}: of the {} of the run", others.join(", "), thousands(cycles.total))
    };
    format!("{what}, {}{rest}", thousands(report.frame_cycles()))
}

/// Units that work on behind the last frame.
fn working_on(report: &Report) -> Vec<&str> {
    let units = report.units.iter().flatten().filter(|(_, unit)| report.drain() > 0 && report.drain_of(unit) == 0);
    units.map(|(name, _)| name.as_str()).collect()
}

/// FIFOs that were not empty all the time behind the last frame.
fn filled_behind(report: &Report) -> Vec<&str> {
    let drain = report.drain();
    let empty = |histogram: &[u64]| histogram.first().copied().unwrap_or(0);
    let fifos = report.fifos.iter().flatten().filter(|(_, fifo)| empty(&fifo.histogram) < drain);
    fifos.map(|(name, _)| name.as_str()).collect()
}
