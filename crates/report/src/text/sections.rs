//! The tables, one function each.

use super::table::{Align, Table};
use crate::bottleneck::{Stall, largest_stall};
use crate::model::{Difference, Fifo, Figure, FigureGroup, RealPath, Report};
use crate::number::{decimal, percent, real, rounded, thousands};
use crate::work;
use Align::{Left, Right};
use basrelief_reference::QualityMetrics;

/// Heights of a histogram's bars; the first means none at all.
const BARS: [char; 9] = ['·', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
/// Maximum number of bars of a histogram.
const BINS: usize = 16;

pub(crate) fn units(report: &Report) -> Table {
    let mut table = Table::new(&[
        ("Unit", Left, 0),
        ("tokens", Right, 3),
        ("busy %", Right, 0),
        ("starved %", Right, 0),
        ("blocked %", Right, 0),
        ("memory %", Right, 0),
        ("done %", Right, 1),
        ("main stall", Left, 2),
    ]);
    let total = report.breakdown_cycles();
    let after = report.cycles.as_ref().map_or(0, |cycles| cycles.total.saturating_sub(total));
    for (name, unit) in report.units.iter().flatten() {
        let share = |n: u64| percent(n, total);
        table.row([
            unit.numeral.map_or(name.clone(), |n| format!("{name} ({n})")),
            thousands(unit.tokens),
            share(unit.busy),
            share(sum(unit.starved.values())),
            share(sum(unit.blocked.values())),
            share(sum(unit.memory.values())),
            share(unit.done.saturating_sub(after)),
            largest_stall(unit).map_or(String::new(), |(wait, _)| cause(wait)),
        ]);
    }
    table
}

/// A wait in two words, as in the tables, the comparison and the time line.
pub(crate) fn cause(wait: Stall<'_>) -> String {
    match wait {
        Stall::Starved(fifo) => format!("starved: {fifo}"),
        Stall::Blocked(fifo) => format!("blocked: {fifo}"),
        Stall::Memory(client) => format!("memory: {client}"),
    }
}

/// Saturating, as a report may come from a file.
fn sum<'a>(counts: impl IntoIterator<Item = &'a u64>) -> u64 {
    counts.into_iter().fold(0, |sum, &n| sum.saturating_add(n))
}

pub(crate) fn fifos(report: &Report) -> Table {
    let mut table = Table::new(&[
        ("FIFO", Left, 0),
        ("depth", Right, 0),
        ("tokens", Right, 2),
        ("high-water", Right, 0),
        ("mean", Right, 1),
        ("empty %", Right, 2),
        ("full %", Right, 0),
        ("empty .. full", Left, 3),
    ]);
    for (name, fifo) in report.fifos.iter().flatten() {
        let fifo = &in_frames(fifo, report.drain());
        let total = sum(&fifo.histogram);
        table.row([
            name.clone(),
            thousands(fifo.depth),
            thousands(fifo.tokens),
            thousands(fifo.high_water),
            format!("{:.1}", mean_occupancy(fifo)),
            percent(fifo.histogram.first().copied().unwrap_or(0), total),
            percent(full_cycles(fifo), total),
            sparkline(&fifo.histogram),
        ]);
    }
    table
}

/// The same without the drain, if it was empty then.
pub(crate) fn in_frames(fifo: &Fifo, drain: u64) -> Fifo {
    let mut fifo = fifo.clone();
    if let Some(empty) = fifo.histogram.first_mut() {
        *empty = empty.checked_sub(drain).unwrap_or(*empty);
    }
    fifo
}

/// Returns the cycles in which every slot was occupied.
pub(crate) fn full_cycles(fifo: &Fifo) -> u64 {
    usize::try_from(fifo.depth).ok().and_then(|d| fifo.histogram.get(d)).copied().unwrap_or(0)
}

/// Returns the mean number of occupied slots over all cycles.
pub(crate) fn mean_occupancy(fifo: &Fifo) -> f64 {
    let held: f64 = fifo.histogram.iter().enumerate().map(|(k, &n)| k as f64 * n as f64).sum();
    match sum(&fifo.histogram) {
        0 => 0.0,
        total => held / total as f64,
    }
}

