//! The bottleneck: a sentence, bars of the saved cycles, and the critical path.

use super::markup::{Html, details, el, el_text, sentence, text};
use super::svg::{BarPart, bar, percent_of};
use super::table::with_cells;
use super::units::legend;
use crate::model::{CriticalPath, PathPart, RelaxedCycles, Report};
use crate::number::thousands;
use crate::text::bottleneck_sentence;
use crate::text::bottlenecks::by_polygon;
use crate::text::table::Align::{Left, Right};

/// Parts of the critical path with a row of their own.
const TOLD: usize = 8;
/// Name of the other parts together.
const REST: &str = "rest";

/// The section. A functional run has only a sentence.
pub(super) fn bottleneck_section(report: &Report) -> Html {
    let lead = el("p", &[("class", "lead")], [sentence(&bottleneck_sentence(report))]);
    [lead, savings_table(report), path(report)].into_iter().collect()
}

/// Table of the cycles that each relaxation saves.
fn savings_table(report: &Report) -> Html {
    let Some(limits) = report.limits.as_ref().filter(|limits| !limits.is_empty()) else { return Html::default() };
    let total = report.frame_cycles();
    let columns =
        [("resource", Left), ("relaxation", Left), ("cycles saved", Left), ("", Right), ("share", Right), ("cycles left", Right)];
    let row = |limit: &RelaxedCycles| {
        let part: BarPart = ("amount", "saved".into(), limit.saved);
        let (saved, then) = (thousands(limit.saved), thousands(limit.cycles));
        vec![
            text(&limit.resource),
            text(&limit.what),
            bar(&[part], total),
            text(saved),
            text(percent_of(limit.saved, total)),
            text(then),
        ]
    };
    let caption = format!("Measured by resimulation, of {} render cycles", thousands(total));
    let table = with_cells(&caption, &columns, limits.iter().map(row).collect());
    let settings = limits.iter().map(|limit| {
        let set: String = limit.set.iter().map(|set| format!(" --set {set}")).collect();
        vec![text(format!("{}, {}", limit.resource, limit.what)), el_text("code", "", set.trim())]
    });
    let settings = with_cells("Options of a full run", &[("relaxation", Left), ("options", Left)], settings.collect());
    [el("div", &[("class", "bars")], [table]), details("Options to reproduce these", settings)].into_iter().collect()
}

/// The critical path as one bar; its longest parts numbered, with their meaning in a table.
fn path(report: &Report) -> Html {
    let Some(path) = &report.critical_path else { return Html::default() };
    let mut parts: Vec<(BarPart, String)> = path.parts.iter().take(TOLD).map(path_part).collect();
    let rest: u64 = path.parts.iter().skip(TOLD).fold(0, |sum, part| sum.saturating_add(part.cycles));
    if rest > 0 {
        let count = path.parts.len() - TOLD;
        parts.push((("done", REST.into(), rest), format!("{count} further parts together")));
    }
    let bars: Vec<BarPart> = parts.iter().map(|(part, _)| part.clone()).collect();
    let rows = parts.iter().map(|((class, name, n), about)| {
        let swatch = el("span", &[("class", &format!("swatch {class}")), ("aria-hidden", "true")], []);
        vec![[swatch, text(name)].into_iter().collect(), text(about), text(thousands(*n)), text(percent_of(*n, path.cycles))]
    });
    let columns = [("part", Left), ("meaning", Left), ("cycles", Right), ("share", Right)];
    let table = with_cells("Parts, longest first", &columns, rows.collect());
    let colours = [("busy", "a unit at work"), ("fifo", "a FIFO"), ("memory", "a memory"), ("done", "rest")];
    let bar = el("div", &[("class", "thick")], [bar(&bars, path.cycles)]);
    [el_text("h3", "", "Critical path"), el_text("p", "quiet", path_caption(path)), bar, legend(colours), table]
        .into_iter()
        .collect()
}

fn path_caption(path: &CriticalPath) -> String {
    let by_polygon = path.polygons.as_ref().map_or(String::new(), |polygons| by_polygon(polygons, path.cycles));
    format!(
        "Chain of work and stalls that ends with the last frame: {} cycles without gap or overlap. Other paths may \
         tie.{by_polygon}",
        thousands(path.cycles)
    )
}

/// A part of the path: its colour and its meaning.
fn path_part(PathPart { resource, what, cycles, .. }: &PathPart) -> (BarPart, String) {
    let (class, about) = match what.as_str() {
        "occupancy" => ("busy", "the unit is taken"),
        "latency" => ("busy", "from the start of a step to its result"),
        "FIFO" => ("fifo", "through the FIFO"),
        "slot" => ("fifo", "for a free slot of the FIFO"),
        "arrival" => ("memory", "of a request at its memory"),
        "bus" => ("memory", "the data bus is taken"),
        "bank" => ("memory", "the bank is not ready"),
        "data" => ("memory", "for the data"),
        "order" => ("memory", "for answers before it"),
        "cache" => ("memory", "for the cache"),
        _ => ("done", "in flight at the end"),
    };
    ((class, format!("{resource} {what}").trim().to_owned(), *cycles), about.to_owned())
}
