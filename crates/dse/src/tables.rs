//! The table of all points, and the files made from it.

use crate::figures::{ReportFigure, figures};
use crate::folder::publish;
use crate::front::{INPUT, input_column, input_numbers};
use crate::plan::{Plan, PlanPoint};
use crate::{Cell, Column, ColumnRole, ObjectiveDirection, PageOptions, PointState, Row, Table, front, page, vega, write};
use crate::{PointStatus, SweepError, SweepFolder, SweepHost};
use basrelief_threads as threads;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

/// Files of a sweep and their descriptions. The front is written last.
pub const FILES: &[(&str, &str)] = &[
    ("sweep.html", "the sweep as a page"),
    ("sweep.jsonl", "the whole table, a JSON object per point"),
    ("sweep.csv", "the same as CSV"),
    #[cfg(feature = "parquet")]
    ("sweep.parquet", "the same as Parquet"),
    #[cfg(feature = "sqlite")]
    ("sweep.sqlite", "the same as a SQLite database"),
    ("sweep.vl.json", "a chart of the front for Vega-Lite"),
    (FRONT, "the front in words"),
];
const FRONT: &str = "front.txt";

/// Writes the tables of all points, and returns the front as text.
///
/// # Errors
/// A report that cannot be read, a file that cannot be written.
pub fn tables(plan: &Plan, folder: &SweepFolder, host: &dyn SweepHost) -> Result<String, SweepError> {
    let all: Vec<&PlanPoint> = plan.points.iter().collect();
    let table = table_of(plan, &all, folder)?;
    let failed = |error: std::io::Error| SweepError(format!("the table: {error}"));
    let (mut lines, mut csv) = (Vec::new(), Vec::new());
    write::json_lines(&table, &mut lines).map_err(failed)?;
    write::csv(&table, &mut csv).map_err(failed)?;
    let page = page(
        &table,
        &PageOptions {
            defaults: plan.default_points().into_iter().map(|point| point.id.clone()).collect(),
            files: FILES.iter().skip(1).map(|(file, what)| ((*file).into(), (*what).into())).collect(),
            ..PageOptions::default()
        },
    );
    let chart = serde_json::to_string_pretty(&vega(&table)).map_err(|error| SweepError(error.to_string()))? + "\n";
    let front = front_text(&table);
    let all = [
        page.as_bytes(),
        &lines,
        &csv,
        #[cfg(feature = "parquet")]
        &crate::parquet(&table).map_err(failed)?,
        #[cfg(feature = "sqlite")]
        &crate::sqlite(&table).map_err(failed)?,
        chart.as_bytes(),
        front.as_bytes(),
    ];
    FILES.iter().zip(all).try_for_each(|((file, _), bytes)| publish(&folder.path_of(file), bytes, host))?;
    Ok(front)
}

/// Returns the table of these points: objectives, constraints, inputs if there are several, axes, and all other figures.
///
/// # Errors
/// A report that cannot be read.
pub(crate) fn table_of(plan: &Plan, points: &[&PlanPoint], folder: &SweepFolder) -> Result<Table, SweepError> {
    let read = |point: &&PlanPoint| match folder.find(&point.id) {
        PointStatus::Report => folder.report(&point.id).map(|report| (PointState::Ok, figures(&report))),
        PointStatus::Failed => folder.failure(&point.id).map(|failure| {
            let crate::folder::PointFailure { outcome, message } = failure;
            (PointState::Failed(format!("{outcome}: {message}")), vec![])
        }),
        PointStatus::Outdated | PointStatus::Missing => Ok((PointState::Pending, vec![])),
    };
    let read = threads::par_map(points.iter().collect(), read).into_iter().collect::<Result<Vec<_>, _>>()?;
    let columns = columns(plan, &read);
    let numbers: BTreeMap<&str, usize> = columns.iter().enumerate().map(|(n, column)| (column.name.as_str(), n)).collect();
    let row = |(point, (state, figures)): (&&PlanPoint, &(PointState, Vec<ReportFigure>))| {
        let mut cells = vec![Cell::Missing; columns.len()];
        for (name, cell) in axis_cells(plan, point).chain(figures.iter().map(|figure| (&*figure.name, figure.cell.clone()))) {
            cells[numbers[name]] = cell;
        }
        let picture = folder.picture(&point.id).filter(|_| *state == PointState::Ok);
        Row { id: point.id.clone(), state: state.clone(), cells, picture }
    };
    let rows = points.iter().zip(&read).map(row).collect();
    let table = Table { title: plan.title.clone(), columns, constraints: plan.constraints.clone(), rows };
    table.check().map_err(|error| SweepError(error.to_string()))?;
    Ok(table)
}

