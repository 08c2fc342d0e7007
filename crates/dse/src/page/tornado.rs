//! Effect of each axis, largest first.

use super::data::SweepView;
use super::labels::rounded;
use crate::effects::{Effect, effects, is_whole_grid};
use basrelief_report::html::markup::{Html, breakable, el, el_text, text};
use basrelief_report::html::svg::{rect, svg};
use basrelief_report::html::{Align, with_cells};

/// A table of bars per objective.
pub(super) fn tornado(sweep: &SweepView<'_>) -> Html {
    let effects = effects(sweep.table);
    let told: Vec<&[Effect]> = effects.chunk_by(|a, b| a.objective == b.objective).collect();
    let tables: Html = told.into_iter().map(|effects| table(sweep, effects)).collect();
    if tables.is_empty() {
        return tables;
    }
    let about = "Mean of an objective over all points with the same value of an axis. The bar spans the lowest to the highest mean: a longer \
                 bar means a stronger effect.";
    let noise =
        if is_whole_grid(sweep.table) { "" } else { " The points are no whole grid, so other axes can add to an effect." };
    [el_text("p", "quiet", format!("{about}{noise}")), tables].into_iter().collect()
}

fn table(sweep: &SweepView<'_>, effects: &[Effect]) -> Html {
    let varied = effects.iter().filter(|effect| effect.levels.len() > 1);
    let ends: Vec<_> = varied.filter_map(|effect| Some((effect, effect.extreme_levels()?))).collect();
    let low = ends.iter().map(|(_, (low, _))| low.mean).reduce(f64::min);
    let high = ends.iter().map(|(_, (_, high))| high.mean).reduce(f64::max);
    let Some((low, high)) = low.zip(high) else { return Html::default() };
    let objective = effects[0].objective;
    let rounded = |x: f64| rounded(x, &sweep.table.columns[objective].unit);
    if sweep.drawn_index(objective).is_none() {
        let says = format!("{} is {} for all values of the axes.", sweep.header(objective), rounded(low));
        return el_text("p", "", says);
    }
    let rows = ends.iter().map(|(effect, (least, most))| {
        let share = |x: f64| if high > low { (x - low) / (high - low) * 1000.0 } else { 0.0 };
        let (from, to) = (share(least.mean), share(most.mean));
        let shape = rect("amount", [from, 0.0, (to - from).max(2.0), 10.0], "");
        let is_flat = effect.mean_range() == 0.0;
        let [at_least, at_most] = [least, most].map(|level| if is_flat { "all values" } else { level.label.as_str() });
        let says = match is_flat {
            true => format!("{} at all values", rounded(least.mean)),
            false => format!("from {} at {at_least} to {} at {at_most}", rounded(least.mean), rounded(most.mean)),
        };
        vec![
            breakable(
                std::iter::once(&effect.axis)
                    .chain(&effect.tied)
                    .map(|axis| sweep.table.columns[*axis].name.as_str())
                    .collect::<Vec<_>>()
                    .join(" with "),
            ),
            svg("bar", (1000.0, 10.0), &says, "none", shape),
            text(rounded(effect.mean_range())),
            text(rounded(least.mean)),
            text(at_least),
            text(rounded(most.mean)),
            text(at_most),
            text(rounded(effect.best_moved())),
        ]
    });
    use Align::{Left, Right};
    let columns = [
        ("axis", Left),
        ("", Left),
        ("change of mean", Right),
        ("lowest mean", Right),
        ("at", Left),
        ("highest mean", Right),
        ("at", Left),
        ("change of best", Right),
    ];
    let caption = format!("Mean of {}; bars lie between {} and {}", sweep.header(objective), rounded(low), rounded(high));
    el("div", &[("class", "bars")], [with_cells(&caption, &columns, rows.collect())])
}
