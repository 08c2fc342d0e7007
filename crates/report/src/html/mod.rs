//! The report as one page: no script, nothing from outside, the same to the byte for equal runs.
//!
//! | part | where |
//! |---|---|
//! | well-formed, escaped markup | `markup` |
//! | bars, charts | `svg` |
//! | tables | `table` |
//! | the block diagram | `diagram` |
//! | everything else | a file per section |
//!
//! Each colour has one meaning: `style.css` names them.

mod bottlenecks;
mod compared;
mod diagram;
mod fifos;
mod frames;
mod head;
mod lifetimes;
pub mod markup;
mod memories;
mod page;
mod page_assets;
mod parameters;
mod pictures;
pub mod svg;
mod table;
#[cfg(test)]
mod tests;
mod units;

use crate::area::{PlaceArea, by_place};
use crate::model::Report;
use crate::model::costs::LISTED;
use crate::number::thousands;
use crate::text::table::Table;
use crate::text::{
    costs as cost_tables, hardware as hardware_tables, sections as text_sections, sensitivity as sensitivity_tables,
};
use crate::work;
use markup::{Html, details, el, el_text, sentence};
use page::POLICY;

pub use crate::text::Align;
pub use compared::{ComparedReport, compared};
pub use head::big_numbers;
pub use page::{STYLE, section, whole_page};
pub use page_assets::PageAssets;
pub use parameters::ParameterRow;
pub use pictures::PagePicture;
pub use table::with_cells;

/// Returns the page, without the host part of the report.
///
/// # Errors
/// Errors of [`Report::to_json`].
pub fn to_html(report: &Report, assets: &PageAssets) -> Result<String, serde_json::Error> {
    let report = &Report { host: None, ..report.clone() };
    let shown = contents(report, assets);
    let links = shown.iter().map(|(id, title, _)| el("a", &[("href", &format!("#{id}"))], [markup::text(title)]));
    let nav = el("nav", &[("aria-label", "Parts of this page")], links);
    let parts = shown.iter().map(|(id, title, content)| section(id, title, content.clone()));
    let main = el("main", &[], parts);
    let save = head::save_link(&report.to_json()?);
    let body = el("body", &[], [head::head(report), nav, main, save]);
    Ok(whole_page(&format!("{} · {} · Basrelief", report.machine, report.input.name), POLICY, "", body))
}

type SectionContent = (&'static str, &'static str, Html);

/// Sections in their order, bottlenecks first. Empty sections are left out.
fn contents(report: &Report, assets: &PageAssets) -> Vec<SectionContent> {
    let all = [
        ("bottlenecks", "Bottlenecks", bottlenecks::bottleneck_section(report)),
        ("pictures", "Images", pictures::pictures(report, &assets.pictures)),
        ("diagram", "Block diagram", diagram::block_diagram(report, &assets.diagram)),
        ("units", "Cycle breakdown", units::units(report)),
        ("fifos", "FIFOs", fifos::fifos(report)),
        ("memories", "Memories", memories::memories(report)),
        ("frames", "Frames", frames::frames(report)),
        ("costs", "Cycles per object and polygon", costs(report)),
        ("sensitivity", "Sensitivity to assumed parameters", sensitivity(report)),
        ("hardware", "Hardware", hardware(report)),
        ("figures", "Figures", figures(report)),
        ("quality", "Quality", table::html("Images against the reference images", &text_sections::quality(report))),
        ("parameters", "Parameters", parameters::parameters(&assets.parameters)),
        ("warnings", "Warnings", el_list(&report.warnings)),
    ];
    all.into_iter().filter(|(_, _, content)| !content.is_empty()).collect()
}

/// Returns the key figures of a run, as escaped markup styled by [`STYLE`].
pub fn headline(report: &Report) -> String {
    head::big_numbers(head::numbers(report)).into_text()
}

/// A part of the page, for pages that are more than a report.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PageSection {
    /// Name of the section in addresses.
    pub id: &'static str,
    /// Heading of the section.
    pub title: &'static str,
    /// Escaped markup below the heading, styled by [`STYLE`].
    pub html: String,
}

/// The parts of the page that have something to say, as [`to_html`] shows them.
pub fn sections(report: &Report, assets: &PageAssets) -> Vec<PageSection> {
    let contents = contents(report, assets).into_iter();
    contents.map(|(id, title, html)| PageSection { id, title, html: html.into_text() }).collect()
}