/// Names and values of a point's input and axes.
fn axis_cells<'a>(plan: &'a Plan, point: &'a PlanPoint) -> impl Iterator<Item = (&'a str, Cell)> {
    let input = (plan.inputs.len() > 1).then(|| (INPUT, Cell::Text(plan.inputs[point.input].name.clone())));
    let axes = plan.axes.iter().zip(&point.places);
    let cells = axes.flat_map(|(axis, &place)| axis.keys.iter().map(String::as_str).zip(axis.cells[place].iter().cloned()));
    input.into_iter().chain(cells)
}

fn columns(plan: &Plan, points: &[(PointState, Vec<ReportFigure>)]) -> Vec<Column> {
    let mut columns: Vec<Column> = Vec::new();
    let column = |name: &str, role| Column { name: name.into(), unit: String::new(), role, what: String::new() };
    columns.extend(plan.objectives.iter().map(|o| column(&o.column, ColumnRole::Objective(o.goal))));
    let mut named: BTreeSet<String> = columns.iter().map(|column| column.name.clone()).collect();
    let constrained = plan.constraints.iter().filter(|constraint| named.insert(constraint.column.clone()));
    columns.extend(constrained.map(|constraint| column(&constraint.column, ColumnRole::Figure)));
    columns.extend((plan.inputs.len() > 1).then(|| column(INPUT, ColumnRole::Axis)));
    let parameters = plan.machine.parameters();
    for key in plan.axes.iter().flat_map(|axis| &axis.keys) {
        let parameter = parameters.iter().find(|parameter| parameter.key == *key);
        let (unit, what) = parameter.map_or(("", ""), |parameter| (parameter.unit, &parameter.doc));
        columns.push(Column { unit: unit.into(), what: what.into(), ..column(key, ColumnRole::Axis) });
    }
    for figure in points.iter().flat_map(|(_, figures)| figures) {
        if named.insert(figure.name.clone()) {
            columns.push(column(&figure.name, ColumnRole::Figure));
        }
    }
    let about: BTreeMap<&str, &ReportFigure> =
        points.iter().flat_map(|(_, figures)| figures).map(|figure| (figure.name.as_str(), figure)).collect();
    for column in &mut columns {
        if let Some(figure) = about.get(column.name.as_str()) {
            (column.unit, column.what) = (figure.unit.clone(), figure.what.clone());
        }
    }
    columns
}

/// Maximum number of printed points of a front, with their ties.
const MOST_PRINTED: usize = 40;
/// Maximum number of axes with a column each. Of more axes, a row names those that it changes.
const MOST_AXES: usize = 12;

/// Returns the Pareto front as a text table. Below each point are its ties, with `=` for its objectives.
fn front_text(table: &Table) -> String {
    let mut front = front::front_points(table);
    let (points, ties) = (front.len(), front.iter().map(|point| point.ties.len()).sum());
    let columns = FrontColumns::of(table);
    columns.sort(&mut front);
    let rows = front.iter().flat_map(|point| {
        let ties = point.ties.iter().map(|tie| columns.cells(*tie, true));
        std::iter::once(columns.cells(point.row, false)).chain(ties).collect::<Vec<_>>()
    });
    let lines: Vec<Vec<String>> = std::iter::once(columns.titles()).chain(rows.take(MOST_PRINTED)).collect();
    let mut text = front_heading(table, points, ties);
    if points > 0 {
        text += &aligned(&lines);
    }
    if points + ties > MOST_PRINTED {
        let _ = writeln!(text, "... and {} more", points + ties - MOST_PRINTED);
    }
    text + &failures(table)
}

