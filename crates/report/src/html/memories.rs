//! Traffic of the memories over time, and latencies of requests.

use super::markup::{Html, breakable, details, el, el_text, text};
use super::svg::{BarPart, ColumnChart, Ruler, bar, bins, mean, percent_of, px};
use super::table::{html, with_cells};
use crate::model::{Client, Memory, Report};
use crate::number::{decimal, thousands};
use crate::text::table::Align::{Left, Right};
use crate::text::{display, sections};

/// Maximum number of columns of a bus over time.
const COLUMNS: usize = 150;
/// Possible ends of the scale of a bus \[percent\].
const SCALES: [f64; 6] = [2.0, 5.0, 10.0, 20.0, 50.0, 100.0];

pub(super) fn memories(report: &Report) -> Html {
    let Some(memories) = report.memories.as_ref().filter(|memories| !memories.is_empty()) else { return Html::default() };
    let most = memories.values().flat_map(|memory| memory.clients.values()).map(|client| client.moved_bytes).max().unwrap_or(0);
    let each = memories.iter().map(|(name, memory)| memory_card(report, name, memory, most));
    let tables = [
        html("Display", &display::display(report)),
        html("Caches", &sections::caches(report)),
        details("All clients as a table", html("Memories and their clients", &sections::memories(report))),
        details("Channels", html("Channels", &sections::channels(report))),
    ];
    each.chain(tables).collect()
}

fn memory_card(report: &Report, name: &str, memory: &Memory, most: u64) -> Html {
    let busy = report.derived.get(&format!("{name}.bus_utilization"));
    let busy = busy.map_or(String::new(), |d| format!(": bus utilization {} % of render cycles", px(100.0 * d.value)));
    let latencies = memory.clients.iter().filter(|(_, client)| client.latency.iter().any(|&n| n > 0));
    let latencies: Html = latencies.map(|(name, client)| latency(name, client)).collect();
    let cards = if latencies.is_empty() { latencies } else { el("div", &[("class", "cards")], [latencies]) };
    let heading = el("h3", &[], [text(name), el_text("span", "quiet", busy)]);
    let side = el("div", &[("class", "pair")], [bus(report, name, memory), clients(name, memory, most)]);
    el("div", &[("class", "memory-part")], [heading, side, cards])
}

/// When its buses moved data.
fn bus(report: &Report, name: &str, memory: &Memory) -> Html {
    let possible = (memory.bus.interval * memory.channels.len() as u64).max(1) as f64;
    let shares: Vec<f64> = memory.bus.busy.iter().map(|&n| 100.0 * n as f64 / possible).collect();
    let start = |at: usize| thousands((at as u64).saturating_mul(memory.bus.interval));
    let columns: Vec<(String, f64)> = bins(&shares, COLUMNS).map(|(at, n)| (start(at), mean(n))).collect();
    if columns.is_empty() {
        return Html::default();
    }
    let most = columns.iter().fold(0.0, |most: f64, (_, n)| most.max(*n));
    let top = SCALES.into_iter().find(|scale| most <= *scale).unwrap_or(100.0);
    let title = format!("Bus of {name} over time");
    let across = match report.drain() {
        0 => "cycle".to_owned(),
        _ => format!("cycle; rendering ends at {}", thousands(report.frame_cycles())),
    };
    let axes = [across.as_str(), "% of the bus, all channels"];
    let ruler = Some(Ruler::of_bins(shares.len(), COLUMNS, memory.bus.interval as f64));
    ColumnChart { title: &title, axes, class: "busy", columns, ruler, top: (top, format!("{top} %")), size: (540.0, 150.0) }
        .draw()
}

/// Bytes of each client, on one scale for all memories.
fn clients(name: &str, memory: &Memory, most: u64) -> Html {
    let row = |(name, client): (&String, &Client)| {
        let hits = if client.bursts == 0 { String::new() } else { percent_of(client.row_hits, client.bursts) };
        let part: BarPart = ("amount", "bytes".into(), client.moved_bytes);
        vec![breakable(name), bar(&[part], most), text(thousands(client.moved_bytes)), text(hits)]
    };
    let columns = [("client", Left), ("", Left), ("bytes moved", Right), ("row hits", Right)];
    let table = with_cells(&format!("Clients of {name}"), &columns, memory.clients.iter().map(row).collect());
    el("div", &[("class", "bars")], [table])
}

fn latency(name: &str, client: &Client) -> Html {
    let columns = client.latency.iter().enumerate().map(|(k, &n)| (thousands(1_u64 << k.min(63)), n as f64));
    let columns: Vec<(String, f64)> = columns.collect();
    let most = client.latency.iter().copied().max().unwrap_or(0);
    let title = format!("Latency of {name}");
    let mean = client.mean_latency().map_or(String::new(), |mean| format!(", mean {}", decimal(mean, 1)));
    let heading = format!("Latency: {name}{mean}, 95 % below {}", thousands(client.latency_95));
    let axes = ["cycles: this value to twice it", "requests"];
    let top = (most as f64, thousands(most));
    // Each column is twice the one before it, so the columns have labels of their own.
    let chart = ColumnChart { title: &title, axes, class: "memory", columns, ruler: None, top, size: (260.0, 130.0) };
    el("div", &[("class", "card")], [el("h4", &[], [text(heading)]), chart.draw()])
}
