//! Occupancy of the FIFOs.

use super::markup::{Html, details, el, el_text, text};
use super::svg::{ColumnChart, Ruler, bins, percent_of, px};
use super::table::html;
use crate::model::{Fifo, Report};
use crate::number::thousands;
use crate::text::sections::{self, full_cycles, in_frames, mean_occupancy};

/// Maximum number of columns of a histogram.
const COLUMNS: usize = 33;

/// A small histogram each.
pub(super) fn fifos(report: &Report) -> Html {
    let Some(fifos) = report.fifos.as_ref().filter(|fifos| !fifos.is_empty()) else { return Html::default() };
    let cards = fifos.iter().map(|(name, fifo)| card(name, &in_frames(fifo, report.drain())));
    let cards = el("div", &[("class", "cards")], cards);
    let about = "x: occupied slots; y: % of render cycles.";
    let table = details("As a table", html("FIFOs", &sections::fifos(report)));
    [el_text("p", "quiet", about), cards, table].into_iter().collect()
}

fn card(name: &str, fifo: &Fifo) -> Html {
    let total = fifo.histogram.iter().fold(0, |sum: u64, &n| sum.saturating_add(n));
    let shares: Vec<f64> = fifo.histogram.iter().map(|&n| 100.0 * n as f64 / total.max(1) as f64).collect();
    let columns: Vec<(String, f64)> = bins(&shares, COLUMNS).map(|(slot, n)| (slot.to_string(), n.iter().sum())).collect();
    let highest = columns.iter().fold(0.0, |most: f64, (_, n)| most.max(*n));
    let title = format!("FIFO {name}");
    let per = shares.len().div_ceil(COLUMNS).max(1);
    let upright = if per > 1 { format!("% of cycles, {per} slots per bar") } else { "% of cycles".into() };
    let chart = ColumnChart {
        title: &title,
        axes: ["occupied slots", &upright],
        class: "fifo",
        columns,
        ruler: Some(Ruler::numbered(0.0, shares.len(), COLUMNS)),
        top: (highest, format!("{highest:.0} %")),
        size: (260.0, 125.0),
    };
    let mean = px((mean_occupancy(fifo) * 10.0).round() / 10.0);
    let says = format!(
        "mean {} of {} slots; full {} of the time; {} tokens",
        mean,
        thousands(fifo.depth),
        percent_of(full_cycles(fifo), total),
        thousands(fifo.tokens)
    );
    el("div", &[("class", "card")], [el("h3", &[], [text(name)]), el_text("p", "quiet", says), chart.draw()])
}