/// Returns the title of a sweep and the counts of its front.
fn front_heading(table: &Table, points: usize, ties: usize) -> String {
    let of = table.rows.iter().filter(|row| table.feasible(row)).count();
    let kept: Vec<String> = table.constraints.iter().map(ToString::to_string).collect();
    let keep = if kept.is_empty() { String::new() } else { format!(" that keep {}", kept.join(", ")) };
    let are = if points == 1 { "is" } else { "are" };
    let among = if input_column(table).is_some() { ", each among the points of its input" } else { "" };
    let counts = match (of, keep.as_str()) {
        (0, "") => "No point has a report, so none is Pareto-optimal".into(),
        (0, _) => format!("No point keeps {}, so none is Pareto-optimal", kept.join(", ")),
        _ => format!("{points} of {of} points{keep} {are} Pareto-optimal{among}"),
    };
    let mut text = format!("{}\n{counts}\n", table.title) + &missing_values(table);
    if ties > 0 {
        let _ =
            writeln!(text, "Ties: {ties}. A row with `=` equals the point above it in every objective and has no smaller area.");
    }
    text
}

/// Returns a line for each objective that points of a front lack.
fn missing_values(table: &Table) -> String {
    let lacking = |(column, _): (usize, ObjectiveDirection)| {
        let lacks = |row: &&Row| table.feasible(row) && row.cells[column].number().is_none();
        let count = table.rows.iter().filter(lacks).count();
        let (have, are) = if count == 1 { ("point has", "it is") } else { ("points have", "they are") };
        (count > 0).then(|| format!("{count} {have} no `{}`, so {are} on no front\n", table.columns[column].name))
    };
    table.objectives().filter_map(lacking).collect()
}

/// The columns of a front in text: objectives, then axes, or what a point changes if there are many axes.
struct FrontColumns<'a> {
    table: &'a Table,
    objectives: Vec<usize>,
    shown: Vec<usize>,
    are_axes_few: bool,
}

impl<'a> FrontColumns<'a> {
    fn of(table: &'a Table) -> Self {
        let objectives: Vec<usize> = table.objectives().map(|(at, _)| at).collect();
        let are_axes_few = table.axes().count() <= MOST_AXES;
        let shown = objectives.iter().copied().chain(table.axes().filter(|_| are_axes_few)).collect();
        Self { table, objectives, shown, are_axes_few }
    }

    /// Sorts points by input, then by the first objective. Of equals the first of the plan is first.
    fn sort(&self, front: &mut [front::FrontPoint]) {
        let cost = |row: usize| self.shown.first().and_then(|&at| self.table.rows[row].cells[at].number()).unwrap_or(f64::NAN);
        let inputs = input_numbers(self.table);
        front.sort_by(|a, b| inputs[a.row].cmp(&inputs[b.row]).then(cost(a.row).total_cmp(&cost(b.row))));
    }

    fn titles(&self) -> Vec<String> {
        let title = |&at: &usize| match self.table.columns[at].role {
            ColumnRole::Objective(ObjectiveDirection::Min) => format!("{} min", self.table.columns[at].header()),
            ColumnRole::Objective(ObjectiveDirection::Max) => format!("{} max", self.table.columns[at].header()),
            ColumnRole::Axis | ColumnRole::Figure => self.table.columns[at].header(),
        };
        self.shown.iter().map(title).chain((!self.are_axes_few).then(|| "change from the first point".into())).collect()
    }

    /// Returns the cells of a row. The objectives of a tie are those of the row above.
    fn cells(&self, row: usize, is_tie: bool) -> Vec<String> {
        let cell = |&at: &usize| match is_tie && self.objectives.contains(&at) {
            true => "=".into(),
            false => self.table.rows[row].cells[at].to_string(),
        };
        self.shown.iter().map(cell).chain((!self.are_axes_few).then(|| changed_axes(self.table, row))).collect()
    }
}

