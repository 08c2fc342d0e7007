//! A report as one long table, one figure per row, for CSV files and comparisons.

use crate::model::{Channel, Client, CycleBreakdown, Figure, PictureQuality, Report, Unit, UnlistedCosts};
use crate::text::sections::{full_cycles, in_frames, mean_occupancy};
use serde_json::Value;

/// One figure of a report.
#[derive(Clone, Debug, PartialEq)]
pub struct FigureRow {
    /// Part of the report: `units`, `fifos` ...
    pub table: &'static str,
    /// Unit, FIFO, memory or parameter in that part.
    pub name: String,
    /// Name of the figure.
    pub field: &'static str,
    /// Key within the figure: FIFO, client, frame or number of slots.
    pub key: String,
    /// The figure; never a list.
    pub value: Figure,
}

#[derive(Default)]
struct FigureRows(Vec<FigureRow>);

impl FigureRows {
    fn of<'a>(&'a mut self, table: &'static str, name: &'a str) -> NamedRows<'a> {
        NamedRows { rows: &mut self.0, table, name }
    }
}

/// Rows of one unit, FIFO, memory or parameter.
struct NamedRows<'a> {
    rows: &'a mut Vec<FigureRow>,
    table: &'static str,
    name: &'a str,
}

impl NamedRows<'_> {
    fn add(&mut self, field: &'static str, key: impl ToString, value: impl Into<Figure>) {
        match value.into() {
            Figure::List(list) => {
                for (i, value) in list.into_iter().enumerate() {
                    let key = key.to_string();
                    let key = if key.is_empty() { i.to_string() } else { format!("{key}.{i}") };
                    self.add(field, key, value);
                }
            }
            value => self.rows.push(FigureRow { table: self.table, name: self.name.into(), field, key: key.to_string(), value }),
        }
    }
}

/// Lists every figure of a report except those of the host, in the report's order.
pub fn rows(report: &Report) -> Vec<FigureRow> {
    let mut rows = FigureRows::default();
    add_run(report, &mut rows);
    add_config("", &report.config, &mut rows);
    for (name, u) in report.units.iter().flatten() {
        add_unit(rows.of("units", name), u);
    }
    for (name, f) in report.fifos.iter().flatten() {
        let mut rows = rows.of("fifos", name);
        rows.add("depth", "", f.depth);
        rows.add("tokens", "", f.tokens);
        rows.add("high_water", "", f.high_water);
        // As in every other table, over the render cycles.
        rows.add("mean_occupancy", "", crate::number::round6(mean_occupancy(&in_frames(f, report.drain()))));
        rows.add("full_cycles", "", full_cycles(f));
        rows.add("histogram", "", f.histogram.clone());
    }
    for (name, memory) in report.memories.iter().flatten() {
        for (key, c) in &memory.clients {
            add_client(rows.of("memories", name), key, c);
        }
        for (number, c) in memory.channels.iter().enumerate() {
            add_channel(rows.of("channels", name), &number.to_string(), c);
        }
    }
    if let Some(d) = &report.display {
        rows.of("display", "").add("memory", "", d.memory.as_str());
        let counts = [("flips", d.flips), ("pictures_shown", d.pictures_shown), ("flip_wait", d.flip_wait)];
        let more = [("longest_flip_wait", d.longest_flip_wait), ("reads", d.reads), ("underruns", d.underruns)];
        for (field, n) in counts.into_iter().chain(more).chain([("bus_cycles", d.bus_cycles)]) {
            rows.of("display", "").add(field, "", n);
        }
    }
    for (name, c) in report.caches.iter().flatten() {
        for (field, n) in [("lookups", c.look_ups), ("hits", c.hits), ("misses", c.misses), ("merged", c.merged)] {
            rows.of("caches", name).add(field, "", n);
        }
    }
    add_costs(report, &mut rows);
    for (name, value) in &report.figures {
        rows.of("figures", name).add("value", "", value.clone());
    }
    add_pictures(report, &mut rows);
    for (name, d) in &report.derived {
        rows.of("derived", name).add("value", &d.unit, d.value);
    }
    rows.0
}

