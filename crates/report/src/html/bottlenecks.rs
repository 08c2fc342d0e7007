//! The bottleneck: a sentence, the ladder, bars of the saved cycles, and the critical path.

use super::markup::{Html, breakable, details, el, el_text, sentence, text};
use super::svg::{BarPart, bar, labelled_bar, percent_of};
use super::table::with_cells;
use super::units::legend;
use crate::model::{CriticalPath, PathPart, RelaxedCycles, Report};
use crate::number::thousands;
use crate::text::bottleneck_sentence;
use crate::text::bottlenecks::{by_polygon, ladder};
use crate::text::table::Align::{Left, Right};
use crate::work::work;

/// Parts of the critical path with a row of their own.
const TOLD: usize = 8;
/// Name of the other parts together.
const REST: &str = "rest";

/// The section. A functional run has only a sentence.
pub(super) fn bottleneck_section(report: &Report) -> Html {
    let lead = el("p", &[("class", "lead")], [sentence(&bottleneck_sentence(report))]);
    [lead, waterfall(report), savings_table(report), path(report)].into_iter().collect()
}

/// The bottleneck ladder as a waterfall: on each rung the cycles left, and beside them the cycles that the rung saves.
fn waterfall(report: &Report) -> Html {
    let rows = ladder(report);
    let total = report.frame_cycles();
    let work = work(report).one;
    let rate = format!("{work}s per cycle");
    let columns = [("relaxed", Left), ("", Left), ("cycles left", Right), ("saved so far", Right), (rate.as_str(), Right)];
    let cells = rows.iter().map(|row| {
        let saved = row.before.saturating_sub(row.cycles);
        let parts: [BarPart; 2] = [("busy", "left".into(), row.cycles), ("amount", "saved by this rung".into(), saved)];
        let so_far = percent_of(total.saturating_sub(row.cycles), total);
        vec![breakable(row.name()), bar(&parts, total), text(thousands(row.cycles)), text(so_far), text(&row.rate)]
    });
    let table = with_cells("Bottleneck ladder: each rung adds to the rungs above it", &columns, cells.collect());
    let rungs = rows.iter().skip(1).map(|row| vec![breakable(row.name()), options(row.set)]);
    let sets = with_cells("Options of a full run", &[("rung", Left), ("options", Left)], rungs.collect());
    if rows.is_empty() {
        return Html::default();
    }
    let colours = [("busy", "cycles left"), ("amount", "saved by this rung")];
    [el("div", &[("class", "bars rungs")], [table]), legend(colours), details("Options to reproduce the ladder", sets)]
        .into_iter()
        .collect()
}

/// Settings as options of the command line.
fn options(set: &[String]) -> Html {
    el_text("code", "", set.iter().map(|set| format!("--set {set}")).collect::<Vec<_>>().join(" "))
}

/// The resource and its relaxation.
fn relaxed(limit: &RelaxedCycles) -> Html {
    [breakable(&limit.resource), el_text("span", "quiet", format!(" {}", limit.what))].into_iter().collect()
}

/// Table of the cycles that each relaxation saves.
fn savings_table(report: &Report) -> Html {
    let limits: &[RelaxedCycles] = report.bottlenecks.as_ref().map_or(&[], |of| &of.single);
    if limits.is_empty() {
        return Html::default();
    }
    let total = report.frame_cycles();
    let columns = [("relaxed", Left), ("", Left), ("cycles saved", Right), ("share", Right), ("cycles left", Right)];
    let row = |limit: &RelaxedCycles| {
        let part: BarPart = ("amount", "saved".into(), limit.saved);
        let (saved, then) = (thousands(limit.saved), thousands(limit.cycles));
        vec![relaxed(limit), bar(&[part], total), text(saved), text(percent_of(limit.saved, total)), text(then)]
    };
    let caption = format!("Measured by resimulation, of {} render cycles", thousands(total));
    let table = with_cells(&caption, &columns, limits.iter().map(row).collect());
    let settings = limits.iter().map(|limit| vec![relaxed(limit), options(&limit.set)]);
    let settings = with_cells("Options of a full run", &[("relaxation", Left), ("options", Left)], settings.collect());
    [el("div", &[("class", "bars")], [table]), details("Options to reproduce these", settings)].into_iter().collect()
}