/// A histogram as at most [`BINS`] bars, the highest at full height; a bar for everything that is not zero.
fn sparkline(histogram: &[u64]) -> String {
    let per_bin = histogram.len().div_ceil(BINS).max(1);
    let bins: Vec<u64> = histogram.chunks(per_bin).map(sum).collect();
    let most = bins.iter().copied().max().unwrap_or(0).max(1);
    let height = |n: u64| (u128::from(n) * (BARS.len() as u128 - 1)).div_ceil(u128::from(most)) as usize;
    bins.into_iter().map(|n| BARS.get(height(n)).copied().unwrap_or('█')).collect()
}

pub(crate) fn memories(report: &Report) -> Table {
    let mut table = Table::new(&[
        ("Memory", Left, 0),
        ("client", Left, 0),
        ("reads", Right, 2),
        ("writes", Right, 2),
        ("requested", Right, 4),
        ("bytes moved", Right, 0),
        ("row hits %", Right, 1),
        ("conflicts %", Right, 3),
        ("queue wait", Right, 1),
        ("mean latency", Right, 1),
        ("95 % below", Right, 3),
    ]);
    for (name, memory) in report.memories.iter().flatten() {
        for (at, (client, c)) in memory.clients.iter().enumerate() {
            table.row([
                if at == 0 { name.clone() } else { String::new() },
                client.clone(),
                thousands(c.reads),
                thousands(c.writes),
                thousands(c.requested()),
                thousands(c.moved_bytes),
                percent(c.row_hits, c.bursts),
                percent(c.row_conflicts, c.bursts),
                ratio_text(c.queue_wait, c.bursts),
                c.mean_latency().map_or(String::new(), |mean| decimal(mean, 1)),
                if c.latency_95 == 0 { String::new() } else { thousands(c.latency_95) },
            ]);
        }
    }
    table
}

/// As [`decimal`] with one decimal; nothing where there is nothing to divide by.
fn ratio_text(above: u64, below: u64) -> String {
    if below == 0 { String::new() } else { decimal(above as f64 / below as f64, 1) }
}

pub(crate) fn channels(report: &Report) -> Table {
    let mut table = Table::new(&[
        ("Channel", Left, 0),
        ("no.", Right, 0),
        ("bus busy", Right, 0),
        ("bus %", Right, 0),
        ("over time", Left, 2),
        ("row hits %", Right, 1),
        ("conflicts %", Right, 3),
        ("turnarounds", Right, 4),
        ("refreshes", Right, 5),
        ("mean queue", Right, 1),
    ]);
    let total = report.cycles.as_ref().map_or(0, |cycles| cycles.total);
    for (name, memory) in report.memories.iter().flatten() {
        let bus =
            report.derived.get(&format!("{name}.bus_utilization")).map_or(String::new(), |d| format!("{:.1}", 100.0 * d.value));
        for (number, c) in memory.channels.iter().enumerate().filter(|(_, c)| c.bus_busy > 0) {
            let first = |text: &str| if number == 0 { text.to_owned() } else { String::new() };
            let bursts = c.row_hits + c.row_closed + c.row_conflicts;
            table.row([
                first(name),
                number.to_string(),
                thousands(c.bus_busy),
                first(&bus),
                first(&sparkline(&memory.bus.busy)),
                percent(c.row_hits, bursts),
                percent(c.row_conflicts, bursts),
                thousands(c.turn_arounds),
                thousands(c.refreshes),
                ratio_text(c.queued, total),
            ]);
        }
    }
    table
}

pub(crate) fn caches(report: &Report) -> Table {
    let columns =
        [("Cache", Left, 0), ("lookups", Right, 0), ("hits %", Right, 0), ("misses %", Right, 0), ("merged %", Right, 1)];
    let mut table = Table::new(&columns);
    for (name, c) in report.caches.iter().flatten() {
        let share = |n: u64| percent(n, c.look_ups);
        table.row([name.clone(), thousands(c.look_ups), share(c.hits), share(c.misses), share(c.merged)]);
    }
    table
}

pub(crate) fn routes(report: &Report) -> Table {
    let columns = [("Route", Left, 0), ("polygons", Right, 0), ("%", Right, 1), ("dots", Right, 0), ("%", Right, 0)];
    let mut table = Table::new(&columns);
    let routes = work::routes(report);
    let polygons = sum(routes.iter().map(|r| &r.polygons));
    let dots = sum(routes.iter().map(|r| &r.dots));
    for r in routes {
        let (share_polygons, share_dots) = (percent(r.polygons, polygons), percent(r.dots, dots));
        table.row([r.name.into(), thousands(r.polygons), share_polygons, thousands(r.dots), share_dots]);
    }
    table
}

