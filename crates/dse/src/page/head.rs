//! Summary of the sweep in words.

use super::data::SweepView;
use super::labels;
use crate::ObjectiveSpace;
use crate::front::input_column;
use crate::rules::ObjectiveDirection;
use crate::table::{Cell, PointState};
use basrelief_report::html::big_numbers;
use basrelief_report::html::markup::{Html, el, el_text, text};
use basrelief_report::number::{percent_in_words, thousands};

/// Title, a sentence, and numbers that can be read from a distance.
pub(super) fn head(sweep: &SweepView<'_>) -> Html {
    let title = el("h1", &[], [text("Basrelief "), el_text("span", "quiet", &sweep.table.title)]);
    let best = sweep.table.objectives().filter_map(|(at, goal)| best(sweep, at, goal));
    let counts = [
        (thousands(sweep.run() as u64), "completed points".to_owned()),
        (thousands(sweep.front.len() as u64), "Pareto-optimal".to_owned()),
    ];
    let best = best.map(|(row, at, goal)| {
        let least = if goal == ObjectiveDirection::Min { "lowest" } else { "highest" };
        (value(&sweep.table.rows[row].cells[at], &sweep.table.columns[at].unit), format!("{least} {}", sweep.header(at)))
    });
    el("header", &[], [title, big_numbers(counts.into_iter().chain(best)), el_text("p", "lead", summary(sweep)), volume(sweep)])
}

/// Counts whole, measures to four digits.
fn value(cell: &Cell, unit: &str) -> String {
    match cell {
        Cell::Number(x) => labels::rounded(*x, unit),
        other => labels::cell(other, unit),
    }
}

/// The first row that is best by an objective, among those that may be chosen.
fn best(sweep: &SweepView<'_>, at: usize, goal: ObjectiveDirection) -> Option<(usize, usize, ObjectiveDirection)> {
    let value = |row: &usize| sweep.table.rows[*row].cells.get(at)?.number();
    let better = |a: usize, b: usize| match (value(&a), value(&b)) {
        (Some(x), Some(y)) if goal.better(y, x) => b,
        _ => a,
    };
    sweep.front.iter().copied().filter(|row| value(row).is_some()).reduce(better).map(|row| (row, at, goal))
}

/// Returns a paragraph with the number of points and the best ones.
fn summary(sweep: &SweepView<'_>) -> String {
    let table = sweep.table;
    let count = |state: fn(&PointState) -> bool| table.rows.iter().filter(|row| state(&row.state)).count() as u64;
    let (failed, pending) = (count(|state| matches!(state, PointState::Failed(_))), count(|state| *state == PointState::Pending));
    let mut says = format!("{} {}", thousands(table.rows.len() as u64), if table.rows.len() == 1 { "point" } else { "points" });
    for (count, what) in [(failed, "failed"), (pending, "not run yet")] {
        if count > 0 {
            says += &format!(", {} {what}", thousands(count));
        }
    }
    says += ". ";
    if !table.constraints.is_empty() {
        let kept = table.rows.iter().filter(|row| table.feasible(row)).count() as u64;
        let rules: Vec<String> = table.constraints.iter().map(ToString::to_string).collect();
        says += &format!("{} meet {}. ", thousands(kept), rules.join(" and "));
    }
    let objectives: Vec<String> = table.objectives().map(|(at, goal)| format!("{} {goal}", table.columns[at].name)).collect();
    let front = sweep.front.len();
    let among = if input_column(table).is_some() { " among the points of their input" } else { "" };
    says += &match (objectives.len(), front) {
        (0, _) => "No objective is named, so no point is better than another.".into(),
        (_, 0) => format!("No completed point meets the constraints for {}.", objectives.join(", ")),
        (_, 1) => format!("One point is Pareto-optimal for {}.", objectives.join(", ")),
        _ => format!("{} are Pareto-optimal{among} for {}.", thousands(front as u64), objectives.join(", ")),
    };
    match sweep.ties(None) {
        0 => says,
        1 => says + " One more point equals a Pareto-optimal point in every objective.",
        ties => says + &format!(" {} more points equal a Pareto-optimal point in every objective.", thousands(ties as u64)),
    }
}

/// Returns the hypervolume with its space. It is empty for a front of one point, for several fronts, or if the computation would take too
/// long.
fn volume(sweep: &SweepView<'_>) -> Html {
    if input_column(sweep.table).is_some() {
        return Html::default();
    }
    let costs: Vec<Vec<f64>> = crate::candidates(sweep.table).into_iter().map(|(_, costs)| costs).collect();
    let share = ObjectiveSpace::of(&costs).filter(|_| sweep.front.len() > 1).and_then(|space| space.hypervolume(&costs));
    share.map_or_else(Html::default, |share| {
        let share = percent_in_words(share);
        let says = format!(
            "Hypervolume: the Pareto front dominates {share} of the space from the best value of each objective to 10 % beyond its worst."
        );
        el_text("p", "quiet", says)
    })
}