/// Colours of resources on the critical path.
const HUES: [&str; TOLD] = ["hue-0", "hue-1", "hue-2", "hue-3", "hue-4", "hue-5", "hue-6", "hue-7"];

/// The critical path as one bar with a named segment per resource; its longest parts with their meaning in a table.
fn path(report: &Report) -> Html {
    let Some(path) = &report.critical_path else { return Html::default() };
    let mut resources: Vec<&str> = vec![];
    let mut parts: Vec<(BarPart, &str)> = vec![];
    for part in path.parts.iter().take(TOLD) {
        let known = resources.iter().position(|resource| *resource == part.resource);
        let at = known.unwrap_or(resources.len());
        if known.is_none() {
            resources.push(&part.resource);
        }
        parts.push(((HUES[at], format!("{} {}", part.resource, part.what).trim().to_owned(), part.cycles), meaning(part)));
    }
    let rest: u64 = path.parts.iter().skip(TOLD).fold(0, |sum, part| sum.saturating_add(part.cycles));
    if rest > 0 {
        parts.push((("done", REST.into(), rest), "all further parts together"));
    }
    let rows = parts.iter().map(|((class, name, n), about)| {
        let swatch = el("span", &[("class", &format!("swatch {class}")), ("aria-hidden", "true")], []);
        vec![[swatch, text(name)].into_iter().collect(), text(*about), text(thousands(*n)), text(percent_of(*n, path.cycles))]
    });
    let columns = [("part", Left), ("meaning", Left), ("cycles", Right), ("share", Right)];
    let table = with_cells("Parts, longest first; a colour per unit or memory client", &columns, rows.collect());
    let bar = el("div", &[("class", "thick")], [labelled_bar(&segments(path, &resources), path.cycles)]);
    [el_text("h3", "", "Critical path"), el_text("p", "quiet", path_caption(path)), bar, table].into_iter().collect()
}

/// A segment of the bar for each of these resources, the longest first, then one for all others.
fn segments(path: &CriticalPath, resources: &[&str]) -> Vec<BarPart> {
    let cycles = |of: &dyn Fn(&str) -> bool| {
        path.parts.iter().filter(|part| of(&part.resource)).fold(0, |sum: u64, part| sum.saturating_add(part.cycles))
    };
    let of_resource = |(class, name): (&&'static str, &&str)| (*class, (*name).to_owned(), cycles(&|of| of == *name));
    let mut segments: Vec<BarPart> = HUES.iter().zip(resources).map(of_resource).collect();
    segments.sort_by_key(|(_, _, n)| std::cmp::Reverse(*n));
    let rest = cycles(&|of| !resources.contains(&of));
    segments.extend((rest > 0).then(|| ("done", REST.to_owned(), rest)));
    segments
}

fn path_caption(path: &CriticalPath) -> String {
    let by_polygon = path.polygons.as_ref().map_or(String::new(), |polygons| by_polygon(polygons, path.cycles));
    format!(
        "Chain of work and stalls that ends with the last frame: {} cycles without gap or overlap. Other paths may \
         tie.{by_polygon}",
        thousands(path.cycles)
    )
}

/// The meaning of a part of the path.
fn meaning(part: &PathPart) -> &'static str {
    match part.what.as_str() {
        "occupancy" => "cycles in which the unit is busy",
        "latency" => "cycles from the start of a step to its result",
        "FIFO" => "latency of the FIFO, and one token per cycle",
        "slot" => "wait for a free slot of the FIFO",
        "arrival" => "way of a request to its memory",
        "bus" => "wait for other bursts and for the data bus",
        "bank" => "wait for the row of the bank to open",
        "data" => "cycles from the column command to the end of the data",
        "order" => "wait for an earlier answer, or for the credit that it returns",
        "cache" => "way of the data through the cache",
        "refresh" => "wait of a flip for the display",
        _ => "tokens in flight at the end",
    }
}