/// Returns the axes of a row whose values differ from those of the first row.
fn changed_axes(table: &Table, row: usize) -> String {
    let cells = |at: usize| [0, row].map(|row| &table.rows[row].cells[at]);
    let changed = table.axes().filter(|&at| cells(at)[0] != cells(at)[1]);
    let changes: Vec<String> = changed.map(|at| format!("{}={}", table.columns[at].name, cells(at)[1])).collect();
    if changes.is_empty() { "none".into() } else { changes.join(", ") }
}

/// Returns a line with the number of failed points and the reason of the first; empty if none failed.
fn failures(table: &Table) -> String {
    let failed: Vec<&Row> = table.rows.iter().filter(|row| matches!(row.state, PointState::Failed(_))).collect();
    failed.first().map_or_else(String::new, |first| {
        format!("Failed: {}. The first: {} (points/{}/failed.json)\n", failed.len(), first.state.reason(), first.id)
    })
}

/// Columns of equal width, to the right.
fn aligned(lines: &[Vec<String>]) -> String {
    let columns = lines.first().map_or(0, Vec::len);
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for line in lines {
        let cells: Vec<String> = line.iter().zip(&widths).map(|(cell, width)| format!("{cell:>width$}")).collect();
        text += &(cells.join("  ") + "\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn front_without_points_states_the_reason() {
        let column = |name: &str| Column {
            name: name.into(),
            unit: String::new(),
            role: ColumnRole::Objective(ObjectiveDirection::Min),
            what: String::new(),
        };
        let row = |cell| Row { id: "a".into(), state: PointState::Ok, cells: vec![Cell::Whole(7), cell], picture: None };
        let mut table = Table { columns: vec![column("cycles"), column("rate")], title: "T".into(), ..Table::default() };
        assert_eq!(front_text(&table), "T\nNo point has a report, so none is Pareto-optimal\n");
        table.rows = vec![row(Cell::Missing), row(Cell::Whole(1)), row(Cell::Missing)];
        let text = front_text(&table);
        assert!(
            text.starts_with("T\n1 of 3 points is Pareto-optimal\n2 points have no `rate`, so they are on no front\n"),
            "{text}"
        );
        table.constraints = vec!["cycles < 5".parse().unwrap()];
        assert_eq!(front_text(&table), "T\nNo point keeps cycles < 5, so none is Pareto-optimal\n");
    }

    #[test]
    fn many_axes_are_named_where_they_change() {
        let column = |name: String, role| Column { name, unit: String::new(), role, what: String::new() };
        let objective = column("cycles".into(), ColumnRole::Objective(ObjectiveDirection::Min));
        let axes = (0..=MOST_AXES).map(|axis| column(format!("axis.{axis}"), ColumnRole::Axis));
        let row = |id: &str, cycles, changed: &[usize]| {
            let axes = (0..=MOST_AXES).map(|axis| Cell::Whole(changed.contains(&axis).into()));
            let cells = std::iter::once(Cell::Whole(cycles)).chain(axes).collect();
            Row { id: id.into(), state: PointState::Ok, cells, picture: None }
        };
        let mut rows = vec![row("a", 9, &[]), row("b", 9, &[3, 12]), row("c", 8, &[5])];
        let table = Table {
            title: "t".into(),
            columns: std::iter::once(objective).chain(axes).collect(),
            rows: rows.clone(),
            ..Table::default()
        };
        let best = "t\n1 of 3 points is Pareto-optimal\ncycles min  change from the first point\n         8                     axis.5=1\n";
        assert_eq!(front_text(&table), best);
        rows.truncate(2);
        rows[1].state = PointState::Failed("deadlock".into());
        let text = front_text(&Table { rows, ..table });
        assert!(
            text.ends_with("         9                         none\nFailed: 1. The first: deadlock (points/b/failed.json)\n"),
            "{text}"
        );
    }
}
