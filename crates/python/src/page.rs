//! Reports as HTML pages, and as fragments for a notebook.

use crate::error::{CommandError, CommandResult, PythonResult};
use crate::pixels::GivenPixels;
use basrelief_report::html::{PageAssets, PagePicture, STYLE, headline, sections};
use basrelief_report::{Report, TextStyle, to_html, to_text};
use basrelief_sim::{page_assets, page_pictures};
use pyo3::{Python, pyfunction};

/// Width of text output [columns].
pub const WIDTH: usize = 120;

/// Sections shown in a notebook, in this order.
const SHOWN: [&str; 4] = ["pictures", "bottlenecks", "diagram", "units"];

pub fn report_of(text: &str) -> CommandResult<Report> {
    Report::from_json(text).map_err(CommandError::bad_input)
}

/// Returns the available pictures of a page.
pub fn pictures(image: Option<&GivenPixels>, reference: Option<&GivenPixels>) -> CommandResult<Vec<PagePicture>> {
    let Some(image) = image else { return Ok(vec![]) };
    let reference = reference.map(GivenPixels::picture).transpose()?;
    page_pictures(&image.picture()?, reference.as_ref()).map_err(CommandError::bad_input)
}

fn with_pictures(report: &Report, given: &(Option<GivenPixels>, Option<GivenPixels>)) -> CommandResult<PageAssets> {
    Ok(PageAssets {
        pictures: pictures(given.0.as_ref(), given.1.as_ref())?,
        ..page_assets(report).map_err(CommandError::bad_input)?
    })
}

/// Reads a report from the text of the file `name`, and removes the figures of the host.
#[pyfunction]
pub fn read_report(name: &str, text: &str) -> PythonResult<String> {
    let report = Report::from_json(text).map_err(CommandError::in_input(name))?;
    Ok(Report { host: None, ..report }.to_json().map_err(CommandError::bad_input)?)
}

/// Returns the report as text, as the command line prints it.
#[pyfunction]
pub fn text(report: &str) -> PythonResult<String> {
    Ok(to_text(&report_of(report)?, TextStyle { width: WIDTH, color: false }, &[]))
}

/// Returns the report as one page with image and reference image, as `--html` writes it.
#[pyfunction]
pub fn page(py: Python<'_>, report: String, pictures: (Option<GivenPixels>, Option<GivenPixels>)) -> PythonResult<String> {
    py.detach(|| {
        let report = report_of(&report)?;
        Ok(to_html(&report, &with_pictures(&report, &pictures)?).map_err(CommandError::bad_input)?)
    })
}

/// Returns the notebook fragment of a report: key figures, pictures, bottlenecks, block diagram, and cycle breakdown.
#[pyfunction]
pub fn part(py: Python<'_>, report: String, pictures: (Option<GivenPixels>, Option<GivenPixels>)) -> PythonResult<String> {
    py.detach(|| {
        let report = report_of(&report)?;
        let all = sections(&report, &with_pictures(&report, &pictures)?);
        let shown = SHOWN.iter().filter_map(|id| all.iter().find(|section| section.id == *id));
        let parts: String = shown.map(|section| format!("<h2>{}</h2>{}", section.title, section.html)).collect();
        Ok(format!("<div class=\"basrelief\"><style>{}</style>{}{parts}</div>", scoped(), headline(&report)))
    })
}

/// Rules of JupyterLab that would hide bars, draw key figures in a column, and keep light rows on a dark page.
const RESET: &str = "table { table-layout: auto; margin-left: 0; margin-right: 0; }
th, td { line-height: inherit; max-width: none; }
tbody tr { background: none; }
dt, dd { float: none; width: auto; }
dt { font-weight: normal; }
code { padding: 0; background: none; color: inherit; }
";

/// Returns the style sheet of a notebook fragment, which must not change the rest of the page. The repeated class outranks the rules of
/// JupyterLab for tables and lists. A browser without nested rules, or a site that shows notebooks without styles, shows plain tables.
fn scoped() -> String {
    let style = STYLE.replace(":root {", "& {").replace("\nbody {", "\n& {");
    format!(".basrelief.basrelief.basrelief {{\n{RESET}{style}}}")
}