pub(crate) fn circuits(report: &Report) -> Table {
    let mut table = Table::new(&[("Circuit", Left, 0), ("needed %", Right, 0), ("started %", Right, 0), ("idle %", Right, 0)]);
    let cycles = report.frame_cycles();
    if report.cycles.is_none() {
        return table;
    }
    for c in work::circuits(report) {
        let share = |n: u64| percent(n, cycles);
        let idle = cycles.saturating_sub(c.started);
        table.row([c.name.into(), share(c.needed.unwrap_or(c.started)), share(c.started), share(idle)]);
    }
    table
}

pub(crate) fn processes(report: &Report) -> Table {
    let mut table = Table::new(&[("Process", Left, 0), ("runs", Right, 0), ("cycles", Right, 0), ("%", Right, 0)]);
    for p in work::processes(report) {
        let share = percent(p.cycles, report.frame_cycles());
        table.row([p.name.into(), thousands(p.runs), thousands(p.cycles), share]);
    }
    table
}

/// Maximum number of rows of a table of figures.
const ROWS: usize = 40;

/// A table of figures; a long one is cut short.
pub(crate) fn columns(work::ColumnTable { columns, .. }: &work::ColumnTable<'_>) -> Table {
    let titles: Vec<_> = columns.iter().map(|(title, _)| (*title, Right, 0)).collect();
    let mut rows = Table::new(&titles);
    let count = columns.iter().map(|(_, list)| list.len()).max().unwrap_or(0);
    for i in 0..count.min(ROWS) {
        rows.row(columns.iter().map(|(_, list)| list.get(i).map_or(String::new(), figure)));
    }
    if count > ROWS {
        rows.row([format!("{} more", count - ROWS)]);
    }
    rows
}

/// Returns the figures of the machine, except those that have tables of their own, such as routes and processes.
pub(crate) fn figures(report: &Report) -> Table {
    let mut table = Table::new(&[("Figure", Left, 0), ("", Right, 0), ("", Left, 1), ("description", Left, 3)]);
    let elsewhere = |name: &str| match report.legend.get(name).and_then(|legend| legend.part.as_ref()) {
        None | Some(FigureGroup::Work) => false,
        Some(FigureGroup::Started(_) | FigureGroup::Needed(_)) => report.cycles.is_some(),
        Some(FigureGroup::Route(_) | FigureGroup::Process(_) | FigureGroup::Column { .. }) => true,
    };
    let counted_to = |name: &str| report.figures.get(&format!("{name}{COUNTED_TO}"));
    let is_bound = |name: &str| name.strip_suffix(COUNTED_TO).is_some_and(|of| report.figures.contains_key(of));
    for (name, value) in report.figures.iter().filter(|(name, _)| !elsewhere(name) && !is_bound(name)) {
        let more = if counted_to(name) == Some(value) { " or more" } else { "" };
        let (unit, about) = report.legend.get(name).map_or(("", ""), |legend| (legend.unit.as_str(), legend.about.as_str()));
        table.row([name.clone(), figure(value), format!("{unit}{more}").trim_start().into(), about.into()]);
    }
    table
}

/// Suffix of the figure that has the maximum count of another figure.
const COUNTED_TO: &str = "_counted_to";

/// A figure as people read it; a long list is cut short.
pub(crate) fn figure(value: &Figure) -> String {
    const SHOWN: usize = 8;
    match value {
        Figure::Count(n) => thousands(*n),
        Figure::Real(x) => real(*x),
        Figure::Text(text) => text.clone(),
        Figure::List(list) => {
            let rest = if list.len() > SHOWN { " .." } else { "" };
            list.iter().take(SHOWN).map(figure).collect::<Vec<_>>().join("  ") + rest
        }
    }
}

pub(crate) fn quality(report: &Report) -> Table {
    let columns = [
        ("Quality", Left, 0),
        ("PSNR dB", Right, 0),
        ("SSIM", Right, 0),
        ("FLIP", Right, 0),
        ("mean error", Right, 1),
        ("largest error", Right, 1),
    ];
    let mut table = Table::new(&columns);
    let Some(quality) = &report.quality else { return table };
    let mut row = |name: String, q: &QualityMetrics, d: Option<Difference>| {
        let [mean, largest] = d.map_or_else(Default::default, |d| [format!("{:.3}", d.mean), d.largest.to_string()]);
        table.row([name, format!("{:.2}", q.psnr_db), format!("{:.4}", q.ssim), format!("{:.4}", q.flip), mean, largest]);
    };
    for (k, frame) in quality.frames.iter().enumerate() {
        row(format!("frame {}", k + 1), frame, None);
    }
    if !quality.frames.is_empty() {
        let worst = QualityMetrics { psnr_db: quality.min.psnr_db, ssim: quality.min.ssim, flip: quality.max.flip };
        row("worst".into(), &worst, None);
        row("mean".into(), &quality.mean, None);
    }
    row("final image".into(), &quality.last, quality.difference);
    table
}

