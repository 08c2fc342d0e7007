//! Reports as pages, and as parts of a notebook.

use crate::error::{Done, bad, within};
use crate::pixels::Given;
use basrelief_report::html::{Beside, PagePicture, STYLE, sections};
use basrelief_report::{Report, Style, to_html, to_text};
use basrelief_sim::{page_assets, page_pictures};
use pyo3::{Python, pyfunction};

/// Columns of a text.
pub const WIDTH: usize = 120;

/// The sections of a page that a notebook shows.
const SHOWN: [&str; 4] = ["bottlenecks", "pictures", "diagram", "units"];

pub fn report_of(text: &str) -> Done<Report> {
    Report::from_json(text).map_err(bad)
}

/// The pictures of a page, as far as they are there.
pub fn pictures(image: Option<&Given>, reference: Option<&Given>) -> Done<Vec<PagePicture>> {
    let Some(image) = image else { return Ok(vec![]) };
    let reference = reference.map(Given::picture).transpose()?;
    page_pictures(&image.picture()?, reference.as_ref()).map_err(bad)
}

fn with_pictures(report: &Report, (image, reference): (Option<Given>, Option<Given>)) -> Done<Beside> {
    Ok(Beside { pictures: pictures(image.as_ref(), reference.as_ref())?, ..page_assets(report).map_err(bad)? })
}

/// A report that was written to a file of this name, without what the host took.
#[pyfunction]
pub fn read_report(name: &str, text: &str) -> Done<String> {
    let report = Report::from_json(text).map_err(within(name))?;
    Report { host: None, ..report }.to_json().map_err(bad)
}

/// What the command line prints of a report.
#[pyfunction]
pub fn text(report: &str) -> Done<String> {
    Ok(to_text(&report_of(report)?, Style { width: WIDTH, color: false }, &[]))
}

/// The report as one page, as `--html` writes it; with the machine's picture and the exact one.
#[pyfunction]
pub fn page(py: Python<'_>, report: String, pictures: (Option<Given>, Option<Given>)) -> Done<String> {
    py.detach(|| {
        let report = report_of(&report)?;
        to_html(&report, &with_pictures(&report, pictures)?).map_err(bad)
    })
}

/// What a notebook shows of a report: what limits the run, its pictures, its block diagram, and where the cycles went.
#[pyfunction]
pub fn part(py: Python<'_>, report: String, pictures: (Option<Given>, Option<Given>)) -> Done<String> {
    py.detach(|| {
        let report = report_of(&report)?;
        let all = sections(&report, &with_pictures(&report, pictures)?);
        let shown = all.iter().filter(|section| SHOWN.contains(&section.id));
        let parts: String = shown.map(|section| format!("<h2>{}</h2>{}", section.title, section.html)).collect();
        Ok(format!("<div class=\"basrelief\"><style>{}</style>{parts}</div>", scoped()))
    })
}

/// The style sheet for a part of somebody else's page, which it must leave alone. A browser that does not know `@scope`, and a site that
/// shows notebooks without styles, shows plain tables.
fn scoped() -> String {
    let style = STYLE.replace(":root {", ":scope {").replace("\nbody {", "\n:scope {");
    format!("@scope (.basrelief) {{\n{style}}}")
}
