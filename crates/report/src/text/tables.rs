//! The tables by name, each with a caption that states its units and totals.

use super::table::Table;
use super::{bottlenecks, costs, display, hardware, sections, sensitivity};
use crate::model::{Report, Sensitivity};
use crate::number::thousands;
use crate::work;

/// Tables that belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableGroup {
    /// Cycles saved when one resource is relaxed.
    Bottlenecks,
    /// Cycle breakdown of each unit.
    Units,
    /// Occupancy of each FIFO.
    Fifos,
    /// Traffic of memory clients and utilization of channels.
    Memories,
    /// Hits and misses of each cache.
    Caches,
    /// Cycles per object and polygon.
    Costs,
    /// Effect of each assumed parameter.
    Sensitivity,
    /// Routes, circuits, processes and lists that only some machines have.
    Machine,
    /// Hardware by kind.
    Hardware,
    /// Counts of the machine.
    Figures,
    /// Quality of each picture.
    Quality,
    /// Figures derived from the counts.
    Derived,
}

impl TableGroup {
    /// All, in the order in which they are shown.
    pub const ALL: [Self; 12] = [
        Self::Bottlenecks,
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

    /// Name in `--tables`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bottlenecks => "bottlenecks",
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

    /// Description for `--help`.
    pub fn about(self) -> &'static str {
        match self {
            Self::Bottlenecks => "Cycles saved when one resource is relaxed",
            Self::Units => "Cycle breakdown of each unit",
            Self::Fifos => "Occupancy of each FIFO",
            Self::Memories => "Traffic of memory clients and utilization of channels",
            Self::Caches => "Hits and misses of each cache",
            Self::Costs => "Cycles per object and polygon (needs --costs)",
            Self::Sensitivity => "Effect of each assumed parameter (needs --sensitivity)",
            Self::Machine => "Routes, circuits, processes and lists that only some machines have",
            Self::Hardware => "Hardware by kind",
            Self::Figures => "Counts of the machine",
            Self::Quality => "Quality of each image against the reference image",
            Self::Derived => "Figures derived from the counts",
        }
    }

    /// Returns a note about a table without rows, which names the option that makes the table; `None` if the report has rows.
    pub fn absence(self, report: &Report) -> Option<String> {
        let has_time = report.cycles.is_some();
        let cure = match self {
            _ if !self.of(report).is_empty() => return None,
            Self::Quality => "it needs the reference image, so omit --no-exact",
            Self::Machine | Self::Hardware | Self::Figures => "the machine has nothing to list there",
            Self::Costs if has_time => "a run with --costs has it",
            Self::Sensitivity if has_time && report.outcome.is_complete() => "a run with --sensitivity has it",
            Self::Bottlenecks if has_time && report.outcome.is_complete() => {
                "--bottlenecks makes it, unless a warning says why not"
            }
            Self::Bottlenecks | Self::Sensitivity if has_time => "only complete runs have it",
            _ if has_time => "the run has nothing to list there",
            Self::Costs => "a run with --costs, without --functional, has it",
            Self::Sensitivity => "a run with --sensitivity, without --functional, has it",
            _ => "omit --functional to have it",
        };
        Some(format!("this run has no table `{}`; {cure}", self.name()))
    }

    /// Tables with rows, each with its caption.
    pub(crate) fn of(self, report: &Report) -> Vec<(String, Table)> {
        let captioned = |caption: String, table: Table| if table.is_empty() { vec![] } else { vec![(caption, table)] };
        let plain = |table| captioned(String::new(), table);
        match self {
            Self::Bottlenecks => {
                let caption = in_frames(report, "measured by resimulation; % of render cycles", &[]);
                let ladder = format!("{caption}; each row adds to the rows above it");
                [captioned(ladder, bottlenecks::ladder_table(report)), captioned(caption, bottlenecks::table(report))].concat()
            }
            Self::Units => {
                let cycles = report.breakdown_cycles();
                let of = if cycles == report.frame_cycles() { "render cycles" } else { "all cycles of the run" };
                let caption = format!("% of {of} ({}){}", thousands(cycles), tokens_of(report));
                captioned(if report.cycles.is_some() { caption } else { String::new() }, sections::units(report))
            }
            Self::Fifos => captioned(in_frames(report, "over render cycles", &filled_behind(report)), sections::fifos(report)),
            Self::Memories => {
                let total = report.cycles.as_ref().map_or(0, |cycles| cycles.total);
                let caption = format!("whole run, {} cycles; queue wait in cycles per burst", thousands(total));
                let channels = format!("{caption}; bus %: all channels, over render cycles");
                let shown = "scan-out and flips; flip latency in cycles; bus %: of all channels".to_owned();
                [
                    captioned(caption, sections::memories(report)),
                    captioned(channels, sections::channels(report)),
                    captioned(shown, display::display(report)),
                ]
                .concat()
            }
            Self::Caches => captioned("whole run; % of lookups".into(), sections::caches(report)),
            Self::Costs => {
                let all = report.costs.as_ref().map_or(0, |costs| costs.unit_cycles);
                let caption = format!("% of the cycles of all units ({})", thousands(all));
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

/// Table of changes, then table of failures.
fn sensitivity_tables(of: &Sensitivity) -> Vec<(String, Table)> {
    let tables = [(sensitivity::caption(of), sensitivity::changes(of)), (String::new(), sensitivity::failed(of))];
    tables.into_iter().filter(|(_, table)| !table.is_empty()).collect()
}

/// Caption with the render cycles, and the names of rows that cover all cycles of the run instead.
fn in_frames(report: &Report, what: &str, others: &[&str]) -> String {
    let Some(cycles) = &report.cycles else { return String::new() };
    let rest = if others.is_empty() {
        String::new()
    } else {
        format!("; {}: of all {} cycles", others.join(", "), thousands(cycles.total))
    };
    format!("{what} ({}){rest}", thousands(report.frame_cycles()))
}

/// States the work behind the tokens: a token may hold several fragments, or none.
fn tokens_of(report: &Report) -> String {
    let work = work::work(report);
    let all = format!("; a token holds several {}s or is control: {} {}s in all", work.one, thousands(work.count), work.one);
    if work.count > 0 { all } else { String::new() }
}

/// Returns the FIFOs that held tokens at some time after the last frame.
fn filled_behind(report: &Report) -> Vec<&str> {
    let drain = report.drain();
    let empty = |histogram: &[u64]| histogram.first().copied().unwrap_or(0);
    let fifos = report.fifos.iter().flatten().filter(|(_, fifo)| empty(&fifo.histogram) < drain);
    fifos.map(|(name, _)| name.as_str()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    #[test]
    fn absent_table_names_its_option() {
        let note = |report: &Report, table: TableGroup| table.absence(report).unwrap_or_default();
        let report = samples::balanced();
        assert_eq!(note(&report, TableGroup::Units), "");
        assert_eq!(note(&report, TableGroup::Costs), "this run has no table `costs`; a run with --costs has it");
        let functional = samples::functional();
        assert_eq!(note(&functional, TableGroup::Fifos), "this run has no table `fifos`; omit --functional to have it");
        let words = "this run has no table `costs`; a run with --costs, without --functional, has it";
        assert_eq!(note(&functional, TableGroup::Costs), words);
        let words = "this run has no table `bottlenecks`; only complete runs have it";
        assert_eq!(note(&samples::deadlocked(), TableGroup::Bottlenecks), words);
    }
}
