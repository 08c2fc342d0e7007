//! Comparison page of two or more reports: changes, causes, and both reports side by side.

use super::diagram::block_diagram;
use super::markup::{Html, details, el, el_text, text as words};
use super::page::{POLICY, section, whole_page};
use super::page_assets::PageAssets;
use super::svg::{BarPart, bar};
use super::table::{html as table_of, with_cells};
use super::{head, pictures, units};
use crate::compare::{Comparison, cause_name, measured_by};
use crate::model::Report;
use crate::number::{signed, thousands};
use crate::text::table::Align::{Left, Right};
use indexmap::IndexSet;

/// A report on the page of a comparison.
#[derive(Clone, Debug)]
pub struct ComparedReport<'a> {
    /// Name given by the user.
    pub name: &'a str,
    /// The report.
    pub report: &'a Report,
    /// Block diagram and pictures, if any.
    pub assets: PageAssets,
}

/// Page that compares a report with other reports.
pub fn compared(a: &ComparedReport<'_>, others: &[(ComparedReport<'_>, &Comparison)]) -> String {
    let title = format!("{} against {} · Basrelief", a.name, others.iter().map(|(b, _)| b.name).collect::<Vec<_>>().join(", "));
    let several = others.len() > 1;
    let parts = (1..).zip(others).map(|(number, (b, comparison))| {
        let id = |part: &str| if several { format!("{part}-{number}") } else { part.to_owned() };
        pair(a, b, comparison, &id)
    });
    let heading = el("h1", &[], [words("Basrelief "), el_text("span", "quiet", "comparison")]);
    let body = el("body", &[], [el("header", &[], [heading]), el("main", &[], parts)]);
    whole_page(&title, POLICY, "", body)
}

fn pair(a: &ComparedReport<'_>, b: &ComparedReport<'_>, comparison: &Comparison, id: &dyn Fn(&str) -> String) -> Html {
    let names = el(
        "p",
        &[],
        [el_text("b", "", "A"), words(format!(": {}   ", a.name)), el_text("b", "", "B"), words(format!(": {}", b.name))],
    );
    let explanation = [names, el_text("p", "lead", &comparison.explanation), numbers(a.report, b.report), shares(comparison)];
    let parts = [
        ("explained", "Causes", explanation.into_iter().collect()),
        ("pictures", "Images", side_by_side(for_both(a, b, |side| pictures::pictures(side.report, &side.assets.pictures)))),
        ("units", "Cycle breakdown", bars(a.report, b.report)),
        ("diagram", "Block diagrams", for_both(a, b, |side| block_diagram(side.report, &side.assets.diagram))),
        ("changes", "All changes", changes(comparison)),
    ];
    let shown = parts.into_iter().filter(|(_, _, content): &(_, _, Html)| !content.is_empty());
    shown.map(|(part, title, content)| section(&id(part), title, content)).collect()
}

/// The figures of the head, of both. The clock of a time moves into the cells if the clocks differ.
fn numbers(a: &Report, b: &Report) -> Html {
    let (of_a, of_b) = (head::numbers(a), head::numbers(b));
    let without_clock = |unit: &str| unit.split_once(head::CLOCK).map_or(unit.to_owned(), |(time, _)| time.to_owned());
    let rows = of_b.into_iter().filter_map(|(number, unit)| {
        let kind = without_clock(&unit);
        let (before, of) = of_a.iter().find(|(_, of)| without_clock(of) == kind)?;
        if *of == unit {
            return Some(vec![words(&unit), words(before), words(number)]);
        }
        let with_clock = |number: &str, unit: &str| words(format!("{number}{}", unit.strip_prefix(&kind).unwrap_or_default()));
        Some(vec![words(&kind), with_clock(before, of), with_clock(&number, &unit)])
    });
    with_cells("Key figures", &[("", Left), ("A", Right), ("B", Right)], rows.collect())
}

/// Bars of the causes.
fn shares(comparison: &Comparison) -> Html {
    let Some(explained) = comparison.explained.as_ref() else { return Html::default() };
    let most = explained.shares.iter().filter_map(|share| share.by).chain([explained.together]).map(i64::unsigned_abs).max();
    let row = |name: &str, by: Option<i64>, share: String, how: &str| {
        let part: BarPart = ("amount", "cycles".into(), by.map_or(0, i64::unsigned_abs));
        let label = by.map_or("not measured".into(), |by| signed(by as f64));
        vec![words(name), bar(&[part], most.unwrap_or(1).max(1)), words(label), words(share), words(how)]
    };
    let rows = explained.shares.iter().map(|share| {
        row(&cause_name(share), share.by, share.share.map_or(String::new(), |share| signed(share.round())), measured_by(share))
    });
    let rows = rows.chain([row("interaction", Some(explained.together), String::new(), "")]).collect();
    let columns =
        [("cause", Left), ("", Left), ("cycles alone", Right), ("share of the change in cycles", Right), ("measured by", Left)];
    el("div", &[("class", "bars")], [with_cells("Changed parameters", &columns, rows)])
}

/// Something of A, then the same of B.
fn for_both(a: &ComparedReport<'_>, b: &ComparedReport<'_>, of: impl Fn(&ComparedReport<'_>) -> Html) -> Html {
    let part = |name: &str, side| {
        let content: Html = of(side);
        if content.is_empty() { content } else { el("div", &[], [el_text("h3", "", name), content]) }
    };
    [part("A", a), part("B", b)].into_iter().collect()
}

/// Places both beside each other if the window is wide enough.
fn side_by_side(both: Html) -> Html {
    if both.is_empty() { both } else { el("div", &[("class", "pair")], [both]) }
}

/// Two bars per unit, of the cycles that each run has.
fn bars(a: &Report, b: &Report) -> Html {
    let (Some(of_a), Some(of_b)) = (&a.units, &b.units) else { return Html::default() };
    let whole = a.frame_cycles().max(b.frame_cycles());
    let names: IndexSet<&String> = of_a.keys().chain(of_b.keys()).collect();
    let rows = names.into_iter().flat_map(|name| {
        [("A", a, of_a.get(name)), ("B", b, of_b.get(name))].into_iter().filter_map(move |(which, report, unit)| {
            let (parts, own) = units::breakdown_parts(report, unit?);
            let heading = if which == "A" || of_a.get(name).is_none() { words(name) } else { Html::default() };
            Some(vec![heading, words(which), bar(&parts, whole.max(own)), words(thousands(unit?.busy))])
        })
    });
    let columns = [("unit", Left), ("", Left), ("", Left), ("busy", Right)];
    let table = with_cells("Render cycles of units, A above B on a common scale", &columns, rows.collect());
    [units::legend(units::STATES), el("div", &[("class", "bars compared")], [table])].into_iter().collect()
}

fn changes(comparison: &Comparison) -> Html {
    let tables = comparison.sections.iter().map(|section| {
        let table = section.table();
        details(&format!("{} ({})", section.title(), section.changes.len()), table_of(section.title(), &table))
    });
    tables.collect()
}