fn add_run(report: &Report, rows: &mut FigureRows) {
    let facts = [
        ("version", report.version.as_str()),
        ("machine", &report.machine),
        ("input", &report.input.name),
        ("input_sha256", &report.input.sha256),
        ("outcome", report.outcome.kind.name()),
    ];
    for (name, text) in facts {
        rows.of("run", name).add("value", "", text);
    }
    rows.of("run", "width").add("value", "", u64::from(report.size.width));
    rows.of("run", "height").add("value", "", u64::from(report.size.height));
    if let Some(cycles) = &report.cycles {
        rows.of("cycles", "").add("total", "", cycles.total);
        rows.of("cycles", "").add("frames", "", cycles.frames.clone());
        rows.of("cycles", "").add("write_tail", "", cycles.drain);
    }
}

fn add_config(prefix: &str, value: &Value, rows: &mut FigureRows) {
    let figure: Figure = match value {
        Value::Object(group) => {
            for (name, value) in group {
                let key = if prefix.is_empty() { name.clone() } else { format!("{prefix}.{name}") };
                add_config(&key, value, rows);
            }
            return;
        }
        Value::String(text) => text.as_str().into(),
        Value::Number(n) => match (n.as_u64(), n.as_f64()) {
            (Some(n), _) => n.into(),
            (None, Some(x)) => x.into(),
            (None, None) => n.to_string().as_str().into(),
        },
        Value::Null | Value::Bool(_) | Value::Array(_) => value.to_string().as_str().into(),
    };
    rows.of("config", prefix).add("value", "", figure);
}

fn add_unit(mut rows: NamedRows<'_>, unit: &Unit) {
    for (field, n) in [("steps", unit.steps), ("tokens", unit.tokens), ("busy", unit.busy)] {
        rows.add(field, "", n);
    }
    for (field, causes) in [("starved", &unit.starved), ("blocked", &unit.blocked), ("memory", &unit.memory)] {
        for (key, &n) in causes {
            rows.add(field, key, n);
        }
    }
    rows.add("done", "", unit.done);
}

fn add_client(mut rows: NamedRows<'_>, key: &str, client: &Client) {
    let counts = [
        ("reads", client.reads),
        ("writes", client.writes),
        ("read_bytes", client.read_bytes),
        ("write_bytes", client.write_bytes),
        ("bursts", client.bursts),
        ("moved_bytes", client.moved_bytes),
        ("row_hits", client.row_hits),
        ("row_closed", client.row_closed),
        ("row_conflicts", client.row_conflicts),
        ("queue_wait", client.queue_wait),
        ("latency_sum", client.latency_sum),
        ("latency_95", client.latency_95),
    ];
    for (field, n) in counts {
        rows.add(field, key, n);
    }
    rows.add("latency", key, client.latency.clone());
}

fn add_channel(mut rows: NamedRows<'_>, key: &str, channel: &Channel) {
    let counts = [
        ("row_hits", channel.row_hits),
        ("row_closed", channel.row_closed),
        ("row_conflicts", channel.row_conflicts),
        ("turnarounds", channel.turn_arounds),
        ("refreshes", channel.refreshes),
        ("bus_busy", channel.bus_busy),
        ("queued", channel.queued),
    ];
    for (field, n) in counts {
        rows.add(field, key, n);
    }
}

fn add_costs(report: &Report, rows: &mut FigureRows) {
    let Some(costs) = &report.costs else { return };
    rows.of("costs", "").add("unit_cycles", "", costs.unit_cycles);
    rows.of("costs", "").add("done", "", costs.done);
    for (name, whole) in [("pixels", &costs.pixels), ("non_pixel", &costs.non_pixel), ("unattributed", &costs.unattributed)] {
        add_breakdown(rows.of("costs", name), "", whole);
    }
    for (number, frame) in costs.frames.iter().enumerate() {
        add_breakdown(rows.of("costs", "frame"), &number.to_string(), frame);
    }
    for o in &costs.objects {
        let name = o.object.to_string();
        rows.of("objects", &name).add("polygons", "", o.polygons);
        rows.of("objects", &name).add("fragments", "", o.fragments);
        add_breakdown(rows.of("objects", &name), "", &o.breakdown);
    }
    add_unlisted("objects", &costs.other_objects, rows);
    for p in &costs.polygons {
        let name = format!("{}.{}", p.frame, p.polygon);
        if let Some(object) = p.object {
            rows.of("polygons", &name).add("object", "", u64::from(object));
        }
        rows.of("polygons", &name).add("fragments", "", p.fragments);
        add_breakdown(rows.of("polygons", &name), "", &p.breakdown);
    }
    add_unlisted("polygons", &costs.other_polygons, rows);
}