fn el_list(items: &[String]) -> Html {
    if items.is_empty() {
        return Html::default();
    }
    el("ul", &[("class", "warnings")], items.iter().map(|item| el("li", &[], [sentence(item)])))
}

/// Sensitivity to assumed parameters.
fn sensitivity(report: &Report) -> Html {
    let Some(of) = &report.sensitivity else { return Html::default() };
    let failed = table::html("Did not finish", &sensitivity_tables::failed(of));
    [table::html(&sensitivity_tables::caption(of), &sensitivity_tables::changes(of)), failed].into_iter().collect()
}

/// Cycles per object and polygon.
fn costs(report: &Report) -> Html {
    use cost_tables::{attribution, objects, polygons};
    if report.costs.is_none() {
        return Html::default();
    }
    let says = "Every busy or stalled cycle of a unit counts for the object and polygon of the step that ends it. Busy and stall \
                percentages are of the row.";
    let lists = [
        table::html("Cycles by purpose", &attribution(report)),
        details("The most expensive objects", table::html("Objects", &objects(report, LISTED))),
        details("The most expensive polygons", table::html("Polygons", &polygons(report, LISTED))),
        details("Lifetimes of these polygons", lifetimes::draw(report)),
    ];
    std::iter::once(el_text("p", "quiet", says)).chain(lists).collect()
}

/// A bar for the area of each unit, FIFO, cache and port.
fn areas(report: &Report) -> Html {
    let Some(sum) = report.hardware_area() else { return Html::default() };
    let places = by_place(&report.hardware);
    let most = places.first().map_or(0, |of| of.area.area_ge);
    let row = |PlaceArea { place, kind, area }: &PlaceArea<'_>| {
        let bar = svg::bar(&[("amount", "gate equivalents".into(), area.area_ge)], most);
        vec![
            markup::text(place),
            markup::text(kind),
            bar,
            markup::text(thousands(area.area_ge)),
            markup::text(svg::percent_of(area.area_ge, sum.area_ge)),
        ]
    };
    let caption = format!("Area by place: {} gate equivalents (NAND2) in all", thousands(sum.area_ge));
    let columns = [
        ("where", Align::Left),
        ("kind", Align::Left),
        ("", Align::Left),
        ("gate equivalents", Align::Right),
        ("share", Align::Right),
    ];
    el("div", &[("class", "bars")], [with_cells(&caption, &columns, places.iter().map(row).collect())])
}

fn hardware(report: &Report) -> Html {
    let pieces =
        details("Every piece", table::html("Hardware, piece by piece", &hardware_tables::hardware_table(&report.hardware)));
    [areas(report), table::html("Totals by kind", &hardware_tables::totals(report)), pieces].into_iter().collect()
}

/// Counts, tables that only some machines have, and derived figures.
fn figures(report: &Report) -> Html {
    use text_sections::{circuits, columns, derived, processes, routes};
    let own: Vec<(&str, Table)> = vec![
        ("Routes", routes(report)),
        ("Circuits", circuits(report)),
        ("Processes", processes(report)),
        ("Derived figures", derived(report)),
    ];
    let tables = std::iter::once(counts_table(report)).chain(own.iter().map(|(caption, table)| table::html(caption, table)));
    let listed = work::tables(report);
    let lists = listed.iter().map(|list| details(&format!("Table: {}", list.name), table::html(list.name, &columns(list))));
    let columns = el("div", &[("class", "columns")], tables);
    [columns].into_iter().chain(lists).collect()
}

/// Table of the counts without a table of their own, each with its meaning.
fn counts_table(report: &Report) -> Html {
    let table = text_sections::figures(report);
    let row = |row: &Vec<String>| {
        let legend = row.first().and_then(|name| report.legend.get(name));
        let [unit, about] = legend.map_or_else(Default::default, |legend| [legend.unit.as_str(), legend.about.as_str()]);
        let cells = row.iter().map(String::as_str).chain([unit]).map(markup::text);
        cells.chain([sentence(about)]).collect()
    };
    let columns = [("figure", Align::Left), ("", Align::Right), ("unit", Align::Left), ("description", Align::Left)];
    table::with_cells("Counts", &columns, table.rows().iter().map(row).collect())
}
