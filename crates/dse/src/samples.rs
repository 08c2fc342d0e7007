//! Tables for tests, and for pages to look at.

use crate::{Cell, Column, ColumnRole, ObjectiveDirection, PointState, Row, Table};

pub(crate) fn column(name: &str, unit: &str, role: ColumnRole) -> Column {
    Column { name: name.into(), unit: unit.into(), role, what: String::new() }
}

/// A made-up device: entries, lanes, levels and a method; cycles, decibels and bytes as they might be. Every 97th point fails.
pub(crate) fn device(count: usize) -> Table {
    let columns = vec![
        column("cycles.total", "cycles", ColumnRole::Objective(ObjectiveDirection::Min)),
        column("quality.psnr_db", "dB", ColumnRole::Objective(ObjectiveDirection::Max)),
        column("memories.bytes", "bytes", ColumnRole::Objective(ObjectiveDirection::Min)),
        column("replacement.entries", "entries", ColumnRole::Axis),
        column("search.lanes", "inner products/cycle", ColumnRole::Axis),
        column("levels", "", ColumnRole::Axis),
        column("texture.layout", "", ColumnRole::Axis),
    ];
    let constraints = vec!["quality.psnr_db >= 18".parse().unwrap()];
    Table { title: format!("a made-up device, {count} points"), columns, constraints, rows: (0..count).map(row).collect() }
}

fn row(number: usize) -> Row {
    let at = |every: usize, length: usize| number / every % length;
    let (entries, lanes, levels, method) = (at(1, 25), at(25, 8), at(200, 5), at(1000, 10));
    let size = 16.0 * libm::exp2(entries as f64 / 3.0);
    let noise = f64::from((number as u32).wrapping_mul(2_654_435_761) >> 20) / 4096.0;
    let db = 14.0 + 0.9 * entries as f64 + 1.2 * levels as f64 + noise + if method % 3 == 0 { 1.0 } else { 0.0 };
    let cycles = 220_000.0 + 900.0 * size * (levels + 1) as f64 / libm::exp2(lanes as f64 / 2.0) + 8000.0 * noise;
    let bytes = 5_300_000 + (size as u64) * 128 * (levels as u64 + 1);
    let method = ["nearest", "linear", "blocked", "blocked_6d", "direct"][method % 5].to_owned();
    let figures = [Cell::Whole(cycles as u64), Cell::Number(db), Cell::Whole(bytes)];
    let axes = [Cell::Whole(size as u64), Cell::Whole(1 << lanes), Cell::Whole(levels as u64 + 1), Cell::Text(method)];
    let id = format!("{:016x}", (number as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    let failed = number % 97 == 5;
    Row {
        state: if failed { PointState::Failed("deadlock: `shaded` is full, `replacement` waits".into()) } else { PointState::Ok },
        picture: (!failed).then(|| format!("points/{id}/image.png")),
        cells: figures.into_iter().chain(axes).collect(),
        id,
    }
}