/// Returns derived figures, except the utilization of units, idle circuits and hit rates, which other tables have.
pub(crate) fn derived(report: &Report) -> Table {
    let mut table = Table::new(&[("Derived", Left, 0), ("", Right, 0), ("", Left, 1)]);
    let has_own_table = |name: &str| [".utilization", ".hit_rate", ".idle"].iter().any(|end| name.ends_with(end));
    for (name, d) in report.derived.iter().filter(|(name, _)| !has_own_table(name)) {
        let (value, unit) = if d.unit == "1" { (100.0 * d.value, "%") } else { (d.value, d.unit.as_str()) };
        table.row([name.clone(), rounded(value), unit.into()]);
    }
    table
}

/// Image times of a real path beside the modelled times, and its traffic.
fn real_path(report: &Report, path: &RealPath) -> String {
    let time = |name: &str, measured: f64, idle: f64| {
        let modelled = report.device_number(name).map_or(String::new(), |ms| format!("modelled {} s, ", decimal(ms / 1e3, 2)));
        format!("{} s ({modelled}path idle for {} s)", decimal(measured / 1e3, 2), decimal(idle / 1e3, 2))
    };
    let first = time("first_picture_ms", path.first_picture_ms, path.first_picture_idle_ms);
    let last = time("final_picture_ms", path.final_picture_ms, path.final_picture_idle_ms);
    let RealPath { connections, requests, request_bytes, scene_bytes, tiles, tile_bytes, hash_bytes, head_bytes, .. } = path;
    let abandoned = match path.abandoned_tiles {
        0 => String::new(),
        n => format!(" {n} tiles were dropped when their view ended."),
    };
    format!(
        "Real path: the first image arrived after {first}, the final image of its frame after {last}. Sent: {requests} requests \
         ({request_bytes} bytes) on {connections} connections. Received: {scene_bytes} bytes of the scene, {tile_bytes} bytes of \
         {tiles} tiles, {hash_bytes} bytes of tile hashes, {head_bytes} bytes of headers and unused responses.{abandoned}"
    )
}

/// A number per second: in millions, small ones in full.
fn host_rate(x: f64) -> String {
    if x < 1e5 { decimal(x, 0) } else { format!("{} M", decimal(x / 1e6, 2)) }
}

pub(crate) fn host(report: &Report) -> Option<String> {
    let host = report.host.as_ref()?;
    let cycles = host.cycles_per_s.map_or(String::new(), |c| format!("{} cycles/s, ", host_rate(c)));
    let fragments = host_rate(host.fragments_per_s);
    let one = work::work(report).one;
    let [simulated, all] = [host.simulate_s, host.wall_s].map(|seconds| decimal(seconds, 2));
    let simulated = format!("Simulated in {simulated} s ({cycles}{fragments} {one}s/s), {all} s in all.");
    Some(match &host.path {
        Some(path) => format!("{simulated}\n{}", real_path(report, path)),
        None => simulated,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bar_for_everything_that_is_not_zero() {
        assert_eq!(sparkline(&[0, 1, 1_000_000, 500_000]), "·▁█▄");
        assert_eq!(sparkline(&[1; 65]).chars().count(), 13);
        assert_eq!(sparkline(&[]), "");
        assert_eq!(sparkline(&[u64::MAX, u64::MAX]), "██");
    }

    #[test]
    fn means_and_full_cycles_follow_from_the_histogram() {
        let fifo = Fifo { depth: 2, tokens: 1, high_water: 2, histogram: vec![5, 0, 5] };
        assert_eq!((mean_occupancy(&fifo), full_cycles(&fifo)), (1.0, 5));
        let broken = Fifo { depth: u64::MAX, ..Fifo::default() };
        assert_eq!((mean_occupancy(&broken), full_cycles(&broken)), (0.0, 0));
    }

    #[test]
    fn long_lists_are_cut_short() {
        assert_eq!(figure(&vec![1_u64; 9].into()), "1  1  1  1  1  1  1  1 ..");
    }
}
