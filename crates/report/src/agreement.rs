//! One meaning per figure: every figure that several tables, files and pages show is computed from each of them and compared.

use crate::compare::comparisons_text;
use crate::html::{PageAssets, to_html};
use crate::long_table;
use crate::model::{Figure, HardwareArea, Report};
use crate::number::{decimal, thousands};
use crate::text::table::Table;
use crate::text::{TableGroup, TextStyle, to_text};
use crate::{samples, work};

/// A report with a write tail, in which every FIFO is empty, and with the quality of several frames.
fn report() -> Report {
    let mut report = samples::simulated();
    let balanced = samples::balanced();
    let cycles = report.cycles.as_mut().unwrap();
    let tail = 4 * cycles.total;
    cycles.frames = vec![cycles.total];
    cycles.total += tail;
    cycles.drain = tail;
    for unit in report.units.as_mut().unwrap().values_mut() {
        unit.done += tail;
    }
    for fifo in report.fifos.as_mut().unwrap().values_mut() {
        fifo.histogram[0] += tail;
    }
    let last = balanced.quality.unwrap().last;
    let frames = [30.5, 25.25, 41.0].map(|psnr_db| basrelief_reference::QualityMetrics { psnr_db, ..last });
    report.quality = crate::model::PictureQuality::of(&frames, None);
    report.figures.insert("fragments".into(), 5000.into());
    report.legend = balanced.legend;
    report.hardware = vec![samples::piece("a", basrelief_kernel::HardwareKind::Adder, 1, 8)];
    report.hardware[0].area.area_ge = 1234;
    report.derived = crate::derived::derive(&report);
    report
}

/// Returns a cell of a table of the report.
fn cell(report: &Report, group: TableGroup, row: &str, column: &str) -> String {
    let tables: Vec<Table> = group.of(report).into_iter().map(|(_, table)| table).collect();
    let found = tables.iter().find_map(|table| {
        let at = table.columns().position(|(title, _)| title == column)?;
        let row = table.rows().iter().find(|cells| cells[0] == row || cells[0].starts_with(&format!("{row} (")))?;
        Some(row[at].clone())
    });
    found.unwrap_or_else(|| panic!("no {column} of {row} in {}", group.name()))
}

/// Returns a number of the long table, which CSV files and comparisons show.
fn long(report: &Report, table: &str, name: &str, field: &str) -> f64 {
    let rows = long_table::rows(report);
    let row = rows.iter().find(|row| (row.table, row.name.as_str(), row.field) == (table, name, field) && row.key.is_empty());
    row.and_then(|row| row.value.number()).unwrap_or_else(|| panic!("no {table}.{name}.{field}"))
}

fn derived(report: &Report, name: &str) -> f64 {
    report.derived.get(name).unwrap_or_else(|| panic!("no {name}")).value
}

fn tenth(x: f64) -> String {
    format!("{x:.1}")
}

#[test]
fn fifo_figures_agree_in_every_place() {
    let report = report();
    let html = to_html(&report, &PageAssets::default()).unwrap();
    let drawing = report.frame_cycles() as f64;
    for name in report.fifos.as_ref().unwrap().keys() {
        let mean = long(&report, "fifos", name, "mean_occupancy");
        assert!(mean > 0.0, "{name}");
        assert_eq!(cell(&report, TableGroup::Fifos, name, "mean"), tenth(mean), "{name}");
        assert!(html.contains(&format!("<td class=\"right\">{}</td>", tenth(mean))), "{name}: {mean}");
        let full = 100.0 * long(&report, "fifos", name, "full_cycles") / drawing;
        assert_eq!(
            cell(&report, TableGroup::Fifos, name, "full %").parse().unwrap_or(0.0),
            (10.0 * full).round() / 10.0,
            "{name}"
        );
    }
}

#[test]
fn unit_memory_and_cache_shares_agree_with_derived_figures() {
    let report = report();
    for (name, unit) in report.units.as_ref().unwrap() {
        let share = 100.0 * derived(&report, &format!("{name}.utilization"));
        assert_eq!(cell(&report, TableGroup::Units, name, "busy %"), tenth(share), "{name}");
        assert_eq!(long(&report, "units", name, "busy"), unit.busy as f64);
    }
    for name in report.memories.as_ref().unwrap().keys() {
        let share = 100.0 * derived(&report, &format!("{name}.bus_utilization"));
        assert_eq!(cell(&report, TableGroup::Memories, name, "bus %"), tenth(share), "{name}");
    }
    for name in report.caches.as_ref().unwrap().keys() {
        let share = 100.0 * derived(&report, &format!("{name}.hit_rate"));
        assert_eq!(cell(&report, TableGroup::Caches, name, "hits %"), tenth(share), "{name}");
    }
}

#[test]
fn headline_figures_agree_in_every_place() {
    let report = report();
    let (text, html) = (to_text(&report, TextStyle::default(), &[]), to_html(&report, &PageAssets::default()).unwrap());
    let table = comparisons_text(("a", &report), &[], TextStyle::default());
    let cycles = thousands(report.frame_cycles());
    let per_one = decimal(derived(&report, &format!("cycles_per_{}", work::work(&report).one)), 2);
    let bytes = thousands(report.memory_bytes().unwrap());
    let area = thousands(HardwareArea::sum(&report.hardware).area_ge);
    let psnr = format!("{:.2}", report.quality.as_ref().unwrap().min.psnr_db);
    assert_eq!(psnr, "25.25");
    for (place, said) in [("the summary", &text), ("the page", &html), ("the overview", &table)] {
        for figure in [&cycles, &bytes, &area, &psnr] {
            assert!(said.contains(figure.as_str()), "{figure} in {place}: {said}");
        }
    }
    assert!(text.contains(&format!("{per_one} per fragment")) && html.contains(&format!("<dd>{per_one}</dd>")), "{per_one}");
    let clients = report.memories.as_ref().unwrap().values().flat_map(|memory| memory.clients.values());
    assert_eq!(thousands(clients.map(|client| client.moved_bytes).sum()), bytes);
    let measure = report.measure();
    assert_eq!((measure.cycles, measure.psnr_db), (report.frame_cycles(), Some(25.25)));
    assert_eq!(Figure::from(measure.area_ge), Figure::from(1234_u64));
}