fn add_breakdown(mut rows: NamedRows<'_>, key: &str, spent: &CycleBreakdown) {
    spent.fields().into_iter().for_each(|(field, n)| rows.add(field, key, n));
}

fn add_unlisted(table: &'static str, others: &UnlistedCosts, rows: &mut FigureRows) {
    if others.count > 0 {
        rows.of(table, "others").add("count", "", others.count);
        rows.of(table, "others").add("fragments", "", others.fragments);
        add_breakdown(rows.of(table, "others"), "", &others.breakdown);
    }
}

/// Worst and mean quality of several pictures.
fn add_summary(quality: &PictureQuality, rows: &mut FigureRows) {
    for (key, field, x) in [
        ("min", "psnr_db", quality.min.psnr_db),
        ("min", "ssim", quality.min.ssim),
        ("max", "flip", quality.max.flip),
        ("mean", "psnr_db", quality.mean.psnr_db),
        ("mean", "ssim", quality.mean.ssim),
        ("mean", "flip", quality.mean.flip),
    ] {
        rows.of("quality", "").add(field, key, x);
    }
}

fn add_pictures(report: &Report, rows: &mut FigureRows) {
    if let Some(quality) = &report.quality {
        let frames = quality.frames.iter().enumerate().map(|(k, q)| (k.to_string(), q));
        for (key, q) in std::iter::once((String::new(), &quality.last)).chain(frames) {
            for (field, x) in [("psnr_db", q.psnr_db), ("ssim", q.ssim), ("flip", q.flip)] {
                rows.of("quality", "").add(field, &key, x);
            }
        }
        if !quality.frames.is_empty() {
            add_summary(quality, rows);
        }
        if let Some(difference) = &quality.difference {
            rows.of("quality", "").add("mean_difference", "", difference.mean);
            rows.of("quality", "").add("largest_difference", "", u64::from(difference.largest));
        }
    }
    for picture in &report.image {
        rows.of("image", &picture.file).add("sha256", "", picture.sha256.as_str());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;
    use std::collections::BTreeSet;

    #[test]
    fn every_row_has_its_own_place() {
        let rows = rows(&Report { costs: samples::costed().costs, ..samples::simulated() });
        let places: BTreeSet<_> = rows.iter().map(|r| (r.table, r.name.clone(), r.field, r.key.clone())).collect();
        assert_eq!(places.len(), rows.len());
        assert!(rows.iter().all(|r| !matches!(r.value, Figure::List(_))));
    }

    #[test]
    fn rows_contain_attributed_cycles() {
        let rows = rows(&samples::costed());
        let find = |at: [&str; 4]| rows.iter().find(|r| [r.table, &r.name, r.field, &r.key] == at).map(|r| r.value.clone());
        assert_eq!(find(["costs", "pixels", "cycles", ""]), Some(2_300_000.into()));
        assert_eq!(find(["costs", "frame", "starved", "1"]), Some(450_000.into()));
        assert_eq!(find(["objects", "3", "polygons", ""]), Some(700.into()));
        assert_eq!(find(["polygons", "1.17", "busy", ""]), Some(66_000.into()));
        assert_eq!(find(["polygons", "1.4", "object", ""]), Some(3.into()));
        assert_eq!(find(["polygons", "others", "count", ""]), Some(698.into()));
        assert_eq!(find(["objects", "others", "count", ""]), None);
    }

    #[test]
    fn rows_equal_report() {
        let report = samples::balanced();
        let rows = rows(&report);
        let find = |name: &str, field: &str, key: &str| {
            rows.iter().find(|r| (r.name.as_str(), r.field, r.key.as_str()) == (name, field, key)).map(|r| r.value.clone())
        };
        assert_eq!(find("replacement", "busy", ""), Some(970_000.into()));
        assert_eq!(find("normal-mapping", "memory", "normals-fine"), Some(135_000.into()));
        assert_eq!(find("replacement.entries", "value", ""), Some(256.into()));
        assert_eq!(find("reference_normals_used", "value", "1"), Some(121.into()));
        assert_eq!(find("graphics", "write_bytes", "z"), Some(320_000.into()));
        assert_eq!(find("polygons", "histogram", "4"), Some(900_000.into()));
        assert_eq!(find("", "frames", "1"), Some(480_000.into()));
    }
}
